#include "libchar/fusion/algorithms/blind_gls.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "libchar/core/error.hpp"

namespace libchar::fusion {
namespace {

/// No channel is taken to be more than so many times better than all others together: the variance of
/// one of a factor model may run to zero (Heywood 1931).
constexpr double kMostBetter = 100;

}  // namespace

BlindGls::BlindGls(const Array& array, const Settings& settings)
    : gauge_(static_cast<Eigen::Index>(settings["gauge"])),
      moments_(array.channels),
      factor_(array.channels),
      covariance_(Eigen::MatrixXd::Zero(array.channels, array.channels)),
      gain_(Eigen::VectorXd::Ones(array.channels)),
      variance_(Eigen::VectorXd::Ones(array.channels)),
      mean_(Eigen::VectorXd::Zero(array.channels)),
      weight_(Eigen::VectorXd::Ones(array.channels)),
      next_(static_cast<double>(std::max<Eigen::Index>(20, 3 * array.channels))) {
  if (gauge_ > array.channels)
    throw Error({ErrorKind::usage,
                 "E0855",
                 "",
                 "gauge must be one of the " + std::to_string(array.channels) + " channels",
                 std::to_string(gauge_),
                 ""});
}

/// Gains in the gauge, variances in the unit of the samples.
bool BlindGls::take_factor() {
  const Eigen::Index n = gain_.size();
  double least = moments_.instants(0);
  for (Eigen::Index i = 1; i < n; ++i) least = std::min(least, moments_.instants(i));
  moments_.covariance(covariance_);
  if (!factor_.solve(covariance_, 1, least, none_)) return false;
  const Eigen::VectorXd& g = factor_.factor();
  double inverse = 0;
  for (Eigen::Index i = 0; i < n; ++i) inverse += 1 / g[i];
  const double one = gauge_ == 0 ? static_cast<double>(n) / inverse : g[gauge_ - 1];
  if (!std::isfinite(one) || !(std::abs(one) > 1e-9 * g.cwiseAbs().maxCoeff())) return false;
  gain_ = g / one;
  variance_ = factor_.noise();
  return true;
}

void BlindGls::solve() {
  if (!take_factor()) return;
  solved_ = true;
  const Eigen::Index n = gain_.size();
  double all = 0;
  for (Eigen::Index i = 0; i < n; ++i) all += gain_[i] * gain_[i] / variance_[i];
  for (Eigen::Index i = 0; i < n; ++i) {
    const double own = gain_[i] * gain_[i], others = all - own / variance_[i];
    if (own > kMostBetter * others * variance_[i]) variance_[i] = own / (kMostBetter * others);
    weight_[i] = gain_[i] / variance_[i];
    mean_[i] = moments_.mean(i);
  }
  centre_ = mean_[0] + (mean_.array() - mean_[0]).mean();
}

Estimate BlindGls::step(const Sample& y) {
  moments_.add(y);
  instants_ += 1;
  if (instants_ >= next_) {
    next_ = std::ceil(instants_ * 1.1);
    solve();
  }
  double sum = 0, information = 0, base = std::nan("");
  for (Eigen::Index i = 0; i < y.size(); ++i) {
    if (!usable(y[i])) continue;
    const double from_origin = y[i] - moments_.origin();
    if (std::isnan(base)) base = solved_ ? centre_ : from_origin;
    sum += weight_[i] * (from_origin - (solved_ ? mean_[i] : base));
    information += weight_[i] * gain_[i];
  }
  if (!(information > 0)) return Estimate::none(1);
  return Estimate::scalar(moments_.origin() + (base + sum / information),
                          solved_ ? 1 / information : std::nan(""));
}

Eigen::MatrixXd BlindGls::weights() const {
  return weight_ / weight_.dot(gain_);
}

void BlindGls::remarks(Warnings& warnings) const {
  if (!solved_)
    warnings.add("not_calibrated",
                 "blind-gls found no common movement of the channels: it was the plain mean");
}

}  // namespace libchar::fusion
