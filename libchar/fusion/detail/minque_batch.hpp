#pragma once
// Noise variances of n channels from the covariance of a whole record, without a reference (Rao
// 1970, 1971; Patterson & Thompson 1971). P = I - H (H'H)^-1 H' takes out whatever the inputs do,
// so C may be the covariance of the samples or of P y.

#include <Eigen/Core>
#include <string>

namespace libchar::fusion {

/// P y, instant by instant (columns). Inputs much larger than the noise must leave before squares
/// are summed: the covariance of y instead of P y costs the digits of (input / noise)^2.
Eigen::MatrixXd residuals(const Eigen::MatrixXd& y, const Eigen::MatrixXd& h);

/// MINQUE with identity weights: (P o P) v = diag(P C P'). May be negative. Throws Error(numeric)
/// when H does not allow it.
Eigen::VectorXd minque(const Eigen::MatrixXd& covariance, const Eigen::MatrixXd& h);

/// For H = 1 without a matrix: v_i = n/(n-2) [s_i - sum s / (n (n-1))], s_i the second moment of
/// y_i - mean(y). n > 2.
Eigen::VectorXd minque(const Eigen::VectorXd& second_moments);

/// Restricted maximum likelihood: maximises -1/2 [sum ln v + ln det(H' R^-1 H) + tr(M C)],
/// positive, efficient. By scoring in ln v with step halving. Throws Error(numeric) when H does not
/// allow it.
Eigen::VectorXd reml(const Eigen::MatrixXd& covariance, const Eigen::MatrixXd& h);

/// Empty: the differences between the channels determine every variance (P o P is regular). Else
/// the sentence that says why not. Necessary is (n-r)(n-r+1)/2 >= n.
std::string not_identifiable(const Eigen::MatrixXd& h);

}  // namespace libchar::fusion
