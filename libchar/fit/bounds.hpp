#pragma once
// Cramér-Rao bounds: what a record of a given length can give at best.

#include <optional>

#include "libchar/fit/bin_likelihood.hpp"

namespace libchar {

/// Record length at which the bound of `term` is `relative_sd`, at the same rate; nothing when 1e12
/// s do not do.
std::optional<double> seconds_for(
    Term term, double relative_sd, const Mixture& theta, double rate_hz, const TermSet& fitted);

}  // namespace libchar
