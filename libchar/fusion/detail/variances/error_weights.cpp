#include "libchar/fusion/detail/variances/error_weights.hpp"

#include <algorithm>
#include <cmath>

#include "libchar/core/numeric/dense.hpp"

namespace libchar::fusion {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kFloat = 0x1p-23;      // of a sample: what a copy as float32 loses
constexpr double kNoDifference = 1e-3;  // of an error: no weight could use it

/// Correlations of the errors about zero; a column of zeros has none with others.
MatrixXd correlations(const MatrixXd& error, VectorXd& length) {
  length = error.colwise().norm().transpose();
  MatrixXd unit = error;
  for (Index i = 0; i < unit.cols(); ++i)
    if (length[i] > 0) unit.col(i) /= length[i];
  return unit.transpose() * unit;
}

/// Solves S_PP v_P = b_P for the channels of P; zero elsewhere.
VectorXd solve_on(const MatrixXd& s, const VectorXd& b, const std::vector<Index>& p) {
  const MatrixXd part = s(p, p);
  const VectorXd right = b(p);
  VectorXd v = VectorXd::Zero(b.size());
  v(p) = ldlt_solve(part, right);
  return v;
}

}  // namespace

std::vector<std::pair<int, int>> copies_of(const MatrixXd& error, const MatrixXd& channel, double rounding) {
  std::vector<std::pair<int, int>> out;
  std::vector<bool> copy(static_cast<std::size_t>(error.cols()), false);
  for (Index j = 1; j < error.cols(); ++j)
    for (Index i = 0; i < j; ++i) {
      if (copy[static_cast<std::size_t>(i)]) continue;
      const double off = (error.col(i) - error.col(j)).norm();
      const double as_float = kFloat * std::min(channel.col(i).norm(), channel.col(j).norm());
      const double immaterial = kNoDifference * std::min(error.col(i).norm(), error.col(j).norm());
      const double rounded = rounding * (error.col(i).norm() + error.col(j).norm());
      if (!(off <= std::max(rounded, std::min(as_float, immaterial)))) continue;
      copy[static_cast<std::size_t>(j)] = true;
      out.emplace_back(static_cast<int>(j), static_cast<int>(i));
      break;
    }
  return out;
}

double estimated_shrinkage(const MatrixXd& error, std::int64_t rows) {
  VectorXd length;
  const MatrixXd c = correlations(error, length);
  double off = 0, spread = 0;
  for (Index i = 0; i < c.rows(); ++i)
    for (Index j = 0; j < i; ++j) {
      const double square = c(i, j) * c(i, j);
      off += square;
      // Gaussian: var(c) = (1 - c^2)^2 / N.
      spread += (1 - square) * (1 - square) / static_cast<double>(std::max<std::int64_t>(rows, 1));
    }
  return off > 0 ? std::min(1.0, spread / off) : 1;
}

MatrixXd shrunk(const MatrixXd& error, double share) {
  MatrixXd out = MatrixXd::Zero(error.rows() + error.cols(), error.cols());
  out.topRows(error.rows()) = std::sqrt(1 - share) * error;
  for (Index i = 0; i < error.cols(); ++i) out(error.rows() + i, i) = std::sqrt(share) * error.col(i).norm();
  return out;
}

VectorXd non_negative_weights(const MatrixXd& error) {
  const Index n = error.cols();
  VectorXd length;
  const MatrixXd s = correlations(error, length);
  const double least = length.minCoeff(), most = length.maxCoeff();
  // Without an error there is nothing to weigh: those that have none share alike.
  if (!(least > 1e-150 * most))
    return (length.array() <= 1e-150 * most).cast<double>() /
           static_cast<double>((length.array() <= 1e-150 * most).count());
  // In units of each channel's error: u = v |e|, min u'S u / 2 - b'u with b = least / |e|.
  const VectorXd b = (least / length.array()).matrix();
  VectorXd u = VectorXd::Zero(n);
  std::vector<Index> free;
  for (Index round = 0; round < 3 * n + 3; ++round) {
    const VectorXd slope = b - s * u;
    Index best = -1;
    for (Index i = 0; i < n; ++i)
      if (std::find(free.begin(), free.end(), i) == free.end() && slope[i] > 1e-12 * b[i] &&
          (best < 0 || slope[i] / b[i] > slope[best] / b[best]))
        best = i;
    if (best < 0) break;
    free.push_back(best);
    for (;;) {
      const VectorXd to = solve_on(s, b, free);
      double step = 1;
      for (const Index i : free)
        if (!(to[i] > 0)) step = std::min(step, u[i] / (u[i] - to[i]));
      if (step >= 1) {
        u = to;
        break;
      }
      u += step * (to - u);
      std::erase_if(free, [&](Index i) { return !(u[i] > 1e-14 * u.maxCoeff()); });
      for (Index i = 0; i < n; ++i)
        if (std::find(free.begin(), free.end(), i) == free.end()) u[i] = 0;
      if (free.empty()) break;
    }
  }
  const VectorXd w = u.cwiseProduct(b);
  return w / w.sum();
}

}  // namespace libchar::fusion
