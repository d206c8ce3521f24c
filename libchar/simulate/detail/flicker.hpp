#pragma once
// Flicker (1/f) noise of any length in constant memory: a filter of some fifty first-order sections
// whose spectrum and impulse response are those of fractional differencing to better than 1e-6
// (derivation in flicker.cpp and docs/theory/simulation.md).

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "libchar/simulate/random.hpp"

namespace libchar {

/// How a coloured noise begins.
enum class Start {
  stationary,  ///< the record is a window of a noise that has always been there; its increments are
               ///< stationary, its level is counted from the value just before the first sample
  zero,        ///< as published: the filter starts at rest, the noise grows from nothing
};

/// h_k = sum_j weight_j pole_j^k, pole = 1 - loss. The loss is what is stored: poles lie closer to
/// 1 than a double resolves.
struct FlickerFilter {
  std::vector<double> loss;    ///< descending
  std::vector<double> weight;  ///< all positive
};

/// The records for which the filter of unknown length is designed: 2^40 samples.
inline constexpr std::uint64_t kLongestFlicker = std::uint64_t{1} << 40U;

/// Filter for records of up to `length` samples (0: unknown). For lags k <= length and frequencies
/// of at least 1/(2 length) cycles a sample, |h_k/h_k,exact - 1|, ||H|^2/|H|^2,exact - 1| and the
/// relative error of the variogram are below 1e-6.
FlickerFilter design_flicker(std::uint64_t length);

/// Draws the states of the sections (weights not applied) from their joint stationary distribution.
std::vector<double> stationary_states(const FlickerFilter& filter, DeviateStream& deviates);
/// Row by row, the lower triangular factor L with L L' = stationary covariance of the states.
std::vector<double> stationary_factor(const FlickerFilter& filter);

/// The filter at work.
class FlickerStream {
 public:
  /// Starts at rest.
  explicit FlickerStream(const FlickerFilter& filter);
  /// Starts stationary, at the level 0.
  FlickerStream(const FlickerFilter& filter, DeviateStream& start_deviates);
  /// Replaces driving deviates of unit variance by flicker of unit coefficient.
  void run(std::span<double> values);
  std::size_t sections() const { return loss_.size(); }

 private:
  std::vector<double> loss_, weight_, state_;  ///< padded to whole vectors; states times weights
  double level_ = 0;                           ///< output just before the first sample
};

// The truncated recursive filter of flicker, for comparison (Kasdin 1995, [RV 1.19-1.28]).

/// x_t = w_t - sum_{k=1}^{taps} b_k x_{t-k} from rest, block by block: `rv-truncated-iir`. b are
/// the coefficients of (1 - z^-1)^(1/2): b_0 = 1, b_k = b_{k-1} (k - 3/2)/k. Below some 1/(taps)
/// cycles per sample its spectrum is flat, not 1/f.
class TruncatedKasdin {
 public:
  explicit TruncatedKasdin(std::size_t taps);
  /// Replaces driving deviates by the output.
  void run(std::span<double> values);

 private:
  std::vector<double> reversed_;  ///< -b_taps ... -b_1
  std::vector<double> past_;      ///< outputs, oldest first, in a window that slides over a buffer
  std::size_t at_ = 0;            ///< where the window begins
};

}  // namespace libchar
