#pragma once
// Gains and noise variances of the channels without a reference, as the one factor of their covariance
// (one_factor.hpp), then generalized least squares with both [Aitken 1936]:
//   y_i - mean_i = g_i x + e_i,  x = c + sum p_i (y_i - mean_i) / sum p_i g_i,  p_i = g_i / v_i
// c is the mean of the channels' means, the gauge of the gains what cannot be known without a reference: the middle
// one is one (that of one channel is off by as much as a channel is, and a turned sign moves a mean), or that of a
// channel. blind-calibration weighs its corrected channels alike; here a noisy one counts as little as it should. A
// missing sample costs nothing but itself; solved after 20 instants, or three a channel, and when the record has grown
// by a tenth.

#include <Eigen/Core>
#include <array>
#include <vector>

#include "libchar/fusion/algorithm.hpp"
#include "libchar/fusion/detail/variances/one_factor.hpp"

namespace libchar::fusion {

// Means and covariance of channels some of whose samples are missing: of the instants that are complete,
// in which all channels see the same input, so that its power cancels in what is made of them (Welford);
// while these are few, of each pair over the instants that have both: the same until the first sample is missing.

class PairCovariance {
 public:
  explicit PairCovariance(Eigen::Index channels);
  /// No trip to the heap.
  void add(const Sample& y);
  /// Of the samples: the first usable one. Means and products are about it, so that an offset costs no digits.
  double origin() const { return origin_; }
  /// Instants behind the mean of channel i.
  double instants(Eigen::Index i) const { return by_pairs() ? count_(i, i) : complete_; }
  /// Less the origin.
  double mean(Eigen::Index i) const { return by_pairs() ? pair_mean_(i, i) : mean_[i]; }
  /// Into the lower triangle of `out`; a pair never seen together has covariance zero.
  void covariance(Eigen::MatrixXd& out) const;

 private:
  bool by_pairs() const;
  void add_complete(const Sample& y);
  void begin_pairs();
  void add_pairs(const Sample& y);
  double complete_ = 0, origin_ = 0;
  bool started_ = false;
  bool pairs_ = false;  // some instant was not complete
  Eigen::VectorXd mean_, delta_;
  Eigen::MatrixXd products_;  // of complete instants about the mean, lower triangle
  // (i, j), i >= j: instants and products about the means of the pair; pair_mean_(i, j): of channel i
  // where j is present too.
  Eigen::MatrixXd count_, pair_mean_, pair_products_;
};

struct BlindGls {
  static constexpr Description description{
      .name = "blind-gls",
      .title = "Blind gains and variances, then generalized least squares",
      .source = "Lawley & Maxwell 1971; Aitken 1936",
      .complexity = "O(n^2)",
      .needs = {.min_channels = 3, .max_channels = kMostPaired, .accepts_missing = true}};
  static constexpr std::array options{
      Option{"gauge", "", 0, 0, 1e6, "0: the middle gain is one; k: channel k (from 1) has gain one", true}};
  BlindGls(const Array& array, const Settings& settings);
  static double cost_ns(const Array& array, const Settings&) {
    const auto n = static_cast<double>(array.channels);
    return 10 * n + 2 * n * n;
  }
  Estimate step(const Sample& y);
  /// Of the samples as they come; they do not sum to one where gains differ.
  Eigen::MatrixXd weights() const;
  Eigen::VectorXd variances() const { return variance_; }
  void remarks(Findings& warnings) const;
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
  std::vector<double> sorted_;                       // gains
  double instants_ = 0, next_, centre_ = 0;
  bool solved_ = false;
};

}  // namespace libchar::fusion
