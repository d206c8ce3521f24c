#pragma once
// Points of a record with missing samples.

#include <cstdint>
#include <span>
#include <vector>

#include "libchar/allan/allan_deviation.hpp"

namespace libchar {

/// Are its terms differences of means, so that those of what is present will do?
bool of_window_means(const DeviationRow& row);

/// Points at the ascending `factors` from means over what is present (missing_samples.cpp); no
/// terms where there is no estimate.
std::vector<AllanPoint> points_of_present(std::span<const double> rate,
                                          const DeviationRow& row,
                                          const std::vector<std::uint64_t>& factors,
                                          double dt_s);

/// Says what was taken off for missing samples, and at how many averaging times (`without`,
/// ascending) there is no estimate.
void note_missing(const std::vector<std::uint64_t>& without, AllanCurve& curve);

}  // namespace libchar
