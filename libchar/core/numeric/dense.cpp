#include "libchar/core/numeric/dense.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <cmath>

namespace libchar {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

SymmetricEigen symmetric_eigen(const MatrixXd& a) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(a);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

SymmetricEigen tridiagonal_eigen(const VectorXd& diagonal, const VectorXd& subdiagonal) {
  Eigen::SelfAdjointEigenSolver<MatrixXd> solver;
  solver.computeFromTridiagonal(diagonal, subdiagonal);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

ThinQr thin_qr(const MatrixXd& a) {
  const Eigen::HouseholderQR<MatrixXd> qr(a);
  return {qr.householderQ() * MatrixXd::Identity(a.rows(), a.cols()), qr.matrixQR().diagonal()};
}

MatrixXd qr_triangle(const MatrixXd& a) {
  const Eigen::HouseholderQR<MatrixXd> qr(a);
  return qr.matrixQR().topRows(a.cols()).triangularView<Eigen::Upper>();
}

MatrixXd column_basis(const MatrixXd& a) {
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(a);
  return qr.householderQ() * MatrixXd::Identity(a.rows(), qr.rank());
}

MatrixXd least_squares(const MatrixXd& a, const MatrixXd& b) {
  const Eigen::HouseholderQR<MatrixXd> qr(a);
  MatrixXd x(a.cols(), b.cols());
  for (Index j = 0; j < b.cols(); ++j) x.col(j) = qr.solve(VectorXd(b.col(j)));
  return x;
}

PivotedSolution pivoted_least_squares(const MatrixXd& a, const VectorXd& b, std::optional<double> threshold) {
  // Columns of length one: what counts as nothing beyond the others must not depend on units.
  VectorXd scale = a.colwise().norm().cwiseInverse();
  for (double& s : scale)
    if (!std::isfinite(s)) s = 1;
  Eigen::ColPivHouseholderQR<MatrixXd> qr(a * scale.asDiagonal());
  if (threshold) qr.setThreshold(*threshold);
  // By hand: Eigen's solve() goes by pivots that are not exactly zero, and what rounding leaves of a column twice is
  // none of these.
  const Eigen::Index rank = qr.rank();
  const VectorXd rotated = qr.householderQ().setLength(rank).adjoint() * b;
  const VectorXd solved =
      qr.matrixQR().topLeftCorner(rank, rank).triangularView<Eigen::Upper>().solve(rotated.head(rank));
  VectorXd x = VectorXd::Zero(a.cols());
  for (Eigen::Index i = 0; i < rank; ++i) {
    const Eigen::Index column = qr.colsPermutation().indices()[i];
    x[column] = scale[column] * solved[i];
  }
  return {x, rank};
}

PivotedSolution shortest_least_squares(const MatrixXd& a, const VectorXd& b, double threshold) {
  Eigen::CompleteOrthogonalDecomposition<MatrixXd> cod;
  cod.setThreshold(threshold);
  cod.compute(a);
  if (cod.rank() == 0) return {VectorXd::Zero(a.cols()), 0};
  return {cod.solve(b), cod.rank()};
}

MatrixXd general_solve(const MatrixXd& a, const MatrixXd& b) { return Eigen::PartialPivLU<MatrixXd>(a).solve(b); }

std::optional<MatrixXd> cholesky_factor(const MatrixXd& a) {
  const Eigen::LLT<MatrixXd> llt(a);
  if (llt.info() != Eigen::Success) return std::nullopt;
  return MatrixXd(llt.matrixL());
}

MatrixXd inverse_cholesky_factor(const MatrixXd& a) {
  const Eigen::LLT<MatrixXd> llt(a);
  return llt.matrixL().solve(MatrixXd::Identity(a.rows(), a.rows()));
}

MatrixXd solve_lower(const MatrixXd& l, const MatrixXd& b) { return l.triangularView<Eigen::Lower>().solve(b); }

VectorXd solve_lower(const MatrixXd& l, const VectorXd& b) { return l.triangularView<Eigen::Lower>().solve(b); }

VectorXd solve_factored(const MatrixXd& l, const VectorXd& b) {
  return l.transpose().triangularView<Eigen::Upper>().solve(solve_lower(l, b));
}

MatrixXd cholesky_inverse(const MatrixXd& a) { return a.llt().solve(MatrixXd::Identity(a.rows(), a.rows())); }

VectorXd ldlt_solve(const MatrixXd& a, const VectorXd& b) { return a.ldlt().solve(b); }

MatrixXd complement_projector(const MatrixXd& q) { return MatrixXd::Identity(q.rows(), q.rows()) - q * q.transpose(); }

MatrixXd without_columns_of(const MatrixXd& q, const MatrixXd& y) { return y - q * (q.transpose() * y); }

MatrixXd upper_times_transposed(const MatrixXd& u, const MatrixXd& b, Index rows) {
  return u.triangularView<Eigen::Upper>() * b.topRows(rows).transpose();
}

}  // namespace libchar
