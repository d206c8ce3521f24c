#pragma once
// Short runs of missing samples, filled with draws of what the record does around them.

#include <span>
#include <vector>

namespace libchar {

/// The record with runs of up to 16 missing samples filled; empty when there are none, or more than
/// 5 % of the samples are in them (then closing them up is as good). Longer runs stay missing.
std::vector<double> bridged(std::span<const double> record);

}  // namespace libchar
