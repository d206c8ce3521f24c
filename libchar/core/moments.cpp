#include "libchar/core/moments.hpp"

#include <algorithm>
#include <cmath>

namespace libchar {
namespace {

constexpr int kLanes = 8;  // independent partial sums: the compiler may use any vector width without changing a bit

double fold(const double (&lane)[kLanes]) {
  return ((lane[0] + lane[4]) + (lane[2] + lane[6])) + ((lane[1] + lane[5]) + (lane[3] + lane[7]));
}

}  // namespace

Moments::Central Moments::of_block(const double* x, int n) {
  const double shift = x[0];
  double sum[kLanes] = {};
  for (int i = 0; i + kLanes <= n; i += kLanes)
    for (int k = 0; k < kLanes; ++k) sum[k] += x[i + k] - shift;
  for (int i = n - n % kLanes; i < n; ++i) sum[i % kLanes] += x[i] - shift;
  Central c;
  c.n = n;
  const double offset = fold(sum) / n;
  c.mean = shift + offset;
  double s1[kLanes] = {}, s2[kLanes] = {}, s3[kLanes] = {}, s4[kLanes] = {};
  const auto add = [&](double value, int k) {
    const double d = (value - shift) - offset, d2 = d * d;
    s1[k] += d;
    s2[k] += d2;
    s3[k] += d2 * d;
    s4[k] += d2 * d2;
  };
  for (int i = 0; i + kLanes <= n; i += kLanes)
    for (int k = 0; k < kLanes; ++k) add(x[i + k], k);
  for (int i = n - n % kLanes; i < n; ++i) add(x[i], i % kLanes);
  const double e = fold(s1);  // what rounding left of the sum of deviations (Chan's corrected two-pass formula)
  c.m2 = std::max(0.0, fold(s2) - e * e / n);
  c.m3 = fold(s3);
  c.m4 = fold(s4);
  return c;
}

Moments::Central Moments::merged(const Central& a, const Central& b) {
  if (a.n == 0) return b;
  if (b.n == 0) return a;
  Central c;
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
  for (const double x : samples) {
    if (std::isnan(x)) {
      ++missing_;
      continue;
    }
    minimum_ = std::min(minimum_, x);
    maximum_ = std::max(maximum_, x);
    pending_[pending_count_++] = x;
    if (pending_count_ == kBlock) {
      done_ = merged(done_, of_block(pending_, kBlock));
      pending_count_ = 0;
    }
  }
}

Moments::Central Moments::total() const {
  return pending_count_ == 0 ? done_ : merged(done_, of_block(pending_, pending_count_));
}

std::uint64_t Moments::count() const { return static_cast<std::uint64_t>(done_.n) + static_cast<std::uint64_t>(pending_count_); }
std::uint64_t Moments::missing() const { return missing_; }
double Moments::mean() const { return total().mean; }
double Moments::variance() const {
  const Central c = total();
  return c.n < 2 ? 0.0 : c.m2 / (c.n - 1);
}
double Moments::standard_deviation() const { return std::sqrt(variance()); }
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
