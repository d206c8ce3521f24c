#pragma once
// Expected squared DCT-II coefficients of flicker phase noise: y_t = F (x_t - x_{t-1})/dt with x unit flicker, S_y(f) = F² 2 sin(pi f dt)/dt.

#include <cstdint>
#include <vector>

#include "libchar/fit/record/power_bins.hpp"

namespace libchar {

/// E[c_k²] per unit F², n samples: within 1e-3 for n >= 4096 (k whole, or between whole numbers for a mean over a bin).
double flicker_phase_dct_mean(double k, std::uint64_t n, double dt_s);

/// Means of every bin, in the order of the bins.
std::vector<double> flicker_phase_units(const std::vector<PowerBin>& bins, double rate_hz);

}  // namespace libchar
