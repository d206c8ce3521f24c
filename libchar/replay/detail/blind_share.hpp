#pragma once
// How much of a run the scores without a reference are made of. Leave-one-out runs an algorithm once for each sensor;
// where that costs more than is allowed it runs on stretches that are spread evenly over the run, and where those would
// be shorter than a cell of the error meters it is left out. The cost is counted (fusion::Entry::cost_ns), not
// measured: what is computed depends on no clock.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "libchar/fusion/registry.hpp"

namespace libchar {

/// Instants of the run, the first is 0.
struct BlindStretch {
  std::int64_t from = 0;         ///< the algorithm runs from here on
  std::int64_t scored_from = 0;  ///< and is scored from here on: it has found into the stretch
  std::int64_t to = 0;           ///< one behind the last
};

struct BlindShare {
  bool whole = true;
  std::vector<BlindStretch> stretches;  ///< when not whole; empty: left out
  double cost_s = 0;                    ///< of the whole run
  double share = 1;                     ///< of the run's instants that are scored
};

/// An algorithm that is run on other channels for scores: without each of them, on every second and on the others.
/// How many of n channels are left out in turn: all up to 32; of more than 128, where each part may
/// hold a number for each pair of channels, 4096 / n, and no fewer than four.
inline std::ptrdiff_t left_out_of(std::ptrdiff_t n) {
  return std::min(n, std::clamp<std::ptrdiff_t>(4096 / std::max<std::ptrdiff_t>(n, 1), 4, 32));
}

/// run: instants of it; the first `warm_up` are not scored. budget_s: of one core, infinite: no limit.
BlindShare blind_share(const fusion::Entry& entry, const fusion::Settings& settings, const fusion::Array& array,
                       std::int64_t run, std::int64_t warm_up, double budget_s);

}  // namespace libchar
