#pragma once
// Equivalent degrees of freedom of a deviation.

#include <array>
#include <cstddef>
#include <cstdint>

#include "libchar/allan/allan_deviation.hpp"
#include "libchar/core/noise_terms.hpp"

namespace libchar {

// Covariance of two terms (second or third differences) of a deviation, for each noise of unit coefficient.

inline constexpr std::size_t kRandomTerms = 4;  ///< white, flicker, walk, quantization; the ramp is deterministic

/// One value per random term, by the index of Term.
using PerTerm = std::array<double, kRandomTerms>;

/// Covariance of d1 = (second difference of x at step m1)/m1 and d2 likewise with m2, their centres `lag` samples
/// apart: delta2_m1 delta2_m2 s(lag) / (m1 m2), evaluated without cancellation between very different steps and far
/// away. Flicker takes nearly all of the time: `with_flicker` false leaves it at 0.
PerTerm allan_term_covariance(double m1, double m2, double lag, double dt_s, bool with_flicker = true);

/// Exact equivalent degrees of freedom, 2 E[v]^2 / Var[v], of the deviation's variance at factor m
/// from `terms` terms at stride `stride`, for the discrete noise mixture (docs/theory/allan.md).
/// Identities: white, m=1: 2M/3; random walk, m=1: M.
double equivalent_dof(DeviationType type, const Mixture& theta, std::uint64_t m, std::uint64_t terms,
                      std::uint64_t stride, double dt_s);

/// Share of each random term in the Allan variance at m samples; nothing where there is none.
PerTerm allan_shares(const Mixture& theta, double m, double dt_s);

}  // namespace libchar
