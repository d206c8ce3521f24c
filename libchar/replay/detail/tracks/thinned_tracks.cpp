#include "libchar/replay/detail/tracks/thinned_tracks.hpp"

#include <algorithm>
#include <cmath>

namespace libchar {
namespace {

/// At about nine characters a number.
constexpr std::size_t kMostNumbers = 120000;

std::size_t size_of(const Timeline& t) { return t.time_s.size() * (1 + t.low.size() + t.high.size()); }

// NaN stands for no value; fmin and fmax pass it over.
std::vector<double> reduced(const std::vector<double>& values, std::size_t divisor, double (*both)(double, double)) {
  std::vector<double> out;
  for (std::size_t i = 0; i < values.size(); i += divisor) {
    double v = values[i];
    for (std::size_t k = i + 1; k < std::min(i + divisor, values.size()); ++k) v = both(v, values[k]);
    out.push_back(v);
  }
  return out;
}

}  // namespace

Timeline merged_bins(const Timeline& timeline, std::size_t divisor) {
  if (divisor <= 1) return timeline;
  Timeline out;
  for (std::size_t i = 0; i < timeline.time_s.size(); i += divisor) {
    const std::size_t last = std::min(i + divisor, timeline.time_s.size()) - 1;
    out.time_s.push_back((timeline.time_s[i] + timeline.time_s[last]) / 2);
  }
  for (const auto& series : timeline.low)
    out.low.push_back(reduced(series, divisor, [](double a, double b) { return std::fmin(a, b); }));
  for (const auto& series : timeline.high)
    out.high.push_back(reduced(series, divisor, [](double a, double b) { return std::fmax(a, b); }));
  return out;
}

std::size_t track_divisor(const ReplayResult& result) {
  std::size_t all = 0;
  for (const AlgorithmResult& a : result.algorithms) all += size_of(a.weight_track) + size_of(a.variance_track);
  return std::max<std::size_t>(1, (all + kMostNumbers - 1) / kMostNumbers);
}

}  // namespace libchar
