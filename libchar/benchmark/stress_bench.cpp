#include <algorithm>
#include <cmath>

#include "libchar/benchmark/bench_document.hpp"
#include "libchar/benchmark/detail/stress_cells.hpp"

namespace libchar {
namespace {

/// Wrong ones first, then what was compared by digits beyond the stated ones, then what held, then refusals.
double rank(const StressCell& cell) {
  switch (cell.outcome) {
    case StressOutcome::wrong:
      return -100;
    case StressOutcome::digits:
      return std::isnan(cell.stated) ? 50 + cell.digits : cell.digits - cell.stated;
    case StressOutcome::held:
      return 100;
    case StressOutcome::refused:
      return 101;
  }
  return 0;
}

}  // namespace

std::size_t StressBench::count(StressOutcome outcome) const {
  return static_cast<std::size_t>(
      std::count_if(cells.begin(), cells.end(), [&](const StressCell& cell) { return cell.outcome == outcome; }));
}

StressBench bench_stress(const StressBenchOptions& options, Progress& progress) {
  StressBench out;
  out.seed = options.seed;
  out.cells = stress_estimators(options, progress);
  for (auto& part : {stress_simulators(options), stress_fusion(options, progress)})
    out.cells.insert(out.cells.end(), part.begin(), part.end());
  std::stable_sort(out.cells.begin(), out.cells.end(),
                   [](const StressCell& a, const StressCell& b) { return rank(a) < rank(b); });
  return out;
}

}  // namespace libchar
