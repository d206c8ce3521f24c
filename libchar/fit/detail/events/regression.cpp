// With X the columns, W = diag(1 / E c_k^2) and c the record's coefficients:
//   sizes b = (X'WX)^-1 X'Wc, covariance (X'WX)^-1;  a further column s has the score
//   s'W(c - Xb) / sqrt(s'Ws - s'WX (X'WX)^-1 X'Ws)                    (Rao 1948; Aitken 1935)
#include "libchar/fit/detail/events/regression.hpp"

#include <cmath>

#include "libchar/core/numeric/dense.hpp"

namespace libchar {

double weighted_product(std::span<const double> weight,
                        std::span<const double> x,
                        std::span<const double> y) {
  double lanes[4] = {};
  std::size_t k = 0;
  for (; k + 4 <= x.size(); k += 4)
    for (std::size_t lane = 0; lane < 4; ++lane)
      lanes[lane] += weight[k + lane] * x[k + lane] * y[k + lane];
  for (; k < x.size(); ++k) lanes[0] += weight[k] * x[k] * y[k];
  return (lanes[0] + lanes[2]) + (lanes[1] + lanes[3]);
}

Regression regress(std::vector<EventShape> shapes,
                   const SeriesGrid& grid,
                   std::span<const double> coefficients,
                   std::span<const double> weight) {
  Regression fit;
  fit.shape = std::move(shapes);
  fit.rest.assign(coefficients.begin(), coefficients.end());
  const auto count = static_cast<Eigen::Index>(fit.shape.size());
  if (count == 0) return fit;
  for (const EventShape& shape : fit.shape) {
    fit.column.emplace_back(coefficients.size());
    fill_column(shape, grid, fit.column.back());
  }
  Eigen::MatrixXd normal(count, count);
  Eigen::VectorXd right(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const std::vector<double>& x = fit.column[static_cast<std::size_t>(i)];
    right(i) = weighted_product(weight, x, coefficients);
    for (Eigen::Index j = 0; j <= i; ++j)
      normal(i, j) = normal(j, i) =
          weighted_product(weight, x, fit.column[static_cast<std::size_t>(j)]);
  }
  // Columns in units of their own sizes: a ramp beside a step loses no digits.
  const Eigen::VectorXd scale = normal.diagonal().array().rsqrt();
  const Eigen::MatrixXd inverse =
      cholesky_inverse(scale.asDiagonal() * normal * scale.asDiagonal());
  fit.covariance = scale.asDiagonal() * inverse * scale.asDiagonal();
  fit.size = fit.covariance * right;
  for (Eigen::Index i = 0; i < count; ++i) {
    const std::vector<double>& x = fit.column[static_cast<std::size_t>(i)];
    for (std::size_t k = 0; k < x.size(); ++k) fit.rest[k] -= fit.size(i) * x[k];
  }
  return fit;
}

Score score_of(const Regression& beside,
               std::span<const double> column,
               std::span<const double> weight) {
  Score score{weighted_product(weight, column, beside.rest),
              weighted_product(weight, column, column)};
  const auto count = static_cast<Eigen::Index>(beside.shape.size());
  if (count == 0) return score;
  Eigen::VectorXd cross(count);
  for (Eigen::Index i = 0; i < count; ++i)
    cross(i) = weighted_product(weight, column, beside.column[static_cast<std::size_t>(i)]);
  const double alone = score.information;
  score.information -= cross.dot(beside.covariance * cross);
  // What the others explain but for a thousandth is nothing new.
  if (score.information < 1e-3 * alone) score = {};
  return score;
}

}  // namespace libchar
