#pragma once
// Where a clock does not go on: counters and hours that begin again, logs of which the first rows are
// of another run, clocks that restart.

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "libchar/log/recording.hpp"

namespace libchar {

inline constexpr std::int64_t kNsInSecond = 1000000000;

struct ClockWrap {
  std::int64_t range_ns = 0;  ///< what has to be added from here on
  std::string what;           ///< "the 32-bit clock ran over"
  bool local = false;         ///< an hour of local time
};

/// Why a clock steps back between two stamps as the file has them: a counter of 16 or 32 bits, signed
/// or not, in the stamps' own unit, us or ms; the seconds of a minute, an hour, a day, a week; an hour
/// of local time that stands twice. Nothing when the step has another cause.
std::optional<ClockWrap> find_wrap(std::int64_t before_ns, std::int64_t stamp_ns, const TimeBase& clock,
                                   double interval_ns);

/// What local time skips at the beginning of summer time, where that is all that two rows lie apart.
std::int64_t skipped_hour(std::int64_t before_ns, std::int64_t stamp_ns, const TimeBase& clock, double interval_ns);

/// How many of the first rows are none: of an earlier run, or of a clock that was not set yet. The next
/// ones rise, far away from them. Nor is a lone first row further away than the log of `rows` (0: no telling) is long.
std::size_t wild_start(std::span<const std::int64_t> stamps, const TimeBase& clock, std::uint64_t rows = 0);

/// Rows whose stamps lie before that of the row in front of all of them.
struct BackwardRows {
  std::uint64_t in_a_row = 0, rising = 0;
  std::int64_t first = 0, last = 0;
  std::string place;  ///< of the first

  void add(std::int64_t stamp) {
    if (in_a_row++ == 0) first = stamp;
    rising += in_a_row > 1 && stamp > last;
    last = stamp;
  }
  /// They go on by themselves: the clock began again.
  bool restarted() const { return 10 * rising >= 9 * (in_a_row - 1); }
};

}  // namespace libchar
