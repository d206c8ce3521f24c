#pragma once
// Welch's averaged modified periodogram.

#include <complex>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "libchar/core/hidden.hpp"
#include "libchar/spectrum/spectrum.hpp"

namespace libchar {

enum class Detrend { none, constant, linear };

template <>
inline constexpr auto enum_table<Detrend> = enum_words<Detrend, "none constant linear">;

/// What welch() and WelchStream work in, kept from one record to the next: for long segments it is as large as a
/// record, and new memory costs as much as a transform. Any number of threads may share it.
class WelchWorkspace {
 public:
  WelchWorkspace();
  struct State;
  State& state() { return *state_; }

 private:
  detail::Hidden<State> state_;
};

struct WelchOptions {
  Window window = Window::hann;
  /// samples per segment; 0 = a quarter of the record as in [RV app. A]
  std::uint64_t segment = 0;
  double overlap = 0.5;  ///< fraction of a segment, 0 <= overlap < 1
  Detrend detrend = Detrend::constant;
  Sides sides = Sides::one;
  Scaling scaling = Scaling::psd;
  int threads = 0;
};

/// Welch's averaged modified periodogram. NaN = missing: segments that touch one are dropped; when
/// fewer than one whole segment is left the segment is shortened and a note says so. Throws
/// Error(numeric) when no segment of >= 8 samples is possible. `workspace` none: memory of its own.
Spectrum welch(std::span<const double> record, double rate_hz, const WelchOptions& options = {},
               WelchWorkspace* workspace = nullptr);

/// The same, in less memory and by all threads where the segments are long: the record is used up.
Spectrum welch_using_up(std::vector<double> record, double rate_hz, const WelchOptions& options = {},
                        WelchWorkspace* workspace = nullptr);

/// Samples of a segment that lasts `seconds`. Throws Error(usage) when the rate is not known (0), or
/// the segment would be shorter than 8 samples.
std::uint64_t segment_samples(double seconds, double rate_hz);

// What two channels have in common at each frequency.

struct CrossSpectrum {
  Sides sides = Sides::one;
  Window window = Window::hann;
  double rate_hz = 1;
  std::uint64_t segment = 0, segments = 0, dropped = 0;
  double effective_segments = 0;  ///< independent ones: overlap counted
  /// Coherence that independent channels stay below at a bin with 95 %: 1 - 0.05^(1/(K - 1)), K effective segments
  double significant_coherence = 1;
  std::vector<double> frequency_hz;           ///< 0 … Nyquist
  std::vector<std::complex<double>> density;  ///< mean conj(X) Y, U_x U_y / Hz: the phase is that of y less that of x
  std::vector<double> first, second;          ///< densities of x and y
  std::vector<double> coherence;              ///< |density|² / (first · second), 0 … 1
  std::vector<double> coherence_unbiased;     ///< (K c - 1)/(K - 1), not below 0
  std::vector<double> phase_sd_rad;           ///< sqrt((1 - c)/(2 K c)), at most pi/sqrt(3), which no phase at all has
  std::vector<std::string> notes;
};

/// Welch's method for a pair of records of one length; segments that touch a missing sample of
/// either are dropped. Densities whatever `options.scaling` says. Throws as welch; Error(numeric)
/// with fewer than two segments: the coherence of one is 1 for any channels.
CrossSpectrum cross_spectrum(std::span<const double> x, std::span<const double> y, double rate_hz,
                             const WelchOptions& options = {});

// The spectrum as it changes in time.

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

/// The periodogram of each segment of welch() by itself: two degrees of freedom a bin. Needs `options.segment`. Throws
/// as welch; Error(usage) where the record is shorter than a segment or the values are more than 2 GiB.
Spectrogram spectrogram(std::span<const double> record, double rate_hz, const WelchOptions& options);

// Welch's method with the median of the segments in place of their mean: bursts in a few segments do not count.

enum class SegmentAverage { mean, median };

template <>
inline constexpr auto enum_table<SegmentAverage> = enum_words<SegmentAverage, "mean median">;

/// Expected median of `count` independent powers of mean 1 with 2 degrees of freedom: of an even
/// number the mean of the middle two.
double expected_median(std::uint64_t count);

/// welch(), each bin the median of the segments' powers over its expected value. Degrees of freedom
/// are the mean's, less what a median of this many is worse (0.48 of them in the end). Throws as
/// welch; Error(usage) where the powers of all segments are more than 2 GiB.
Spectrum median_welch(std::span<const double> record, double rate_hz, const WelchOptions& options = {});

}  // namespace libchar
