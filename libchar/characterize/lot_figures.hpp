#pragma once
// Mean and spread of a quantity over the members of a lot. Coefficients are compared as logarithms.

#include <cstddef>
#include <optional>
#include <span>

#include "libchar/core/coefficient.hpp"
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

/// The same of noise coefficients as logarithms, estimates by one fit each; `samples` of the records, one a value.
std::optional<RandomEffects> coefficient_effects(std::span<const double> logarithm,
                                                 std::span<const double> variance,
                                                 std::span<const double> samples,
                                                 std::size_t members);

/// ln(value) of a coefficient and its variance as a lot takes them: in the model of all terms.
struct LogCoefficient {
  double y = 0, v = 0;
};
LogCoefficient log_coefficient(const Coefficient& found);

LotFigures lot_figures(const RandomEffects& effects, bool of_logarithms);

}  // namespace libchar
