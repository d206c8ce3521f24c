#include "libchar/characterize/lot_figures.hpp"

#include <cmath>

namespace libchar {

std::optional<RandomEffects> lot_effects(std::span<const double> value,
                                         std::span<const double> variance,
                                         std::size_t members) {
  if (value.size() < 2 || 3 * value.size() < 2 * members) return std::nullopt;
  return random_effects(value, variance);
}

LotFigures lot_figures(const RandomEffects& effects, bool of_logarithms) {
  LotFigures out{effects.mean, effects.mean_ci95, effects.spread, effects.spread_ci95};
  if (!of_logarithms) return out;
  out.mean = std::exp(out.mean);
  out.mean_ci95 = {std::exp(out.mean_ci95.low), std::exp(out.mean_ci95.high)};
  return out;
}

}  // namespace libchar
