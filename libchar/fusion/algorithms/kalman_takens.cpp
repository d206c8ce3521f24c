#include "libchar/fusion/algorithms/kalman_takens.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "libchar/core/refusal.hpp"
#include "libchar/fusion/detail/variances/weighted_mean.hpp"

namespace libchar::fusion {
namespace {

std::size_t whole(const Settings& settings, std::string_view name) { return static_cast<std::size_t>(settings[name]); }

/// The spread of z stands for the prediction's error until this many errors are known.
constexpr double kPriorErrors = 30;
/// Smallest Q in units of the variance of the channels together: they are never ignored.
constexpr double kLeastShare = 1e-6;

}  // namespace

KalmanTakensFilter::KalmanTakensFilter(const Array& array, const Settings& settings, bool from_reference)
    : levels_(array.noise_levels),
      weights_(levels_.minCoeff() * levels_.cwiseInverse()),
      dimension_(whole(settings, "dimension")),
      neighbours_(whole(settings, "neighbours")),
      dictionary_(whole(settings, "dictionary")),
      theiler_(from_reference ? 0 : whole(settings, "theiler")),
      from_reference_(from_reference),
      given_q_(settings["process_variance"]),
      keep_(1 - 1 / settings["memory"]),
      search_(dimension_, neighbours_, dictionary_),
      series_(2 * (dictionary_ + dimension_ + theiler_)),
      recent_(dimension_) {
  weights_ /= weights_.sum();
  least_q_ = kLeastShare / levels_.cwiseInverse().sum();
}

void KalmanTakensFilter::append(double value) {
  const std::size_t most = dictionary_ + dimension_ + theiler_;
  if (last_ == series_.size()) {
    std::copy(series_.begin() + static_cast<std::ptrdiff_t>(first_), series_.end(), series_.begin());
    last_ -= first_;
    first_ = 0;
  }
  series_[last_++] = value;
  if (last_ - first_ > most) ++first_;
}

void KalmanTakensFilter::widen_spread(double z) {
  seen_ += 1;
  const double off = z - mean_;
  mean_ += off / seen_;
  spread_ += off * (z - mean_);
}

void KalmanTakensFilter::learn(double truth) {
  // One NaN parts the stretches; more would only push known ones out.
  if (std::isnan(truth) && last_ > first_ && std::isnan(series_[last_ - 1])) return;
  append(truth);
  if (!std::isnan(truth)) widen_spread(truth);
}

/// The series without its gaps, and before which of its values they stand.
void KalmanTakensFilter::exchange(LearntExchange& with) {
  with.needs_same_rate("its stretches of the past");
  std::vector<double> values, gaps;
  for (std::size_t k = first_; k < last_; ++k)
    if (std::isnan(series_[k]))
      gaps.push_back(static_cast<double>(values.size()));
    else
      values.push_back(series_[k]);
  with.list("series", values);
  with.list("gaps_before", gaps);
  with.number("mean", mean_);
  with.number("spread", spread_);
  with.number("instants", seen_);
  if (!with.taking_in()) return;
  first_ = last_ = 0;
  std::size_t gap = 0;
  for (std::size_t k = 0; k <= values.size(); ++k) {
    if (gap < gaps.size() && gaps[gap] == static_cast<double>(k)) {
      append(std::nan(""));
      ++gap;
    }
    if (k < values.size()) append(values[k]);
  }
}

std::size_t KalmanTakensFilter::learnt_stretches() const {
  std::size_t stretches = 0, length = 0;  // values without a gap so far
  for (std::size_t k = first_; k < last_; ++k) {
    length = std::isnan(series_[k]) ? 0 : length + 1;
    if (length > dimension_) ++stretches;
  }
  return stretches;
}

/// NaN while the past is too short: a few stretches would always find the same neighbours.
double KalmanTakensFilter::predict() {
  const std::size_t length = last_ - first_, behind = dimension_ + (from_reference_ ? 0 : theiler_ - 1);
  if (heard_ < dimension_ || length <= behind) return std::nan("");
  const std::size_t starts = std::min(length - behind, dictionary_);
  if (!from_reference_ && starts < std::min(2 * neighbours_, dictionary_)) return std::nan("");
  const double* const series = series_.data() + first_;
  return prediction(search_.nearest(series, starts, recent_.data()), series, dimension_);
}

/// Q + variance is what the square of the error should be.
void KalmanTakensFilter::learn_error(double error, double variance) {
  error_square_ = keep_ * error_square_ + (error * error - variance);
  error_weight_ = keep_ * error_weight_ + 1;
}

double KalmanTakensFilter::process_variance() const {
  if (given_q_ > 0) return given_q_;
  const double spread = seen_ > 1 ? spread_ / (seen_ - 1) : 0;
  const double fade = std::max(0.0, 1 - error_weight_ * (1 - keep_)) * kPriorErrors;
  return (error_square_ + fade * spread) / (error_weight_ + fade);
}

void KalmanTakensFilter::remember(double z, bool measured) {
  std::copy(recent_.begin() + 1, recent_.end(), recent_.begin());
  recent_.back() = z;
  heard_ = std::isnan(z) ? 0 : std::min(heard_ + 1, dimension_);
  if (!from_reference_) append(measured ? z : std::nan(""));
  if (measured) widen_spread(z);
}

Estimate KalmanTakensFilter::step(const Sample& y) {
  const WeightedMean mean = weighted_mean(y.data(), weights_.data(), weights_.size());
  const bool measured = mean.used > 0;
  double information = 0;
  for (Eigen::Index i = 0; i < y.size(); ++i)
    if (usable(y[i])) information += 1 / levels_[i];
  const double variance = 1 / information, predicted = predict();
  // Errors as small as the noise leave an estimate of Q at or below zero.
  const double q = std::max(process_variance(), least_q_);
  if (!measured) {
    gap_variance_ += q;
    remember(predicted, false);
    return Estimate::scalar(predicted, std::isnan(predicted) ? predicted : gap_variance_);
  }
  Estimate estimate = Estimate::scalar(mean.x, variance);
  if (!std::isnan(predicted)) {
    const double prior = std::max(q, gap_variance_);
    const double share = prior / (prior + variance);  // of the channels
    estimate = Estimate::scalar(predicted + share * (mean.x - predicted), share * variance);
    if (gap_variance_ == 0) learn_error(mean.x - predicted, variance);
  }
  gap_variance_ = 0;
  remember(mean.x, true);
  return estimate;
}

/// Below the error of the channels together the past says more than they do: the input repeats.
void KalmanTakensFilter::remark(Findings& warnings) const {
  const double fused = 1 / levels_.cwiseInverse().sum(), q = process_variance();
  if (given_q_ > 0 || !(error_weight_ > kPriorErrors) || !(q < fused)) return;
  warnings.add("input_repeats",
               "predicts the input from its past better than the sensors measure it: the input "
               "repeats itself or is constant; another input would not be estimated as well");
}

void KalmanTakensTaught::finish_learning() {
  if (filter_.learnt_stretches() >= 2 * filter_.neighbours()) return;
  throw numeric_error("E0862")
      .says("the learning window holds fewer than two stretches of the past for each neighbour")
      .got(std::to_string(filter_.learnt_stretches()))
      .hint("lengthen the learning window, or ask for fewer neighbours");
}

}  // namespace libchar::fusion
