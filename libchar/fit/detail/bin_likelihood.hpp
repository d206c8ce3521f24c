#pragma once
// The likelihood of power bins: independent gamma variables whose means are linear in theta.
//   half deviance  D(theta) = sum_j nu_j/2 (u_j - 1 - ln u_j),
//                  u_j = measured_j / mu_j,  mu = A theta,  -ln L = D + const

#include <Eigen/Core>
#include <array>
#include <vector>

#include "libchar/core/noise_terms.hpp"
#include "libchar/fit/power_bins.hpp"

namespace libchar {

struct PowerBin;

using TermSet = std::array<bool, kTerms>;
using TermMatrix = Eigen::Matrix<double, kTerms, kTerms>;

struct BinProblem {
  Eigen::ArrayXd energy, dof;
  Eigen::Array<double, Eigen::Dynamic, static_cast<int>(kTerms)> unit;
  Eigen::Index size() const { return energy.size(); }
};

BinProblem bin_problem(const std::vector<PowerBin>& bins);

Eigen::ArrayXd model_of(const BinProblem& problem, const Mixture& theta);
double half_deviance(const BinProblem& problem, const Mixture& theta);

/// Expected information of theta at theta, 1/2 sum nu a a' / mu^2, for the terms of the set
/// (others: zero rows).
TermMatrix fisher_information(const BinProblem& problem,
                              const Mixture& theta,
                              const TermSet& terms);

/// Inverse of the block of `information` that belongs to `terms`, other entries zero; columns are
/// scaled first.
TermMatrix inverse_of(const TermMatrix& information, const TermSet& terms);

inline TermSet only_positive(const Mixture& theta) {
  TermSet set{};
  for (std::size_t i = 0; i < kTerms; ++i) set[i] = theta[i] > 0;
  return set;
}
inline std::size_t count_of(const TermSet& set) {
  std::size_t n = 0;
  for (const bool in : set) n += in ? 1 : 0;
  return n;
}

}  // namespace libchar
