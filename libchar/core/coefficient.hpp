#pragma once
// A noise coefficient with what is known of it: status, interval, bounds; and how well a model fits.

#include <array>
#include <optional>

#include "libchar/core/document/enum_table.hpp"
#include "libchar/core/noise_terms.hpp"
#include "libchar/core/numeric/interval.hpp"

namespace libchar {

enum class Status {
  detected,      ///< value and interval
  not_detected,  ///< likelihood ratio below the threshold: no value, only `upper95`
  undetermined,  ///< present alone or with another term, but the record cannot tell them apart: value and wide interval
  misfit,        ///< fitted, but the noise terms do not describe the record: intervals are widened by the scatter
  given,         ///< not fitted but stated by somebody (models only)
  not_fitted,    ///< the term was not part of the model that was asked for
};
template <>
inline constexpr auto enum_table<Status> =
    enum_words<Status, "detected not_detected undetermined misfit given not_fitted">;

/// The estimate of a square that no bound and no decision biases: below zero where chance has it so.
struct SquareInAll {
  double square = 0;
  double sd = 0, skewness = 0;  ///< of its distribution
  bool operator==(const SquareInAll&) const = default;
};

/// One coefficient (not squared), in the channel's unit times the unit of core/units.hpp's term_unit.
struct Coefficient {
  Status status = Status::not_fitted;
  std::optional<double> value;    ///< nothing when not detected
  Interval ci95;                  ///< low = 0 when it reaches zero; meaningful when there is a value
  double relative_sd = 0;         ///< standard deviation / value, from the fit's covariance
  bool profile = false;           ///< ci95 by profile likelihood (relative_sd > 15 %), else log-normal Wald
  std::optional<double> upper95;  ///< one-sided upper 95 % limit when there is no value
  double likelihood_ratio = 0;    ///< 2 (lnL with - lnL without)
  std::optional<double> bound;    ///< Cramér–Rao bound at the fit, relative sd
  std::optional<double> seconds_for_10_percent;  ///< record length at which the bound is 10 %
  /// In the model of all terms that were offered, none of them held at zero; for means over many records.
  std::optional<SquareInAll> in_all;
};

/// One of each term, indexed by Term.
using Coefficients = std::array<Coefficient, kTerms>;

/// How well a model describes the data: chi-square, its degrees of freedom, and the probability of more.
struct Goodness {
  double chi2 = 0;
  double dof = 0;
  double p = 1;
};

}  // namespace libchar
