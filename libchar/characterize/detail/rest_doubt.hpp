#pragma once
// Does an inertial sensor whose strength is the same throughout rest? A car, a walk, a flying drone move evenly.

#include <optional>
#include <string_view>

#include "libchar/core/finding.hpp"
#include "libchar/fit/fit_result.hpp"

namespace libchar::detail {

/// `rounding`: density of the converter's, 0 where it is not known. Nothing where the spectrum is that of a sensor at
/// rest, or the unit that of no inertial sensor.
std::optional<Finding> doubt_rest(const NoiseFit& fit, std::string_view unit, double rounding);

}  // namespace libchar::detail
