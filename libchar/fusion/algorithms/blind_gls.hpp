#pragma once
// Gains and noise variances of the channels without a reference, as the one factor of their covariance
// (one_factor.hpp), then generalized least squares with both [Aitken 1936]:
//   y_i - mean_i = g_i x + e_i,  x = c + sum p_i (y_i - mean_i) / sum p_i g_i,  p_i = g_i / v_i
// c is the mean of the channels' means, the gauge of the gains (the first channel's is one, as in [RV 3.5],
// or the mean of 1/g) what cannot be known without a reference. blind-calibration weighs its
// corrected channels alike; here a noisy one counts as little as it should. A missing sample costs
// nothing but itself; solved after 20 instants, or three a channel, and when the record has grown
// by a tenth.

#include <array>

#include "libchar/fusion/algorithm.hpp"
#include "libchar/fusion/detail/variances/one_factor.hpp"
#include "libchar/fusion/detail/variances/pair_covariance.hpp"

namespace libchar::fusion {

struct BlindGls {
  static constexpr Description description{
      .name = "blind-gls",
      .title = "Blind gains and variances, then generalized least squares",
      .source = "Lawley & Maxwell 1971; Aitken 1936",
      .complexity = "O(n^2)",
      .needs = {.min_channels = 3, .max_channels = kMostPaired, .accepts_missing = true}};
  static constexpr std::array options{
      Option{"gauge",
             "",
             1,
             0,
             1e6,
             "k: channel k (from 1) has gain one; 0: the mean of the inverse gains is one",
             true}};
  BlindGls(const Array& array, const Settings& settings);
  static double cost_ns(const Array& array, const Settings&) {
    const auto n = static_cast<double>(array.channels);
    return 10 * n + 2 * n * n;
  }
  Estimate step(const Sample& y);
  /// Of the samples as they come; they do not sum to one where gains differ.
  Eigen::MatrixXd weights() const;
  Eigen::VectorXd variances() const { return variance_; }
  void remarks(Warnings& warnings) const;
  const Eigen::VectorXd& gain() const { return gain_; }

 private:
  void solve();
  bool take_factor();

  Eigen::Index gauge_;
  PairCovariance moments_;
  OneFactor factor_;
  Eigen::MatrixXd covariance_;
  Eigen::VectorXd none_;                             // of the noise nothing is given
  Eigen::VectorXd gain_, variance_, mean_, weight_;  // weight_: p
  double instants_ = 0, next_, centre_ = 0;
  bool solved_ = false;
};

}  // namespace libchar::fusion
