// Freedman & Diaconis, Z. Wahrscheinlichkeitstheorie verw. Gebiete 57 (1981) 453.
#include "libchar/lot/histogram.hpp"

#include <algorithm>
#include <cmath>

#include "libchar/core/numeric/median.hpp"

namespace libchar {
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
