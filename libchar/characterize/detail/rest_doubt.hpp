#pragma once
// Does an inertial sensor whose strength is the same throughout rest? A car, a walk, a flying drone move evenly.

#include <optional>
#include <span>
#include <string_view>

#include "libchar/characterize/characterization.hpp"
#include "libchar/core/finding.hpp"
#include "libchar/fit/fit_result.hpp"

namespace libchar::detail {

/// Of an inertial sensor; nothing for another unit.
std::optional<AtRest> limit_at_rest(std::string_view unit);

/// `rounding`: density of the converter's, 0 where it is not known. Nothing where the spectrum is that of a sensor at
/// rest, or the unit that of no inertial sensor.
std::optional<Finding> doubt_rest(const NoiseFit& fit, std::string_view unit, double rounding);

/// What only several channels of a log show together: `judge_together` of their samples, and inertial channels that
/// look like noise while gyroscopes of the same log turn throughout.
void doubt_together(std::span<ChannelResult> channels);

}  // namespace libchar::detail
