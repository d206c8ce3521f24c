#include "libchar/fusion/detail/minque_batch.hpp"

#include <cmath>
#include <numeric>
#include <vector>

#include "libchar/core/dense.hpp"
#include "libchar/core/error.hpp"
#include "libchar/fusion/detail/generalized_least_squares.hpp"

namespace libchar::fusion {
namespace {

/// H may be of less than full rank.
Eigen::MatrixXd residual_projector(const Eigen::MatrixXd& h) {
  return complement_projector(column_basis(h));
}

void require_identifiable(const Eigen::MatrixXd& h) {
  if (std::string sentence = not_identifiable(h); !sentence.empty())
    throw Error({ErrorKind::numeric,
                 "E0854",
                 "",
                 std::move(sentence),
                 "",
                 "more channels, or a reference"});
}

/// Score and information of ln v at v: right side q - (1 - p) and K = (I - QQ') o (I - QQ').
struct Scoring {
  Eigen::VectorXd right;
  Eigen::MatrixXd information;
  double likelihood = 0;  // times -2, up to a constant
};

Scoring scoring(const Eigen::MatrixXd& c, const Eigen::MatrixXd& h, const Eigen::VectorXd& v) {
  const Eigen::VectorXd root = v.cwiseSqrt().cwiseInverse();
  const ThinQr qr = thin_qr(root.asDiagonal() * h);
  const Eigen::MatrixXd m = complement_projector(qr.q);
  const Eigen::MatrixXd scaled = root.asDiagonal() * c * root.asDiagonal();
  const Eigen::MatrixXd residual = projected(m, scaled);
  double log_determinant = 0;
  for (const double pivot : qr.r_diagonal) log_determinant += 2 * std::log(std::abs(pivot));
  return {residual.diagonal() - m.diagonal(),
          m.cwiseAbs2(),
          v.array().log().sum() + log_determinant + residual.trace()};
}

}  // namespace

std::string not_identifiable(const Eigen::MatrixXd& h) {
  const Eigen::Index n = h.rows();
  const Eigen::MatrixXd p = residual_projector(h);
  const Eigen::Index rank =
      static_cast<Eigen::Index>(std::lround(static_cast<double>(n) - p.trace()));
  const Eigen::Index mixtures = (n - rank) * (n - rank + 1) / 2;
  const std::string counts = std::to_string(n) + " channels of " + std::to_string(rank) +
                             (rank == 1 ? " input" : " inputs");
  if (mixtures < n)
    return "the noise variances of " + counts + " cannot be told apart: their differences give " +
           std::to_string(mixtures) + " second moments for " + std::to_string(n) + " variances";
  const SymmetricEigen eigen = symmetric_eigen(p.cwiseAbs2());
  if (eigen.values[0] > 1e-10) return "";
  const Eigen::VectorXd direction = eigen.vectors.col(0);
  std::string names;
  for (Eigen::Index i = 0; i < n; ++i)
    if (std::abs(direction[i]) > 0.1) names += (names.empty() ? "" : ", ") + std::to_string(i + 1);
  return "the noise variances of " + counts +
         " cannot be told apart: this observation matrix mixes those of channels " + names;
}

Eigen::MatrixXd residuals(const Eigen::MatrixXd& y, const Eigen::MatrixXd& h) {
  return without_columns_of(column_basis(h), y);
}

Eigen::VectorXd minque(const Eigen::MatrixXd& covariance, const Eigen::MatrixXd& h) {
  require_identifiable(h);
  const Eigen::MatrixXd p = residual_projector(h);
  return cholesky_solve(p.cwiseAbs2(), projected_diagonal(p, covariance));
}

Eigen::VectorXd minque(const Eigen::VectorXd& second_moments) {
  const double n = static_cast<double>(second_moments.size());
  return (n / (n - 2) * (second_moments.array() - second_moments.sum() / (n * (n - 1)))).matrix();
}

Eigen::VectorXd reml(const Eigen::MatrixXd& covariance, const Eigen::MatrixXd& h) {
  require_identifiable(h);
  const Eigen::MatrixXd p = residual_projector(h);
  const Eigen::MatrixXd c = projected(p, covariance);
  const Eigen::Index n = h.rows();
  Eigen::VectorXd v = Eigen::VectorXd::Constant(n, c.trace() / p.trace());
  if (!(v[0] > 0))
    throw Error({ErrorKind::numeric,
                 "E0854",
                 "",
                 "the channels do not differ: no noise to measure",
                 "",
                 ""});
  Scoring now = scoring(c, h, v);
  for (int round = 0; round < 500; ++round) {
    const Eigen::VectorXd step = ldlt_solve(now.information, now.right);
    double length = std::min(1.0, 2 / step.cwiseAbs().maxCoeff());
    Eigen::VectorXd next = v;
    Scoring there;
    for (; length > 1e-12; length /= 2) {
      next = (v.array() * (length * step.array()).exp()).matrix();
      there = scoring(c, h, next);
      if (there.likelihood <= now.likelihood + 1e-14 * std::abs(now.likelihood)) break;
    }
    const double moved = (length * step).cwiseAbs().maxCoeff();
    v = next;
    now = there;
    if (moved < 1e-15 || length <= 1e-12) break;
  }
  return v;
}

}  // namespace libchar::fusion
