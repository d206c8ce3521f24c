#pragma once
// What is known of a stamp that is not one regular step behind the last: how much of a gap lies
// inside the window that was asked for, whether a counter ran over, how late several rows are
// together.

#include <cstdint>
#include <optional>
#include <vector>

namespace libchar {

/// Grid points first … last behind a row; none when last < first.
struct GridStretch {
  std::int64_t first = 1, last = 0;
  std::uint64_t count() const {
    return last < first ? 0 : static_cast<std::uint64_t>(last - first + 1);
  }
};

/// Of the `gap` missing grid points behind a row `before_ns` after the first stamp: those from
/// `from_ns` on and before `to_ns` (INT64_MAX = no end), also after the first stamp.
GridStretch gap_in_window(
    std::int64_t gap, double before_ns, double dt_ns, std::int64_t from_ns, std::int64_t to_ns);

struct Rollover {
  int bits = 32;
  std::int64_t range_ns = 0;  ///< what has to be added from here on
};

/// The counter of 16 or 32 bits that ran over between two stamps as the file has them; nothing when
/// the step back has another cause.
std::optional<Rollover> find_rollover(std::int64_t before_ns,
                                      std::int64_t stamp_ns,
                                      std::int64_t unit_ns,
                                      double dt_ns);

/// Grid points that a row and the rows behind it are late together: a single late row whose
/// followers are on time is no gap. `lags` starts with the row's own.
std::int64_t common_lag(std::vector<double> lags);

}  // namespace libchar
