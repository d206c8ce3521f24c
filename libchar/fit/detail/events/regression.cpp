// With X the columns, W = diag(1 / E c_k^2) and c the record's coefficients:
//   sizes b = (X'WX)^-1 X'Wc, covariance (X'WX)^-1;  a further column s has the score
//   s'W(c - Xb) / sqrt(s'Ws - s'WX (X'WX)^-1 X'Ws)                    (Rao 1948; Aitken 1935)

#include "libchar/fit/detail/events/regression.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libchar/core/numeric/dense.hpp"
#include "libchar/fit/detail/record/cycles.hpp"

namespace libchar {

// Orthonormal DCT-II of n points, with a = pi k / n and s = sqrt(2/n):
//   step at t0       -s sin(a t0) / (2 sin(a/2)), the mean of w + 1 steps from t0 on -s sin(a (t0 + w/2))
//                    sin(a (w+1)/2) / ((w+1) 2 sin^2(a/2))
//   r^t              s (1 - (-1)^k r^n) (1 - r) cos(a/2) / ((1 - r)^2 + 4 r sin^2(a/2)),   r = exp(-1/tau)
//   t                -s cos(a/2) / (2 sin^2(a/2)) for odd k, 0 for even k
// geometric sums of cosines; the mean of m samples of an exponential is an exponential again.

namespace {

using std::numbers::pi;

/// A step within a point is the mean of the steps beside it by its place; a line over w points is the mean of w + 1
/// steps.
void fill_step(const EventShape& shape, double n, std::vector<double>& column) {
  const double scale = -std::sqrt(2 / n) / 2, whole = std::floor(shape.at), within = shape.at - whole;
  const double steps = shape.bridged + 1, middle = whole + 0.5 * shape.bridged;
  Turning half(pi / (2 * n)), place(pi * middle / n), next(pi * (middle + 1) / n);
  Turning wide(pi * steps / (2 * n));
  for (double& value : column) {
    half.next();
    place.next();
    next.next();
    wide.next();
    const double line = shape.bridged > 0 ? wide.sine / (steps * half.sine) : 1;
    value = scale * line * ((1 - within) * place.sine + within * next.sine) / half.sine;
  }
}

void fill_warm_up(double tau, const SeriesGrid& grid, std::vector<double>& column) {
  const double n = static_cast<double>(grid.points), m = static_cast<double>(grid.per_point);
  const double below = -std::expm1(-1 / tau), r = 1 - below, end = std::exp(-n / tau);
  // The first point is a mean over m samples, the size is that of the first sample.
  const double first = below / (m * -std::expm1(-1 / (tau * m)));
  const double scale = std::sqrt(2 / n) * first * below;
  Turning half(pi / (2 * n));
  double parity = -1;
  for (double& value : column) {
    half.next();
    value = scale * (1 - parity * end) * half.cosine / (below * below + 4 * r * half.sine * half.sine);
    parity = -parity;
  }
}

void fill_ramp(const SeriesGrid& grid, std::vector<double>& column) {
  const double n = static_cast<double>(grid.points);
  const double samples = n * static_cast<double>(grid.per_point);
  const double scale = -std::sqrt(2 / n) / 2 * static_cast<double>(grid.per_point) / (samples - 1);
  Turning half(pi / (2 * n));
  bool odd = true;
  for (double& value : column) {
    half.next();
    value = odd ? scale * half.cosine / (half.sine * half.sine) : 0;
    odd = !odd;
  }
}

void fill_cycle(const EventShape& shape, std::size_t points, std::vector<double>& column) {
  const detail::SineColumns sines(detail::off_grid(shape.at), points);
  const Eigen::RowVector2d phase(std::cos(shape.tau), std::sin(shape.tau));
  Turning half(sines.half_unit);
  for (std::size_t k = 1; k <= column.size(); ++k) {
    half.next();
    column[k - 1] = sines.at(k, half.sine, half.cosine).dot(phase);
  }
}

}  // namespace

void fill_column(const EventShape& shape, const SeriesGrid& grid, std::vector<double>& column) {
  switch (shape.kind) {
    case EventKind::step:
      return fill_step(shape, static_cast<double>(grid.points), column);
    case EventKind::warm_up:
      return fill_warm_up(shape.tau, grid, column);
    case EventKind::ramp:
      return fill_ramp(grid, column);
    case EventKind::cycle:
      return fill_cycle(shape, grid.points, column);
  }
}

double weighted_product(std::span<const double> weight, std::span<const double> x, std::span<const double> y) {
  double lanes[4] = {};
  std::size_t k = 0;
  for (; k + 4 <= x.size(); k += 4)
    for (std::size_t lane = 0; lane < 4; ++lane) lanes[lane] += weight[k + lane] * x[k + lane] * y[k + lane];
  for (; k < x.size(); ++k) lanes[0] += weight[k] * x[k] * y[k];
  return (lanes[0] + lanes[2]) + (lanes[1] + lanes[3]);
}

Regression regress(std::vector<EventShape> shapes, const SeriesGrid& grid, std::span<const double> coefficients,
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
      normal(i, j) = normal(j, i) = weighted_product(weight, x, fit.column[static_cast<std::size_t>(j)]);
  }
  // Columns in units of their own sizes: a ramp beside a step loses no digits.
  const Eigen::VectorXd scale = normal.diagonal().array().rsqrt();
  const Eigen::MatrixXd inverse = cholesky_inverse(scale.asDiagonal() * normal * scale.asDiagonal());
  fit.covariance = scale.asDiagonal() * inverse * scale.asDiagonal();
  fit.size = fit.covariance * right;
  for (Eigen::Index i = 0; i < count; ++i) {
    const std::vector<double>& x = fit.column[static_cast<std::size_t>(i)];
    for (std::size_t k = 0; k < x.size(); ++k) fit.rest[k] -= fit.size(i) * x[k];
  }
  return fit;
}

std::vector<double> leverage_of(const std::vector<std::vector<double>>& columns, const Eigen::MatrixXd& covariance,
                                std::span<const double> weight) {
  std::vector<double> leverage(weight.size());
  Eigen::VectorXd row(covariance.rows());
  for (std::size_t k = 0; k < leverage.size(); ++k) {
    for (Eigen::Index i = 0; i < row.size(); ++i) row(i) = columns[static_cast<std::size_t>(i)][k];
    leverage[k] = std::clamp(row.dot(covariance * row) * weight[k], 0.0, 1.0);
  }
  return leverage;
}

Score score_of(const Regression& beside, std::span<const double> column, std::span<const double> weight) {
  Score score{weighted_product(weight, column, beside.rest), weighted_product(weight, column, column)};
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
