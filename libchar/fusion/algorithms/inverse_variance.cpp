#include "libchar/fusion/algorithms/inverse_variance.hpp"

#include <cassert>
#include <cmath>

#include "libchar/fusion/detail/variances/weighted_mean.hpp"

namespace libchar::fusion {

InverseVariance::InverseVariance(const Array& array) : levels_(array.noise_levels) {
  assert(levels_.size() == array.channels);
  // Relative to the smallest, so that levels near the ends of the range of a double do not
  // overflow.
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

}  // namespace libchar::fusion
