#pragma once
// What the first and the last sample of a record put into all of its slow coefficients.

#include <cstdint>
#include <span>
#include <vector>

#include "libchar/core/noise_terms.hpp"
#include "libchar/fit/record/power_bins.hpp"

namespace libchar::detail {

/// The noise of a record of samples dt_s apart; the last term is flicker phase noise.
struct EndNoise {
  Mixture theta{};
  double dt_s = 1;
};

/// Largest share of the ends in a coefficient of n samples.
double share_of_ends(const EndNoise& noise, std::uint64_t n);

/// E[c_k²] of quantization of theta = 1 without the ends of its n samples.
double quantization_without_ends(double k, std::uint64_t n, double dt_s);

/// The likeliest noise of a record with unknown ends, whose coefficients 0..n-1 these are: quantization, flicker phase
/// of a clock, and those of white noise, flicker and walk that raise 2 ln L by 6. `start`: a guess with all terms.
EndNoise noise_with_ends(std::span<const double> coefficients, const EndNoise& start, bool clock);

/// Leaves out the coefficients of a part, which has ends of its own, that hold more of them than a twentieth.
void leave_out_ends(const EndNoise& noise, PooledPower& power);

/// Takes the first and the last sample out of the coefficients 0..n-1 of a record, as if they were missing. Returns the
/// share of each coefficient's noise that went with them, at [k]; beyond its end that is next to nothing.
std::vector<double> take_out_ends(std::span<double> coefficients, const EndNoise& noise);

}  // namespace libchar::detail
