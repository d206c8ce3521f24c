#pragma once
// MINQUE with identity weights on exponentially forgotten moments, a threshold and a recovery time: algorithms 1-3 of
// [RV 4, 5] with what is wrong in them mended (docs/theory/fusion.md). Kept for comparison; `minque` is the one to use.
//
//   v = MINQUE(I) of the moments of the channels in use (minque_published.hpp)
//   w_i = (1/v_i) / sum_j 1/v_j; the simple mean of the channels in use whenever a v is not above
//   zero out when v_i > threshold_i; in again when v_i is below it and the recovery time since then
//   is over
//
// Mended: second moments about zero (a bias is not forgotten), a threshold for each channel,
// moments of differences (no mixture of two states at an exclusion), a recovery time for each
// channel (no lock on a second fault). The options take back the first two.

#include <Eigen/Core>
#include <array>
#include <vector>

#include "libchar/fusion/algorithm.hpp"

namespace libchar::fusion {

// Exponentially forgotten second moments of the differences between channels, D_ij: the input
// cancels exactly, and any subset of channels can be judged from them without a transient.
//
//   about the running mean:  D <- g (D + (1-g) delta^2), delta = d - mean,
//                            mean <- mean + (1-g) delta                       (West 1979)
//   about zero:              S <- g S + (1-g) d^2, D = S / (1 - g^k)
//   variances of a subset of m channels, MINQUE with identity weights:
//                            v_i = [sum_j D_ij - T/(m-1)] / (m-2),  T = sum_{j<k} D_jk

class PairMoments {
 public:
  PairMoments(Eigen::Index n, double gamma, bool about_zero);
  /// The samples of the m channels in `index`.
  void update(const double* y, const int* index, int m);
  /// Variances of these m > 2 channels from their differences alone, into v[index[k]].
  void variances(const int* index, int m, double* v) const;
  /// Variance of one channel beside the m > 1 of `index`.
  double variance_beside(int channel, const int* index, int m) const;

 private:
  double moment(Eigen::Index i, Eigen::Index j) const;
  void update_all(const double* y);
  void variances_of_all(double* v) const;
  double gamma_;
  bool about_zero_;
  // Symmetric; of a pair i > j: mean(i, j) of y_i - y_j, square(i, j), and count(i, j): what of 1 -
  // g^k is missing, g^k.
  Eigen::MatrixXd mean_, square_, missing_;
  mutable Eigen::VectorXd moments_;  // of one channel with those before it
};

struct MinquePublished {
  static constexpr Description description{
      .name = "minque-published",
      .title = "MINQUE as published, with its fault rule mended",
      .source = "[RV 4, 5]",
      .complexity = "O(n^2)",
      .needs = {.min_channels = 3, .max_channels = kMostPaired, .more_than_inputs = 2, .accepts_missing = true},
      .as_published = true};
  static constexpr std::array options{
      Option{"gamma", "", 0.999, 0.5, 0.9999999, "memory of the moments: 1/(1 - gamma) instants"},
      Option{"about_zero", "", 1, 0, 1, "1: second moments about zero, 0: about the running mean, as published", true},
      Option{"common_threshold", "", 0, 0, 1, "1: one threshold for all channels, as published", true},
      Option{"threshold", "", 2, 1, 1e6, "of a variance, relative to its largest value in the stretch without faults"},
      Option{"settling", "samples", -1, -1, 1e12,
             "instants at the start that set no threshold; -1: three times the memory", true},
      Option{"recovery_samples", "samples", 6000, 1, 1e12, "from exclusion to the earliest return", true}};

  MinquePublished(const Array& array, const Settings& settings);
  static double cost_ns(const Array& array, const Settings&) {
    const auto n = static_cast<double>(array.channels);
    return 10 * n + 3 * n * n;
  }
  MinquePublished(const MinquePublished&) = delete;
  MinquePublished& operator=(const MinquePublished&) = delete;
  Estimate step(const Sample& y);
  Eigen::MatrixXd weights() const { return weights_; }
  Eigen::VectorXd variances() const { return variances_; }
  const FaultLog& faults() const { return log_; }
  void remarks(Findings& warnings) const;

 private:
  void choose(const Sample& y, bool with_faulty);
  void learn_threshold();
  void judge(const Sample& y);
  double weigh();

  PairMoments moments_;
  bool common_;
  double factor_;
  std::int64_t settling_, fault_free_, recovery_, now_ = 0, plain_means_ = 0;
  std::vector<int> in_use_;
  int m_ = 0;
  std::vector<char> out_;
  std::vector<std::int64_t> out_since_;
  Eigen::VectorXd variances_, weights_, threshold_;
  FaultLog log_;
};

}  // namespace libchar::fusion
