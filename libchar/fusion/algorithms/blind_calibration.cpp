#include "libchar/fusion/algorithms/blind_calibration.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "libchar/core/refusal.hpp"

namespace libchar::fusion {
namespace {

void require_channel(Eigen::Index wanted, Eigen::Index channels, const char* option) {
  if (wanted > channels)
    throw usage_error("E0855")
        .says(std::string(option) + " must be one of the " + std::to_string(channels) + " channels")
        .got(std::to_string(wanted));
}

}  // namespace

BlindCalibration::BlindCalibration(const Array& array, const Settings& settings)
    : gauge_(static_cast<Eigen::Index>(settings["gauge"])),
      noise_removal_(settings["noise_removal"] != 0),
      mean_(Eigen::VectorXd::Zero(array.channels)),
      delta_(mean_),
      factor_(array.channels),
      inverse_gain_(Eigen::VectorXd::Ones(array.channels)),
      offset_(mean_),
      solved_mean_(mean_),
      squares_(Eigen::MatrixXd::Zero(array.channels, array.channels)),
      conditions_(array.channels + 1, array.channels + 1),
      solution_(array.channels + 1),
      elimination_(array.channels + 1, array.channels + 1),
      next_(static_cast<double>(std::max<Eigen::Index>(20, 3 * array.channels))) {
  require_channel(gauge_, array.channels, "gauge");
  if (array.noise_levels.size() == array.channels) levels_ = array.noise_levels;
  if (array.channels < 3 && levels_.size() == 0) noise_removal_ = false;
}

/// The mean of the corrected channels that are there, by what has been learnt so far.
Estimate BlindCalibration::of_present(const Sample& y) const {
  double sum = 0, present = 0, first = 0;
  for (Eigen::Index i = 0; i < y.size(); ++i) {
    if (!usable(y[i])) continue;
    if (present == 0) first = y[i];
    sum += solved_ ? inverse_gain_[i] * ((y[i] - origin_) - solved_mean_[i]) : y[i] - first;
    ++present;
  }
  if (present == 0) return Estimate::none(1);
  return Estimate::scalar((solved_ ? origin_ + centre_ : first) + sum / present, std::nan(""));
}

Estimate BlindCalibration::step(const Sample& y) {
  if (!complete(y)) return of_present(y);
  gather(y);
  if (instants_ >= next_) {
    next_ = std::ceil(instants_ * 1.1);
    solve();
  }
  const Eigen::Index n = y.size();
  const double base = solved_ ? centre_ : y[0] - origin_;
  double x = 0;
  for (Eigen::Index i = 0; i < n; ++i) x += inverse_gain_[i] * ((y[i] - origin_) - (solved_ ? solved_mean_[i] : base));
  return Estimate::scalar(origin_ + (base + x / static_cast<double>(n)), std::numeric_limits<double>::quiet_NaN());
}

/// Welford's update of mean and products.
void BlindCalibration::gather(const Sample& y) {
  instants_ += 1;
  const Eigen::Index n = y.size();
  const double gain = 1 / instants_;
  if (instants_ == 1) origin_ = y[0];
  for (Eigen::Index i = 0; i < n; ++i) delta_[i] = (y[i] - origin_) - mean_[i];
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
  if (!factor_.solve(squares_, instants_, instants_, levels_)) return false;
  inverse_gain_ = factor_.factor().cwiseInverse();
  return true;
}

/// argmin a'(P o C) a on the gauge, by its optimality conditions. In memory of its own: `step` calls it.
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
    conditions_(i, n) = conditions_(n, i) = gauge_ == 0 ? 1 / static_cast<double>(n) : (i == gauge_ - 1 ? 1.0 : 0.0);
  elimination_.compute(conditions_);
  if (!elimination_.isInvertible()) return false;
  // P A Q = L U by hand, since Eigen's solve() asks the heap for its intermediate vector.
  solution_.setZero();
  solution_[elimination_.permutationP().indices()[n]] = 1;
  elimination_.matrixLU().triangularView<Eigen::UnitLower>().solveInPlace(solution_);
  elimination_.matrixLU().triangularView<Eigen::Upper>().solveInPlace(solution_);
  for (Eigen::Index k = 0; k <= n; ++k)
    if (const Eigen::Index i = elimination_.permutationQ().indices()[k]; i < n) inverse_gain_[i] = solution_[k];
  return true;
}

void BlindCalibration::set_gauge() {
  const double factor = gauge_ == 0 ? inverse_gain_.mean() : inverse_gain_[gauge_ - 1];
  if (std::abs(factor) > 1e-9 * inverse_gain_.cwiseAbs().maxCoeff()) inverse_gain_ /= factor;
}

void BlindCalibration::set_offsets() {
  solved_mean_ = mean_;
  centre_ = mean_[0] + (mean_.array() - mean_[0]).mean();
  // Loops: `step` calls it.
  double gains = 0, means = 0;
  for (const double inverse : inverse_gain_) gains += 1 / inverse;
  for (const double mean : mean_) means += origin_ + mean;
  for (Eigen::Index i = 0; i < mean_.size(); ++i) offset_[i] = (origin_ + mean_[i]) - means / gains / inverse_gain_[i];
}

void BlindCalibration::remarks(Findings& warnings) const {
  if (!solved_) warnings.add("not_calibrated", "found no common movement of the channels: it was the plain mean");
  if (!noise_removal_ && mean_.size() < 3)
    warnings.add("noise_bias", "of two channels without noise levels it takes their noise for gain");
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
    if (i != reference_ && std::isfinite(ratio)) inverse_gain_[i] = gamma_ * inverse_gain_[i] + (1 - gamma_) * ratio;
    offset_[i] = mean_[i] - centre;
    x += inverse_gain_[i] * (y[i] - offset_[i]);
  }
  return Estimate::scalar(x / static_cast<double>(n), std::numeric_limits<double>::quiet_NaN());
}

}  // namespace libchar::fusion
