#pragma once
// What PX4's messages of sensors hold: a ULog names types and fields, but no units.
// Source: the comments of PX4's message definitions (msg/*.msg), from version 1.4 to 1.16.

#include <optional>
#include <string_view>

namespace libchar {

/// The unit of a field ("rad/s"), nothing where it is not known; `field` as in its own message and
/// without an index ("gyro_rad").
std::optional<std::string_view> px4_unit(std::string_view message, std::string_view field);

/// Is this a message that a sensor's driver, or what merges several, writes?
bool px4_sensor(std::string_view message);

/// Stamps, identities, counters, flags: what is no sample whatever the message ("device_id", "error_count").
bool px4_no_sample(std::string_view field);

}  // namespace libchar
