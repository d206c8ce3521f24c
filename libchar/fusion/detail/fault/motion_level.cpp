#include "libchar/fusion/detail/fault/motion_level.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace libchar::fusion {
namespace {

constexpr double kBinsOfOne = 4;       ///< bins of a root mean square
constexpr double kLargestSquare = 16;  ///< that a z^2 counts
constexpr double kFewestAdded = 1024;  ///< samples before anything is said
constexpr double kBorrowed = 16;       ///< samples of the bin before, in those of each
constexpr double kErrorsApart = 5;     ///< standard errors, and a ratio, that make a difference
constexpr double kLeastRatio = 1.3;
constexpr double kLeastLevel = 0.05;

}  // namespace

double MotionLevel::at(std::size_t sensor, double x) const {
  const Sensor& of = sensors_[sensor];
  if (!of.differs) return 1;
  const double place = std::abs(x) * kBinsOfOne / std::sqrt(of.square) - 0.5;
  if (place <= 0) return of.level[0];
  const auto bin = static_cast<std::size_t>(std::min(place, static_cast<double>(kBins - 1)));
  if (bin + 1 >= kBins) return of.level[kBins - 1];
  const double share = place - static_cast<double>(bin);
  return of.level[bin] + share * (of.level[bin + 1] - of.level[bin]);
}

void MotionLevel::add(std::size_t sensor, double x, double z) {
  Sensor& of = sensors_[sensor];
  of.count = std::min(of.count + 1, kMemory);
  of.square += (x * x - of.square) / of.count;
  const double place = of.square > 0 ? std::abs(x) * kBinsOfOne / std::sqrt(of.square) : 0;
  const auto bin = static_cast<std::size_t>(std::min(place, static_cast<double>(kBins - 1)));
  of.sums[bin] += std::min(z * z, kLargestSquare);
  of.counts[bin] += 1;
}

void MotionLevel::renew(double samples) {
  const double kept = 1 - samples / kMemory;
  any_ = false;
  for (Sensor& of : sensors_) {
    for (std::size_t b = 0; b < kBins; ++b) {
      of.sums[b] *= kept;
      of.counts[b] *= kept;
    }
    find_level(of);
    any_ = any_ || of.differs;
  }
}

void MotionLevel::find_level(Sensor& of) {
  const double count = std::accumulate(of.counts.begin(), of.counts.end(), 0.0);
  const double sum = std::accumulate(of.sums.begin(), of.sums.end(), 0.0);
  of.differs = false;
  if (count < kFewestAdded || !(sum > 0)) return;
  const double mean = sum / count;
  double before = of.sums[0] / std::max(of.counts[0], 1.0), least = before, most = before;
  for (std::size_t b = 0; b < kBins; ++b) {
    before = (of.sums[b] + kBorrowed * before) / (of.counts[b] + kBorrowed);
    of.level[b] = std::max(before / mean, kLeastLevel);
    const double error = kErrorsApart * std::sqrt(2 / std::max(of.counts[b], 1.0));
    if (of.counts[b] < 64) continue;
    least = std::min(least, before * (1 + error));
    most = std::max(most, before / (1 + error));
  }
  of.differs = most > kLeastRatio * least;
}

}  // namespace libchar::fusion
