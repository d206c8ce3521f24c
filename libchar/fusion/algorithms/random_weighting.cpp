#include "libchar/fusion/algorithms/random_weighting.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "libchar/core/refusal.hpp"
#include "libchar/fusion/detail/variances/weighted_mean.hpp"

namespace libchar::fusion {

RandomWeighting::RandomWeighting(const Array& array, const Settings& settings)
    : floor_(settings["floor"]),
      squares_(Eigen::VectorXd::Zero(array.channels)),
      variances_(squares_),
      weights_(Eigen::VectorXd::Constant(array.channels, 1 / static_cast<double>(array.channels))) {}

/// By the weights so far: an instant that lacks a sample teaches nothing, since the mean that the channels are compared
/// with would be another one.
Estimate RandomWeighting::of_present(const Sample& y) const {
  const WeightedMean mean = weighted_mean_of_present(y.data(), weights_.data(), weights_.size());
  return Estimate::scalar(mean.x, mean.used > 0 ? variance_ / mean.used : std::nan(""));
}

Estimate RandomWeighting::step(const Sample& y) {
  if (!complete(y)) return of_present(y);
  const Eigen::Index n = squares_.size();
  const double channels = static_cast<double>(n), base = y[0];
  double mean = 0;
  for (Eigen::Index i = 0; i < n; ++i) mean += y[i] - base;
  mean /= channels;
  // Sums in place of means: weights do not care for the number of instants.
  double total = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const double d = (y[i] - base) - mean;
    squares_[i] += d * d;
    total += squares_[i];
  }
  instants_ += 1;
  if (!(total > 0)) return Estimate::scalar(base + mean, 0);
  const double shared = total / (channels * (channels - 1)), scale = channels / ((channels - 2) * instants_);
  double largest = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    variances_[i] = scale * (squares_[i] - shared);
    largest = std::max(largest, variances_[i]);
  }
  const double lowest = largest * std::max(floor_, 1e-26);
  double sum = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    variances_[i] = std::max(variances_[i], lowest);
    weights_[i] = largest / variances_[i];
    sum += weights_[i];
  }
  const double inverse = 1 / sum;
  double x = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    weights_[i] *= inverse;
    x += weights_[i] * (y[i] - base);
  }
  variance_ = largest * inverse;
  return Estimate::scalar(base + x, variance_);
}

RandomWeightingPublished::RandomWeightingPublished(const Array& array, const Settings& settings)
    : reference_(static_cast<Eigen::Index>(settings["reference_channel"]) - 1),
      second_(static_cast<Eigen::Index>(settings["second_channel"]) - 1),
      squares_(Eigen::VectorXd::Zero(array.channels)),
      products_(squares_),
      variances_(squares_),
      weights_(Eigen::VectorXd::Constant(array.channels, 1 / static_cast<double>(array.channels))) {
  if (reference_ >= array.channels || second_ >= array.channels || reference_ == second_)
    throw usage_error("E0855")
        .says("random-weighting-published compares with two different channels of the " +
              std::to_string(array.channels) + " of the scene")
        .got(std::to_string(reference_ + 1) + " and " + std::to_string(second_ + 1))
        .hint("set reference_channel and second_channel");
}

Estimate RandomWeightingPublished::step(const Sample& y) {
  const Eigen::Index n = squares_.size();
  instants_ += 1;
  double sum = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const double other = y[i == reference_ ? second_ : reference_];
    squares_[i] += y[i] * y[i];
    products_[i] += y[i] * other;
    variances_[i] = (squares_[i] - products_[i]) / instants_;
    weights_[i] = 1 / variances_[i];
    sum += weights_[i];
  }
  // As published there is no rule for a variance of zero: then the mean.
  if (!std::isfinite(sum) || sum == 0)
    weights_.setConstant(1 / static_cast<double>(n));
  else
    weights_ /= sum;
  double x = 0;
  for (Eigen::Index i = 0; i < n; ++i) x += weights_[i] * (y[i] - y[0]);
  return Estimate::scalar(y[0] + x, std::numeric_limits<double>::quiet_NaN());
}

}  // namespace libchar::fusion
