// Differences of a cumulated record, re-anchored every block. Why: the plain sum of 1e8 samples with an offset of 1e9
// standard deviations is 100 % noise, and 9.81 m/s^2 with 1e-3 noise already costs eight digits (docs/theory/allan.md).

#include "libchar/allan/detail/anchored_phase.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "libchar/allan/detail/kernels/eight_lanes.hpp"
#include "libchar/core/numeric/lanes.hpp"
#include "libchar/core/numeric/present.hpp"

namespace libchar {
namespace {

// Sums of squared differences over contiguous samples: eight partial sums in fixed order, so that
// the bits do not depend on the vector width the processor has.

/// d_t = c0 + c1 t + c2 t^2 + (second or third difference of at[0][t], at[1][t], …), t = 0, stride, 2 stride, …
struct DifferenceRun {
  const double* at[4] = {};
  double c[3] = {};
  std::size_t count = 0;
  std::size_t stride = 1;
};

/// Inlined into each kernel, so that it is compiled for the instructions of that.
template <int kOrder>
[[gnu::always_inline]] inline double squared(const DifferenceRun& run, std::size_t t) {
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
  const std::size_t whole = run.count / kLanes * kLanes;
  for (std::size_t t = 0; t < whole; t += kLanes)
    for (std::size_t h = 0; h < 2; ++h) {
      const std::size_t at = t + 4 * h;
      const Four middle = LIBCHAR_FOUR(run.at[1] + at), third = LIBCHAR_FOUR(run.at[2] + at);
      const Four high = third - middle;
      Four d = high - (middle - LIBCHAR_FOUR(run.at[0] + at));
      if constexpr (kOrder == 3) d = ((LIBCHAR_FOUR(run.at[3] + at) - third) - high) - d;
      d += c0 + u[h] * (c1 + u[h] * c2);
      u[h] += static_cast<double>(kLanes);
      sum[h] += d * d;
    }
  std::memcpy(lane, sum, sizeof lane);
  for (std::size_t t = whole; t < run.count; ++t) lane[t % kLanes] += squared<kOrder>(run, t);
  return sum_of_lanes(lane);
}

template <int kOrder>
[[gnu::always_inline]] inline double any_stride(const DifferenceRun& run) {
  if (run.stride == 1) return contiguous<kOrder>(run);
  double lane[kLanes] = {};
  for (std::size_t s = 0; s < run.count; ++s) lane[s % kLanes] += squared<kOrder>(run, s * run.stride);
  return sum_of_lanes(lane);
}

LIBCHAR_LANES double squared_second_differences_lanes(const DifferenceRun& run) { return any_stride<2>(run); }
constexpr InLanes<squared_second_differences_lanes> squared_second_differences;

LIBCHAR_LANES double squared_third_differences_lanes(const DifferenceRun& run) { return any_stride<3>(run); }
constexpr InLanes<squared_third_differences_lanes> squared_third_differences;

constexpr std::size_t kBlock = AnchoredPhase::kBlock;

DoubleDouble two_sum(double a, double b) {
  const double s = a + b, t = s - a;
  return {s, (a - (s - t)) + (b - t)};
}

double finite_or(double value, double instead) { return std::isfinite(value) ? value : instead; }

AnchoredPhase empty_phase(std::size_t points, double scale, bool summed) {
  AnchoredPhase phase;
  phase.points = points;
  phase.scale = scale;
  phase.summed = summed;
  phase.local.assign(points + 1, 0.0);
  if (summed) phase.local2.assign(points + 1, 0.0);
  const std::size_t blocks = points / kBlock + 1;
  phase.anchor.resize(blocks);
  phase.base.resize(blocks);
  if (summed) phase.base2.resize(blocks);
  return phase;
}

double first_finite(std::span<const double> values, double instead) {
  for (const double value : values)
    if (std::isfinite(value)) return value;
  return instead;
}

/// Gap-free stretches of finite values; those of a rate record reach one phase point further.
void find_stretches(std::span<const double> record, std::size_t reach, AnchoredPhase& phase) {
  for (std::size_t begin = 0; begin < record.size(); ++begin) {
    const std::size_t end = begin + finite_run(record.subspan(begin));
    if (end > begin) phase.stretches.push_back({begin, end + reach});
    if (end < record.size()) ++phase.missing;
    begin = end;
  }
}

/// local2 and W from local, A and X.
void sum_again(AnchoredPhase& phase) {
  const double length = kBlock;
  DoubleDouble base;
  for (std::size_t b = 0; b < phase.base2.size(); ++b) {
    phase.base2[b] = base;
    double sum = 0;
    const std::size_t end = std::min((b + 1) * kBlock, phase.points + 1);
    for (std::size_t p = b * kBlock; p < end; ++p) {
      phase.local2[p] = sum;
      sum += phase.local[p];
    }
    base = base + phase.base[b] * length + phase.anchor[b] * (length * (length - 1) / 2) + DoubleDouble{sum, 0};
  }
}

/// Value of the polynomial part at local position j + t: c[0] + c[1] t + c[2] t^2.
struct Polynomial {
  std::array<DoubleDouble, 3> c;
  void add(double weight, const Polynomial& other, bool of_sum) {
    for (std::size_t k = 0; k < (of_sum ? 3 : 2); ++k) c[k] = c[k] + times(other.c[k], weight);
  }
  /// By a power of two nothing is rounded.
  static DoubleDouble times(DoubleDouble value, double weight) {
    return std::fabs(weight) == 3 ? value * weight : DoubleDouble{value.high * weight, value.low * weight};
  }
};

Polynomial polynomial(const AnchoredPhase& phase, std::size_t position, bool of_sum) {
  const std::size_t b = position / kBlock;
  const double j = static_cast<double>(position % kBlock);
  const DoubleDouble a = phase.anchor[b];
  if (!of_sum) return {{phase.base[b] + a * j, a, DoubleDouble{}}};
  return {{phase.base2[b] + phase.base[b] * j + a * (j * (j - 1) / 2), phase.base[b] + a * (j - 0.5), a * 0.5}};
}

/// Largest |x/2 - first| of what is finite; n is a multiple of four.
LIBCHAR_LANES double largest_deviation_lanes(const double* x, std::size_t n, double first) {
  const Four infinite = Four{} + std::numeric_limits<double>::infinity();
  Four largest = {};
  for (std::size_t i = 0; i < n; i += 4) {
    const Four distance = LIBCHAR_FOUR(x + i) / 2 - first;
    const Four deviation = distance < 0 ? -distance : distance;
    largest = ((deviation > largest) & (deviation < infinite)) ? deviation : largest;
  }
  return std::max(std::max(largest[0], largest[1]), std::max(largest[2], largest[3]));
}
constexpr InLanes<largest_deviation_lanes> largest_deviation;

constexpr double kWeights[2][4] = {{1, -2, 1, 0}, {-1, 3, -3, 1}};

}  // namespace

double balancing_scale(std::span<const double> record) {
  const double first = first_finite(record, 0) / 2;
  const std::size_t whole = record.size() / 4 * 4;
  double largest = largest_deviation(record.data(), whole, first);
  for (const double value : record.subspan(whole)) {
    const double deviation = std::fabs(value / 2 - first);
    if (deviation > largest && std::isfinite(deviation)) largest = deviation;
  }
  if (largest == 0) return 1;
  return std::ldexp(1.0, std::clamp(-std::ilogb(largest), -1022, 1023));
}

DoubleDouble operator+(DoubleDouble a, DoubleDouble b) {
  const DoubleDouble high = two_sum(a.high, b.high);
  const DoubleDouble low = two_sum(a.low, b.low);
  const DoubleDouble sum = two_sum(high.high, high.low + low.high);
  return two_sum(sum.high, sum.low + low.low);
}

DoubleDouble operator*(DoubleDouble a, double k) {
  const double product = a.high * k;
  return two_sum(product, std::fma(a.high, k, -product) + a.low * k);
}

AnchoredPhase anchored_phase_of_rate(std::span<const double> rate, bool summed) {
  AnchoredPhase phase = empty_phase(rate.size() + 1, balancing_scale(rate), summed);
  const double scale = phase.scale, origin = first_finite(rate, 0) * scale;
  find_stretches(rate, 1, phase);
  DoubleDouble base;
  double anchor = origin;
  for (std::size_t b = 0; b < phase.base.size(); ++b) {
    // A record of one sample less than whole blocks has its last point in a block without samples.
    const std::size_t first = std::min<std::size_t>(b * kBlock, rate.size());
    const auto block = rate.subspan(first, std::min(kBlock, rate.size() - first));
    anchor = first_finite(block, anchor / scale) * scale;
    double total = 0;
    for (const double y : block) total += finite_or(y * scale, anchor) - anchor;
    const double mean = total / static_cast<double>(std::max<std::size_t>(block.size(), 1));
    phase.anchor[b] = two_sum(anchor, -origin) + DoubleDouble{mean, 0};
    phase.base[b] = base;
    double sum = 0;
    double* local = phase.local.data() + b * kBlock;
    for (std::size_t j = 0; j < block.size(); ++j) {
      local[j] = sum;
      sum += (finite_or(block[j] * scale, anchor) - anchor) - mean;
    }
    if (block.size() < kBlock) local[block.size()] = sum;
    base = base + phase.anchor[b] * static_cast<double>(kBlock) + DoubleDouble{sum, 0};
  }
  if (summed) sum_again(phase);
  return phase;
}

AnchoredPhase anchored_phase_of_phase(std::span<const double> points, bool summed) {
  AnchoredPhase phase = empty_phase(points.size(), balancing_scale(points), summed);
  const double scale = phase.scale, origin = first_finite(points, 0) * scale;
  find_stretches(points, 0, phase);
  double anchor = origin;
  for (std::size_t b = 0; b < phase.base.size(); ++b) {
    const auto block = points.subspan(b * kBlock, std::min(kBlock, points.size() - b * kBlock));
    anchor = first_finite(block, anchor / scale) * scale;
    const double last = block.empty() ? anchor : finite_or(block.back() * scale, anchor);
    // Multiples of a slope of few digits are exact, so removing it rounds nothing but the small rest.
    const float slope = static_cast<float>((last - anchor) / static_cast<double>(kBlock));
    phase.base[b] = two_sum(anchor, -origin);
    phase.anchor[b] = {static_cast<double>(slope), 0};
    for (std::size_t j = 0; j < block.size(); ++j)
      phase.local[b * kBlock + j] =
          (finite_or(block[j] * scale, anchor) - anchor) - static_cast<double>(j) * static_cast<double>(slope);
  }
  if (summed) sum_again(phase);
  return phase;
}

double sum_of_squares(const AnchoredPhase& phase, int order, bool of_sum, std::size_t m, std::size_t first,
                      std::size_t last, std::size_t stride) {
  const std::vector<double>& local = of_sum ? phase.local2 : phase.local;
  double sum = 0;
  for (std::size_t i = first; i < last;) {
    DifferenceRun run;
    Polynomial p;
    std::size_t room = last - i;  // starts until one of the positions enters its next block
    for (int k = 0; k <= order; ++k) {
      const std::size_t position = i + static_cast<std::size_t>(k) * m;
      p.add(kWeights[order - 2][k], polynomial(phase, position, of_sum), of_sum);
      run.at[k] = local.data() + position;
      room = std::min(room, kBlock - position % kBlock);
    }
    for (std::size_t k = 0; k < 3; ++k) run.c[k] = p.c[k].high;
    run.count = (room + stride - 1) / stride;
    run.stride = stride;
    sum += order == 2 ? squared_second_differences(run) : squared_third_differences(run);
    i += run.count * stride;
  }
  return sum;
}

}  // namespace libchar
