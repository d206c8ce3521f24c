#pragma once
// Gains and offsets of the channels without a reference, from the fact that they all see one moving
// input (Balzano & Nowak 2007; [RV 3.5]), then the mean of the corrected channels.
//
//   u_i = g_i x + beta_i + e_i,  C = covariance of u so far,  a_i = 1 / g_i up to a common factor
//   without noise: (P o C) a = 0, P = I - 11'/n; the gauge sets the factor: a_ref = 1, or mean(a) = 1
//   x = mean of all means + mean of a_i (u_i - mean(u_i)): an offset of the input moves x by itself
//   and by nothing else, whatever the gauge. The offsets that are reported belong to the gauge:
//   beta_i = mean(u_i) - t / a_i with sum beta = 0. x of beta would be off by (sum 1/a - n)/n of the
//   input's mean, since the mean of 1/a is not one where that of a is (Jensen)
//
// Noise adds its variances D to the diagonal of C and biases every gain. Default: D is taken off, as the noise levels
// where they are given, else estimated with the gains as the one factor of C = s g g' + D (n > 2), alternating the
// leading eigenvector of D^-1/2 C D^-1/2 and D = diag(C - s g g'); then (P o (C - D)) a = 0 holds for a = 1/g. With
// noise_removal = 0: argmin a'(P o C) a on the gauge. Solved when the number of instants has grown by a tenth, from
// running moments, never per instant. An instant that lacks a sample teaches nothing: the others have their mean.
//
// As published: the solution of a single instant, u_ref / u_i of centred samples, smoothed with 0.999999 from one. It
// is a ratio of Gaussians, without a mean (docs/theory/fusion.md): kept for comparison.

#include <Eigen/LU>
#include <array>

#include "libchar/fusion/algorithm.hpp"
#include "libchar/fusion/detail/variances/one_factor.hpp"

namespace libchar::fusion {

struct BlindCalibration {
  static constexpr Description description{
      .name = "blind-calibration",
      .title = "Blind calibration, then the mean",
      .source = "[RV 3.5]; Balzano & Nowak 2007",
      .complexity = "O(n^2)",
      .needs = {.min_channels = 2, .max_channels = kMostPaired, .accepts_missing = true}};
  static constexpr std::array options{
      Option{"gauge", "", 0, 0, 1e6, "0: mean of the inverse gains is one; k: channel k (from 1) has gain one", true},
      Option{"noise_removal", "", 1, 0, 1, "1: the noise is taken off the diagonal of the covariance", true}};
  BlindCalibration(const Array& array, const Settings& settings);
  static double cost_ns(const Array& array, const Settings&) {
    const auto n = static_cast<double>(array.channels);
    return 10 * n + n * n;
  }
  Estimate step(const Sample& y);
  /// Of the samples as they come: a_i / n.
  Eigen::MatrixXd weights() const { return inverse_gain_ / static_cast<double>(inverse_gain_.size()); }
  void remarks(Findings& warnings) const;
  /// Solves for what has been seen so far (`step` does so now and then).
  void solve();
  const Eigen::VectorXd& inverse_gain() const { return inverse_gain_; }
  const Eigen::VectorXd& offset() const { return offset_; }

 private:
  Estimate of_present(const Sample& y) const;
  void gather(const Sample& y);
  bool solve_factor();
  bool solve_gram();
  void set_gauge();
  void set_offsets();

  Eigen::Index gauge_;
  bool noise_removal_;
  Eigen::VectorXd levels_;  // given noise variances, or empty
  Eigen::VectorXd mean_, delta_;
  OneFactor factor_;
  Eigen::VectorXd inverse_gain_, offset_, solved_mean_;
  Eigen::MatrixXd squares_;  // sums of products about the mean, lower triangle
  Eigen::MatrixXd conditions_;
  Eigen::VectorXd solution_;
  Eigen::FullPivLU<Eigen::MatrixXd> elimination_;
  double instants_ = 0, next_ = 0, centre_ = 0;
  double origin_ = 0;  // of samples and means: the first one
  bool solved_ = false;
};

struct BlindCalibrationPublished {
  static constexpr Description description{.name = "blind-calibration-published",
                                           .title = "Blind calibration as published, then the mean",
                                           .source = "[RV 3.5]",
                                           .complexity = "O(n)",
                                           .needs = {.min_channels = 2},
                                           .as_published = true};
  static constexpr std::array options{
      Option{"reference_channel", "", 1, 1, 1e6, "channel whose gain is taken for one, counted from 1", true},
      Option{"gamma", "", 0.999999, 0, 1, "smoothing of the solutions of single instants"}};
  BlindCalibrationPublished(const Array& array, const Settings& settings);
  Estimate step(const Sample& y);
  Eigen::MatrixXd weights() const { return inverse_gain_ / static_cast<double>(inverse_gain_.size()); }
  const Eigen::VectorXd& inverse_gain() const { return inverse_gain_; }
  const Eigen::VectorXd& offset() const { return offset_; }

 private:
  Eigen::Index reference_;
  double gamma_;
  Eigen::VectorXd mean_, inverse_gain_, offset_;
  double instants_ = 0;
};

}  // namespace libchar::fusion
