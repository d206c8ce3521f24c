#pragma once
// Which axis of a triad a channel is, by its name.

#include <string>
#include <string_view>

namespace libchar {

struct AxisName {
  char axis = 0;      ///< 'x', 'y' or 'z'; 0: the name says none
  std::string front;  ///< the name in lower case without unit, marks at its end and that letter
};

/// "gyr_x", "ax", "Gyro Y [deg/s]", "wz": a letter behind a mark, or behind a word of the field.
AxisName axis_name(std::string_view channel);

namespace detail {

/// Whether the name is that of a gyroscope's channel or of what one measures: "gx", "gyro_x", "wz", "delta_angle[0]".
bool names_angular_rate(std::string_view channel);

/// Whether the name is that of a balance or a load cell, whose g is the gram: "load", "weight_1", "HX711", "net mass".
bool names_mass(std::string_view channel);

}  // namespace detail

}  // namespace libchar
