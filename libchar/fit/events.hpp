#pragma once
// Is it noise at all? What a noise spectrum cannot hold: steps, a warm-up, a straight drift. Found in time, against the fitted noise,
// and taken out as means with a sign before the noise is fitted again. Theory and figures: docs/theory/events.md.

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/core/interval.hpp"
#include "libchar/core/noise_terms.hpp"

namespace libchar {

enum class EventKind { step, warm_up, ramp };
/// "step", "warm-up", "ramp".
std::string_view event_name(EventKind kind);

/// Something in a record that is a mean and no noise. Times are from the record's first sample.
struct Event {
  EventKind kind = EventKind::step;
  double at_s = 0;      ///< step: the first sample after it
  Interval at_ci95;     ///< step: where it is with 95 %
  bool in_gap = false;  ///< step: while samples were missing
  /// step: after less before; warm-up: at the first sample; ramp: last sample less first
  double size = 0;
  double sd = 0;         ///< of `size`
  double from_s = 0;     ///< warm-up: the first sample that is present
  double tau_s = 0;      ///< warm-up: time constant
  Interval tau_ci95;     ///< upper end 0: the record sets none
  double slope = 0;      ///< ramp: per s
  double score = 0;      ///< |size| / sd, or the root of what 2 ln L gained where that is less
  double threshold = 0;  ///< what noise alone passes as often as `false_alarm` says
  std::vector<EventKind> not_told_from{};  ///< kinds that explain the record nearly as well
};

/// A record as the search sees it: evenly spaced values, each the mean of `per_point` samples; without missing ones.
struct EventSeries {
  std::vector<double> value;
  double start_s = 0;                ///< of the first value: the record may begin with missing ones
  double step_s = 0;                 ///< between values
  std::uint64_t per_point = 1;       ///< samples averaged in a value
  std::vector<Interval> unseen_s{};  ///< stretches that were missing, filled by straight lines
};

/// At most `points` means over the whole record; NaN samples are left out of them.
EventSeries event_series(std::span<const double> record,
                         double rate_hz,
                         std::uint64_t points = std::uint64_t{1} << 15U);

/// E c_k^2, k = 1..n-1 at [k-1], of the orthonormal DCT-II of a series of n values, according to the noise that the caller fits to it.
using NoisePowers = std::function<std::vector<double>(const EventSeries& series)>;

/// The same of a mixture for n means of `per_point` samples; `shape` multiplies the power at a frequency in Hz (none: 1).
std::vector<double> mixture_powers(const Mixture& theta,
                                   std::uint64_t n,
                                   std::uint64_t per_point,
                                   double rate_hz,
                                   const std::function<double(double)>& shape = {});

/// The mixture of white noise, flicker and walk that fits a series from its slowest coefficients up, as far as it describes them:
/// what `find_events` uses where the caller has no better.
NoisePowers fitted_powers();

struct EventOptions {
  double false_alarm = 0.003;  ///< of a record that is noise, over all kinds and places
  int most = 8;  ///< events looked for; where there are more, something else is the matter
  bool steps = true, warm_up = true, ramp = true;
};

/// Jumps between two levels, over and over: random telegraph noise, of which the steps found are a few.
struct Telegraph {
  double size = 0, sd = 0;  ///< between the levels
  int jumps = 0;            ///< at least
  double dwell_s = 0;       ///< mean time at a level, at most
};

struct EventSearch {
  std::vector<Event> events;  ///< in the order in which they were found
  std::vector<double>
      power;  ///< the noise they were found against: E c_k^2 of the series without them
  std::optional<Telegraph> telegraph;
  int spent = 0;                       ///< degrees of freedom that the events took from the noise
  bool more = false;                   ///< stopped at `most` with more to find
  std::vector<std::string> sentences;  ///< one an event, in the unit given
};

/// Searches a series; at least 64 values, Error(numeric) below.
EventSearch find_events(const EventSeries& series,
                        const NoisePowers& powers,
                        const EventOptions& options = {},
                        std::string_view unit = {});

/// Takes the events out of a record at its full rate (its mean is not kept).
void subtract_events(std::span<const Event> events, double rate_hz, std::span<double> record);

/// "A step of 0.125 ± 0.004 deg/s at 740 s (between 739.8 and 740.3 s)."
std::string event_sentence(const Event& event, std::string_view unit);

}  // namespace libchar
