#include "libchar/core/axis_name.hpp"

#include <algorithm>
#include <array>
#include <cctype>

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

}  // namespace

AxisName axis_name(std::string_view channel) {
  const std::string stem = stem_of(channel);
  if (stem.empty() || stem.back() < 'x') return {};
  AxisName out{stem.back(), stem.substr(0, stem.size() - 1)};
  if (out.front.empty() || !is_letter(out.front.back())) return out;
  const auto ends_in = [&](std::string_view word) {
    return out.front == word || (out.front.ends_with(word) && out.front.size() > word.size() &&
                                 !is_letter(out.front[out.front.size() - word.size() - 1]));
  };
  return std::any_of(kWords.begin(), kWords.end(), ends_in) ? out : AxisName{};
}

}  // namespace libchar
