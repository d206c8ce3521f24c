#pragma once
// Recursive re-weighted MINQUE for any observation matrix H (n x r): the method of reweighted_variances.hpp with
//
//   R^-1/2 H = Q U,  M = I - Q Q',  q_i = r_i^2 / v_i,  (M o M + lambda I) u = mean(q) - diag(M),
//   v_i <- v_i (1 + a u_i)
//
// Residuals are gathered over n instants for each solution of the n x n system, so that an instant costs O(n r + n^2).
// Factors stand until the variances change or another set of channels is in use.

#include <Eigen/Core>
#include <vector>

#include "libchar/fusion/algorithm.hpp"
#include "libchar/fusion/detail/variances/generalized_least_squares.hpp"
#include "libchar/fusion/detail/variances/reweighted_variances.hpp"

namespace libchar::fusion {

class ReweightedMatrix {
 public:
  ReweightedMatrix(const Eigen::MatrixXd& h, const ReweightingOptions& options);

  /// As ReweightedVariances: any one of the inputs, NaN when these channels do not determine them all.
  double fuse(const double* y, const int* index, int m);
  void update();
  Estimate estimate() const;
  /// As ReweightedVariances.
  void restart(double instants);
  void assume(std::size_t i, double variance);

  std::size_t size() const { return v_.size(); }
  double variance(std::size_t i) const { return v_[i]; }
  const double* residuals() const { return r_.data(); }
  const double* residual_variances() const { return residual_variance_.data(); }
  /// Of a channel that was not in use: sample less what the others say, and its variance.
  double innovation(std::size_t i, double sample) const;
  double innovation_variance(std::size_t i) const;
  double rounding() const { return rounding_; }
  bool started() const { return started_; }
  const std::vector<double>& variances() const { return v_; }
  /// n x r, zero for channels that are not in use.
  Eigen::MatrixXd weights() const;

 private:
  bool factor(const int* index, int m);
  void start();
  void improve();
  void solve_information(double lambda);
  void apply(double a);

  ReweightingOptions options_;
  GeneralizedLeastSquares gls_;
  std::vector<double> v_, residual_variance_;
  Eigen::VectorXd r_, right_, squares_;  // squares_: gathered, by position in index_
  Eigen::MatrixXd information_;
  State x_;
  std::vector<int> index_;  // of the factors
  int m_ = 0;
  bool factored_ = false, determined_ = false, started_ = false;
  double gathered_ = 0, instants_ = 0, rounding_ = 0;
};

}  // namespace libchar::fusion
