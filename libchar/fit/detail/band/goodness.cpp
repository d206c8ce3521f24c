// Probability integral transform: nu u = nu measured/model is chi-square with nu degrees of freedom under the model, so
// z = Phi^-1(F(nu u)) is standard normal for every bin, single coefficients included, and sum z^2 is chi-square.
#include "libchar/fit/detail/band/goodness.hpp"

#include <boost/math/special_functions/erf.hpp>
#include <cmath>

#include "libchar/core/numeric/distributions.hpp"

namespace libchar {

double normal_deviate(double energy_ratio, double dof) {
  if (dof > 300) {
    // Wilson-Hilferty: good to 1e-4 there, and it does not underflow in the tails.
    const double spread = 2 / (9 * dof);
    return (std::cbrt(energy_ratio) - (1 - spread)) / std::sqrt(spread);
  }
  const double x = dof * energy_ratio;
  constexpr double kFar = 38;
  if (energy_ratio > 1) {
    const double tail = chi_square_tail(x, dof);
    return tail > 1e-300 ? std::sqrt(2.0) * boost::math::erfc_inv(2 * tail) : kFar;
  }
  const double tail = chi_square_cdf(x, dof);
  return tail > 1e-300 ? -std::sqrt(2.0) * boost::math::erfc_inv(2 * tail) : -kFar;
}

std::vector<FitResidual> residuals_of(const std::vector<PowerBin>& bins, const Mixture& theta, double rate_hz) {
  std::vector<FitResidual> residuals;
  residuals.reserve(bins.size());
  for (const PowerBin& bin : bins) {
    const double model = expected_energy(bin, theta);
    residuals.push_back({bin.frequency_hz, bin.energy / rate_hz, model / rate_hz, bin.dof,
                         normal_deviate(bin.energy / model, bin.dof)});
  }
  return residuals;
}

Goodness goodness_of(std::span<const FitResidual> residuals, std::size_t fitted) {
  Goodness goodness;
  for (const FitResidual& residual : residuals) goodness.chi2 += residual.z * residual.z;
  goodness.dof = std::max(0.0, static_cast<double>(residuals.size()) - static_cast<double>(fitted));
  goodness.p = goodness.dof > 0 ? chi_square_tail(goodness.chi2, goodness.dof) : 1;
  return goodness;
}

}  // namespace libchar
