#pragma once
// Cramér-Rao bounds: what a record of a given length can give at best.

#include <array>
#include <optional>

#include "libchar/core/noise_terms.hpp"

namespace libchar {

/// What a record of this length can give at best, before any fit, for assumed coefficients: relative sd per term
/// (nothing if absent).
std::array<std::optional<double>, kTerms> cramer_rao(const Mixture& theta, double rate_hz, double samples,
                                                     const TermSet& fitted);

/// Record length at which the bound of `term` is `relative_sd`, at the same rate; nothing when 10¹² s do not do.
std::optional<double> seconds_for(Term term, double relative_sd, const Mixture& theta, double rate_hz,
                                  const TermSet& fitted);

}  // namespace libchar
