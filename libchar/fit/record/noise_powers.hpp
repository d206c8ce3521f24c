#pragma once
// What noise puts into the cosine transform of a series of means: the measure that events are found against.

#include <functional>

#include "libchar/fit/signs/event.hpp"

namespace libchar {

/// Of a series, by the noise that is fitted to it.
using NoisePowers = std::function<EventSeries::Noise(const EventSeries& series)>;

/// The mixture of white noise, flicker, walk and quantization (white phase noise of a clock) that fits a series. It is
/// fitted from the slowest coefficients up, as far as it describes them. `find_events` uses it where the caller has no
/// better one.
NoisePowers fitted_powers();

}  // namespace libchar
