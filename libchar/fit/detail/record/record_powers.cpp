#include "libchar/fit/detail/record/record_powers.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libchar/spectrum/fft.hpp"

namespace libchar {
namespace {

/// Between the last coefficient of a block that is left and the first that is not, per point.
double split(std::uint64_t block) {
  return (static_cast<double>(kLeftToMeans) - 0.5) / static_cast<double>(block);
}

}  // namespace

std::uint64_t first_kept(std::uint64_t length, std::uint64_t block) {
  return std::max<std::uint64_t>(
      1, static_cast<std::uint64_t>(std::ceil(split(block) * static_cast<double>(length))));
}

std::uint64_t end_of_left(std::uint64_t points, std::uint64_t per_mean, std::uint64_t block) {
  const auto last =
      static_cast<std::uint64_t>(split(block) * static_cast<double>(points * per_mean));
  return std::min(last + 1, points);
}

PooledPower record_power(std::span<const double> points,
                         std::uint64_t spacing,
                         std::uint64_t first,
                         std::uint64_t end) {
  PooledPower power{points.size(), spacing, first, 1, {}};
  Dct plan(points.size());
  const std::span<const double> c = plan.transform(points);
  power.mean.reserve(end > first ? end - first : 0);
  for (std::uint64_t k = first; k < end; ++k) power.mean.push_back(c[k] * c[k]);
  return power;
}

void append_pooled(const PooledSums& sums,
                   std::uint64_t length,
                   std::uint64_t spacing,
                   std::uint64_t first,
                   std::vector<PooledPower>& out) {
  if (sums.transforms == 0) return;
  PooledPower pooled{length, spacing, first, sums.transforms, {}};
  for (std::uint64_t k = first; k < sums.power.size(); ++k)
    pooled.mean.push_back(sums.power[k] / static_cast<double>(sums.transforms));
  if (!pooled.mean.empty()) out.push_back(std::move(pooled));
}

}  // namespace libchar
