#pragma once
// The weighted mean where channels see several inputs, or one with different gains: generalized
// least squares with variances that stay [RV 4.22, corrected: A = H]. Channels whose sample is
// missing are left out; the factors stand while the same channels are present.

#include <Eigen/Core>
#include <vector>

#include "libchar/fusion/algorithm.hpp"

namespace libchar::fusion {

// X = (H' R^-1 H)^-1 H' R^-1 y with R = diag(v), by orthogonalising R^-1/2 H = Q U: X = U^-1 Q'
// R^-1/2 y [Aitken 1936]. The normal matrix is never formed; the factors stand until variances or
// channels change. No trip to the heap after construction.

class GeneralizedLeastSquares {
 public:
  explicit GeneralizedLeastSquares(const Eigen::MatrixXd& h);

  /// Takes the m channels named in `index` with these noise variances (of all n). False: they do
  /// not determine every input.
  bool factor(const double* variances, const int* index, int m);
  /// Inputs x (r values) from the samples of those channels, and the residuals y - H x into
  /// `residual` (n values, theirs only).
  void solve(const double* y, double* x, double* residual) const;

  Eigen::Index inputs() const { return h_.cols(); }
  const Eigen::MatrixXd& h() const { return h_; }
  /// Orthonormal basis of the column space of R^-1/2 H; row k is channel index[k].
  const Eigen::MatrixXd& q() const { return q_; }
  /// Share of channel index[k] in its own fitted value, p_k = sum_j q_kj^2.
  double leverage(int k) const;
  /// Variance of input j.
  double variance(Eigen::Index j) const { return inverse_.row(j).squaredNorm(); }
  /// Of what the inputs say that channel i reads: h_i (H' R^-1 H)^-1 h_i'.
  double predicted_variance(Eigen::Index i) const;
  /// X = gain * y: r x m, columns in the order of `index`.
  Eigen::MatrixXd gain() const;
  int channels() const { return m_; }

 private:
  Eigen::MatrixXd h_, q_, upper_, inverse_;  // inverse_ of U
  Eigen::VectorXd root_;                     // 1 / sqrt(v), by position
  const int* index_ = nullptr;
  int m_ = 0;
};

class GeneralMean {
 public:
  /// n rows of r inputs; a noise variance for each channel (all equal: ordinary least squares).
  GeneralMean(const Eigen::MatrixXd& h, const Eigen::VectorXd& variances);
  GeneralMean(const GeneralMean&) = delete;
  GeneralMean& operator=(const GeneralMean&) = delete;
  Estimate step(const Sample& y);
  /// n x r; zero for the channels that were missing in the last step.
  Eigen::MatrixXd weights() const;

 private:
  bool take_present(const Sample& y);

  GeneralizedLeastSquares gls_;
  Eigen::VectorXd variances_, residual_;
  std::vector<int> present_, before_;
  bool determined_ = false;
};

}  // namespace libchar::fusion
