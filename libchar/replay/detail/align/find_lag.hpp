#pragma once
// The lag between sensors and reference of a scene, estimated.

#include "libchar/replay/detail/align/instants.hpp"

namespace libchar {

/// Seconds by which the sensors lag the reference, from the stretch `window`. Throws Error(numeric)
/// when they are too little alike, Error(input) when the reference is slower than the sensors.
double find_lag(const Scene& scene,
                const Instants& instants,
                const TimeWindow& window,
                Progress& progress);

}  // namespace libchar
