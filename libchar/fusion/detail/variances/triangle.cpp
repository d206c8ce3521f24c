#include "libchar/fusion/detail/variances/triangle.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libchar/core/numeric/dense.hpp"

namespace libchar::fusion {

Triangle::Triangle(Eigen::Index width)
    : upper_(Eigen::MatrixXd::Zero(width, width)), pending_(3 * width + 8, width) {}

void Triangle::add(const Eigen::VectorXd& row) {
  pending_.row(filled_++) = row.transpose();
  ++rows_;
  if (filled_ == pending_.rows()) fold();
}

void Triangle::fold() {
  if (filled_ == 0) return;
  Eigen::MatrixXd stacked(upper_.rows() + filled_, upper_.cols());
  stacked << upper_, pending_.topRows(filled_);
  upper_ = qr_triangle(stacked);
  filled_ = 0;
}

const Eigen::MatrixXd& Triangle::upper() {
  fold();
  return upper_;
}

double rounding_of_rows(std::int64_t rows) {
  constexpr double kSteps = 32;  // tried with five columns of 2e3 to 2e5 rows
  return kSteps * std::numeric_limits<double>::epsilon() *
         std::sqrt(static_cast<double>(std::max<std::int64_t>(rows, 1)));
}

Eigen::VectorXd solve_scaled(const Eigen::MatrixXd& upper,
                             Eigen::Index unknowns,
                             double rounding,
                             Eigen::Index& dependent) {
  Eigen::VectorXd length = upper.leftCols(unknowns).colwise().norm().transpose();
  for (double& l : length)
    if (!(l > 0)) l = 1;
  const Eigen::MatrixXd a = upper.leftCols(unknowns) * length.cwiseInverse().asDiagonal();
  const PivotedSolution scaled = shortest_least_squares(a, upper.col(unknowns), rounding);
  dependent = unknowns - scaled.rank;
  return (scaled.x.array() / length.array()).matrix();
}

}  // namespace libchar::fusion
