#pragma once
// The noise of rounding is behind the sensor's: N is without it, and whoever simulates N rounds again.

#include "libchar/fit/fit_result.hpp"
#include "libchar/fit/signs/digital.hpp"

namespace libchar::detail {

/// Takes it out of N and out of the shape of the noise before it; `fit.rounding` is what it adds to the density.
/// N becomes a limit where rounding is a tenth of N² or more, and N² not above it beyond its interval. Where N² is
/// below it, the samples were not rounded so, and nothing changes. Of skewed noise it is not taken out: the interval
/// of N reaches to N without it.
void take_out_rounding(const DigitalFaults::Rounding& rounding, NoiseFit& fit);

/// With it in N again: for consumers that do not round.
Coefficients terms_with_rounding(const NoiseFit& fit);

}  // namespace libchar::detail
