#pragma once
// Spectra on a logarithmic frequency axis.

#include <cstddef>

#include "libchar/spectrum/spectrum.hpp"

namespace libchar {

/// The spectrum averaged into bins of equal width on a logarithmic frequency axis, degrees of
/// freedom summed; at most `bins`.
Spectrum log_binned(const Spectrum& spectrum, std::size_t bins);

}  // namespace libchar
