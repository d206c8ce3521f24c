#include "libchar/fusion/detail/alignment_samples.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libchar/core/numeric/median.hpp"

namespace libchar::fusion {
namespace {

constexpr Eigen::Index kWildStretch = 512;
constexpr double kWildTimes = 10;
constexpr Eigen::Index kHalfLowPass = 24;
constexpr double kLowPassBand = 0.1;

// The largest value of s * y, when it is a limit; else none.
double upper_limit(const Eigen::Ref<const Eigen::VectorXd>& y, double sign) {
  const double none = std::numeric_limits<double>::infinity();
  double top = -none, next = -none;
  Eigen::Index hits = 0, next_hits = 0, runs = 0;
  for (Eigen::Index t = 0; t < y.size(); ++t) {
    const double v = sign * y(t);
    if (!std::isfinite(v)) continue;
    if (v > top) {
      next = top;
      next_hits = hits;
      top = v;
      hits = runs = 0;
    } else if (v < top && v > next) {
      next = v;
      next_hits = 0;
    }
    if (v == top) {
      ++hits;
      if (t > 0 && y(t - 1) == y(t)) ++runs;
    } else if (v == next) {
      ++next_hits;
    }
  }
  return std::isfinite(next) && hits >= 3 && runs >= 1 && hits >= 3 * next_hits ? top : none;
}

void drop_wild_of(Eigen::Ref<Eigen::VectorXd> samples, const Eigen::VectorXd& middle) {
  std::vector<double> deviations;
  for (Eigen::Index t = 0; t < samples.size(); ++t)
    if (std::isfinite(samples(t))) deviations.push_back(samples(t) - middle(t));
  if (deviations.size() < 32) return;
  const double offset = median_in_place(deviations);
  for (double& d : deviations) d = std::abs(d - offset);
  const std::size_t kept = deviations.size() - std::max<std::size_t>(3, deviations.size() / 100);
  std::nth_element(deviations.begin(), deviations.begin() + static_cast<std::ptrdiff_t>(kept), deviations.end());
  double sum = 0;
  for (std::size_t k = 0; k < kept; ++k) sum += deviations[k] * deviations[k];
  const double most = kWildTimes * std::sqrt(sum / static_cast<double>(kept));
  if (!(most > 0)) return;
  for (Eigen::Index t = 0; t < samples.size(); ++t)
    if (std::abs(samples(t) - middle(t) - offset) > most) samples(t) = ChannelAlignment::kUnknown;
}

}  // namespace

ChannelLimits limits_of(const Eigen::Ref<const Eigen::VectorXd>& samples) {
  return {-upper_limit(samples, -1), upper_limit(samples, 1)};
}

void drop_wild(Eigen::Ref<Eigen::MatrixXd> samples) {
  for (Eigen::Index from = 0; from < samples.rows(); from += kWildStretch) {
    const Eigen::Index size = std::min(kWildStretch, samples.rows() - from);
    Eigen::VectorXd middle(size);
    std::vector<double> values;
    for (Eigen::Index t = 0; t < size; ++t) {
      values.clear();
      for (Eigen::Index i = 0; i < samples.cols(); ++i)
        if (std::isfinite(samples(from + t, i))) values.push_back(samples(from + t, i));
      middle(t) = values.empty() ? 0 : median_in_place(values);
    }
    for (Eigen::Index i = 0; i < samples.cols(); ++i) drop_wild_of(samples.col(i).segment(from, size), middle);
  }
}

Eigen::MatrixXd low_passed(const Eigen::Ref<const Eigen::MatrixXd>& samples) {
  Eigen::VectorXd taps(2 * kHalfLowPass + 1);
  for (Eigen::Index k = -kHalfLowPass; k <= kHalfLowPass; ++k) {
    const double x = static_cast<double>(k), u = x / (kHalfLowPass + 1);
    const double angle = 2 * std::numbers::pi * kLowPassBand * x;
    taps(k + kHalfLowPass) = (k == 0 ? 1 : std::sin(angle) / angle) * std::pow(1 - u * u, 2);
  }
  taps /= taps.sum();
  Eigen::MatrixXd out(samples.rows(), samples.cols());
  for (Eigen::Index i = 0; i < samples.cols(); ++i)
    for (Eigen::Index t = 0; t < samples.rows(); ++t) {
      double sum = 0, weight = 0;
      for (Eigen::Index k = -kHalfLowPass; k <= kHalfLowPass; ++k) {
        const Eigen::Index at = t + k;
        if (at < 0 || at >= samples.rows() || !std::isfinite(samples(at, i))) continue;
        sum += taps(k + kHalfLowPass) * samples(at, i);
        weight += taps(k + kHalfLowPass);
      }
      out(t, i) = weight > 0.5 ? sum / weight : ChannelAlignment::kUnknown;
    }
  return out;
}

}  // namespace libchar::fusion
