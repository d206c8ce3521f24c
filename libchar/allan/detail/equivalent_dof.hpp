#pragma once
// Equivalent degrees of freedom of a deviation.

#include <cstdint>

#include "libchar/allan/allan_deviation.hpp"
#include "libchar/allan/detail/term_covariance.hpp"
#include "libchar/core/noise_terms.hpp"

namespace libchar {

/// Exact equivalent degrees of freedom, 2 E[v]^2 / Var[v], of the deviation's variance at factor m
/// from `terms` terms at stride `stride`, for the discrete noise mixture (docs/theory/allan.md).
/// Identities: white, m=1: 2M/3; random walk, m=1: M.
double equivalent_dof(DeviationType type,
                      const Mixture& theta,
                      std::uint64_t m,
                      std::uint64_t terms,
                      std::uint64_t stride,
                      double dt_s);

/// Share of each random term in the Allan variance at m samples; nothing where there is none.
PerTerm allan_shares(const Mixture& theta, double m, double dt_s);

}  // namespace libchar
