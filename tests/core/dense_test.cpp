// Known answers of the small dense algebra: inverses of Hilbert matrices are integers (M.-D. Choi,
// Amer. Math. Monthly 90, 1983).

#include "libchar/core/numeric/dense.hpp"

#include <catch2/catch.hpp>

using namespace libchar;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

MatrixXd hilbert(Eigen::Index n) {
  MatrixXd h(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j) h(i, j) = 1 / static_cast<double>(i + j + 1);
  return h;
}

MatrixXd inverse_of_hilbert_3() { return (MatrixXd(3, 3) << 9, -36, 30, -36, 192, -180, 30, -180, 180).finished(); }

bool close(const MatrixXd& a, const MatrixXd& b, double digits) {
  return a.rows() == b.rows() && a.cols() == b.cols() &&
         (a - b).cwiseAbs().maxCoeff() <= digits * b.cwiseAbs().maxCoeff();
}

}  // namespace

TEST_CASE("dense: solutions and inverses of the Hilbert matrix are its integers") {
  const MatrixXd h = hilbert(3), inverse = inverse_of_hilbert_3();
  const VectorXd ones = VectorXd::Ones(3), x = (VectorXd(3) << 3, -24, 30).finished();
  CHECK(close(cholesky_inverse(h), inverse, 1e-13));
  CHECK(close(ldlt_solve(h, ones), x, 1e-13));
  CHECK(close(general_solve(h, ones), x, 1e-13));
  CHECK(close(least_squares(h, ones), x, 1e-13));
  const auto factor = cholesky_factor(h);
  REQUIRE(factor.has_value());
  CHECK(close(solve_factored(*factor, ones), x, 1e-13));
  CHECK(close(inverse_cholesky_factor(h) * *factor, MatrixXd::Identity(3, 3), 1e-14));
  CHECK_FALSE(cholesky_factor(-h).has_value());
}

TEST_CASE("dense: what is left beside a column stands at right angles to it") {
  MatrixXd q(3, 1);
  q << 2.0 / 3, 2.0 / 3, 1.0 / 3;
  const MatrixXd y = hilbert(3), left = without_columns_of(q, y), p = complement_projector(q);
  CHECK((q.transpose() * left).cwiseAbs().maxCoeff() < 1e-15);
  CHECK(close(p * y, left, 1e-15));
}
