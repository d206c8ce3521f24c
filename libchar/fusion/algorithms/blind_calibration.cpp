#include "libchar/fusion/algorithms/blind_calibration.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "libchar/core/error.hpp"

namespace libchar::fusion {
namespace {

constexpr int kRounds = 60;
/// Share of a channel's variance below which its noise is not followed.
constexpr double kLeastNoise = 1e-14;
/// Gains less certain than this (relative standard deviation) are none: of a scene that stands still
/// they are ratios of noise.
constexpr double kUncertainGain = 0.1;

void require_channel(Eigen::Index wanted, Eigen::Index channels, const char* option) {
  if (wanted > channels)
    throw Error(
        {ErrorKind::usage,
         "E0855",
         "",
         std::string(option) + " must be one of the " + std::to_string(channels) + " channels",
         std::to_string(wanted),
         ""});
}

}  // namespace

BlindCalibration::BlindCalibration(const Array& array, const Settings& settings)
    : gauge_(static_cast<Eigen::Index>(settings["gauge"])),
      noise_removal_(settings["noise_removal"] != 0),
      mean_(Eigen::VectorXd::Zero(array.channels)),
      delta_(mean_),
      noise_(mean_),
      factor_(mean_),
      scratch_(mean_),
      inverse_gain_(Eigen::VectorXd::Ones(array.channels)),
      offset_(mean_),
      squares_(Eigen::MatrixXd::Zero(array.channels, array.channels)),
      conditions_(array.channels + 1, array.channels + 1),
      solution_(array.channels + 1),
      elimination_(array.channels + 1, array.channels + 1),
      next_(static_cast<double>(std::max<Eigen::Index>(20, 3 * array.channels))) {
  require_channel(gauge_, array.channels, "gauge");
  if (array.noise_levels.size() == array.channels) levels_ = array.noise_levels;
  if (array.channels < 3 && levels_.size() == 0) noise_removal_ = false;
}

Estimate BlindCalibration::step(const Sample& y) {
  gather(y);
  if (instants_ >= next_) {
    next_ = std::ceil(instants_ * 1.1);
    solve();
  }
  const Eigen::Index n = y.size();
  double x = 0;
  for (Eigen::Index i = 0; i < n; ++i) x += inverse_gain_[i] * (y[i] - offset_[i]);
  return Estimate::scalar(x / static_cast<double>(n), std::numeric_limits<double>::quiet_NaN());
}

/// Welford's update of mean and products.
void BlindCalibration::gather(const Sample& y) {
  instants_ += 1;
  const Eigen::Index n = y.size();
  const double gain = 1 / instants_;
  for (Eigen::Index i = 0; i < n; ++i) delta_[i] = y[i] - mean_[i];
  for (Eigen::Index j = 0; j < n; ++j) {
    const double scaled = delta_[j] * (1 - gain);
    for (Eigen::Index i = j; i < n; ++i) squares_(i, j) += delta_[i] * scaled;
  }
  for (Eigen::Index i = 0; i < n; ++i) mean_[i] += gain * delta_[i];
}

void BlindCalibration::solve() {
  if (!(noise_removal_ ? solve_factor() : solve_gram())) return;
  solved_ = true;
  set_gauge();
  set_offsets();
}

/// The one factor of the covariance; false while the channels do not move.
bool BlindCalibration::solve_factor() {
  const Eigen::Index n = mean_.size();
  const auto covariance = squares_.selfadjointView<Eigen::Lower>();
  for (Eigen::Index i = 0; i < n; ++i)
    if (!(squares_(i, i) > 0)) return false;
  const bool known = levels_.size() == n;
  if (!solved_) {
    noise_ = 0.5 * squares_.diagonal() / instants_;
    factor_ = noise_.cwiseSqrt();
  }
  if (known) noise_ = levels_;
  // A factor in units of the noise, v = D^-1/2 g; a power step is v <- D^-1/2 C D^-1/2 v / |.|.
  for (int round = 0; round < kRounds; ++round) {
    scratch_ = factor_.cwiseQuotient(noise_);
    delta_.noalias() = covariance * scratch_;
    delta_ /= instants_;
    // delta_ = C D^-1 g; Rayleigh quotient of the scaled problem: lambda = g'D^-1 C D^-1 g / g'D^-1
    // g.
    const double lambda = scratch_.dot(delta_) / scratch_.dot(factor_);
    const double length = std::sqrt(delta_.cwiseAbs2().cwiseQuotient(noise_).sum());
    if (!(lambda > 1) || !(length > 0)) return false;
    factor_ = delta_ * (std::sqrt(lambda - 1) / length);
    if (known) continue;
    for (Eigen::Index i = 0; i < n; ++i) {
      const double all = squares_(i, i) / instants_;
      noise_[i] = std::max(all - factor_[i] * factor_[i], kLeastNoise * all);
    }
  }
  // Relative to the strongest: a channel without the input has no gain to be inverted.
  const double strongest = factor_.cwiseAbs().maxCoeff();
  for (Eigen::Index i = 0; i < n; ++i) {
    if (!(std::abs(factor_[i]) > 1e-6 * strongest)) return false;
    // var(g) / g^2 = v / (N g^2), as if the factor itself were known.
    if (noise_[i] > kUncertainGain * kUncertainGain * instants_ * factor_[i] * factor_[i])
      return false;
  }
  inverse_gain_ = factor_.cwiseInverse();
  return true;
}

/// argmin a'(P o C) a on the gauge, by its optimality conditions. In memory of its own: `step`
/// calls it.
bool BlindCalibration::solve_gram() {
  const Eigen::Index n = mean_.size();
  const double scale = squares_.diagonal().maxCoeff();
  if (!(scale > 0)) return false;
  conditions_.setZero();
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j) {
      const double projector = (i == j ? 1.0 : 0.0) - 1 / static_cast<double>(n);
      conditions_(i, j) = projector * squares_(std::max(i, j), std::min(i, j)) / scale;
    }
  for (Eigen::Index i = 0; i < n; ++i)
    conditions_(i, n) = conditions_(n, i) =
        gauge_ == 0 ? 1 / static_cast<double>(n) : (i == gauge_ - 1 ? 1.0 : 0.0);
  elimination_.compute(conditions_);
  if (!elimination_.isInvertible()) return false;
  // P A Q = L U by hand, since Eigen's solve() asks the heap for its intermediate vector.
  solution_.setZero();
  solution_[elimination_.permutationP().indices()[n]] = 1;
  elimination_.matrixLU().triangularView<Eigen::UnitLower>().solveInPlace(solution_);
  elimination_.matrixLU().triangularView<Eigen::Upper>().solveInPlace(solution_);
  for (Eigen::Index k = 0; k <= n; ++k)
    if (const Eigen::Index i = elimination_.permutationQ().indices()[k]; i < n)
      inverse_gain_[i] = solution_[k];
  return true;
}

void BlindCalibration::set_gauge() {
  const double factor = gauge_ == 0 ? inverse_gain_.mean() : inverse_gain_[gauge_ - 1];
  if (std::abs(factor) > 1e-9 * inverse_gain_.cwiseAbs().maxCoeff()) inverse_gain_ /= factor;
}

void BlindCalibration::set_offsets() {
  const double t = mean_.sum() / inverse_gain_.cwiseInverse().sum();
  offset_ = mean_ - t * inverse_gain_.cwiseInverse();
}

void BlindCalibration::remarks(Warnings& warnings) const {
  if (!solved_)
    warnings.add(
        "not_calibrated",
        "blind-calibration found no common movement of the channels: it was the plain mean");
  if (!noise_removal_ && mean_.size() < 3)
    warnings.add(
        "noise_bias",
        "blind-calibration of two channels without noise levels takes their noise for gain");
}

BlindCalibrationPublished::BlindCalibrationPublished(const Array& array, const Settings& settings)
    : reference_(static_cast<Eigen::Index>(settings["reference_channel"]) - 1),
      gamma_(settings["gamma"]),
      mean_(Eigen::VectorXd::Zero(array.channels)),
      inverse_gain_(Eigen::VectorXd::Ones(array.channels)),
      offset_(mean_) {
  require_channel(reference_ + 1, array.channels, "reference_channel");
}

Estimate BlindCalibrationPublished::step(const Sample& y) {
  const Eigen::Index n = y.size();
  instants_ += 1;
  mean_ += (y - mean_) / instants_;
  const double centre = mean_.mean(), reference = y[reference_] - mean_[reference_];
  double x = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const double ratio = reference / (y[i] - mean_[i]);
    if (i != reference_ && std::isfinite(ratio))
      inverse_gain_[i] = gamma_ * inverse_gain_[i] + (1 - gamma_) * ratio;
    offset_[i] = mean_[i] - centre;
    x += inverse_gain_[i] * (y[i] - offset_[i]);
  }
  return Estimate::scalar(x / static_cast<double>(n), std::numeric_limits<double>::quiet_NaN());
}

}  // namespace libchar::fusion
