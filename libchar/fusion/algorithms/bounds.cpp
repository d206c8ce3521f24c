#include "libchar/fusion/algorithms/bounds.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

#include "libchar/fusion/detail/variances/weighted_mean.hpp"

namespace libchar::fusion {

BestSensor::BestSensor(const Array& array)
    : squares_(Eigen::VectorXd::Zero(array.channels)),
      counts_(squares_),
      order_(static_cast<std::size_t>(array.channels)) {
  std::iota(order_.begin(), order_.end(), 0);
}

void BestSensor::learn(const Sample& y, const Sample& truth) {
  for (Eigen::Index i = 0; i < y.size(); ++i)
    if (usable(y[i])) {
      squares_[i] += (y[i] - truth[0]) * (y[i] - truth[0]);
      counts_[i] += 1;
    }
}

void BestSensor::finish_learning() {
  // From sums to mean squares; a channel that was never there comes last.
  for (Eigen::Index i = 0; i < squares_.size(); ++i)
    squares_[i] = counts_[i] > 0 ? squares_[i] / counts_[i] : std::numeric_limits<double>::infinity();
  std::stable_sort(order_.begin(), order_.end(), [this](int a, int b) { return squares_[a] < squares_[b]; });
}

Estimate BestSensor::step(const Sample& y) const {
  for (const int i : order_)
    if (usable(y[i])) return Estimate::scalar(y[i], squares_[i]);
  return Estimate::none(1);
}

Eigen::MatrixXd BestSensor::weights() const {
  Eigen::MatrixXd w = Eigen::MatrixXd::Zero(squares_.size(), 1);
  w(order_[0], 0) = 1;
  return w;
}

SectionedLeastSquares::SectionedLeastSquares(const Array& array, const Settings& settings)
    : form_{settings["calibrate"] != 0, true, false}, starts_(array.section_starts) {
  std::sort(starts_.begin(), starts_.end());
  std::erase_if(starts_, [](std::int64_t start) { return start <= 0; });
  learners_.assign(starts_.size() + 1, WeightLearner(array.channels));
  means_.resize(learners_.size());
}

std::size_t SectionedLeastSquares::section(std::int64_t instant, std::size_t from) const {
  while (from < starts_.size() && instant >= starts_[from]) ++from;
  return from;
}

void SectionedLeastSquares::learn(const Sample& y, const Sample& truth) {
  learning_ = section(learnt_++, learning_);
  learners_[learning_].add(y, truth[0]);
}

void SectionedLeastSquares::finish_learning() {
  // A section too short to learn from goes with the one before it.
  std::size_t last = learners_.size();
  for (std::size_t s = 0; s < learners_.size(); ++s)
    if (learners_[s].enough()) {
      means_[s].take(learners_[s].weights(form_));
      if (last == learners_.size())
        for (std::size_t earlier = 0; earlier < s; ++earlier) means_[earlier] = means_[s];
      last = s;
    } else if (last < learners_.size()) {
      means_[s] = means_[last];
    }
  // No section at all: the learner says what is missing.
  if (last == learners_.size()) means_[0].take(learners_[0].weights(form_));
}

Estimate SectionedLeastSquares::step(const Sample& y) {
  running_ = section(now_++, running_);
  return means_[running_].step(y);
}

Eigen::MatrixXd SectionedLeastSquares::weights() const { return means_[running_].learnt().weights; }

}  // namespace libchar::fusion
