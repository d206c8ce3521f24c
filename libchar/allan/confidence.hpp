#pragma once
// How well a deviation is known: equivalent degrees of freedom, covariance between averaging times,
// chi-square intervals.

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "libchar/allan/allan_covariance.hpp"
#include "libchar/allan/allan_deviation.hpp"
#include "libchar/allan/chi_square.hpp"
#include "libchar/core/noise_terms.hpp"

namespace libchar {

/// Exact equivalent degrees of freedom, 2 E[v]^2 / Var[v], of the deviation's variance at factor m
/// from `terms` terms at stride `stride`, for the discrete noise mixture (accuracy.md 3).
/// Identities: white, m=1: 2M/3; random walk, m=1: M.
double equivalent_dof(DeviationType type,
                      const Mixture& theta,
                      std::uint64_t m,
                      std::uint64_t terms,
                      std::uint64_t stride,
                      double dt_s);

/// Exact covariance of overlapping Allan variances at the points of `curve` (their m, terms,
/// stride) for the mixture; cost independent of the record length (accuracy.md 3).
Eigen::MatrixXd allan_covariance(const AllanCurve& curve, const Mixture& theta);

/// Fills edf, ci68, ci95 and reliable of every point for the fitted mixture.
void add_intervals(AllanCurve& curve, const Mixture& theta);

}  // namespace libchar
