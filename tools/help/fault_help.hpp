#pragma once

namespace sensorchar {

/// The help of --fault, in every verb that takes it.
inline constexpr const char* kFaultHelp =
    "SENSOR:KIND[=VALUE]@FROM..TO in seconds; KIND scale, bias, ramp, stuck, saturation, noise, dropout";

}  // namespace sensorchar
