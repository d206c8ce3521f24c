#include "libchar/benchmark/detail/pareto.hpp"

#include <cmath>
#include <limits>

namespace libchar {

std::vector<double> front_gaps(const std::vector<CostAndError>& points) {
  std::vector<double> gaps(points.size(), std::numeric_limits<double>::quiet_NaN());
  const auto counts = [](const CostAndError& p) {
    return !std::isnan(p.cost) && !std::isnan(p.error);
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!counts(points[i])) continue;
    double least = points[i].error;
    for (const CostAndError& other : points)
      if (counts(other) && other.cost <= points[i].cost && other.error < least) least = other.error;
    gaps[i] = least == points[i].error ? 0 : points[i].error / least - 1;
  }
  return gaps;
}

}  // namespace libchar
