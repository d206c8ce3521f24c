#pragma once
// The noise of one sensor, block by block, in constant memory: white, flicker, random walk,
// quantization noise and ramp with given coefficients (docs/theory/simulation.md).

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "libchar/core/hidden.hpp"
#include "libchar/core/noise_terms.hpp"
#include "libchar/simulate/detail/flicker.hpp"

namespace libchar {

/// What the coefficients and the bandwidth mean before sampling.
enum class Sampling {
  per_sample,    ///< noise is made sample by sample, the low-pass works on the samples: no aliasing
  band_limited,  ///< white noise is continuous, goes through the low-pass, then is sampled: aliased
};

struct NoiseDesign {
  Mixture coefficient{};  ///< Q, B, K, Qz, R themselves (not squared); a term of 0 costs nothing
  /// of a first-order Gauss-Markov process beside them, stationary from the first sample on; sigma 0: none
  double gauss_markov_sigma = 0, gauss_markov_tau_s = 0;
  double flicker_phase = 0;  ///< F: F times the differences of unit flicker over the sampling interval
  double rate_hz = 1;
  /// corner of the first-order low-pass; needed when band_limited
  std::optional<double> bandwidth_hz;
  Sampling sampling = Sampling::per_sample;
  Start start = Start::stationary;           ///< of the flicker
  std::string flicker_method = "recursive";  ///< or "rv-truncated-iir", which starts at zero
  std::size_t truncated_taps = 1000;         ///< of "rv-truncated-iir"
  /// Samples the flicker is designed for; 0: 2^40. Records made with one length begin alike,
  /// however many of their samples are taken; another length changes the flicker.
  std::uint64_t length = 0;
};

class NoiseGenerator {
 public:
  /// Error(usage) when the design makes no sense.
  NoiseGenerator(const NoiseDesign& design, std::uint64_t seed, std::uint64_t sensor);

  /// Adds the next samples: to the first what the low-pass of the sensor is to filter together with
  /// its signal, y_t = a y_{t-1} + (1 - a) u_t with a = exp(-2 pi bandwidth/rate), to the second what
  /// is added behind it. Both of one length; the second may be empty when `adds_after` is false.
  void add(std::span<double> before_low_pass, std::span<double> after_low_pass);
  /// Where the low-pass stands before the first sample, on top of the signal's own level: y_{-1},
  /// drawn so that filtered white and quantization noise are stationary from the first sample on. 0
  /// when nothing of them goes through it.
  double low_pass_start() const;
  bool adds_after() const;

 private:
  struct State;
  detail::Hidden<State> state_;
};

}  // namespace libchar
