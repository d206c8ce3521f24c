#pragma once
// Dense linear algebra of small matrices, compiled once: a decomposition of Eigen costs seconds of
// compilation wherever it is named, these functions cost none. They take and return dynamic matrices
// and use the heap, so none of them belongs into a loop over samples.

#include <Eigen/Core>
#include <optional>

namespace libchar {

/// Eigenvalues ascending, eigenvectors in the columns, of a symmetric n x n matrix.
struct SymmetricEigen {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};
SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& a);
/// Of the tridiagonal matrix with this diagonal (n values) and this subdiagonal (n - 1).
SymmetricEigen tridiagonal_eigen(const Eigen::VectorXd& diagonal, const Eigen::VectorXd& subdiagonal);

/// A = Q R of an m x n matrix, m >= n, by Householder: Q m x n, and the diagonal of R.
struct ThinQr {
  Eigen::MatrixXd q;
  Eigen::VectorXd r_diagonal;
};
ThinQr thin_qr(const Eigen::MatrixXd& a);
/// R alone, n x n, zero below the diagonal.
Eigen::MatrixXd qr_triangle(const Eigen::MatrixXd& a);
/// Orthonormal basis of the columns of A, m x rank: QR with column pivoting.
Eigen::MatrixXd column_basis(const Eigen::MatrixXd& a);

/// argmin |A x - b| for each column b by Householder QR; A of full column rank.
Eigen::MatrixXd least_squares(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);
/// argmin |A x - b| by QR of columns scaled to length one, with pivoting; columns that say nothing beyond the others
/// get zero.
struct PivotedSolution {
  Eigen::VectorXd x;
  Eigen::Index rank = 0;
};
/// A pivot of the scaled columns below `threshold` times the largest counts as zero; none given: Eigen's, n epsilon.
PivotedSolution pivoted_least_squares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b,
                                      std::optional<double> threshold = {});

/// The same, but of all x that do as well the shortest (complete orthogonal decomposition): columns
/// that say the same share what they are worth.
PivotedSolution shortest_least_squares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b, double threshold);

/// A^-1 B of a square A, by LU with partial pivoting.
Eigen::MatrixXd general_solve(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

/// L of A = L L', A symmetric; none when A is not positive definite.
std::optional<Eigen::MatrixXd> cholesky_factor(const Eigen::MatrixXd& a);
/// L^-1, whether A is positive definite or not.
Eigen::MatrixXd inverse_cholesky_factor(const Eigen::MatrixXd& a);
/// L^-1 B and L^-1 b, L lower triangular.
Eigen::MatrixXd solve_lower(const Eigen::MatrixXd& l, const Eigen::MatrixXd& b);
Eigen::VectorXd solve_lower(const Eigen::MatrixXd& l, const Eigen::VectorXd& b);
/// (L L')^-1 b, L lower triangular.
Eigen::VectorXd solve_factored(const Eigen::MatrixXd& l, const Eigen::VectorXd& b);
/// A^-1 of a symmetric positive definite A.
Eigen::MatrixXd cholesky_inverse(const Eigen::MatrixXd& a);
/// A^-1 b of a symmetric semidefinite A, by L D L' with pivoting.
Eigen::VectorXd ldlt_solve(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);

/// I - Q Q': the complement of the orthonormal columns of Q.
Eigen::MatrixXd complement_projector(const Eigen::MatrixXd& q);
/// Y - Q (Q' Y).
Eigen::MatrixXd without_columns_of(const Eigen::MatrixXd& q, const Eigen::MatrixXd& y);
/// U times the transpose of the first `rows` rows of B, U upper triangular.
Eigen::MatrixXd upper_times_transposed(const Eigen::MatrixXd& u, const Eigen::MatrixXd& b, Eigen::Index rows);

}  // namespace libchar
