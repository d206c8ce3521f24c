#pragma once
// The spectrum as it changes in time.

#include <cstdint>
#include <span>
#include <vector>

#include "libchar/spectrum/welch.hpp"

namespace libchar {

struct Spectrogram {
  Sides sides = Sides::one;
  Scaling scaling = Scaling::psd;
  Window window = Window::hann;
  double rate_hz = 1;
  std::uint64_t segment = 0;
  std::vector<double> time_s;              ///< middles of the segments, after the first sample
  std::vector<double> frequency_hz;        ///< 0 … Nyquist
  std::vector<std::vector<double>> value;  ///< [time][frequency]; empty where a sample is missing
};

/// The periodogram of each segment of welch() by itself: two degrees of freedom a bin. Needs
/// `options.segment`. Throws as welch; Error(usage) where the record is shorter than a segment or
/// the values are more than 2 GiB.
Spectrogram spectrogram(std::span<const double> record,
                        double rate_hz,
                        const WelchOptions& options);

}  // namespace libchar
