#include "libchar/fusion/detail/variances/pair_covariance.hpp"

#include <algorithm>

namespace libchar::fusion {

PairCovariance::PairCovariance(Eigen::Index channels)
    : mean_(Eigen::VectorXd::Zero(channels)),
      delta_(mean_),
      products_(Eigen::MatrixXd::Zero(channels, channels)),
      count_(products_),
      pair_mean_(products_),
      pair_products_(products_) {}

/// Too few instants are complete, and there are others.
bool PairCovariance::by_pairs() const {
  constexpr double kLeast = 200, kLeastAChannel = 20;
  return pairs_ && complete_ < std::max(kLeast, kLeastAChannel * static_cast<double>(mean_.size()));
}

void PairCovariance::add(const Sample& y) {
  for (Eigen::Index i = 0; i < y.size() && !started_; ++i)
    if (usable(y[i])) {
      origin_ = y[i];
      started_ = true;
    }
  const bool whole = complete(y);
  if (!whole && !pairs_) begin_pairs();
  if (by_pairs()) add_pairs(y);
  if (whole) add_complete(y);
}

/// So far every pair was there whenever all were.
void PairCovariance::begin_pairs() {
  pairs_ = true;
  for (Eigen::Index j = 0; j < mean_.size(); ++j)
    for (Eigen::Index i = j; i < mean_.size(); ++i) {
      count_(i, j) = complete_;
      pair_mean_(i, j) = mean_[i];
      pair_mean_(j, i) = mean_[j];
      pair_products_(i, j) = products_(i, j);
    }
}

void PairCovariance::add_complete(const Sample& y) {
  const Eigen::Index n = y.size();
  complete_ += 1;
  const double gain = 1 / complete_;
  for (Eigen::Index i = 0; i < n; ++i) delta_[i] = (y[i] - origin_) - mean_[i];
  for (Eigen::Index j = 0; j < n; ++j) {
    const double scaled = delta_[j] * (1 - gain);
    for (Eigen::Index i = j; i < n; ++i) products_(i, j) += delta_[i] * scaled;
  }
  for (Eigen::Index i = 0; i < n; ++i) mean_[i] += gain * delta_[i];
}

void PairCovariance::add_pairs(const Sample& y) {
  const Eigen::Index n = y.size();
  for (Eigen::Index j = 0; j < n; ++j) {
    if (!usable(y[j])) continue;
    const double second = y[j] - origin_;
    for (Eigen::Index i = j; i < n; ++i) {
      if (!usable(y[i])) continue;
      const double count = count_(i, j) += 1;
      const double off = (y[i] - origin_) - pair_mean_(i, j);
      pair_mean_(i, j) += off / count;
      if (i != j) pair_mean_(j, i) += (second - pair_mean_(j, i)) / count;
      pair_products_(i, j) += off * (second - pair_mean_(j, i));
    }
  }
}

void PairCovariance::covariance(Eigen::MatrixXd& out) const {
  for (Eigen::Index j = 0; j < out.cols(); ++j)
    for (Eigen::Index i = j; i < out.rows(); ++i) {
      const double count = by_pairs() ? count_(i, j) : complete_;
      const double products = by_pairs() ? pair_products_(i, j) : products_(i, j);
      out(i, j) = count > 0 ? products / count : 0;
    }
}

}  // namespace libchar::fusion
