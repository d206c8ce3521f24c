// A channel sees the common input late, scaled, shifted and with some of the other axes:
//   y(t) = b + (1 + g) x(t - d) + sum_k m_k c_k(t)   so that
//   z(t) = (y(t + d) - b - sum_k m_k c_k(t)) / (1 + g)   is x again.
// y(t + d) comes from its neighbours through a fractional-delay filter of unit sum (Laakso et al.,
// IEEE Signal Process. Mag. 13 (1996) 30): a sinc behind a Kaiser window, or cubic Lagrange.
#include "libchar/fusion/alignment.hpp"

#include <cmath>
#include <numbers>

namespace libchar::fusion {
namespace {

constexpr Eigen::Index kHalf = 12;
constexpr double kKaiser = 8;

// Modified Bessel function of the first kind, order 0, by its series.
double bessel_0(double x) {
  double sum = 1, term = 1;
  for (int k = 1; k < 60; ++k) {
    term *= (x / (2 * k)) * (x / (2 * k));
    sum += term;
  }
  return sum;
}

std::vector<double> sinc_taps(double f) {
  std::vector<double> out;
  double sum = 0;
  for (Eigen::Index k = 1 - kHalf; k <= kHalf; ++k) {
    const double x = f - static_cast<double>(k), u = x / static_cast<double>(kHalf);
    const double angle = std::numbers::pi * x;
    const double sinc = x == 0 ? 1 : std::sin(angle) / angle;
    out.push_back(sinc * bessel_0(kKaiser * std::sqrt(std::max(0.0, 1 - u * u))));
    sum += out.back();
  }
  for (double& w : out) w /= sum;
  return out;
}

std::vector<double> cubic_taps(double f) {
  return {-f * (f - 1) * (f - 2) / 6,
          (f + 1) * (f - 1) * (f - 2) / 2,
          -(f + 1) * f * (f - 2) / 2,
          (f + 1) * f * (f - 1) / 6};
}

}  // namespace

DelayTaps::DelayTaps(double delay, Interpolation interpolation)
    : floor(static_cast<Eigen::Index>(std::floor(delay))), fraction(delay - std::floor(delay)) {
  if (fraction == 0) {
    weights = {1};
  } else if (interpolation == Interpolation::cubic) {
    weights = cubic_taps(fraction);
    first = -1;
  } else {
    weights = sinc_taps(fraction);
    first = 1 - kHalf;
  }
}

double DelayTaps::at(
    const double* y, Eigen::Index stride, Eigen::Index size, Eigen::Index t, bool strict) const {
  const Eigen::Index place = t + floor, from = place + first;
  const auto taps = static_cast<Eigen::Index>(weights.size());
  if (from >= 0 && from + taps <= size) {
    double sum = 0;
    for (Eigen::Index k = 0; k < taps; ++k)
      sum += weights[static_cast<std::size_t>(k)] * y[(from + k) * stride];
    if (std::isfinite(sum)) return sum;
  }
  if (strict || place < 0 || place + 1 >= size) return ChannelAlignment::kUnknown;
  return (1 - fraction) * y[place * stride] + fraction * y[(place + 1) * stride];
}

void cross_means(const Alignment& alignment,
                 const Eigen::Ref<const Eigen::VectorXd>& column,
                 Eigen::VectorXd& means) {
  const auto n = static_cast<Eigen::Index>(alignment.channels.size());
  means.resize(column.size() / n - 1);
  for (Eigen::Index k = 0; k < means.size(); ++k) {
    double sum = 0;
    Eigen::Index count = 0;
    for (Eigen::Index i = 0; i < n; ++i)
      if (const double c = column((k + 1) * n + i); std::isfinite(c)) {
        sum += c;
        ++count;
      }
    means(k) = 2 * count >= n ? sum / static_cast<double>(count) : ChannelAlignment::kUnknown;
  }
}

Eigen::VectorXd in_time(const Alignment& alignment,
                        const Eigen::VectorXd& aligned,
                        const Eigen::VectorXd& cross) {
  Eigen::VectorXd out(aligned.size());
  for (Eigen::Index i = 0; i < aligned.size(); ++i) {
    const ChannelAlignment& channel = alignment.channels[static_cast<std::size_t>(i)];
    out(i) = channel.bias + (1 + channel.gain) * aligned(i);
    for (Eigen::Index k = 0; k < cross.size(); ++k)
      if (const double m = channel.cross[static_cast<std::size_t>(k)]; m != 0)
        out(i) += m * cross(k);
  }
  return out;
}

Aligner::Aligner(const Alignment& alignment) : alignment_(&alignment) {
  for (const ChannelAlignment& channel : alignment.channels)
    taps_.emplace_back(channel.delay, alignment.interpolation);
}

void Aligner::clip(Eigen::MatrixXd& samples) const {
  for (Eigen::Index i = 0; i < samples.rows(); ++i) {
    const ChannelLimits& limits = alignment_->limits[static_cast<std::size_t>(i)];
    if (std::isinf(limits.low) && std::isinf(limits.high)) continue;
    for (Eigen::Index t = 0; t < samples.cols(); ++t)
      if (!limits.hold(samples(i, t))) samples(i, t) = ChannelAlignment::kUnknown;
  }
}

void Aligner::column(const Eigen::MatrixXd& samples, Eigen::Index t, Eigen::VectorXd& out) const {
  const auto n = static_cast<Eigen::Index>(alignment_->channels.size());
  out.resize(n);
  Eigen::VectorXd cross;
  cross_means(*alignment_, samples.col(t), cross);
  for (Eigen::Index i = 0; i < n; ++i) {
    const ChannelAlignment& channel = alignment_->channels[static_cast<std::size_t>(i)];
    double y = taps_[static_cast<std::size_t>(i)].at(
        samples.data() + i, samples.rows(), samples.cols(), t);
    y -= channel.bias;
    for (Eigen::Index k = 0; k < cross.size(); ++k)
      if (const double m = channel.cross[static_cast<std::size_t>(k)]; m != 0) y -= m * cross(k);
    out(i) = y / (1 + channel.gain);
  }
}

}  // namespace libchar::fusion
