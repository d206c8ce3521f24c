#pragma once
// What a noise spectrum cannot hold: a step, a warm-up, a straight drift. Each is a mean with a
// sign (docs/theory/events.md).

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/core/numeric/interval.hpp"

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
  double sd = 0;                           ///< of `size`
  double from_s = 0;                       ///< warm-up: the first sample that is present
  double tau_s = 0;                        ///< warm-up: time constant
  Interval tau_ci95;                       ///< upper end 0: the record sets none
  double slope = 0;                        ///< ramp: per s
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

}  // namespace libchar
