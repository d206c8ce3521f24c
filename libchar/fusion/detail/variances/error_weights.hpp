#pragma once
// What least squares does with the errors of corrected channels, e_i = c_i - x, before and beside the free solution:
//   copies      channels that are one channel twice share one weight
//   shrinkage   S <- (1 - s) S + s diag(S), S = E'E, as rows of the problem: |sqrt(1 - s) E w|^2 +
//               s sum |e_i|^2 w_i^2                                  (Schaefer & Strimmer 2005, target D)
//   w >= 0      min w'S w, sum w = 1, w >= 0: with v = w / (w'S w) it is min v'S v / 2 - sum v, v >= 0,
//               solved by the active set of Lawson & Hanson (1974)

#include <Eigen/Core>
#include <utility>
#include <vector>

namespace libchar::fusion {

/// Channels that follow an earlier one to the precision of a float (or of the triangle), by less
/// than a thousandth of either's error: {copy, original}. `error` and `channel` hold a column a channel.
std::vector<std::pair<int, int>> copies_of(const Eigen::MatrixXd& error, const Eigen::MatrixXd& channel,
                                           double rounding);

/// Shrinkage that makes the expected loss least for independent Gaussian errors of `rows` instants:
/// sum var(s_ij) / sum s_ij^2 over i != j of the correlations, at most one.
double estimated_shrinkage(const Eigen::MatrixXd& error, std::int64_t rows);

/// The rows of the shrunk problem: those of `error`, then one a channel.
Eigen::MatrixXd shrunk(const Eigen::MatrixXd& error, double share);

/// argmin |E w|, sum w = 1, w >= 0. Equal weights where every column is zero.
Eigen::VectorXd non_negative_weights(const Eigen::MatrixXd& error);

}  // namespace libchar::fusion
