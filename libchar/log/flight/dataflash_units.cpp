#include "libchar/log/flight/dataflash_units.hpp"

#include <algorithm>
#include <array>

namespace libchar {
namespace {

constexpr std::array<std::string_view, 8> kFamilies = {
    "GYR", "ACC", "IMU", "MAG", "BARO", "BAR", "ARSP", "ISBD"};

constexpr std::array<std::string_view, 13> kNoSample = {"TimeUS",
                                                        "TimeMS",
                                                        "SampleUS",
                                                        "SMS",
                                                        "Offset",
                                                        "GndTemp",
                                                        "GHz",
                                                        "AHz",
                                                        "OfsX",
                                                        "OfsY",
                                                        "OfsZ",
                                                        "Primary",
                                                        "Pri"};

// "IMU2" is of the family IMU: older versions have a message for each sensor.
std::string_view family_of(std::string_view message) {
  const auto found = std::find_if(kFamilies.begin(), kFamilies.end(), [&](std::string_view family) {
    if (!message.starts_with(family)) return false;
    const std::string_view rest = message.substr(family.size());
    return rest.empty() || (rest.size() == 1 && rest[0] >= '1' && rest[0] <= '9');
  });
  return found == kFamilies.end() ? std::string_view() : *found;
}

bool is_axis(std::string_view field, std::string_view front) {
  return field.size() == front.size() + 1 && field.starts_with(front) && field.back() >= 'X' &&
         field.back() <= 'Z';
}

}  // namespace

std::string dataflash_unit(std::string_view message, std::string_view field) {
  const std::string_view family = family_of(message);
  if (family == "GYR" || family == "IMU" || family == "ACC") {
    if (is_axis(field, "Gyr")) return "rad/s";
    if (is_axis(field, "Acc")) return "m/s^2";
    if (field == "Temp" || field == "T") return "degC";
  }
  if (family == "MAG" && is_axis(field, "Mag")) return "mGauss";
  if (family == "BARO" || family == "BAR") {
    if (field == "Press") return "Pa";
    if (field == "Temp") return "degC";
    if (field == "Alt") return "m";
  }
  return "";
}

std::string plain_unit(std::string_view label) {
  if (label == "UNKNOWN" || label == "instance" || label == "satellites") return "";
  if (label == "deglatitude" || label == "deglongitude" || label == "degheading") return "deg";
  if (label == "m/s/s") return "m/s^2";
  if (label == "rad/s/s") return "rad/s^2";
  if (label == "deg/s/s") return "deg/s^2";
  return std::string(label);
}

bool dataflash_sensor(std::string_view message) {
  return !family_of(message).empty();
}

bool dataflash_no_sample(std::string_view field) {
  return field.starts_with("MO") ||
         std::find(kNoSample.begin(), kNoSample.end(), field) != kNoSample.end();
}

}  // namespace libchar
