#pragma once
// Squared DCT-II coefficients of a record in logarithmic bins.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "libchar/core/noise_terms.hpp"
#include "libchar/fit/signs/event.hpp"

namespace libchar {

namespace detail {
struct EndNoise;
}

/// A bin of mean squared DCT-II coefficients and its expectation per unit theta: all the likelihood needs.
struct PowerBin {
  double frequency_hz = 0;            ///< centre
  double energy = 0;                  ///< mean of c_k² (per-sample variance scale: white noise gives Q² fs)
  double dof = 0;                     ///< number of coefficients averaged
  std::array<double, kTerms> unit{};  ///< E[energy] for theta_term = 1
  double low_hz = 0, high_hz = 0;     ///< edges
  /// its coefficients first..end-1 of a transform of `length` means of `spacing` samples
  std::uint64_t first = 0, end = 0, length = 0, spacing = 1;
};

/// E[energy] of a mixture.
inline double expected_energy(const PowerBin& bin, const Mixture& theta) {
  double sum = 0;
  for (std::size_t i = 0; i < kTerms; ++i) sum += theta[i] > 0 ? theta[i] * bin.unit[i] : 0;
  return sum;
}

/// Mean squared coefficients k = first.. of one transform length, pooled over `pooled` transforms.
struct PooledPower {
  /// A sine that was taken out of the record.
  struct Cycle {
    double place = 0;      ///< half periods in the record
    double amplitude = 0;  ///< of its points, times the root of their spacing
    double phase = 0;      ///< amplitude cos(pi place (t + 1/2) / length - phase) at point t
  };
  std::uint64_t length = 0;   ///< points of the transform
  std::uint64_t spacing = 1;  ///< samples averaged in a point
  std::uint64_t first = 1;
  std::uint64_t pooled = 1;
  std::vector<double> mean;
  /// of `mean`, what events put there: taken out of the bins, whose degrees of freedom become fewer; empty: nothing
  std::vector<double> of_events = {};
  /// slow cycles, and `mean` without them; empty: none
  std::vector<Cycle> cycles = {};
  std::vector<double> without_cycles = {};
  /// the two ends were taken out of `mean` (detail/record/ends.hpp): with this share of each
  /// coefficient k, at [k]; empty: they are in
  std::vector<double> with_ends = {};
};

/// Bins without slow cycles and the coefficients of spectral lines.
struct ClippedBins {
  std::vector<PowerBin> bins;
  std::vector<PowerBin> all;  ///< with every coefficient; empty when none was left out
  std::uint64_t clipped = 0;  ///< coefficients left out
  std::vector<Event> cycles;  ///< taken out of the longest transform, by frequency
};

/// Of a record one exact transform, k >= 1. Missing samples: short ones are closed up
/// (concatenated), at a long gap a new record starts and likelihoods add. A record in leaves:
/// powers_of (power_sums.hpp). `ends`: the ends of a record of this noise are taken out.
std::vector<PooledPower> whole_powers(std::span<const double> record, const detail::EndNoise* ends = nullptr);

std::vector<PowerBin> power_bins(std::span<const PooledPower> powers, double rate_hz);
/// The same of a record as a whole.
std::vector<PowerBin> power_bins(std::span<const double> record, double rate_hz);
/// The same after clipping spectral lines: coefficients beyond 32 × the local median are left out.
ClippedBins clipped_power_bins(std::span<const PooledPower> powers, double rate_hz);

}  // namespace libchar
