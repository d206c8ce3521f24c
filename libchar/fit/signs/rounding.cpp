// With the density r = q^2/(12 rate) of rounding to steps q (digital.cpp),
//   measured(f) = terms(f) shape(f) = terms'(f) shape'(f) + r,   N'^2 = N^2 - r,
// so that shape' = (terms shape - r) / (terms - r) at every frequency where it was measured.
#include "libchar/fit/signs/rounding.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/core/text/readable.hpp"
#include "libchar/fit/curve/shaped_curves.hpp"
#include "libchar/fit/detail/curve/coefficients.hpp"

namespace libchar {
namespace {

constexpr auto kRoundedTerm = static_cast<std::size_t>(Term::white);
constexpr double kShownShare = 0.1;  ///< of the standard deviation of N

double root_beside(double value, double square) { return std::sqrt(std::max(0.0, value * value - square)); }

void take_out_of_shape(double density, NoiseFit& fit) {
  constexpr double kLeastRatio = 1e-6;
  for (std::size_t i = 0; i < fit.shape.frequency_hz.size(); ++i) {
    const double terms =
        detail::unshaped_density(fit, std::min(fit.shape.frequency_hz[i], fit.rate_hz / 2), 1 / fit.rate_hz);
    const double rest = terms * fit.shape.ratio[i] - density;
    if (terms > density) fit.shape.ratio[i] = std::max(kLeastRatio, rest / (terms - density));
  }
}

/// Known to the variance of the fit and that of the rounding.
void take_out_of_value(double density, double density_sd, Coefficient& white) {
  const double square = *white.value * *white.value, rest = square - density, more = square / rest;
  white.value = std::sqrt(rest);
  white.relative_sd *= more;
  white.ci95 = {root_beside(white.ci95.low, density), root_beside(white.ci95.high, density)};
  widen_by(density_sd / (2 * rest), white);
  if (white.bound) *white.bound *= more;
  if (white.seconds_for_10_percent) *white.seconds_for_10_percent *= more * more;
}

/// N is hidden beneath the rounding.
void limit_white(double density, Coefficient& white) {
  const double limit = root_beside(white.ci95.high, density);
  white.status = Status::not_detected;
  white.value.reset();
  white.upper95 = limit;
  white.ci95 = {0, limit};
}

void say_rounding(const DigitalFaults::Rounding& rounding, double before, const NoiseFit& fit,
                  std::vector<Finding>& findings) {
  const Coefficient& white = fit.term[kRoundedTerm];
  const std::string step = brief_text(rounding.step);
  if (!white.value)
    findings.push_back(finding(
        "rounding_in_n", fmt::format("White noise does not exceed that of rounding to {}: N has only a limit.", step)));
  else if (before / *white.value - 1 > kShownShare * white.relative_sd)
    findings.push_back(finding(
        "rounding_in_n",
        fmt::format("Rounding to {} adds {} to the white noise of the samples: N is the sensor's, before rounding.",
                    step, percent_text(before / *white.value - 1)),
        "the noise of rounding was taken out of N"));
}

/// Nobody rounded counts, and skewed noise that was rounded looks like them: the interval knows both.
void reach_without(const DigitalFaults::Rounding& rounding, double density, NoiseFit& fit) {
  Coefficient& white = fit.term[kRoundedTerm];
  const double share = 1 - root_beside(*white.value, density) / *white.value;
  white.ci95.low = root_beside(white.ci95.low, density);
  if (share > kShownShare * white.relative_sd)
    fit.findings.push_back(finding(
        "rounding_in_n",
        fmt::format("The noise is skewed, as counts are. If the values are not counts and were rounded to {}, N is "
                    "smaller by {}: its interval holds both.",
                    brief_text(rounding.step), percent_text(share)),
        "the interval of N holds it with and without the noise of rounding"));
}

}  // namespace

void detail::take_out_rounding(const DigitalFaults::Rounding& rounding, NoiseFit& fit) {
  constexpr double kLeastShare = 0.1;  // of the white noise
  Coefficient& white = fit.term[kRoundedTerm];
  // What is not known is not known better without rounding.
  if (!white.value || white.status == Status::undetermined) return;
  if (!(fit.rate_hz > 0) || !(rounding.variance > 0)) return;
  const double density = rounding.variance / fit.rate_hz, before = *white.value;
  if (!(white.ci95.high * white.ci95.high > density)) return;
  if (rounding.of_counts) return reach_without(rounding, density, fit);
  take_out_of_shape(density, fit);
  fit.rounding = density;
  double& theta = fit.theta[kRoundedTerm];
  theta = std::max(0.0, theta - density);
  // An interval that begins at zero without a rounding that matters is the fit's own.
  const bool matters = density > kLeastShare * before * before;
  if (!matters || (white.ci95.low * white.ci95.low > density && before * before > density))
    take_out_of_value(density, rounding.sd / fit.rate_hz, white);
  else {
    limit_white(density, white);
    theta = 0;
  }
  if (white.in_all) white.in_all->square -= density;
  if (fit.second_opinion && fit.second_opinion->value[kRoundedTerm]) {
    double& other = *fit.second_opinion->value[kRoundedTerm];
    const double rest = root_beside(other, density);
    if (rest > 0) fit.second_opinion->sd[kRoundedTerm] *= other / rest;
    other = rest;
  }
  say_rounding(rounding, before, fit, fit.findings);
}

Coefficients detail::terms_with_rounding(const NoiseFit& fit) {
  Coefficients out = fit.term;
  Coefficient& white = out[kRoundedTerm];
  const double rounding = std::sqrt(fit.rounding);
  if (white.value) *white.value = std::hypot(*white.value, rounding);
  if (white.upper95) *white.upper95 = std::hypot(*white.upper95, rounding);
  white.ci95 = {std::hypot(white.ci95.low, rounding), std::hypot(white.ci95.high, rounding)};
  return out;
}

}  // namespace libchar
