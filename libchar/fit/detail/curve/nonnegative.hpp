#pragma once
// Non-negative least squares for at most five unknowns, exactly: every subset of unknowns is tried.

#include "libchar/fit/detail/band/bin_likelihood.hpp"

namespace libchar {

/// argmin over x >= 0 of x'Gx/2 - b'x for the free unknowns, the others zero. G symmetric, positive on the free
/// diagonal. Subsets that are singular to working precision or that have a negative unknown are passed over.
Mixture nonnegative_minimum(const TermMatrix& gram, const Mixture& right, const TermSet& free);

}  // namespace libchar
