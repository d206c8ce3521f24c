#pragma once
// Calibration and weights from a reference x in a learning window [RV 3.6].
//
//   calibration:  y_i ~ a_i x + b_i, corrected c_i = (y_i - b_i) / a_i          [RV 3.27-3.29]
//   weights:      x ~ sum w_i c_i, with sum w = 1 (default: unbiased), or free as published
//                 (shrinks, [RV 3.30])
//
// All from one triangle of the rows [1, y_1 - x, …, y_n - x, x]: with sum w = 1, x - c_n =
// sum_{i<n} w_i (c_i - c_n) + error holds differences only, in which a large x does not eat the
// digits. No normal matrix; columns are scaled.

#include <Eigen/Core>
#include <array>
#include <string_view>
#include <utility>
#include <vector>

#include "libchar/fusion/algorithm.hpp"

namespace libchar::fusion {

// The triangle of a growing least-squares problem: rows are gathered and folded in by Householder QR, so that a
// learning set of any length takes no more room than a few squares of its width, and no normal matrix is formed.

class Triangle {
 public:
  explicit Triangle(Eigen::Index width);
  /// One row of the problem, `width` values.
  void add(const Eigen::VectorXd& row);
  /// Upper triangle of all rows so far: R with R'R = rows' rows.
  const Eigen::MatrixXd& upper();
  std::int64_t rows() const { return rows_; }

 private:
  void fold();
  Eigen::MatrixXd upper_, pending_;
  Eigen::Index filled_ = 0;
  std::int64_t rows_ = 0;
};

/// What a learning window says about channels and weights.
struct LearntWeights {
  Eigen::VectorXd gain, bias;       ///< a and b; 1 and 0 without calibration
  Eigen::VectorXd weights;          ///< of the corrected channels
  double constant = 0;              ///< x = sum w c + constant (affine form only)
  double variance = 0;              ///< of the error in the learning window
  Eigen::Index dependent = 0;       ///< channels that say nothing beyond the others
  std::vector<int> without_signal;  ///< channels whose gain cannot be told from zero: weight zero
  /// {copy, original}: one channel twice, which share one weight
  std::vector<std::pair<int, int>> copies;
};
/// What of it the reader of a result must know.
void remark_on(const LearntWeights& learnt, Findings& warnings);

struct LeastSquaresForm {
  bool calibrate = false;
  bool sum_to_one = true;
  bool constant = false;
  /// of the covariance of the errors towards its diagonal, sum w = 1 (error_weights.hpp); below zero: estimated
  double shrinkage = 0;
  bool non_negative = false;  ///< weights of at least zero that sum to one
};

/// Gathers a learning window; instants with a missing sample are left out.
class WeightLearner {
 public:
  explicit WeightLearner(Eigen::Index channels);
  void add(const Sample& y, double x);
  /// There are instants enough for `weights`.
  bool enough() const { return triangle_.rows() >= n_ + 2; }
  /// Throws Error(numeric): too few instants, or a channel that does not follow the reference.
  LearntWeights weights(const LeastSquaresForm& form);

 private:
  /// Rows of the problem: errors of the channels used, ones, the reference.
  struct Rows {
    Eigen::MatrixXd error;
    Eigen::VectorXd one, truth;
  };
  Eigen::MatrixXd calibrate(const Eigen::MatrixXd& upper, LearntWeights& learnt) const;
  Eigen::VectorXd column_lengths(const Eigen::MatrixXd& upper, const LearntWeights& learnt) const;
  std::vector<Eigen::Index> originals(const Eigen::MatrixXd& error, const Eigen::VectorXd& truth,
                                      LearntWeights& learnt) const;
  void solve(const LeastSquaresForm& form, const Rows& rows, const std::vector<Eigen::Index>& used,
             const Eigen::VectorXd& lengths, LearntWeights& learnt) const;
  void solve_regularized(const LeastSquaresForm& form, const Eigen::MatrixXd& error,
                         const std::vector<Eigen::Index>& used, const Eigen::VectorXd& lengths,
                         LearntWeights& learnt) const;
  Eigen::Index n_;
  double origin_ = 0;  // of the reference: its first value
  Triangle triangle_;
  Eigen::VectorXd row_;
};

/// x = sum w_i (y_i - b_i) / a_i + constant, missing samples handed to the others.
class LearntMean {
 public:
  void take(const LearntWeights& learnt);
  void exchange(LearntExchange& with, Eigen::Index channels);
  Estimate step(const Sample& y) const;
  const LearntWeights& learnt() const { return learnt_; }

 private:
  Estimate of_present(const Sample& y) const;
  LearntWeights learnt_;
  Eigen::VectorXd direct_;  // w_i / a_i
  double total_ = 0, constant_ = 0;
};

/// Weights of one form, learnt in the learning window and used as they are: what the algorithms below have in common.
class ReferenceWeightedMean {
 public:
  /// name: of the algorithm, in its remarks.
  ReferenceWeightedMean(const LeastSquaresForm& form, Eigen::Index channels, std::string_view name)
      : form_(form), channels_(channels), learner_(channels), name_(name) {}
  void learn(const Sample& y, const Sample& truth) { learner_.add(y, truth[0]); }
  void finish_learning() { mean_.take(learner_.weights(form_)); }
  void exchange(LearntExchange& with) { mean_.exchange(with, channels_); }
  Estimate step(const Sample& y) const { return mean_.step(y); }
  Eigen::MatrixXd weights() const { return mean_.learnt().weights; }
  void remarks(Findings& warnings) const { remark_on(mean_.learnt(), warnings); }

 private:
  LeastSquaresForm form_;
  Eigen::Index channels_;
  WeightLearner learner_;
  LearntMean mean_;
  std::string_view name_;
};

template <bool kPublished>
struct LeastSquaresOf : ReferenceWeightedMean {
  static constexpr Needs kNeeds{.min_channels = 1,
                                .max_channels = kMostPaired,
                                .learning_samples = 2,
                                .reference = true,
                                .accepts_missing = true};
  static constexpr Description description = kPublished
                                                 ? Description{.name = "least-squares-published",
                                                               .title = "Least squares as published: weights free",
                                                               .source = "[RV 3.6]",
                                                               .complexity = "O(n)",
                                                               .needs = kNeeds,
                                                               .learning_complexity = "O(n^2)",
                                                               .as_published = true}
                                                 : Description{.name = "least-squares",
                                                               .title = "Least squares, weights sum to one",
                                                               .source = "[RV 3.6]",
                                                               .complexity = "O(n)",
                                                               .needs = kNeeds,
                                                               .learning_complexity = "O(n^2)"};
  static constexpr std::array options{
      Option{"calibrate", "", 1, 0, 1, "1: gain and bias of each channel are learnt first", true},
      Option{"constant", "", 0, 0, 1, "1: the weighted sum has a constant as well (uncalibrated channels)", true}};

  LeastSquaresOf(const Array& array, const Settings& settings)
      : ReferenceWeightedMean({settings["calibrate"] != 0, !kPublished, settings["constant"] != 0}, array.channels,
                              description.name) {}
};

using LeastSquares = LeastSquaresOf<false>;
using LeastSquaresPublished = LeastSquaresOf<true>;

/// Weights that a short or drifting learning window cannot drive to extremes.
template <bool kNonNegative>
struct RegularizedLeastSquares : ReferenceWeightedMean {
  static constexpr Needs kNeeds{.min_channels = 2,
                                .max_channels = kMostPaired,
                                .learning_samples = 2,
                                .reference = true,
                                .accepts_missing = true};
  static constexpr Description description =
      kNonNegative ? Description{.name = "non-negative-least-squares",
                                 .title = "Least squares, weights at least zero that sum to one",
                                 .source = "Lawson & Hanson 1974",
                                 .complexity = "O(n)",
                                 .needs = kNeeds,
                                 .learning_complexity = "O(n^2)"}
                   : Description{.name = "shrunk-least-squares",
                                 .title = "Least squares on a shrunk covariance of the errors",
                                 .source = "Ledoit & Wolf 2004; Schaefer & Strimmer 2005",
                                 .complexity = "O(n)",
                                 .needs = kNeeds,
                                 .learning_complexity = "O(n^2)"};
  static constexpr Option kCalibrate{"calibrate", "", 1, 0, 1, "1: gain and bias of each channel are learnt first",
                                     true};
  static constexpr Option kShrinkage{
      "shrinkage", "",
      0.1,         -1,
      1,           "share of the covariance's diagonal; 0: none, below zero: estimated as for independent instants"};
  static constexpr auto options = [] {
    if constexpr (kNonNegative)
      return std::array{kCalibrate};
    else
      return std::array{kCalibrate, kShrinkage};
  }();

  RegularizedLeastSquares(const Array& array, const Settings& settings)
      : ReferenceWeightedMean(form(settings), array.channels, description.name) {}

 private:
  static LeastSquaresForm form(const Settings& settings) {
    LeastSquaresForm out{.calibrate = settings["calibrate"] != 0, .non_negative = kNonNegative};
    if constexpr (!kNonNegative) out.shrinkage = settings["shrinkage"];
    return out;
  }
};

using ShrunkLeastSquares = RegularizedLeastSquares<false>;
using NonNegativeLeastSquares = RegularizedLeastSquares<true>;

}  // namespace libchar::fusion
