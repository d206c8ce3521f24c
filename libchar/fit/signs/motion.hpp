#pragma once
// Was the sensor at rest, and its noise the same throughout? Stretches of handling, a recording in motion, changes of
// the noise's strength. Needs no fitted noise. Theory and figures: docs/theory/events.md.

#include <optional>
#include <vector>

#include "libchar/core/finding.hpp"
#include "libchar/core/numeric/interval.hpp"
#include "libchar/fit/signs/event.hpp"

namespace libchar {

/// The noise is stronger or weaker from some instant on.
struct StrengthChange {
  EventKind kind =
      EventKind::step;  ///< step: at once; ramp, warm-up: little by little, over the record or from its beginning
  double at_s = 0;
  Interval at_ci95;
  double factor =
      1;  ///< of the standard deviation, after over before (ramp: end over beginning; warm-up: beginning over end)
  Interval factor_ci95;
  double score = 0, threshold = 0;
};

struct Motion {
  bool tested = false;              ///< no: too short (2048 values are needed), or most values repeat the one before
  bool whole = false;               ///< in motion throughout: no stretch to compare with
  std::vector<Interval> moving_s;   ///< stretches of motion or handling
  std::optional<Interval> still_s;  ///< the longest stretch without, and not louder than others
  /// The standard deviation of differences (the largest of three widths) over that of the still stretches alone.
  double louder = 1;
  std::vector<StrengthChange> changes;  ///< of what is left
  std::vector<Interval> louder_s;       ///< between their steps: stretches stronger than the weakest tenth
  std::vector<Finding> findings;
};

/// Searches a series as `event_series` makes it. A record of noise alone has motion or a change in less than one of a
/// hundred cases.
Motion find_motion(const EventSeries& series);

namespace detail {

/// What is left of `all_s` between stretches: the longest part.
Interval longest_between(std::vector<Interval> restless, const Interval& all_s);

}  // namespace detail

}  // namespace libchar
