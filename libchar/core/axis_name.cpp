#include "libchar/core/axis_name.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <span>

#include "libchar/core/text/text.hpp"

namespace libchar {
namespace {

bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }

// The lower-case name up to a unit in brackets, trailing digits and marks dropped.
std::string stem_of(std::string_view name) {
  std::string stem(name.substr(0, name.find_first_of("([{")));
  while (!stem.empty() && !is_letter(stem.back())) stem.pop_back();
  return ascii_lower(stem);
}

// A word of the field in front of the letter, not any word ending in x.
constexpr std::array<std::string_view, 19> kWords = {
    "a",         "g",    "w",      "m",      "b",    "acc",          "accel",
    "gyr",       "gyro", "mag",    "omega",  "rate", "acceleration", "accelerometer",
    "gyroscope", "imu",  "angvel", "linacc", "axis"};

constexpr std::array<std::string_view, 11> kRateWords = {
    "g", "w", "gyr", "gyro", "gyroscope", "omega", "rate", "angvel", "dtheta", "delta_angle", "deltaangle"};

// In a word of its own: not any text that ends so.
bool ends_in_any(std::string_view text, std::span<const std::string_view> words) {
  return std::any_of(words.begin(), words.end(), [&](std::string_view word) {
    return text == word || (text.ends_with(word) && !is_letter(text[text.size() - word.size() - 1]));
  });
}

}  // namespace

bool detail::names_angular_rate(std::string_view channel) {
  const AxisName name = axis_name(channel);
  std::string front = name.axis != 0 ? name.front : stem_of(channel);
  while (!front.empty() && !is_letter(front.back())) front.pop_back();
  return ends_in_any(front, kRateWords);
}

bool detail::names_mass(std::string_view channel) {
  static constexpr std::array<std::string_view, 11> words = {"load", "loadcell", "weight", "mass",    "scale", "scales",
                                                             "hx",   "balance",  "tare",   "gewicht", "poids"};
  const std::string text = ascii_lower(channel.substr(0, channel.find_first_of("([{")));
  for (std::size_t at = 0; at < text.size();) {
    std::size_t end = at;
    while (end < text.size() && is_letter(text[end])) ++end;
    if (std::find(words.begin(), words.end(), std::string_view(text).substr(at, end - at)) != words.end()) return true;
    at = end + 1;
  }
  return false;
}

AxisName axis_name(std::string_view channel) {
  const std::string stem = stem_of(channel);
  if (stem.empty() || stem.back() < 'x') return {};
  AxisName out{stem.back(), stem.substr(0, stem.size() - 1)};
  if (out.front.empty() || !is_letter(out.front.back())) return out;
  return ends_in_any(out.front, kWords) ? out : AxisName{};
}

}  // namespace libchar
