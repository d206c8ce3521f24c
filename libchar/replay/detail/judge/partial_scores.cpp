#include "libchar/replay/detail/judge/partial_scores.hpp"

#include <algorithm>
#include <cmath>

namespace libchar {
namespace {

/// Half the length of an interval of a logarithm.
double log_reach(const Interval& interval) { return std::log(interval.high / interval.low) / 2; }

}  // namespace

bool on_stretches(const AlgorithmResult& a) { return a.blind && a.blind->share < 1; }

CommonMeters in_common(const Meters& a, const Meters& b) {
  CommonMeters out;
  out.copies.reserve(a.size() + b.size());
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    out.a.push_back(&out.copies.emplace_back(a[i]->where_known(*b[i])));
    out.b.push_back(&out.copies.emplace_back(b[i]->where_known(*a[i])));
  }
  return out;
}

void extend_partial_scores(ReplayResult& result, const std::vector<Meters>& meters, const ScoreOptions& scoring) {
  std::size_t whole = 0;
  while (whole < meters.size() && (meters[whole].empty() || on_stretches(result.algorithms[whole]))) ++whole;
  if (whole == meters.size()) return;
  const BlindScore& control = *result.algorithms[whole].blind;
  for (std::size_t k = 0; k < meters.size(); ++k) {
    AlgorithmResult& a = result.algorithms[k];
    if (!on_stretches(a) || meters[k].size() != meters[whole].size()) continue;
    const CommonMeters common = in_common(meters[k], meters[whole]);
    const double ratio = geometric_rms(common.a, scoring).rms / geometric_rms(common.b, scoring).rms;
    const double reach =
        std::hypot(log_reach(rms_ratio_interval(common.a, common.b, scoring)), log_reach(control.predictive_ci95));
    a.rmse = a.blind->predictive_rms = ratio * control.predictive_rms;
    a.rmse_ci95 = a.blind->predictive_ci95 = {a.rmse * std::exp(-reach), a.rmse * std::exp(reach)};
  }
}

}  // namespace libchar
