#pragma once
// Samples of a log as they are analysed.

#include <cstdint>
#include <span>
#include <vector>

#include "libchar/characterize/characterization.hpp"

namespace libchar {

/// The samples, with NaN for those beyond `kLargestSample`, which are no measurement, and how many those are. In `scratch` where there are
/// any.
std::span<const double> usable_samples(std::span<const double> samples,
                                       std::vector<double>& scratch,
                                       std::uint64_t& beyond);

/// A frequency as fractional frequency, in `scratch`; other samples as they are. Phase is differenced when the record is whole.
std::span<const double> rate_samples(std::span<const double> samples,
                                     const CharacterizeOptions& options,
                                     std::vector<double>& scratch);

}  // namespace libchar
