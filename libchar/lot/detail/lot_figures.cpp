// Of fits of noise, v_i is not known but taken from the fit, relative to what was found: who is found too large by
// chance is believed to be known better, and a mean with the weights 1/(v_i + s²) is too large (Doncaster & Spake,
// Methods Ecol. Evol. 9 (2018) 634, who use a variance in common as here). So the mean has the weights of a typical v,
// the median of the records of about the same length; Hartung and Knapp's interval holds for any weights. And
// theta = c² is what a fit finds without bias, so that E[ln c] = ln c - v to second order, which is put back. Mean over
// 200 devices of three terms each: docs/theory/lots.md. The spread, which both would hardly move, is Paule and Mandel's
// of the v_i.
#include "libchar/lot/detail/lot_figures.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "libchar/core/numeric/median.hpp"

namespace libchar {
namespace {

/// Of a value that is hardly known, v is hardly known as well.
constexpr double kMostOfTypical = 4;

/// Medians over the records of about the same length.
std::vector<double> typical_variances(std::span<const double> variance, std::span<const double> samples) {
  std::map<long, std::vector<double>> alike;
  for (std::size_t i = 0; i < variance.size(); ++i) alike[length_class(samples[i])].push_back(variance[i]);
  std::map<long, double> typical;
  for (auto& [key, values] : alike) typical[key] = median_in_place(values);
  std::vector<double> out(variance.size());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = typical[length_class(samples[i])];
  return out;
}

}  // namespace

std::optional<RandomEffects> lot_effects(std::span<const double> value, std::span<const double> variance,
                                         std::size_t members) {
  if (!enough_count(value.size(), members)) return std::nullopt;
  return random_effects(value, variance);
}

std::optional<RandomEffects> coefficient_effects(std::span<const double> logarithm, std::span<const double> variance,
                                                 std::span<const double> samples, std::size_t members) {
  auto out = lot_effects(logarithm, variance, members);
  if (!out) return out;
  const std::vector<double> typical = typical_variances(variance, samples);
  std::vector<double> unbiased(logarithm.begin(), logarithm.end());
  for (std::size_t i = 0; i < unbiased.size(); ++i) unbiased[i] += std::min(variance[i], kMostOfTypical * typical[i]);
  const RandomEffects mean = random_effects(unbiased, typical);
  out->mean = mean.mean;
  out->mean_ci95 = mean.mean_ci95;
  return out;
}

LogCoefficient log_coefficient(const Coefficient& found) {
  const double value = found.value.value_or(0), square = found.in_all ? found.in_all->square : 0;
  if (!(square > 0)) return {std::log(value), found.relative_sd * found.relative_sd};
  // What widens the one (a scatter beyond the noise, heavy tails) widens the other.
  const double sd = std::max(found.in_all->sd / (2 * square), found.relative_sd);
  return {std::log(square) / 2, sd * sd};
}

bool was_sought(Status status) { return status != Status::misfit && status != Status::not_fitted; }

std::optional<SquareInAll> square_in_lot(const Coefficient& found) {
  if (!was_sought(found.status) || found.status == Status::given) return std::nullopt;
  if (found.in_all) {
    SquareInAll out = *found.in_all;
    out.sd = std::max(out.sd, 2 * found.relative_sd * std::max(0.0, out.square));
    return out;
  }
  const double square = found.value.value_or(0) * found.value.value_or(0), sd = 2 * found.relative_sd * square;
  if (!(sd > 0)) return std::nullopt;
  return SquareInAll{square, sd, 4 * found.relative_sd};  // chi-square
}

std::optional<LognormalEffects> effects_of_all(const LotSquares& squares, std::size_t counted, std::size_t members) {
  // The weights of a fit are estimated as well, so that a term that is little known scatters by
  // more than the information of its fit says: B and K of 12000 records each, known to 13 to 130 %
  // of their squares (docs/theory/lots.md).
  constexpr double kExcess = 0.55;
  const std::size_t known = squares.square.size();
  if (known <= counted || known < 3 || counted < 2 || 3 * counted < members) return std::nullopt;
  return lognormal_effects({squares.square, squares.sd, squares.skewness, squares.samples, kExcess});
}

LotFigures lot_figures(const RandomEffects& effects, bool of_logarithms) {
  LotFigures out{effects.mean, effects.mean_ci95, effects.spread, effects.spread_ci95};
  if (!of_logarithms) return out;
  out.mean = std::exp(out.mean);
  out.mean_ci95 = {std::exp(out.mean_ci95.low), std::exp(out.mean_ci95.high)};
  return out;
}

ArithmeticFigures arithmetic_figures(std::span<const double> logarithm, std::span<const double> variance,
                                     std::span<const double> samples) {
  const std::vector<double> typical = typical_variances(variance, samples);
  const std::size_t count = logarithm.size();
  const double n = static_cast<double>(count);
  std::vector<double> value(count), v(count);
  double square = 0;
  for (std::size_t i = 0; i < count; ++i) {
    // E[ln c] = ln c - v, so that E[c] is smaller by v/2 of it.
    value[i] = std::exp(logarithm[i]) * (1 + std::min(variance[i], kMostOfTypical * typical[i]) / 2);
    square += value[i] * value[i] / (1 + typical[i]) / n;
  }
  for (std::size_t i = 0; i < count; ++i) v[i] = typical[i] * square;
  const RandomEffects effects = random_effects(value, v);
  ArithmeticFigures out{effects.mean, effects.mean_ci95, effects.spread, effects.spread_ci95};
  double second = 0, fourth = 0;
  for (const double x : value) {
    const double d2 = (x - effects.mean) * (x - effects.mean);
    second += d2;
    fourth += d2 * d2;
  }
  constexpr double kEnough = 20;
  const double kurtosis = second > 0 ? n * fourth / (second * second) : 3;
  if (n < kEnough || !(kurtosis > 3) || !(out.sd > 0)) return out;
  // Heavy tails: as many values fewer as the kurtosis says (Shoemaker, Am. Stat. 57 (2003) 105).
  const double wider = std::sqrt((n - 1) * (kurtosis - (n - 3) / (n - 1)) / (2 * n));
  out.sd_ci95 = {std::max(0.0, out.sd - wider * (out.sd - out.sd_ci95.low)),
                 out.sd + wider * (out.sd_ci95.high - out.sd)};
  return out;
}

ArithmeticFigures arithmetic_figures(const LognormalEffects& effects) {
  const double mean = std::exp(effects.arithmetic);
  const auto sd = [&](double spread) { return mean * std::sqrt(std::expm1(spread * spread)); };
  return {mean,
          {std::exp(effects.arithmetic_ci95.low), std::exp(effects.arithmetic_ci95.high)},
          sd(effects.spread),
          {sd(effects.spread_ci95.low), sd(effects.spread_ci95.high)}};
}

}  // namespace libchar
