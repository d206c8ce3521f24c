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

bool runs_as_often(const AlgorithmResult& a, double most_available) {
  return a.ran && !a.bound && a.availability >= kLeastAvailable * most_available;
}

double most_available(const ReplayResult& result) {
  double most = 0;
  for (const AlgorithmResult& a : result.algorithms)
    if (a.ran && !a.bound) most = std::max(most, a.availability);
  return most;
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

std::optional<std::size_t> choose_method(const ReplayResult& result, const std::vector<double>& costs, bool fusions) {
  const double most = most_available(result);
  std::vector<std::size_t> all, known;
  for (std::size_t k = 0; k < result.algorithms.size(); ++k) {
    const AlgorithmResult& a = result.algorithms[k];
    if (!std::isfinite(a.rmse) || !runs_as_often(a, most)) continue;
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

std::optional<std::size_t> choose_robust(const ReplayResult& result) {
  const double most = most_available(result);
  std::optional<std::size_t> out;
  int highest = 0;
  for (std::size_t k = 0; k < result.algorithms.size(); ++k) {
    const AlgorithmResult& a = result.algorithms[k];
    if (!runs_as_often(a, most) || a.description->withstands <= highest) continue;
    highest = a.description->withstands;
    out = k;
  }
  return out;
}

}  // namespace libchar
