#include "libchar/fit/detail/record_powers.hpp"

#include "libchar/spectrum/fft.hpp"

namespace libchar {

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

}  // namespace libchar
