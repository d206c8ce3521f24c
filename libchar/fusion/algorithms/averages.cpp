#include "libchar/fusion/algorithms/averages.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "libchar/fusion/detail/variances/weighted_mean.hpp"

namespace libchar::fusion {

InverseVariance::InverseVariance(const Array& array) : levels_(array.noise_levels) {
  assert(levels_.size() == array.channels);
  // Relative to the smallest, so that levels near the ends of the range of a double do not overflow.
  const double smallest = levels_.minCoeff();
  weights_ = (smallest / levels_.array()).matrix();
  const double sum = weights_.sum();
  weights_ /= sum;
  variance_ = smallest / sum;
  if (!array.one_common_input()) general_ = std::make_unique<GeneralMean>(array.h(), levels_);
}

Estimate InverseVariance::step(const Sample& y) const {
  if (general_) return general_->step(y);
  const WeightedMean mean = weighted_mean(y.data(), weights_.data(), weights_.size());
  // Only samples that the levels say nothing for: no opinion.
  return Estimate::scalar(mean.x, mean.used > 0 ? variance_ / mean.used : std::nan(""));
}

Mean::Mean(const Array& array) : levels_(array.noise_levels), channels_(array.channels) {
  const double n = static_cast<double>(channels_);
  variance_ = levels_.size() == channels_ ? levels_.sum() / (n * n) : std::nan("");
  if (!array.one_common_input()) general_ = std::make_unique<GeneralMean>(array.h(), Eigen::VectorXd::Ones(channels_));
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
  if (std::abs(sum) <= kLargestSample) return Estimate::scalar(base + sum / static_cast<double>(channels_), variance_);
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

namespace {

/// Below this many samples, sorting by insertion is faster than selection.
constexpr std::ptrdiff_t kFew = 24;

void sort_by_insertion(double* first, double* last) {
  for (double* next = first + 1; next < last; ++next) {
    const double value = *next;
    double* place = next;
    for (; place > first && place[-1] > value; --place) *place = place[-1];
    *place = value;
  }
}

}  // namespace

Estimate Median::step(const Sample& y) {
  double* const first = sorted_.data();
  double* last = first;
  for (Eigen::Index i = 0; i < y.size(); ++i)
    if (usable(y[i])) *last++ = y[i];
  const std::ptrdiff_t n = last - first;
  if (n == 0) return Estimate::none(1);
  double* const middle = first + n / 2;
  if (n <= kFew)
    sort_by_insertion(first, last);
  else
    std::nth_element(first, middle, last);
  if (n % 2 == 1) return Estimate::scalar(*middle, std::nan(""));
  const double below = *std::max_element(first, middle);
  return Estimate::scalar(below + (*middle - below) / 2, std::nan(""));
}

}  // namespace libchar::fusion
