#pragma once
// A sensor model from what was found in a recording.

#include <string>

#include "libchar/characterize/characterization.hpp"
#include "libchar/model/sensor_model.hpp"

namespace libchar {

/// Everything of a channel with a fit that a simulation needs, where it came from, and what was found about it. Its
/// Allan curve gives the range of averaging times that the recording covers; it may be without points.
SensorModel sensor_model_from(const ChannelResult& channel, const LogInfo& log);

/// The noise part alone, of a fit that knows no recording: `obtained` says of what ("fit of an Allan
/// curve"). `file` and `sha256` are those of the curve.
SensorModel sensor_model_from_curve(const Channel& channel, const NoiseFit& fit, const std::string& obtained,
                                    const LogInfo& source);

}  // namespace libchar
