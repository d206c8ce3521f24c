#pragma once
// How well the points of an Allan curve are known: chi-square intervals by exact degrees of freedom.

#include "libchar/allan/allan_deviation.hpp"
#include "libchar/core/noise_terms.hpp"

namespace libchar {

/// Fills edf, ci68, ci95 and reliable of every point for the fitted mixture, and takes the bias
/// that SP 1065 states for it out of the modified and Hadamard total deviations (`bias`: raw
/// variance over this one), unless it is to stay. MTIE and TIE rms have no interval: edf stays 0.
void add_intervals(AllanCurve& curve, const Mixture& theta);

namespace detail {
/// Degrees of freedom, and the intervals that follow from them.
void set_dof(AllanPoint& point, double edf);
}  // namespace detail

}  // namespace libchar
