#pragma once
// Mean and spread of a quantity over the members of a lot. Coefficients are compared as logarithms.

#include <cstddef>
#include <optional>
#include <span>

#include "libchar/core/interval.hpp"
#include "libchar/core/random_effects.hpp"

namespace libchar {

/// In the unit of the values: exp of the logarithms for coefficients.
struct LotFigures {
  double mean = 0;
  Interval mean_ci95;
  double spread =
      0;  ///< of coefficients relative (standard deviation of the logarithm), of others in their unit
  Interval spread_ci95;
};

/// Of the members that count; none for fewer than two, or under two thirds of all: what was not detected is smaller than what was.
std::optional<RandomEffects> lot_effects(std::span<const double> value,
                                         std::span<const double> variance,
                                         std::size_t members);

LotFigures lot_figures(const RandomEffects& effects, bool of_logarithms);

}  // namespace libchar
