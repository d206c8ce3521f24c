#pragma once
// Which names of columns say time, in what unit, and whose clock it is.

#include <cstdint>
#include <optional>
#include <string_view>

namespace libchar {

/// Whose clock a column is: a device stamps its samples when it takes them, a host when they arrive.
enum class Clock : std::uint8_t { device, unknown, host };

struct TimeName {
  std::int64_t unit_ns = 0;  ///< 0 = not said by the name
  Clock clock = Clock::unknown;
  bool letter = false;  ///< "t" or "ts" alone: time only where the values are a clock
  bool date = false;    ///< a word for dates and clocks: time only where the values are such
};

/// What the name of a column, without its unit, says of time; nothing when it says something else.
/// In capitals or not, in the languages that spreadsheets speak.
std::optional<TimeName> time_name(std::string_view stem);

}  // namespace libchar
