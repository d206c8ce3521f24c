#pragma once
// A clock's noise in its own words: S_y(f) = h_2 f² + h_1 f + h_0 + h_-1/f + h_-2/f², one-sided, of the fractional
// frequency.

#include <string>
#include <string_view>
#include <vector>

#include "libchar/core/coefficient.hpp"
#include "libchar/fit/fit_result.hpp"

namespace libchar {

struct PowerLaw {
  int alpha = 0;
  std::string_view name;          ///< "white phase"
  std::string_view abbreviation;  ///< of Stable32: "WHPM"
  Coefficient h;                  ///< Hz^-(alpha + 1); status, 95 % interval or upper limit as the term's
};

namespace detail {
/// "Hz⁻³" for alpha 2; of frequencies that are not fractional "(Hz)²·Hz⁻³" and the like.
std::string power_law_unit(int alpha, const std::string& unit);
}  // namespace detail

/// h_2 … h_-2 of a fit of a clock (FitOptions::clock); empty for any other.
std::vector<PowerLaw> power_laws(const NoiseFit& fit);

}  // namespace libchar
