// Of fits of noise, v_i is not known but taken from the fit, relative to what was found: who is found too large by chance is believed to be
// known better, and a mean with the weights 1/(v_i + s²) is too large (Doncaster & Spake, Methods Ecol. Evol. 9 (2018) 634, who use a
// variance in common as here). So the mean has the weights of a typical v, the median of the records of about the same length; Hartung and
// Knapp's interval holds for any weights. And theta = c² is what a fit finds without bias, so that E[ln c] = ln c - v to second order, which
// is put back. Mean over 200 devices of three terms each: docs/theory/lots.md. The spread, which both would hardly move, is Paule and
// Mandel's of the v_i.
#include "libchar/characterize/lot_figures.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "libchar/core/median.hpp"

namespace libchar {
namespace {

/// Of a value that is hardly known, v is hardly known as well.
constexpr double kMostOfTypical = 4;

/// Medians over the records of about the same length, within a factor of sqrt 2.
std::vector<double> typical_variances(std::span<const double> variance,
                                      std::span<const double> samples) {
  const auto length = [&](std::size_t i) {
    return std::lround(2 * std::log2(std::max(1.0, samples[i])));
  };
  std::map<long, std::vector<double>> alike;
  for (std::size_t i = 0; i < variance.size(); ++i) alike[length(i)].push_back(variance[i]);
  std::map<long, double> typical;
  for (auto& [key, values] : alike) typical[key] = median_in_place(values);
  std::vector<double> out(variance.size());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = typical[length(i)];
  return out;
}

}  // namespace

std::optional<RandomEffects> lot_effects(std::span<const double> value,
                                         std::span<const double> variance,
                                         std::size_t members) {
  if (value.size() < 2 || 3 * value.size() < 2 * members) return std::nullopt;
  return random_effects(value, variance);
}

std::optional<RandomEffects> coefficient_effects(std::span<const double> logarithm,
                                                 std::span<const double> variance,
                                                 std::span<const double> samples,
                                                 std::size_t members) {
  auto out = lot_effects(logarithm, variance, members);
  if (!out) return out;
  const std::vector<double> typical = typical_variances(variance, samples);
  std::vector<double> unbiased(logarithm.begin(), logarithm.end());
  for (std::size_t i = 0; i < unbiased.size(); ++i)
    unbiased[i] += std::min(variance[i], kMostOfTypical * typical[i]);
  const RandomEffects mean = random_effects(unbiased, typical);
  out->mean = mean.mean;
  out->mean_ci95 = mean.mean_ci95;
  return out;
}

LogCoefficient log_coefficient(const Coefficient& found) {
  const bool other = found.value_in_all && found.relative_sd_in_all > 0;
  // What widens the one (a scatter beyond the noise, heavy tails) widens the other.
  const double sd =
      other ? std::max(found.relative_sd_in_all, found.relative_sd) : found.relative_sd;
  return {std::log(other ? *found.value_in_all : found.value.value_or(0)), sd * sd};
}

LotFigures lot_figures(const RandomEffects& effects, bool of_logarithms) {
  LotFigures out{effects.mean, effects.mean_ci95, effects.spread, effects.spread_ci95};
  if (!of_logarithms) return out;
  out.mean = std::exp(out.mean);
  out.mean_ci95 = {std::exp(out.mean_ci95.low), std::exp(out.mean_ci95.high)};
  return out;
}

}  // namespace libchar
