#include "libchar/fusion/algorithms/blind_gls.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "libchar/core/numeric/median.hpp"
#include "libchar/core/refusal.hpp"

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

namespace {

/// No channel is taken to be more than so many times better than all others together: the variance of
/// one of a factor model may run to zero (Heywood 1931).
constexpr double kMostBetter = 100;

}  // namespace

BlindGls::BlindGls(const Array& array, const Settings& settings)
    : gauge_(static_cast<Eigen::Index>(settings["gauge"])),
      moments_(array.channels),
      factor_(array.channels),
      covariance_(Eigen::MatrixXd::Zero(array.channels, array.channels)),
      gain_(Eigen::VectorXd::Ones(array.channels)),
      variance_(Eigen::VectorXd::Ones(array.channels)),
      mean_(Eigen::VectorXd::Zero(array.channels)),
      weight_(Eigen::VectorXd::Ones(array.channels)),
      sorted_(static_cast<std::size_t>(array.channels)),
      next_(static_cast<double>(std::max<Eigen::Index>(20, 3 * array.channels))) {
  if (gauge_ > array.channels)
    throw usage_error("E0855")
        .says("gauge must be one of the " + std::to_string(array.channels) + " channels")
        .got(std::to_string(gauge_));
}

/// Gains in the gauge, variances in the unit of the samples.
bool BlindGls::take_factor() {
  const Eigen::Index n = gain_.size();
  double least = moments_.instants(0);
  for (Eigen::Index i = 1; i < n; ++i) least = std::min(least, moments_.instants(i));
  moments_.covariance(covariance_);
  if (!factor_.solve(covariance_, 1, least, none_)) return false;
  const Eigen::VectorXd& g = factor_.factor();
  sorted_.assign(g.begin(), g.end());
  const double one = gauge_ == 0 ? median_in_place(sorted_) : g[gauge_ - 1];
  if (!std::isfinite(one) || !(std::abs(one) > 1e-9 * g.cwiseAbs().maxCoeff())) return false;
  gain_ = g / one;
  variance_ = factor_.noise();
  return true;
}

void BlindGls::solve() {
  if (!take_factor()) return;
  solved_ = true;
  const Eigen::Index n = gain_.size();
  double all = 0;
  for (Eigen::Index i = 0; i < n; ++i) all += gain_[i] * gain_[i] / variance_[i];
  for (Eigen::Index i = 0; i < n; ++i) {
    const double own = gain_[i] * gain_[i], others = all - own / variance_[i];
    if (own > kMostBetter * others * variance_[i]) variance_[i] = own / (kMostBetter * others);
    weight_[i] = gain_[i] / variance_[i];
    mean_[i] = moments_.mean(i);
  }
  centre_ = mean_[0] + (mean_.array() - mean_[0]).mean();
}

Estimate BlindGls::step(const Sample& y) {
  moments_.add(y);
  instants_ += 1;
  if (instants_ >= next_) {
    next_ = std::ceil(instants_ * 1.1);
    solve();
  }
  double sum = 0, information = 0, base = std::nan("");
  for (Eigen::Index i = 0; i < y.size(); ++i) {
    if (!usable(y[i])) continue;
    const double from_origin = y[i] - moments_.origin();
    if (std::isnan(base)) base = solved_ ? centre_ : from_origin;
    sum += weight_[i] * (from_origin - (solved_ ? mean_[i] : base));
    information += weight_[i] * gain_[i];
  }
  if (!(information > 0)) return Estimate::none(1);
  return Estimate::scalar(moments_.origin() + (base + sum / information), solved_ ? 1 / information : std::nan(""));
}

Eigen::MatrixXd BlindGls::weights() const { return weight_ / weight_.dot(gain_); }

void BlindGls::remarks(Findings& warnings) const {
  if (!solved_) warnings.add("not_calibrated", "found no common movement of the channels: it was the plain mean");
}

}  // namespace libchar::fusion
