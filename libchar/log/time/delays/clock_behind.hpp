#pragma once
// The even clock behind stamps that come late by a good part of an interval each, some rows of which are lost: steps
// tell neither there. With the right interval the phases of all stamps agree, however many rows are missing, so it is
// where the periodogram of the stamps (Rayleigh's test) has its peak.

#include <cstdint>
#include <optional>
#include <vector>

namespace libchar {

/// Of `stamps`, whose usual interval is about `ns`.
struct EvenClock {
  bool needed = false;       ///< many steps are no multiples of the usual one
  std::optional<double> ns;  ///< of the clock behind them; nothing where they have none
};
EvenClock clock_behind(const std::vector<std::int64_t>& stamps, double ns);

}  // namespace libchar
