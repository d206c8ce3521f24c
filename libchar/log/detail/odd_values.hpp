#pragma once
// Values that are no samples, in the same words whatever the format: each kind is counted with its first places.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/core/finding.hpp"
#include "libchar/log/recording.hpp"

namespace libchar {

inline constexpr std::string_view kInfiniteValues = "infinities, taken as missing samples";
inline constexpr std::string_view kNumbersOutOfRange = "numbers out of the range of a double, taken as missing samples";
inline constexpr std::string_view kNumbersTooSmall = "numbers with an exponent below those of doubles, read as 0";

/// "empty or NaN cells, taken as missing samples (gyro_x 3, gyro_y 1)"; no counts: without them.
std::string missing_cells(const std::vector<Channel>& channels, const std::vector<std::uint64_t>& missing_per_channel);

/// Sources whose samples stand in one row: how long behind the first each is stamped, and from one row to the next.
struct Turns {
  std::vector<double> behind_s;
  double period_s = 0;
};

/// Those of `names` that are stamped apart from the first (stamps_apart).
void say_apart(const std::vector<std::string>& names, const Turns& turns, Findings& findings);

}  // namespace libchar
