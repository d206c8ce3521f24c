#pragma once
// Spectra on a logarithmic frequency axis.

#include <cstddef>
#include <span>

#include "libchar/spectrum/spectrum.hpp"

namespace libchar {

/// The spectrum averaged into bins of equal width on a logarithmic frequency axis, degrees of
/// freedom summed; at most `bins`.
Spectrum log_binned(const Spectrum& spectrum, std::size_t bins);

/// A log-frequency spectrum for display of a long record: short segments for high frequencies, long
/// ones for low ones.
Spectrum log_frequency_spectrum(std::span<const double> record,
                                double rate_hz,
                                Sides sides,
                                std::size_t bins);

}  // namespace libchar
