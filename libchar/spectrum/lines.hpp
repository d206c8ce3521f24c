#pragma once
// Spectral lines.

#include <vector>

#include "libchar/spectrum/spectrum.hpp"

namespace libchar {

struct SpectralLine {
  double frequency_hz = 0;
  double amplitude = 0;  ///< of the sine, in U (peak, not rms)
  double excess = 0;     ///< power above the local floor, in multiples of the floor
  double width_hz = 0;   ///< at half the excess
};

/// Narrow lines that stand out of the local median floor with a false-alarm probability below
/// `alarm` over the whole spectrum.
std::vector<SpectralLine> find_lines(const Spectrum& spectrum, double alarm = 1e-3);

}  // namespace libchar
