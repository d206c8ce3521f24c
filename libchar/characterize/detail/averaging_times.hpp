#pragma once
// Who is the lowest at which averaging time.

#include <string>
#include <vector>

#include "libchar/characterize/compare/characterization_comparison.hpp"

namespace libchar::detail {

/// A curve at an averaging time as a coefficient, interpolated on logarithmic axes: not fitted beyond its ends,
/// undetermined where it has no interval.
Coefficient curve_at(const std::vector<AllanPoint>& curve, double tau_s);

/// Ten averaging times a decade where two curves reach at least.
std::vector<double> compared_times(const ComparedGroup& group);

/// Octaves of them: neighbouring times share their samples, and an octave is about one judgement.
std::size_t octaves_of(const ComparedGroup& group);

/// Times, ranges and the sentence of a group. `share`: of each judgement.
void compare_times(ComparedGroup& group, double share);

}  // namespace libchar::detail
