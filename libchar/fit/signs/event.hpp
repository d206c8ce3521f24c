#pragma once
// What a noise spectrum cannot hold: a step, a warm-up, a straight drift. Each is a mean with a
// sign (docs/theory/events.md).

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/core/numeric/interval.hpp"

namespace libchar {

enum class EventKind { step, warm_up, ramp, cycle };
/// "step", "warm-up", "ramp", "cycle".
std::string_view event_name(EventKind kind);

/// Something in a record that is a mean and no noise. Times are from the record's first sample.
struct Event {
  EventKind kind = EventKind::step;
  double at_s = 0;      ///< step: the first sample after it
  Interval at_ci95;     ///< step: where it is with 95 %
  bool in_gap = false;  ///< step: while samples were missing
  /// step: after less before; warm-up: at the first sample; ramp: last sample less first; cycle: amplitude
  double size = 0;
  double sd = 0;                           ///< of `size`
  double from_s = 0;                       ///< warm-up, cycle: the first sample that is present
  double tau_s = 0;                        ///< warm-up: time constant
  Interval tau_ci95;                       ///< upper end 0: the record sets none
  double slope = 0;                        ///< ramp: per s
  double period_s = 0, phase = 0;          ///< cycle: size cos(2 pi (t - from_s) / period - phase)
  double score = 0;                        ///< |size| / sd, or the root of what 2 ln L gained where that is less
  double threshold = 0;                    ///< what noise alone passes as often as `false_alarm` says
  std::vector<EventKind> not_told_from{};  ///< kinds that explain the record nearly as well
};

/// Takes the events out of a record at its full rate (its mean is not kept).
void subtract_events(std::span<const Event> events, double rate_hz, std::span<double> record);

/// Mean of the events over `count` samples from `first` on, both of them in samples of the record
/// and not necessarily whole.
double event_mean(std::span<const Event> events, double rate_hz, double first, double count);

/// "A step of 0.125 ± 0.004 deg/s at 740 s (between 739.8 and 740.3 s)."
std::string event_sentence(const Event& event, std::string_view unit);
namespace detail {
/// "33.3 s (between 33.1 and 33.5 s)": without the interval where its ends read alike.
std::string place_and_interval(double at_s, const Interval& ci95);
}  // namespace detail

// A record as means of many samples, for searches that look at all of it.

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

/// Means of this many points each, without what was unseen.
EventSeries means_of(const EventSeries& series, std::size_t each);

}  // namespace detail

/// At most `points` means over the whole record; NaN samples are left out of them.
EventSeries event_series(std::span<const double> record, double rate_hz, std::size_t points = std::size_t{1} << 15U);

}  // namespace libchar
