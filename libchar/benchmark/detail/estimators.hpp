#pragma once
// Ways to get noise coefficients from a record: ours, and those that the field uses.

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "libchar/core/noise_terms.hpp"
#include "libchar/core/numeric/interval.hpp"

namespace libchar {

struct CoefficientEstimate {
  std::optional<double> value;  ///< nothing: not detected, or not estimated by this method
  std::optional<Interval> ci95;
};
using NoiseEstimate = std::array<CoefficientEstimate, kTerms>;

struct Estimator {
  std::string_view name;
  std::string_view what;  ///< a sentence, for the legend
  /// `terms`: those that are in the record, for methods that have to be told.
  NoiseEstimate (*estimate)(std::span<const double> record, double rate_hz, const TermSet& terms);
  bool is_ours = true;  ///< else a recipe of another tool
  bool told = false;    ///< it is told the terms; else it decides, or always gives all of its own
};

/// All of them, the program's default first.
const std::vector<Estimator>& estimators();

}  // namespace libchar
