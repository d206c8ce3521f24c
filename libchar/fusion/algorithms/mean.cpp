#include "libchar/fusion/algorithms/mean.hpp"

#include <cmath>

#include "libchar/fusion/detail/variances/weighted_mean.hpp"

namespace libchar::fusion {

Mean::Mean(const Array& array) : levels_(array.noise_levels), channels_(array.channels) {
  const double n = static_cast<double>(channels_);
  variance_ = levels_.size() == channels_ ? levels_.sum() / (n * n) : std::nan("");
  if (!array.one_common_input())
    general_ = std::make_unique<GeneralMean>(array.h(), Eigen::VectorXd::Ones(channels_));
}

Estimate Mean::step(const Sample& y) const {
  if (!general_) return unweighted(y);
  Estimate estimate = general_->step(y);
  estimate.variance.setConstant(std::nan(""));  // how noisy the channels are is not stated
  return estimate;
}

Estimate Mean::unweighted(const Sample& y) const {
  const double* const v = y.data();
  const double base = v[0];
  double a = 0, b = 0;
  Eigen::Index i = 0;
  for (; i + 1 < channels_; i += 2) {
    a += v[i] - base;
    b += v[i + 1] - base;
  }
  if (i < channels_) a += v[i] - base;
  const double sum = a + b;
  if (std::abs(sum) <= kLargestSample)
    return Estimate::scalar(base + sum / static_cast<double>(channels_), variance_);
  return of_present(y);
}

Estimate Mean::of_present(const Sample& y) const {
  double base = 0, sum = 0, variance = 0, present = 0;
  for (Eigen::Index i = 0; i < channels_; ++i) {
    if (!usable(y[i])) continue;
    if (present == 0) base = y[i];
    sum += y[i] - base;
    variance += levels_.size() == channels_ ? levels_[i] : std::nan("");
    ++present;
  }
  if (present == 0) return Estimate::none(1);
  return Estimate::scalar(base + sum / present, variance / (present * present));
}

Eigen::MatrixXd Mean::weights() const {
  if (general_) return general_->weights();
  return Eigen::MatrixXd::Constant(channels_, 1, 1 / static_cast<double>(channels_));
}

}  // namespace libchar::fusion
