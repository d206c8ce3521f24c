#pragma once
// Noise coefficients of a curve alone, digitised from a data sheet or paper.

#include <optional>
#include <vector>

#include "libchar/fit/fit_options.hpp"
#include "libchar/fit/fit_result.hpp"
#include "libchar/spectrum/spectrum.hpp"

namespace libchar {

/// Fit of a curve alone (digitised from a data sheet or paper).
struct DigitisedCurve {
  bool is_allan = true;      ///< else a spectrum
  Sides sides = Sides::one;  ///< of a spectrum
  bool root = true;          ///< values are deviations / root densities (else variances / densities)
  std::vector<double> x;     ///< tau_s or frequency_hz, ascending
  std::vector<double> y;
  std::vector<double> relative_sd;   ///< of the deviation, if the curve has it; empty = unknown
  std::optional<double> duration_s;  ///< of the record behind the curve, gives honest weights
  std::optional<double> rate_hz;
  std::vector<double> group;  ///< how many points each of them stands for; empty = itself
};
/// At most 512 groups of neighbours are fitted.
NoiseFit fit_curve(const DigitisedCurve& curve, const FitOptions& options = {});

}  // namespace libchar
