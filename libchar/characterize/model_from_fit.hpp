#pragma once
// A sensor model from what was found in a recording.

#include <string>

#include "libchar/allan/allan_deviation.hpp"
#include "libchar/fit/fit_result.hpp"
#include "libchar/log/quality.hpp"
#include "libchar/log/recording.hpp"
#include "libchar/model/sensor_model.hpp"

namespace libchar {

/// Everything of the fit that a simulation needs, and where it came from. `allan` gives the range
/// of averaging times that the recording covers; it may be without points.
SensorModel sensor_model_from(const Channel& channel,
                              const LogInfo& log,
                              const ChannelQuality& quality,
                              const NoiseFit& fit,
                              const AllanCurve& allan);

/// The noise part alone, of a fit that knows no recording: `obtained` says of what ("fit of an Allan
/// curve"). `file` and `sha256` are those of the curve.
SensorModel sensor_model_from_curve(const Channel& channel,
                                    const NoiseFit& fit,
                                    const std::string& obtained,
                                    const LogInfo& source);

}  // namespace libchar
