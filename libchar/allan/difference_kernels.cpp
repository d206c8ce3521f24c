#include "libchar/allan/difference_kernels.hpp"

namespace libchar {
namespace {

constexpr std::uint64_t kLanes = 8;

double fold(const double (&lane)[kLanes]) {
  return ((lane[0] + lane[4]) + (lane[2] + lane[6])) + ((lane[1] + lane[5]) + (lane[3] + lane[7]));
}

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
  const double* const a = run.at[0];
  const double* const b = run.at[1];
  const double* const c = run.at[2];
  const double* const e = run.at[3];
  const double c0 = run.c[0], c1 = run.c[1], c2 = run.c[2];
  double lane[kLanes] = {};
  double u[kLanes];
  for (std::uint64_t k = 0; k < kLanes; ++k) u[k] = static_cast<double>(k);
  const std::uint64_t whole = run.count / kLanes * kLanes;
  for (std::uint64_t t = 0; t < whole; t += kLanes)
    for (std::uint64_t k = 0; k < kLanes; ++k) {
      const double high = c[t + k] - b[t + k];
      double d = high - (b[t + k] - a[t + k]);
      if constexpr (kOrder == 3) d = ((e[t + k] - c[t + k]) - high) - d;
      d += c0 + u[k] * (c1 + u[k] * c2);
      u[k] += kLanes;
      lane[k] += d * d;
    }
  for (std::uint64_t t = whole; t < run.count; ++t) lane[t % kLanes] += squared<kOrder>(run, t);
  return fold(lane);
}

template <int kOrder>
[[gnu::always_inline]] inline double any_stride(const DifferenceRun& run) {
  if (run.stride == 1) return contiguous<kOrder>(run);
  double lane[kLanes] = {};
  for (std::uint64_t s = 0; s < run.count; ++s)
    lane[s % kLanes] += squared<kOrder>(run, s * run.stride);
  return fold(lane);
}

}  // namespace

__attribute__((target_clones("avx2", "default"))) double squared_second_differences(
    const DifferenceRun& run) {
  return any_stride<2>(run);
}

__attribute__((target_clones("avx2", "default"))) double squared_third_differences(
    const DifferenceRun& run) {
  return any_stride<3>(run);
}

}  // namespace libchar
