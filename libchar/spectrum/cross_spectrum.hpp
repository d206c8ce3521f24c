#pragma once
// What two channels have in common at each frequency.

#include <complex>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "libchar/spectrum/welch.hpp"

namespace libchar {

struct CrossSpectrum {
  Sides sides = Sides::one;
  Window window = Window::hann;
  double rate_hz = 1;
  std::uint64_t segment = 0, segments = 0, dropped = 0;
  double effective_segments = 0;  ///< independent ones: overlap counted
  /// Coherence that independent channels stay below at a bin with 95 %: 1 - 0.05^(1/(K - 1)), K effective segments
  double significant_coherence = 1;
  std::vector<double> frequency_hz;  ///< 0 … Nyquist
  std::vector<std::complex<double>>
      density;  ///< mean conj(X) Y, U_x U_y / Hz: the phase is that of y less that of x
  std::vector<double> first, second;       ///< densities of x and y
  std::vector<double> coherence;           ///< |density|² / (first · second), 0 … 1
  std::vector<double> coherence_unbiased;  ///< (K c - 1)/(K - 1), not below 0
  std::vector<double>
      phase_sd_rad;  ///< sqrt((1 - c)/(2 K c)), at most pi/sqrt(3), which no phase at all has
  std::vector<std::string> notes;
};

/// Welch's method for a pair of records of one length; segments that touch a missing sample of
/// either are dropped. Densities whatever `options.scaling` says. Throws as welch; Error(numeric)
/// with fewer than two segments: the coherence of one is 1 for any channels.
CrossSpectrum cross_spectrum(std::span<const double> x,
                             std::span<const double> y,
                             double rate_hz,
                             const WelchOptions& options = {});

}  // namespace libchar
