#include "libchar/fit/detail/band/bin_likelihood.hpp"

#include <algorithm>
#include <cmath>

#include "libchar/core/noise_terms.hpp"
#include "libchar/core/numeric/dense.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/fit/record/power_bins.hpp"

namespace libchar {
namespace {

/// Mean of f² over a bin.
double bin_square_hz(const PowerBin& bin) {
  return (bin.low_hz * bin.low_hz + bin.low_hz * bin.high_hz + bin.high_hz * bin.high_hz) / 3;
}

}  // namespace

BinProblem bin_problem(const std::vector<PowerBin>& bins) {
  const auto n = static_cast<Eigen::Index>(bins.size());
  BinProblem problem;
  problem.energy.resize(n);
  problem.dof.resize(n);
  problem.unit.resize(n, static_cast<int>(kTerms));
  if (bins.empty()) throw numeric_error("E0401").says("the record is too short: no frequency is left to be fitted");
  double largest = 0;
  for (const PowerBin& bin : bins) largest = std::max(largest, bin.energy);
  constexpr double kLargestPower = 1e140,
                   kSmallestPower = 1e-140;  // so are their products and profiles
  if (largest > 0 && !(largest > kSmallestPower && largest < kLargestPower))
    throw numeric_error("E0420")
        .says("the squares of the samples do not fit into a double (deviations from 1e-70 to 1e70 do)")
        .hint("give them in another unit");
  if (!(largest > 0)) {
    throw numeric_error("E0412").says(
        "the record is constant, or its squares are too small for a double: there is no noise to fit");
  }
  for (Eigen::Index j = 0; j < n; ++j) {
    const PowerBin& bin = bins[static_cast<std::size_t>(j)];
    problem.energy[j] = std::max(bin.energy, 1e-40 * largest);  // an exact zero has no logarithm
    problem.dof[j] = bin.dof;
    for (std::size_t i = 0; i < kTerms; ++i) problem.unit(j, static_cast<Eigen::Index>(i)) = bin.unit[i];
  }
  return problem;
}

BinProblem bin_problem(const std::vector<PowerBin>& bins, int orders, double band_hz) {
  BinProblem problem = bin_problem(bins);
  if (orders == 0) return problem;
  const Eigen::ArrayXd root = (problem.dof / 2).sqrt();
  Eigen::MatrixXd powers(problem.size(), orders);
  for (Eigen::Index j = 0; j < problem.size(); ++j) {
    const PowerBin& bin = bins[static_cast<std::size_t>(j)];
    const double x = bin_square_hz(bin) / (band_hz * band_hz);
    // Legendre polynomials of 2x - 1, less their value at x = 0, span the same as the powers and stay apart.
    double before = 1, at = 2 * x - 1;
    for (int p = 1; p <= orders; ++p) {
      powers(j, p - 1) = root[j] * (at - (p % 2 == 0 ? 1 : -1));
      const double next = ((2 * p + 1) * (2 * x - 1) * at - p * before) / (p + 1);
      before = at;
      at = next;
    }
  }
  problem.shape = thin_qr(powers).q.array().colwise() / root;
  return problem;
}

Eigen::MatrixXd whitened_shape(const BinProblem& problem) {
  return (problem.shape.colwise() * (problem.dof / 2).sqrt()).matrix();
}

Eigen::ArrayXd shape_of(const BinProblem& problem, const ShapeCoefficients& shape) {
  Eigen::ArrayXd log_gain = Eigen::ArrayXd::Zero(problem.size());
  for (Eigen::Index p = 0; p < problem.shapes(); ++p)
    log_gain += shape[static_cast<std::size_t>(p)] * problem.shape.col(p);
  return log_gain.exp();
}

Eigen::ArrayXd mixture_of(const BinProblem& problem, const Mixture& theta) {
  Eigen::ArrayXd model = Eigen::ArrayXd::Zero(problem.size());
  for (std::size_t i = 0; i < kTerms; ++i) {
    if (theta[i] > 0) model += theta[i] * problem.unit.col(static_cast<Eigen::Index>(i));
  }
  return model;
}

Eigen::ArrayXd model_of(const BinProblem& problem, const ModelPoint& at) {
  if (problem.shapes() == 0) return mixture_of(problem, at.theta);
  return mixture_of(problem, at.theta) * shape_of(problem, at.shape);
}

double half_deviance(const BinProblem& problem, const ModelPoint& at) {
  const Eigen::ArrayXd model = model_of(problem, at);
  double sum = 0;
  for (Eigen::Index j = 0; j < problem.size(); ++j) {
    const double excess = (problem.energy[j] - model[j]) / model[j];
    sum += problem.dof[j] / 2 * (excess - std::log1p(excess));
  }
  return std::isnan(sum) ? std::numeric_limits<double>::infinity() : sum;
}

TermMatrix fisher_information(const BinProblem& problem, const ModelPoint& at, const TermSet& terms) {
  const Eigen::ArrayXd mixture = mixture_of(problem, at.theta);
  const Eigen::ArrayXd weight = problem.dof / (2 * mixture * mixture);
  TermMatrix information = TermMatrix::Zero();
  for (std::size_t a = 0; a < kTerms; ++a) {
    for (std::size_t b = 0; b <= a; ++b) {
      if (!terms[a] || !terms[b]) continue;
      const auto i = static_cast<Eigen::Index>(a), j = static_cast<Eigen::Index>(b);
      information(i, j) = information(j, i) = (weight * problem.unit.col(i) * problem.unit.col(j)).sum();
    }
  }
  if (problem.shapes() == 0) return information;
  // ln mu = ln(A theta) + S a: a relative column of a term beside the columns of the shape, each with weight nu/2.
  const Eigen::ArrayXd root = (problem.dof / 2).sqrt();
  Eigen::MatrixXd relative = Eigen::MatrixXd::Zero(problem.size(), static_cast<int>(kTerms));
  for (std::size_t a = 0; a < kTerms; ++a) {
    const auto i = static_cast<Eigen::Index>(a);
    if (terms[a]) relative.col(i) = (root * problem.unit.col(i) / mixture).matrix();
  }
  const Eigen::MatrixXd apart = without_columns_of(whitened_shape(problem), relative);
  return apart.transpose() * apart;
}

TermMatrix inverse_of(const TermMatrix& information, const TermSet& terms) {
  std::vector<Eigen::Index> in;
  for (std::size_t i = 0; i < kTerms; ++i) {
    if (terms[i]) in.push_back(static_cast<Eigen::Index>(i));
  }
  const auto n = static_cast<Eigen::Index>(in.size());
  Eigen::MatrixXd block(n, n);
  Eigen::VectorXd scale(n);
  for (Eigen::Index a = 0; a < n; ++a) scale[a] = 1 / std::sqrt(information(in[a], in[a]));
  for (Eigen::Index a = 0; a < n; ++a) {
    for (Eigen::Index b = 0; b < n; ++b) block(a, b) = information(in[a], in[b]) * scale[a] * scale[b];
  }
  const Eigen::MatrixXd inverse = cholesky_inverse(block);
  TermMatrix result = TermMatrix::Zero();
  for (Eigen::Index a = 0; a < n; ++a) {
    for (Eigen::Index b = 0; b < n; ++b) result(in[a], in[b]) = inverse(a, b) * scale[a] * scale[b];
  }
  return result;
}

}  // namespace libchar
