#pragma once
// Mean and spread of a quantity over the members of a lot. Coefficients are compared as logarithms.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "libchar/core/coefficient.hpp"
#include "libchar/core/numeric/interval.hpp"
#include "libchar/core/numeric/random_effects.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/lot/fleet_lot.hpp"

namespace libchar {
// Squares that are each known to some accuracy, some of them so little that zero is as good: noise
// coefficients of a lot, of which some were detected and some were not.
//   ln c_i ~ N(mean, spread²),   E[q_i] = c_i²,   q_i, the estimate of the square, can be below zero

/// The estimates of squares, side by side. Scale and unit do not matter.
struct SquareEstimates {
  std::span<const double> square;
  /// By the information at the square, or at zero where it is below: > 0.
  std::span<const double> sd;
  std::span<const double> skewness;  ///< there; 0 or less: not known
  std::span<const double> samples;   ///< of each record: of about one length, errors are of one kind
  /// With r = sd / square, the variance is 1 + excess r / (1 + 1.5 r) times that by the information.
  double excess = 0;
};

struct LognormalEffects {
  std::size_t count = 0;
  double mean = 0;  ///< of ln c
  Interval mean_ci95;
  double arithmetic = 0;  ///< ln E[c], mean + spread²/2
  Interval arithmetic_ci95;
  double spread = 0;  ///< standard deviation of ln c; 0: nothing of it is seen
  Interval spread_ci95;
};

/// Three values at least, one of them above zero. An end of an interval is infinite where the squares do not end it.
LognormalEffects lognormal_effects(const SquareEstimates& in);

/// Records of one class have about the same length, within a factor of sqrt 2: their fits err alike.
inline long length_class(double samples) {
  return clamped_whole<long>(std::round(2 * std::log2(std::max(1.0, samples))));
}

/// At least two, and two thirds of all: what was not detected is smaller than what was.
inline bool enough_count(std::size_t counted, std::size_t members) {
  return counted >= 2 && 3 * counted >= 2 * members;
}

/// Of the members that count; none where they are not enough.
std::optional<RandomEffects> lot_effects(std::span<const double> value, std::span<const double> variance,
                                         std::size_t members);

/// The same of noise coefficients as logarithms, estimates by one fit each; `samples` of the records, one a value.
std::optional<RandomEffects> coefficient_effects(std::span<const double> logarithm, std::span<const double> variance,
                                                 std::span<const double> samples, std::size_t members);

/// ln(value) of a coefficient and its variance as a lot takes them: in the model of all terms.
struct LogCoefficient {
  double y = 0, v = 0;
};
LogCoefficient log_coefficient(const Coefficient& found);

/// Whether a record says something of the coefficient: it was fitted, by a model that describes the record.
bool was_sought(Status status);

/// The square of a noise coefficient, whether it was detected or not. Nothing where the model does
/// not describe the record, or the coefficient was not fitted.
std::optional<SquareInAll> square_in_lot(const Coefficient& found);

/// The squares of a term over the members of a lot, one a member.
struct LotSquares {
  std::vector<double> square, sd, skewness, samples;
  std::vector<std::uint32_t> member;  ///< of the group
};

/// Of all members, also those that are not detected or doubtful, where they are more than those
/// that count, and a third of all members counts.
std::optional<LognormalEffects> effects_of_all(const LotSquares& squares, std::size_t counted, std::size_t members);

LotFigures lot_figures(const RandomEffects& effects, bool of_logarithms);

/// Of logarithms whose effects these are, without a belief in their distribution but for the
/// interval of the standard deviation.
ArithmeticFigures arithmetic_figures(std::span<const double> logarithm, std::span<const double> variance,
                                     std::span<const double> samples);
/// Those that a lognormal distribution has.
ArithmeticFigures arithmetic_figures(const LognormalEffects& effects);

}  // namespace libchar
