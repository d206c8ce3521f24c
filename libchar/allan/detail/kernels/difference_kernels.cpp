#include "libchar/allan/detail/kernels/difference_kernels.hpp"

#include <cstring>

#include "libchar/allan/detail/kernels/eight_lanes.hpp"
#include "libchar/core/numeric/lanes.hpp"

namespace libchar {
namespace {

/// Inlined into each target clone, so that it is compiled for that target.
template <int kOrder>
[[gnu::always_inline]] inline double squared(const DifferenceRun& run, std::uint64_t t) {
  const double u = static_cast<double>(static_cast<std::int64_t>(t));
  const double low = run.at[1][t] - run.at[0][t], high = run.at[2][t] - run.at[1][t];
  double d = high - low;
  if constexpr (kOrder == 3) d = ((run.at[3][t] - run.at[2][t]) - high) - d;
  d += run.c[0] + u * (run.c[1] + u * run.c[2]);
  return d * d;
}

template <int kOrder>
[[gnu::always_inline]] inline double contiguous(const DifferenceRun& run) {
  const double c0 = run.c[0], c1 = run.c[1], c2 = run.c[2];
  double lane[kLanes] = {};
  Four sum[2] = {}, u[2] = {{0, 1, 2, 3}, {4, 5, 6, 7}};
  const std::uint64_t whole = run.count / kLanes * kLanes;
  for (std::uint64_t t = 0; t < whole; t += kLanes)
    for (std::uint64_t h = 0; h < 2; ++h) {
      const std::uint64_t at = t + 4 * h;
      const Four middle = LIBCHAR_FOUR(run.at[1] + at), third = LIBCHAR_FOUR(run.at[2] + at);
      const Four high = third - middle;
      Four d = high - (middle - LIBCHAR_FOUR(run.at[0] + at));
      if constexpr (kOrder == 3) d = ((LIBCHAR_FOUR(run.at[3] + at) - third) - high) - d;
      d += c0 + u[h] * (c1 + u[h] * c2);
      u[h] += static_cast<double>(kLanes);
      sum[h] += d * d;
    }
  std::memcpy(lane, sum, sizeof lane);
  for (std::uint64_t t = whole; t < run.count; ++t) lane[t % kLanes] += squared<kOrder>(run, t);
  return sum_of_lanes(lane);
}

template <int kOrder>
[[gnu::always_inline]] inline double any_stride(const DifferenceRun& run) {
  if (run.stride == 1) return contiguous<kOrder>(run);
  double lane[kLanes] = {};
  for (std::uint64_t s = 0; s < run.count; ++s)
    lane[s % kLanes] += squared<kOrder>(run, s * run.stride);
  return sum_of_lanes(lane);
}

}  // namespace

LIBCHAR_WIDE_LANES double squared_second_differences(const DifferenceRun& run) {
  return any_stride<2>(run);
}

LIBCHAR_WIDE_LANES double squared_third_differences(const DifferenceRun& run) {
  return any_stride<3>(run);
}

}  // namespace libchar
