#pragma once
// What ArduPilot's messages of sensors hold, where a log does not say it itself (FMTU came in 2018).
// Source: ArduPilot's libraries/AP_Logger/LogStructure.h and those of its sensors.

#include <string>
#include <string_view>

namespace libchar {

/// The unit of a field as ArduPilot writes it in all versions; "" where it is not known.
std::string dataflash_unit(std::string_view message, std::string_view field);

/// A UNIT's label as a unit: "UNKNOWN" and "instance" are none, "deglatitude" is "deg", "m/s/s" is "m/s^2".
std::string plain_unit(std::string_view label);

/// Is this a message that a sensor's driver writes ("GYR", "IMU2", "BARO")?
bool dataflash_sensor(std::string_view message);

/// Offsets, counters, health: what is no sample of a sensor.
bool dataflash_no_sample(std::string_view field);

}  // namespace libchar
