#include "libchar/fit/detail/bin_likelihood.hpp"

#include <algorithm>
#include <cmath>

#include "libchar/core/dense.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/noise_terms.hpp"
#include "libchar/fit/power_bins.hpp"

namespace libchar {

BinProblem bin_problem(const std::vector<PowerBin>& bins) {
  const auto n = static_cast<Eigen::Index>(bins.size());
  BinProblem problem{Eigen::ArrayXd(n), Eigen::ArrayXd(n), {}};
  problem.unit.resize(n, static_cast<int>(kTerms));
  double largest = 0;
  for (const PowerBin& bin : bins) largest = std::max(largest, bin.energy);
  if (!(largest > 0) || !std::isfinite(largest)) {
    throw Error({ErrorKind::numeric,
                 "",
                 "",
                 "the record is constant or not finite: there is no noise to fit",
                 "",
                 ""});
  }
  for (Eigen::Index j = 0; j < n; ++j) {
    const PowerBin& bin = bins[static_cast<std::size_t>(j)];
    problem.energy[j] = std::max(bin.energy, 1e-40 * largest);  // an exact zero has no logarithm
    problem.dof[j] = bin.dof;
    for (std::size_t i = 0; i < kTerms; ++i)
      problem.unit(j, static_cast<Eigen::Index>(i)) = bin.unit[i];
  }
  return problem;
}

Eigen::ArrayXd model_of(const BinProblem& problem, const Mixture& theta) {
  Eigen::ArrayXd model = Eigen::ArrayXd::Zero(problem.size());
  for (std::size_t i = 0; i < kTerms; ++i) {
    if (theta[i] > 0) model += theta[i] * problem.unit.col(static_cast<Eigen::Index>(i));
  }
  return model;
}

double half_deviance(const BinProblem& problem, const Mixture& theta) {
  const Eigen::ArrayXd model = model_of(problem, theta);
  double sum = 0;
  for (Eigen::Index j = 0; j < problem.size(); ++j) {
    const double excess = (problem.energy[j] - model[j]) / model[j];
    sum += problem.dof[j] / 2 * (excess - std::log1p(excess));
  }
  return std::isnan(sum) ? std::numeric_limits<double>::infinity() : sum;
}

TermMatrix fisher_information(const BinProblem& problem,
                              const Mixture& theta,
                              const TermSet& terms) {
  const Eigen::ArrayXd model = model_of(problem, theta);
  const Eigen::ArrayXd weight = problem.dof / (2 * model * model);
  TermMatrix information = TermMatrix::Zero();
  for (std::size_t a = 0; a < kTerms; ++a) {
    for (std::size_t b = 0; b <= a; ++b) {
      if (!terms[a] || !terms[b]) continue;
      const auto i = static_cast<Eigen::Index>(a), j = static_cast<Eigen::Index>(b);
      information(i, j) = information(j, i) =
          (weight * problem.unit.col(i) * problem.unit.col(j)).sum();
    }
  }
  return information;
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
    for (Eigen::Index b = 0; b < n; ++b)
      block(a, b) = information(in[a], in[b]) * scale[a] * scale[b];
  }
  const Eigen::MatrixXd inverse = cholesky_inverse(block);
  TermMatrix result = TermMatrix::Zero();
  for (Eigen::Index a = 0; a < n; ++a) {
    for (Eigen::Index b = 0; b < n; ++b) result(in[a], in[b]) = inverse(a, b) * scale[a] * scale[b];
  }
  return result;
}

}  // namespace libchar
