#pragma once
// Exponentially forgotten second moments of the differences between channels, D_ij: the input
// cancels exactly, and any subset of channels can be judged from them without a transient.
//
//   about the running mean:  D <- g (D + (1-g) delta^2), delta = d - mean,
//                            mean <- mean + (1-g) delta                       (West 1979)
//   about zero:              S <- g S + (1-g) d^2, D = S / (1 - g^k)
//   variances of a subset of m channels, MINQUE with identity weights:
//                            v_i = [sum_j D_ij - T/(m-1)] / (m-2),  T = sum_{j<k} D_jk

#include <Eigen/Core>
#include <vector>

namespace libchar::fusion {

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

}  // namespace libchar::fusion
