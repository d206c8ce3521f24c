#include "libchar/fusion/algorithms/minque_published.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libchar/core/numeric/whole.hpp"
#include "libchar/fusion/detail/variances/weighted_mean.hpp"

namespace libchar::fusion {

PairMoments::PairMoments(Eigen::Index n, double gamma, bool about_zero)
    : gamma_(gamma),
      about_zero_(about_zero),
      mean_(Eigen::MatrixXd::Zero(n, n)),
      square_(Eigen::MatrixXd::Zero(n, n)),
      missing_(Eigen::MatrixXd::Ones(n, n)),
      moments_(Eigen::VectorXd::Zero(n)) {}

/// As below where all channels are there, with the same bits: the loops run over neighbours in memory.
void PairMoments::update_all(const double* y) {
  const double gain = 1 - gamma_, gamma = gamma_;
  for (Eigen::Index i = 1; i < square_.cols(); ++i) {
    double* const square = square_.col(i).data();
    double* const mean = mean_.col(i).data();
    double* const missing = missing_.col(i).data();
    const double own = y[i];
    if (about_zero_)
      for (Eigen::Index j = 0; j < i; ++j) {
        const double d = own - y[j];
        square[j] = gamma * square[j] + gain * d * d;
      }
    else
      for (Eigen::Index j = 0; j < i; ++j) {
        const double d = own - y[j], delta = d - mean[j];
        const bool first = missing[j] == 1;
        square[j] = first ? square[j] : gamma * (square[j] + gain * delta * delta);
        mean[j] = first ? d : mean[j] + gain * delta;
      }
    for (Eigen::Index j = 0; j < i; ++j) missing[j] *= gamma;
  }
}

void PairMoments::update(const double* y, const int* index, int m) {
  if (m == square_.cols()) return update_all(y);
  const double gain = 1 - gamma_;
  // index rises, so j < i: the upper triangle, in which neighbours of a row's pairs stand side by side.
  for (int a = 1; a < m; ++a) {
    const int i = index[a];
    for (int b = 0; b < a; ++b) {
      const int j = index[b];
      const double d = y[i] - y[j];
      if (about_zero_) {
        square_(j, i) = gamma_ * square_(j, i) + gain * d * d;
      } else if (missing_(j, i) == 1) {
        mean_(j, i) = d;
      } else {
        const double delta = d - mean_(j, i);
        square_(j, i) = gamma_ * (square_(j, i) + gain * delta * delta);
        mean_(j, i) += gain * delta;
      }
      missing_(j, i) *= gamma_;
    }
  }
}

double PairMoments::moment(Eigen::Index i, Eigen::Index j) const {
  const Eigen::Index low = std::min(i, j), high = std::max(i, j);
  const double square = square_(low, high);
  return about_zero_ && missing_(low, high) < 1 ? square / (1 - missing_(low, high)) : square;
}

/// As below where all channels are there; sums of a channel's moments in another order.
void PairMoments::variances_of_all(double* v) const {
  const Eigen::Index n = square_.cols();
  double total = 0;
  std::fill(v, v + n, 0.0);
  for (Eigen::Index i = 1; i < n; ++i) {
    const double* const square = square_.col(i).data();
    const double* const missing = missing_.col(i).data();
    double* const d = moments_.data();
    for (Eigen::Index j = 0; j < i; ++j)
      d[j] = about_zero_ && missing[j] < 1 ? square[j] / (1 - missing[j]) : square[j];
    for (Eigen::Index j = 0; j < i; ++j) v[j] += d[j];
    const double own = moments_.head(i).sum();
    v[i] += own;
    total += own;
  }
  const auto m = static_cast<double>(n);
  for (Eigen::Index i = 0; i < n; ++i) v[i] = (v[i] - total / (m - 1)) / (m - 2);
}

void PairMoments::variances(const int* index, int m, double* v) const {
  if (m == square_.cols()) return variances_of_all(v);
  double total = 0;
  for (int a = 0; a < m; ++a) v[index[a]] = 0;
  for (int a = 1; a < m; ++a)
    for (int b = 0; b < a; ++b) {
      const double d = moment(index[a], index[b]);
      v[index[a]] += d;
      v[index[b]] += d;
      total += d;
    }
  for (int a = 0; a < m; ++a) v[index[a]] = (v[index[a]] - total / (m - 1)) / (m - 2);
}

double PairMoments::variance_beside(int channel, const int* index, int m) const {
  // The formula of m + 1 channels, written for one of them.
  double own = 0, total = 0;
  for (int a = 0; a < m; ++a) {
    own += moment(channel, index[a]);
    for (int b = 0; b < a; ++b) total += moment(index[a], index[b]);
  }
  return (own - (own + total) / m) / (m - 1);
}

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
  if (settling_ < 0) settling_ = clamped_whole<std::int64_t>(std::ceil(3 / (1 - settings["gamma"])));
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

/// Weights of the channels in use from their variances; returns the variance of the result, NaN for a simple mean.
double MinquePublished::weigh() {
  bool positive = m_ >= 3;
  for (int k = 0; k < m_; ++k) positive = positive && variances_[in_use_[static_cast<std::size_t>(k)]] > 0;
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

void MinquePublished::remarks(Findings& warnings) const {
  if (fault_free_ <= 0)
    warnings.add("faults_not_watched",
                 "no faults are looked for: the thresholds need a stretch that is known to hold none");
  if (plain_means_ > 0)
    warnings.add("negative_variance", "used the simple mean where an estimated variance was not above zero", {},
                 static_cast<std::uint64_t>(plain_means_));
}

}  // namespace libchar::fusion
