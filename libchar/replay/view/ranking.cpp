#include "libchar/replay/view/ranking.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace libchar {
namespace {

// A number before none, a smaller one before a larger.
bool better(double x, double y) {
  return std::isfinite(x) && (!std::isfinite(y) || x < y);
}

std::vector<bool> front(const ReplayResult& result,
                        double (*cost)(const AlgorithmResult& algorithm)) {
  const auto& all = result.algorithms;
  const auto candidate = [&](const AlgorithmResult& a) {
    return a.ran && !a.bound && std::isfinite(a.rmse) && std::isfinite(cost(a));
  };
  std::vector<bool> out(all.size(), false);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!candidate(all[i])) continue;
    out[i] = std::none_of(all.begin(), all.end(), [&](const AlgorithmResult& other) {
      return candidate(other) && other.rmse <= all[i].rmse && cost(other) <= cost(all[i]) &&
             (other.rmse < all[i].rmse || cost(other) < cost(all[i]));
    });
  }
  return out;
}

}  // namespace

std::vector<const AlgorithmResult*> ranked(const ReplayResult& result) {
  std::vector<const AlgorithmResult*> out;
  for (const AlgorithmResult& a : result.algorithms)
    if (a.ran) out.push_back(&a);
  std::stable_sort(out.begin(), out.end(), [](const auto* a, const auto* b) {
    return better(a->rmse, b->rmse);
  });
  return out;
}

std::vector<const AlgorithmResult*> ranked_by_input(const ReplayResult& result, std::size_t input) {
  std::vector<const AlgorithmResult*> out = ranked(result);
  std::erase_if(out, [&](const AlgorithmResult* a) { return input >= a->inputs.size(); });
  std::stable_sort(out.begin(), out.end(), [&](const auto* a, const auto* b) {
    return better(a->inputs[input].error.rmse, b->inputs[input].error.rmse);
  });
  return out;
}

std::vector<SkippedAlgorithms> skipped_algorithms(const ReplayResult& result) {
  std::vector<SkippedAlgorithms> out;
  for (const AlgorithmResult& a : result.algorithms) {
    if (a.ran) continue;
    const std::string front = std::string(a.description->name) + " ";
    const std::string reason = a.why.starts_with(front) ? a.why.substr(front.size()) : a.why;
    const auto known = std::find_if(
        out.begin(), out.end(), [&](const SkippedAlgorithms& s) { return s.reason == reason; });
    if (known == out.end())
      out.push_back({reason, {a.label}});
    else
      known->labels.push_back(a.label);
  }
  return out;
}

ParetoFront pareto_front(const ReplayResult& result) {
  return {front(result, [](const AlgorithmResult& a) { return a.ns_per_sample; }),
          front(result, [](const AlgorithmResult& a) {
            return a.peak_bytes ? static_cast<double>(*a.peak_bytes)
                                : std::numeric_limits<double>::quiet_NaN();
          })};
}

}  // namespace libchar
