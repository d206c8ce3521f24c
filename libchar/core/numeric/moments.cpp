#include "libchar/core/numeric/moments.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "libchar/core/numeric/lanes.hpp"

namespace libchar {
namespace {

constexpr int kLanes = 8;  // independent partial sums: any vector width gives the same bits

double fold(const double (&lane)[kLanes]) {
  return ((lane[0] + lane[4]) + (lane[2] + lane[6])) + ((lane[1] + lane[5]) + (lane[3] + lane[7]));
}

LIBCHAR_LANES double shifted_sum_lanes(const double* x, int n, double shift) {
  Four sum[2] = {};
  const int whole = n - n % kLanes;
  for (int i = 0; i < whole; i += kLanes)
    for (int h = 0; h < 2; ++h) {
      const Four v = LIBCHAR_FOUR(x + i + 4 * h);
      sum[h] += v - shift;
    }
  double lane[kLanes];
  std::memcpy(lane, sum, sizeof lane);
  for (int i = whole; i < n; ++i) lane[i % kLanes] += x[i] - shift;
  return fold(lane);
}
constexpr InLanes<shifted_sum_lanes> shifted_sum;

/// Sums of the first four powers of (x - shift) - offset.
LIBCHAR_LANES void power_sums_lanes(const double* x, int n, double shift, double offset, double out[4]) {
  Four sum[4][2] = {};
  const int whole = n - n % kLanes;
  for (int i = 0; i < whole; i += kLanes)
    for (int h = 0; h < 2; ++h) {
      const Four v = LIBCHAR_FOUR(x + i + 4 * h);
      const Four d = (v - shift) - offset, d2 = d * d;
      sum[0][h] += d;
      sum[1][h] += d2;
      sum[2][h] += d2 * d;
      sum[3][h] += d2 * d2;
    }
  double lane[4][kLanes];
  std::memcpy(lane, sum, sizeof lane);
  for (int i = whole; i < n; ++i) {
    const double d = (x[i] - shift) - offset, d2 = d * d;
    lane[0][i % kLanes] += d;
    lane[1][i % kLanes] += d2;
    lane[2][i % kLanes] += d2 * d;
    lane[3][i % kLanes] += d2 * d2;
  }
  for (int k = 0; k < 4; ++k) out[k] = fold(lane[k]);
}
constexpr InLanes<power_sums_lanes> power_sums;

/// Extremes of n values (a multiple of eight); false when one of them is NaN.
LIBCHAR_LANES bool extremes_lanes(const double* x, int n, double& minimum, double& maximum) {
  Four low[2] = {{minimum, minimum, minimum, minimum}, {minimum, minimum, minimum, minimum}};
  Four high[2] = {{maximum, maximum, maximum, maximum}, {maximum, maximum, maximum, maximum}};
  Four seen[2] = {};
  for (int i = 0; i < n; i += kLanes)
    for (int h = 0; h < 2; ++h) {
      const Four v = LIBCHAR_FOUR(x + i + 4 * h);
      low[h] = v < low[h] ? v : low[h];
      high[h] = v > high[h] ? v : high[h];
      seen[h] = v == v ? seen[h] : v;  // keeps a NaN once it has come by
    }
  for (int h = 0; h < 2; ++h)
    for (int k = 0; k < 4; ++k)
      if (std::isnan(seen[h][k])) return false;
  for (int h = 0; h < 2; ++h)
    for (int k = 0; k < 4; ++k) {
      minimum = std::min(minimum, low[h][k]);
      maximum = std::max(maximum, high[h][k]);
    }
  return true;
}
constexpr InLanes<extremes_lanes> extremes;

/// 0 where the fourth powers of values up to `range` are numbers.
int unit_exponent(double range) {
  constexpr double kLargest = 0x1p240;
  if (range == 0 || (range > 1 / kLargest && range < kLargest)) return 0;
  return std::isfinite(range) ? std::ilogb(range) : std::numeric_limits<double>::max_exponent;
}

}  // namespace

Moments::Central Moments::of_block(const double* x, int n) const {
  const int exponent = unit_exponent(std::max(maximum_ - origin_, origin_ - minimum_));
  if (exponent == 0) return of_block(x, n, origin_);
  double scaled[kBlock];
  for (int i = 0; i < n; ++i) scaled[i] = std::ldexp(x[i], -exponent);
  Central c = of_block(scaled, n, std::ldexp(origin_, -exponent));
  c.exponent = exponent;
  return c;
}

Moments::Central Moments::in_unit(const Central& c, int exponent) {
  const int up = c.exponent - exponent;
  if (up == 0) return c;
  return {c.n,     std::ldexp(c.mean, up), std::ldexp(c.m2, 2 * up), std::ldexp(c.m3, 3 * up), std::ldexp(c.m4, 4 * up),
          exponent};
}

Moments::Central Moments::of_block(const double* x, int n, double origin) const {
  const double shift = x[0];
  Central c;
  c.n = n;
  const double offset = shifted_sum(x, n, shift) / n;
  // About the first sample of all: a mean stored whole would round away the differences of means that `merged` needs.
  c.mean = (shift - origin) + offset;
  double s[4] = {};
  power_sums(x, n, shift, offset, s);
  // s[0]: what rounding left of the sum of deviations (Chan's corrected two-pass formula).
  c.m2 = std::max(0.0, s[1] - s[0] * s[0] / n);
  c.m3 = s[2];
  c.m4 = s[3];
  return c;
}

Moments::Central Moments::merged(const Central& a, const Central& b) {
  if (a.n == 0) return b;
  if (b.n == 0) return a;
  if (a.exponent != b.exponent) {
    // The range never shrinks; the special unit of small samples is dropped when larger ones arrive.
    return merged(in_unit(a, b.exponent), b);
  }
  Central c;
  c.exponent = a.exponent;
  c.n = a.n + b.n;
  const double d = b.mean - a.mean, f = d / c.n;
  c.mean = a.mean + f * b.n;
  c.m2 = a.m2 + b.m2 + d * f * a.n * b.n;
  c.m3 = a.m3 + b.m3 + d * f * f * a.n * b.n * (a.n - b.n) + 3 * f * (a.n * b.m2 - b.n * a.m2);
  c.m4 = a.m4 + b.m4 + d * f * f * f * a.n * b.n * (a.n * a.n - a.n * b.n + b.n * b.n) +
         6 * f * f * (a.n * a.n * b.m2 + b.n * b.n * a.m2) + 4 * f * (a.n * b.m3 - b.n * a.m3);
  return c;
}

void Moments::push(std::span<const double> samples) {
  const double* x = samples.data();
  const double* const end = x + samples.size();
  if (!started_)
    for (const double* first = x; first != end && !started_; ++first) {
      started_ = !std::isnan(*first);
      if (started_) origin_ = std::isfinite(*first) ? *first : 0;
    }
  while (x != end) {
    // A whole block without NaN is taken where it lies; the blocks are the same as when filled one by one.
    if (pending_count_ == 0 && end - x >= kBlock && extremes(x, kBlock, minimum_, maximum_)) {
      done_ = merged(done_, of_block(x, kBlock));
      x += kBlock;
      continue;
    }
    do {
      const double value = *x++;
      if (std::isnan(value)) {
        ++missing_;
        continue;
      }
      minimum_ = std::min(minimum_, value);
      maximum_ = std::max(maximum_, value);
      pending_[pending_count_++] = value;
    } while (x != end && pending_count_ != kBlock);
    if (pending_count_ == kBlock) {
      done_ = merged(done_, of_block(pending_, kBlock));
      pending_count_ = 0;
    }
  }
}

Moments::Central Moments::total() const {
  return pending_count_ == 0 ? done_ : merged(done_, of_block(pending_, pending_count_));
}

std::uint64_t Moments::count() const {
  return static_cast<std::uint64_t>(done_.n) + static_cast<std::uint64_t>(pending_count_);
}
std::uint64_t Moments::missing() const { return missing_; }
double Moments::mean() const {
  const Central c = total();
  return origin_ + std::ldexp(c.mean, c.exponent);
}
double Moments::variance() const {
  const Central c = total();
  return c.n < 2 ? 0.0 : std::ldexp(c.m2 / (c.n - 1), 2 * c.exponent);
}
double Moments::standard_deviation() const {
  const Central c = total();
  return c.n < 2 ? 0.0 : std::ldexp(std::sqrt(c.m2 / (c.n - 1)), c.exponent);
}
double Moments::skewness() const {
  const Central c = total();
  return c.m2 > 0 ? std::sqrt(c.n) * c.m3 / std::pow(c.m2, 1.5) : 0.0;
}
double Moments::kurtosis() const {
  const Central c = total();
  return c.m2 > 0 ? c.n * c.m4 / (c.m2 * c.m2) : 0.0;
}
double Moments::minimum() const { return minimum_; }
double Moments::maximum() const { return maximum_; }

}  // namespace libchar
