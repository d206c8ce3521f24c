#pragma once
// Weights from noise variances that are estimated on all samples so far [RV 3.9].
//
// Default: the variances from the differences between channels (Grubbs 1948, N-cornered hat), in
// which the input cancels:
//   d_i = y_i - mean(y),  s_i = mean over time of d_i^2,  v_i = n/(n-2) [s_i - sum s / (n (n-1))],
//   w_i = (1/v_i) / sum_j 1/v_j
// A variance that comes out below `floor` x the largest is raised to it; [RV] has no rule. Where a sample is missing
// the weights of the others are scaled up to one, and nothing is learnt.
//
// As published: v_i = gamma_ii - gamma_ir with gamma_ij = mean over time of y_i y_j and a reference channel r that must
// be free of faults (for r itself another one). The input's power stands in both terms and cancels on average only, so
// that the estimates may be negative and the weights have no finite moments (docs/theory/fusion.md).

#include <array>
#include <cmath>

#include "libchar/fusion/algorithm.hpp"

namespace libchar::fusion {

struct RandomWeighting {
  static constexpr Description description{
      .name = "random-weighting",
      .title = "Random weighting on differences of channels",
      .source = "[RV 3.9]; Grubbs 1948",
      .complexity = "O(n)",
      .needs = {.min_channels = 3, .more_than_inputs = 2, .accepts_missing = true}};
  static constexpr std::array options{Option{"floor", "", 1e-6, 0, 1, "smallest variance relative to the largest one"}};
  RandomWeighting(const Array& array, const Settings& settings);
  Estimate step(const Sample& y);
  Eigen::MatrixXd weights() const { return weights_; }
  Eigen::VectorXd variances() const { return variances_; }

 private:
  Estimate of_present(const Sample& y) const;

  double floor_;
  double variance_ = std::nan("");  // of the weighted mean
  Eigen::VectorXd squares_, variances_, weights_;
  double instants_ = 0;
};

struct RandomWeightingPublished {
  static constexpr Description description{.name = "random-weighting-published",
                                           .title = "Random weighting as published",
                                           .source = "[RV 3.9]",
                                           .complexity = "O(n)",
                                           .needs = {.min_channels = 2},
                                           .as_published = true};
  static constexpr std::array options{
      Option{"reference_channel", "", 1, 1, 1e6, "channel that the others are compared with, counted from 1", true},
      Option{"second_channel", "", 2, 1, 1e6, "channel that the reference channel itself is compared with", true}};
  RandomWeightingPublished(const Array& array, const Settings& settings);
  Estimate step(const Sample& y);
  Eigen::MatrixXd weights() const { return weights_; }
  Eigen::VectorXd variances() const { return variances_; }

 private:
  Eigen::Index reference_, second_;
  Eigen::VectorXd squares_, products_, variances_, weights_;
  double instants_ = 0;
};

}  // namespace libchar::fusion
