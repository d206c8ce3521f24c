#include "libchar/replay/detail/judge/choice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace libchar {
namespace {

/// Ends of an interval whose ratio is more: the record does not tell how good the method is.
constexpr double kDecade = 10;
/// Share of the weights in one sensor beyond which the others have no part.
constexpr double kAlone = 0.99;
/// Scores that differ by rounding only.
constexpr double kEqual = 1e-9;

bool spans_decades(const AlgorithmResult& a) {
  return std::isfinite(a.rmse_ci95.low) && a.rmse_ci95.high > kDecade * a.rmse_ci95.low;
}

}  // namespace

bool combines_sensors(const AlgorithmResult& algorithm) {
  if (algorithm.weights.size() != 1) return true;
  double sum = 0, largest = 0;
  for (const double weight : algorithm.weights[0]) {
    sum += std::abs(weight);
    largest = std::max(largest, std::abs(weight));
  }
  return !(largest > kAlone * sum);
}

std::optional<std::size_t> choose_method(const ReplayResult& result,
                                         const std::vector<double>& costs,
                                         bool fusions) {
  double most_available = 0;
  for (const AlgorithmResult& a : result.algorithms)
    if (a.ran && !a.bound) most_available = std::max(most_available, a.availability);
  std::vector<std::size_t> all, known;
  for (std::size_t k = 0; k < result.algorithms.size(); ++k) {
    const AlgorithmResult& a = result.algorithms[k];
    if (!a.ran || a.bound || !std::isfinite(a.rmse) ||
        a.availability < kLeastAvailable * most_available)
      continue;
    if (fusions && !combines_sensors(a)) continue;
    all.push_back(k);
    if (!spans_decades(a)) known.push_back(k);
  }
  if (known.empty()) known = all;
  double smallest = std::numeric_limits<double>::infinity();
  for (const std::size_t k : known) smallest = std::min(smallest, result.algorithms[k].rmse);
  const double limit = smallest * (1 + (result.has_reference ? kPracticalTolerance : kEqual));
  std::optional<std::size_t> out;
  const auto order = [&](std::size_t k) {
    const AlgorithmResult& a = result.algorithms[k];
    return std::tuple(a.description->as_published, costs[k], k);
  };
  for (const std::size_t k : known)
    if (result.algorithms[k].rmse <= limit && (!out || order(k) < order(*out))) out = k;
  return out;
}

}  // namespace libchar
