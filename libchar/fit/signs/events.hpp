#pragma once
// Is it noise at all? What a noise spectrum cannot hold: steps, a warm-up, a straight drift. Found in time, against the
// fitted noise, and taken out as means with a sign before the noise is fitted again. Theory and figures:
// docs/theory/events.md.

#include <optional>
#include <string_view>
#include <vector>

#include "libchar/core/finding.hpp"
#include "libchar/fit/record/noise_powers.hpp"
#include "libchar/fit/signs/bursts.hpp"
#include "libchar/fit/signs/event.hpp"

namespace libchar {

struct EventOptions {
  double false_alarm = 0.003;  ///< of a record that is noise, over all kinds and places
  int most = 8;                ///< events looked for; where there are more, something else is the matter
  bool steps = true, warm_up = true, ramp = true, cycle = true;
};

/// Jumps between two levels, over and over: random telegraph noise; the steps found are some of them.
struct Telegraph {
  double size = 0, sd = 0;  ///< between the levels
  int jumps = 0;            ///< at least
  double dwell_s = 0;       ///< mean time at a level, at most
};

struct EventSearch {
  std::optional<detail::Bursts> bursts;  ///< in what the events leave
  std::vector<Event> events;             ///< in the order in which they were found
  std::vector<double> power;             ///< the noise they were found against: E c_k^2 of the series without them
  std::optional<Telegraph> telegraph;
  std::vector<double> leverage;   ///< what the events took of the degree of freedom of each c_k, k = 1.. at [k-1]
  bool more = false;              ///< stopped at `most` with more to find
  bool looks_like_one = false;    ///< of a first look: an event, or nearly
  double drift_gain = 0;          ///< 2 ln L by which a ramp, too weak for an event, is likelier than a random walk
  double cycle_gain = 0;          ///< the same of a cycle
  std::vector<Finding> findings;  ///< one for each event, in the unit given
};

/// Searches a series; at least 64 values, Error(numeric) below.
EventSearch find_events(const EventSeries& series, const NoisePowers& powers, const EventOptions& options = {},
                        std::string_view unit = {});

}  // namespace libchar
