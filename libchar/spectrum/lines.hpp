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

/// The grid of the values of a record, and the noise that blurs it.
struct Quantization {
  double step = 0;      ///< LSB; 0: no grid
  double noise_sd = 0;  ///< of the noise from sample to sample, before rounding
};

/// From the LSB and the standard deviation of first differences of the rounded record.
Quantization quantization_of(double step, double difference_sd);

/// Narrow lines that exceed the local median floor with a false-alarm probability below
/// `alarm` over the whole spectrum. Those that rounding may have made are not among them.
std::vector<SpectralLine> find_lines(const Spectrum& spectrum,
                                     double alarm = 1e-3,
                                     const Quantization& quantization = {});

}  // namespace libchar
