#pragma once
// The quantities that are compared from device to device.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "libchar/core/document/enum_table.hpp"
#include "libchar/core/noise_terms.hpp"

namespace libchar {

/// What is known of a channel: the first five are the terms of core/noise_terms.hpp, in their order.
enum class DeviceQuantity : std::uint8_t {
  white_noise,
  bias_instability,
  random_walk,
  quantization,
  rate_ramp,
  gauss_markov_sigma,
  gauss_markov_time,
  turn_on_bias,             ///< mean of the samples
  temperature_coefficient,  ///< the linear one, at the mean temperature
};
template <>
inline constexpr auto enum_table<DeviceQuantity> =
    enum_words<DeviceQuantity,
               "white_noise bias_instability random_walk quantization rate_ramp gauss_markov_sigma "
               "gauss_markov_time turn_on_bias temperature_coefficient">;
inline constexpr std::size_t kDeviceQuantities = enum_table<DeviceQuantity>.size();

DeviceQuantity quantity_of(Term term);
std::optional<Term> term_of(DeviceQuantity quantity);
/// Never negative, and known by a relative uncertainty: compared as logarithm.
bool in_logarithm(DeviceQuantity quantity);
/// "White noise", "Turn-on bias"…
std::string title_of(DeviceQuantity quantity);
/// Of its values, for a channel in `channel_unit`; the thermometer's unit is K or °C.
std::string unit_of(DeviceQuantity quantity, std::string_view channel_unit);

}  // namespace libchar
