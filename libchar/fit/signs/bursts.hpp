#pragma once
// Bursts: stretches of a record that are disturbed, and not Gaussian at their length.

#include <optional>
#include <span>

#include "libchar/fit/signs/event.hpp"

namespace libchar::detail {

struct Bursts {
  double tau_s = 0;     ///< averaging time at which they are strongest
  double kurtosis = 3;  ///< of differences of neighbouring means
  double core = 1;      ///< standard deviation of the undisturbed differences over that of all
};

/// None where the means of 1, 2, 4 and 8 values of the series, less the events, are Gaussian, as those of noise of any
/// colour are; none of a short series, or of a coarse one, where values repeat.
std::optional<Bursts> find_bursts(const EventSeries& series, std::span<const Event> events);

}  // namespace libchar::detail
