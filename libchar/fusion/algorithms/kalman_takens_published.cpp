#include "libchar/fusion/algorithms/kalman_takens_published.hpp"

#include <algorithm>

namespace libchar::fusion {

KalmanTakensPublished::KalmanTakensPublished(const Array& array, const Settings& settings)
    : levels_(array.noise_levels * settings["noise_scale"]),
      information_(levels_.cwiseInverse().sum()),
      dimension_(static_cast<std::size_t>(settings["dimension"])),
      training_(std::max(static_cast<std::size_t>(settings["training"]), dimension_ + 1)),
      q_(settings["process_variance"]),
      p_(settings["start_variance"]),
      search_(dimension_, static_cast<std::size_t>(settings["neighbours"]), training_) {
  dictionary_.reserve(training_);
  recent_.reserve(dimension_);
}

double KalmanTakensPublished::mean_of(const Sample& y) const {
  return y[0] + (y.array() - y[0]).sum() / static_cast<double>(y.size());
}

Estimate KalmanTakensPublished::step(const Sample& y) {
  const double average = mean_of(y);
  if (dictionary_.size() < training_) {
    dictionary_.push_back(average);
    if (dictionary_.size() == training_)
      recent_.assign(dictionary_.end() - static_cast<std::ptrdiff_t>(dimension_), dictionary_.end());
    x_ = average;
    const double n = static_cast<double>(y.size());
    return Estimate::scalar(average, levels_.sum() / (n * n));
  }
  const auto found = search_.nearest(dictionary_.data(), training_ - dimension_, recent_.data());
  const double predicted = prediction(found, dictionary_.data(), dimension_);
  const double f = predicted == x_ ? 1 : predicted / x_;
  const double prior = 1 / (f * p_ * f + q_);
  p_ = 1 / (prior + information_);
  x_ = predicted + p_ * ((y.array() - predicted) / levels_.array()).sum();
  std::copy(recent_.begin() + 1, recent_.end(), recent_.begin());
  recent_.back() = average;
  return Estimate::scalar(x_, p_);
}

}  // namespace libchar::fusion
