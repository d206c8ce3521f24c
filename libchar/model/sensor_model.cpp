#include "libchar/model/sensor_model.hpp"

#include <algorithm>
#include <cctype>

#include "libchar/core/units.hpp"

namespace libchar {
namespace {

bool is_letter(char c) {
  return std::isalpha(static_cast<unsigned char>(c)) != 0;
}

// The lower-case name up to a unit in brackets, trailing digits and marks dropped.
std::string stem_of(const std::string& name) {
  std::string stem = name.substr(0, name.find_first_of("([{"));
  while (!stem.empty() && !is_letter(stem.back())) stem.pop_back();
  std::transform(stem.begin(), stem.end(), stem.begin(), [](unsigned char c) {
    return static_cast<char>(std::tolower(c));
  });
  return stem;
}

}  // namespace

double simulated_value(const Coefficient& coefficient) {
  return coefficient.value.value_or(0);
}

std::string kind_of(const SensorModel& model) {
  if (!model.kind.empty()) return model.kind;
  const auto unit = find_unit(model.unit);
  if (!unit) return "sensor";
  switch (unit->quantity) {
    case Quantity::angular_rate:
      return "gyroscope";
    case Quantity::acceleration:
      return "accelerometer";
    case Quantity::magnetic_field:
      return "magnetometer";
    case Quantity::pressure:
      return "barometer";
    case Quantity::temperature:
      return "thermometer";
    default:
      return "sensor";
  }
}

std::string axis_of(const SensorModel& model) {
  if (!model.axis.empty()) return model.axis;
  const std::string stem = stem_of(model.channel);
  if (stem.empty() || stem.back() < 'x') return "";
  const std::string letter(1, stem.back());
  if (stem.size() == 1 || !is_letter(stem[stem.size() - 2])) return letter;
  // "ax", "gz", "wy", "gyrox": a word of the field in front of the letter, not any word ending in
  // x.
  static const std::array<const char*, 19> kWords = {"a",
                                                     "g",
                                                     "w",
                                                     "m",
                                                     "b",
                                                     "acc",
                                                     "accel",
                                                     "gyr",
                                                     "gyro",
                                                     "mag",
                                                     "omega",
                                                     "rate",
                                                     "acceleration",
                                                     "accelerometer",
                                                     "gyroscope",
                                                     "imu",
                                                     "angvel",
                                                     "linacc",
                                                     "axis"};
  const std::string front = stem.substr(0, stem.size() - 1);
  const auto ends_in = [&](std::string_view word) {
    return front == word || (front.ends_with(word) && front.size() > word.size() &&
                             !is_letter(front[front.size() - word.size() - 1]));
  };
  return std::any_of(kWords.begin(), kWords.end(), ends_in) ? letter : "";
}

}  // namespace libchar
