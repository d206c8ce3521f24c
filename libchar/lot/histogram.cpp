// Freedman & Diaconis, Z. Wahrscheinlichkeitstheorie verw. Gebiete 57 (1981) 453.

#include "libchar/lot/histogram.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libchar/core/numeric/median.hpp"

namespace libchar {

// P_pk = (U - mean) / (3 s) of an upper limit U. Its variance, to first order, from the standard errors of mean and ln s (Bissell, Appl.
// Stat. 39 (1990) 331, has those of a sample without uncertainties: 1/(3 sqrt n) and 1/sqrt(2 (n - 1))):
//   var P = (se mean / (3 s))² + P² (se ln s)²
// Where a spread of zero is not excluded the interval is what its upper end and both ends of the mean give, and has no upper end.

void add_ppk(const RandomEffects& effects, double limit, Capability& out) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const Interval& mean = effects.mean_ci95;
  const Interval& spread = effects.spread_ci95;
  const double room = limit - effects.mean;
  const double ppk = effects.spread > 0 ? room / (3 * effects.spread)
                     : room >= 0        ? kInfinity
                                        : -kInfinity;
  out.ppk = ppk;
  out.above = std::erfc(3 * ppk / std::sqrt(2.0)) / 2;
  if (spread.low > 0) {
    const double of_mean = (mean.high - mean.low) / 2 / (3 * effects.spread);
    const double of_spread = ppk * std::log(spread.high / spread.low) / 2;
    const double half = std::hypot(of_mean, of_spread);
    out.ppk_ci95 = {ppk - half, ppk + half};
    return;
  }
  const auto at_widest = [&](double from) { return (limit - from) / (3 * spread.high); };
  out.ppk_ci95 = {mean.high <= limit ? at_widest(mean.high) : -kInfinity,
                  mean.low <= limit ? kInfinity : at_widest(mean.low)};
}

namespace {

constexpr double kMostBins = 60, kFarOff = 8;

}  // namespace

Histogram histogram_of(std::span<const double> values) {
  Histogram out;
  if (values.empty()) return out;
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  const std::size_t n = sorted.size();
  const double median = sorted[n / 2], quarters = sorted[3 * n / 4] - sorted[n / 4];
  const double sd = quarters * kMadToSd / 2;
  double low = sorted.front(), high = sorted.back();
  if (sd > 0) {
    low = std::max(low, median - kFarOff * sd);
    high = std::min(high, median + kFarOff * sd);
  }
  const double width = 2 * quarters / std::cbrt(static_cast<double>(n));
  const double bins = width > 0 ? std::clamp(std::ceil((high - low) / width), 1.0, kMostBins) : 1;
  out.low = low;
  out.step = high > low ? (high - low) / bins : std::max(std::abs(low) * 1e-6, 1e-12);
  out.count.resize(static_cast<std::size_t>(bins));
  for (const double x : sorted) {
    if (x < low) {
      ++out.below;
    } else if (x > high) {
      ++out.above;
    } else {
      const auto k = static_cast<std::size_t>((x - low) / out.step);
      ++out.count[std::min(k, out.count.size() - 1)];
    }
  }
  return out;
}

}  // namespace libchar
