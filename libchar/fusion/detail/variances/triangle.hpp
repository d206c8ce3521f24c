#pragma once
// The triangle of a growing least-squares problem: rows are gathered and folded in by Householder
// QR, so that a learning set of any length takes no more room than a few squares of its width, and
// no normal matrix is formed.

#include <Eigen/Core>

namespace libchar::fusion {

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

/// Rounding of a column of a triangle of so many rows, relative to the column's length: errors of
/// the folds add up as steps of a random walk do.
double rounding_of_rows(std::int64_t rows);

/// argmin |A w - b| from the triangle of rows [A b]: columns scaled to length one, then QR with
/// pivoting; the shortest w where several do as well. Columns count as dependent when less than
/// `rounding` of them is left beside the others; `dependent` receives their number.
Eigen::VectorXd solve_scaled(const Eigen::MatrixXd& upper,
                             Eigen::Index unknowns,
                             double rounding,
                             Eigen::Index& dependent);

}  // namespace libchar::fusion
