#pragma once
// How well a stated standard deviation covers the errors: counts of |error| / sd in bins of 1 %, memory fixed.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include "libchar/core/numeric/interval.hpp"

namespace libchar::detail {

class CoverageMeter {
 public:
  void add(double error, double deviation) {
    if (!std::isfinite(error) || !(deviation > 0) || !std::isfinite(deviation)) return;
    const double ratio = std::abs(error) / deviation;
    const double bin = ratio > 0 ? kPerDecade * std::log10(ratio) + kZero : 0;
    ++counts_[static_cast<std::size_t>(std::clamp(bin, 0.0, double{kBins - 1}))];
    ++all_;
  }
  /// The stated deviation times this covers 95 % as that of normal errors would; none: too few estimates.
  std::optional<double> factor() const {
    if (all_ < kLeast) return {};
    std::uint64_t below = 0;
    std::size_t bin = 0;
    while (below + counts_[bin] < static_cast<std::uint64_t>(0.95 * static_cast<double>(all_))) below += counts_[bin++];
    return std::pow(10.0, (static_cast<double>(bin) + 0.5 - kZero) / kPerDecade) / kNormal95;
  }

 private:
  static constexpr int kBins = 1600;
  static constexpr double kPerDecade = 200,
                          kZero = 800;  // ratios from a ten thousandth to ten thousand
  static constexpr std::uint64_t kLeast = 200;
  std::array<std::uint64_t, kBins> counts_{};
  std::uint64_t all_ = 0;
};

}  // namespace libchar::detail
