#include "libchar/fusion/algorithms/minque_published.hpp"

#include <cmath>
#include <limits>

#include "libchar/fusion/detail/variances/weighted_mean.hpp"

namespace libchar::fusion {

MinquePublished::MinquePublished(const Array& array, const Settings& settings)
    : moments_(array.channels, settings["gamma"], settings["about_zero"] != 0),
      common_(settings["common_threshold"] != 0),
      factor_(settings["threshold"]),
      settling_(static_cast<std::int64_t>(settings["settling"])),
      fault_free_(array.fault_free_samples),
      recovery_(static_cast<std::int64_t>(settings["recovery_samples"])),
      in_use_(static_cast<std::size_t>(array.channels)),
      out_(in_use_.size(), 0),
      out_since_(in_use_.size(), 0),
      variances_(Eigen::VectorXd::Zero(array.channels)),
      weights_(Eigen::VectorXd::Constant(array.channels, 1 / static_cast<double>(array.channels))),
      threshold_(Eigen::VectorXd::Zero(array.channels)) {
  if (settling_ < 0) settling_ = static_cast<std::int64_t>(std::ceil(3 / (1 - settings["gamma"])));
}

Estimate MinquePublished::step(const Sample& y) {
  choose(y, true);
  moments_.update(y.data(), in_use_.data(), m_);
  choose(y, false);
  if (m_ >= 3) moments_.variances(in_use_.data(), m_, variances_.data());
  if (now_ < fault_free_)
    learn_threshold();
  else if (fault_free_ > 0)
    judge(y);
  const double variance = weigh();
  ++now_;
  const WeightedMean mean = weighted_mean(y.data(), weights_.data(), y.size());
  return Estimate::scalar(mean.x, variance);
}

void MinquePublished::choose(const Sample& y, bool with_faulty) {
  m_ = 0;
  for (std::size_t i = 0; i < in_use_.size(); ++i)
    if (usable(y[static_cast<Eigen::Index>(i)]) && (with_faulty || out_[i] == 0))
      in_use_[static_cast<std::size_t>(m_++)] = static_cast<int>(i);
}

void MinquePublished::learn_threshold() {
  // The moments of the first instants scatter most; a threshold from them would hide faults.
  if (now_ < settling_ && now_ + 1 < fault_free_) return;
  for (int k = 0; k < m_; ++k) {
    const Eigen::Index i = in_use_[static_cast<std::size_t>(k)];
    threshold_[i] = std::max(threshold_[i], factor_ * variances_[i]);
  }
  if (common_) threshold_.setConstant(threshold_.maxCoeff());
}

void MinquePublished::judge(const Sample& y) {
  int worst = -1;
  double excess = 1;
  for (int k = 0; k < m_; ++k) {
    const int i = in_use_[static_cast<std::size_t>(k)];
    const double ratio = variances_[i] / threshold_[i];
    if (ratio > excess) {
      excess = ratio;
      worst = i;
    }
  }
  // Two channels are left at least: they cannot accuse each other.
  if (worst >= 0 && m_ > 2) {
    out_[static_cast<std::size_t>(worst)] = 1;
    out_since_[static_cast<std::size_t>(worst)] = now_;
    log_.note({now_, worst, true, FaultRule::variance});
    choose(y, false);
    if (m_ >= 3) moments_.variances(in_use_.data(), m_, variances_.data());
  }
  bool changed = false;
  for (std::size_t i = 0; i < out_.size(); ++i) {
    if (out_[i] == 0 || m_ < 2) continue;
    double& v = variances_[static_cast<Eigen::Index>(i)];
    v = moments_.variance_beside(static_cast<int>(i), in_use_.data(), m_);
    if (v < threshold_[static_cast<Eigen::Index>(i)] && now_ - out_since_[i] >= recovery_) {
      out_[i] = 0;
      log_.note({now_, static_cast<int>(i), false, FaultRule::variance});
      changed = true;
    }
  }
  if (changed) choose(y, false);
}

/// Weights of the channels in use from their variances; returns the variance of the result, NaN for
/// a simple mean.
double MinquePublished::weigh() {
  bool positive = m_ >= 3;
  for (int k = 0; k < m_; ++k)
    positive = positive && variances_[in_use_[static_cast<std::size_t>(k)]] > 0;
  weights_.setZero();
  double sum = 0;
  for (int k = 0; k < m_; ++k) {
    const int i = in_use_[static_cast<std::size_t>(k)];
    weights_[i] = positive ? 1 / variances_[i] : 1;
    sum += weights_[i];
  }
  if (sum > 0) weights_ /= sum;
  if (!positive) ++plain_means_;
  return positive ? 1 / sum : std::numeric_limits<double>::quiet_NaN();
}

void MinquePublished::remarks(Warnings& warnings) const {
  if (fault_free_ <= 0)
    warnings.add("faults_not_watched",
                 "minque-published looks for no faults: its thresholds need a stretch that is "
                 "known to hold none");
  if (plain_means_ > 0)
    warnings.add(
        "negative_variance",
        "minque-published used the simple mean where an estimated variance was not above zero",
        {},
        static_cast<std::uint64_t>(plain_means_));
}

}  // namespace libchar::fusion
