#pragma once
// Short runs of missing samples, filled with draws of what the record does around them.

#include <span>
#include <vector>

namespace libchar {

/// The record with runs of up to 16 missing samples filled; empty when there are none, or more than
/// 5 % of the samples are in them (then closing them up is as good). Longer runs stay missing.
std::vector<double> bridged(std::span<const double> record);

/// The same of a clock's phase, of up to three quarters of its readings and in runs of up to an eighth: a rate across a missing reading is not a missing rate,
/// for the phase goes on from where it was. Filled in place; how many were.
std::size_t bridge_phase(std::vector<double>& phase);

}  // namespace libchar
