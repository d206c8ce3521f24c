#pragma once
// What is done about data that break the model, each only when its alarm asks. Order: spikes,
// lines, then the fit, then what its residuals ask for: quantization or bandwidth (high
// frequencies), ramp or dropping of the lowest bins (low ones).

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "libchar/fit/noise_fit.hpp"

namespace libchar {

/// Kurtosis of first differences above which spikes are looked for: 3.1, or five standard
/// deviations above 3 in a short record.
double spike_alarm(std::uint64_t samples);

/// Kurtosis of the first differences of a record; NaN are skipped.
double kurtosis_of_differences(std::span<const double> record);

Remedy spikes_remedy(double kurtosis, double alarm, std::uint64_t replaced);
Remedy lines_remedy(std::uint64_t clipped);

}  // namespace libchar
