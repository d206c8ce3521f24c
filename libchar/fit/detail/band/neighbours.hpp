#pragma once
// What the next richer shapes of a spectrum say of the coefficients.

#include <vector>

#include "libchar/fit/detail/band/band.hpp"
#include "libchar/fit/fit_result.hpp"

namespace libchar {

/// Intervals of the terms of a band with a free shape reach to where its neighbours have them; `best` is its maximum.
void reach_to_neighbours(const std::vector<PowerBin>& bins, const Band& band, const ModelPoint& best,
                         const TermSet& offered, NoiseFit& fit);

}  // namespace libchar
