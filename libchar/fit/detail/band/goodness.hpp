#pragma once
// Does the fitted model describe the bins within their statistical scatter?

#include <span>
#include <vector>

#include "libchar/core/coefficient.hpp"
#include "libchar/core/noise_terms.hpp"
#include "libchar/fit/fit_result.hpp"
#include "libchar/fit/record/power_bins.hpp"

namespace libchar {

/// The residual of a gamma bin as a standard normal deviate, Phi^-1(P(chi2_nu <= nu u)): exact for every nu.
double normal_deviate(double energy_ratio, double dof);

std::vector<FitResidual> residuals_of(const std::vector<PowerBin>& bins, const Mixture& theta, double rate_hz);

/// Sum of z^2 over the residuals against chi-square with (bins - fitted) degrees of freedom.
Goodness goodness_of(std::span<const FitResidual> residuals, std::size_t fitted);

}  // namespace libchar
