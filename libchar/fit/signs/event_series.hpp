#pragma once
// A record as means of many samples, for searches that look at all of it.

#include <span>
#include <vector>

#include "libchar/core/numeric/interval.hpp"

namespace libchar {

/// A record as the search sees it: evenly spaced values, each the mean of `per_point` samples; without missing ones.
struct EventSeries {
  std::vector<double> value;
  double start_s = 0;                ///< of the first value: the record may begin with missing ones
  double step_s = 0;                 ///< between values
  std::size_t per_point = 1;         ///< samples averaged in a value
  std::vector<Interval> unseen_s{};  ///< stretches that were missing, filled by straight lines
  bool ends_free = false;            ///< whatever phase noise puts into the first and the last value was taken out

  /// What noise puts into the orthonormal DCT-II of n values.
  struct Noise {
    std::vector<double> power;  ///< E c_k^2, k = 1..n-1 at [k-1]
    /// Share of the rounding (a clock's phase noise) of the first and the last sample, where it is
    /// largest: it moves all slow coefficients at once, as an event does.
    double ends = 0;
  };
};

namespace detail {

/// A long pause: `at_s` on the axis without pauses.
struct Pause {
  double at_s = 0, length_s = 0;
};

/// A record of several sessions on an axis without its long pauses. Changes nothing, and says no pause, where there is
/// none.
std::vector<Pause> leave_out_pauses(EventSeries& series);
/// The instant of the record.
double with_pauses(std::span<const Pause> pauses, double at_s);

}  // namespace detail

/// At most `points` means over the whole record; NaN samples are left out of them.
EventSeries event_series(std::span<const double> record, double rate_hz, std::size_t points = std::size_t{1} << 15U);

}  // namespace libchar
