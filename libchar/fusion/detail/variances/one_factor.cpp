#include "libchar/fusion/detail/variances/one_factor.hpp"

#include <algorithm>
#include <cmath>

namespace libchar::fusion {
namespace {

constexpr int kRounds = 60;
/// Share of a channel's variance below which its noise is not followed.
constexpr double kLeastNoise = 1e-14;
/// Gains less certain than this (relative standard deviation) are none: of a scene that stands still
/// they are ratios of noise.
constexpr double kUncertainGain = 0.1;

}  // namespace

OneFactor::OneFactor(Eigen::Index channels)
    : factor_(Eigen::VectorXd::Zero(channels)), noise_(factor_), scaled_(factor_), product_(factor_) {}

bool OneFactor::solve(const Eigen::MatrixXd& products, double divisor, double instants, const Eigen::VectorXd& known) {
  const Eigen::Index n = factor_.size();
  const auto covariance = products.selfadjointView<Eigen::Lower>();
  for (Eigen::Index i = 0; i < n; ++i)
    if (!(products(i, i) > 0)) return false;
  if (!begun_) {
    noise_ = 0.5 * products.diagonal() / divisor;
    factor_ = noise_.cwiseSqrt();
  }
  if (known.size() == n) noise_ = known;
  // A factor in units of the noise, v = D^-1/2 g; a power step is v <- D^-1/2 C D^-1/2 v / |.|.
  for (int round = 0; round < kRounds; ++round) {
    scaled_ = factor_.cwiseQuotient(noise_);
    product_.noalias() = covariance * scaled_;
    product_ /= divisor;
    // product_ = C D^-1 g; Rayleigh quotient of the scaled problem: g'D^-1 C D^-1 g / g'D^-1 g.
    const double lambda = scaled_.dot(product_) / scaled_.dot(factor_);
    const double length = std::sqrt(product_.cwiseAbs2().cwiseQuotient(noise_).sum());
    if (!(lambda > 1) || !(length > 0)) return false;
    factor_ = product_ * (std::sqrt(lambda - 1) / length);
    if (known.size() == n) continue;
    for (Eigen::Index i = 0; i < n; ++i) {
      const double all = products(i, i) / divisor;
      noise_[i] = std::max(all - factor_[i] * factor_[i], kLeastNoise * all);
    }
  }
  begun_ = begun_ || certain(instants);
  return certain(instants);
}

bool OneFactor::certain(double instants) const {
  // Relative to the strongest: a channel without the input has no gain to be inverted.
  const double strongest = factor_.cwiseAbs().maxCoeff();
  for (Eigen::Index i = 0; i < factor_.size(); ++i) {
    if (!(std::abs(factor_[i]) > 1e-6 * strongest)) return false;
    // var(g) / g^2 = v / (N g^2), as if the factor itself were known.
    if (noise_[i] > kUncertainGain * kUncertainGain * instants * factor_[i] * factor_[i]) return false;
  }
  return true;
}

}  // namespace libchar::fusion
