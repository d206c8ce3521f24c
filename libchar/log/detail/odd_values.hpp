#pragma once
// Values that are no samples, in the same words whatever the format: each kind is counted with its first places.

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "libchar/core/finding.hpp"
#include "libchar/log/recording.hpp"

namespace libchar {

inline constexpr std::string_view kInfiniteValues = "infinities, taken as missing samples";
inline constexpr std::string_view kNumbersOutOfRange = "numbers out of the range of a double, taken as missing samples";
inline constexpr std::string_view kNumbersTooSmall = "numbers with an exponent below those of doubles, read as 0";
inline constexpr std::string_view kRoundedIntegers = "64-bit integers above 2^53 do not fit a double and were rounded";

/// "empty or NaN cells, taken as missing samples (gyro_x 3, gyro_y 1)"; no counts: without them.
std::string missing_cells(const std::vector<Channel>& channels, const std::vector<std::uint64_t>& missing_per_channel);

/// The first places of odd values in the order of the rows, whatever blocks they were read in.
struct OddPlaces {
  static constexpr std::size_t kShown = 3;
  std::vector<std::pair<std::uint64_t, std::size_t>> first = {};  ///< row, channel
  std::uint64_t count = 0;

  void add(std::uint64_t row, std::size_t channel);
  /// `n` of a block, of which the first alone is known: a channel has one place.
  void add_block(std::uint64_t row, std::size_t channel, std::uint64_t n);
  void say(std::string_view code, std::string_view sentence,
           const std::function<std::string(std::uint64_t row, std::size_t channel)>& place_of,
           Findings& findings) const;
};

/// Sources whose samples stand in one row: how long behind the first each is stamped, and from one row to the next.
struct Turns {
  std::vector<double> behind_s;
  double period_s = 0;
};

/// Those of `names` that are stamped apart from the first (stamps_apart).
void say_apart(const std::vector<std::string>& names, const Turns& turns, Findings& findings);

}  // namespace libchar
