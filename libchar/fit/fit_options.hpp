#pragma once
// What is asked of a fit.

#include <array>
#include <optional>
#include <string>

#include "libchar/core/noise_terms.hpp"
#include "libchar/fit/at_rest.hpp"

namespace libchar {

struct FitOptions {
  std::array<bool, kTerms> terms = {true, true, true, false,
                                    false};  ///< offered from the start; quantization and ramp are added on alarm
  /// automatic spikes/lines/ramp/lowest-bin/bandwidth/quantization remedies, each only on its alarm
  bool remedies = true;
  /// a Gauss-Markov process is looked for next to flicker and walk (remedies on, no ramp offered)
  bool gauss_markov = true;
  /// the samples are a clock's frequency: white and flicker phase noise are offered, no ramp and no
  /// Gauss-Markov process
  bool clock = false;
  /// nothing shapes the top of the spectrum: no filter, no quantization noise that is too weak to be seen
  bool white_top = false;
  /// steps, warm-up and ramp are looked for and taken out (a record that is kept only)
  bool events = true;
  /// and cycles of less than three periods among them
  bool slow_cycles = true;
  /// stretches of the record are compared (a record that is kept only, remedies on)
  bool stationarity = true;
  /// what the terms alone do not describe is searched for: bands, shapes, processes, laws of the slow end (remedies
  /// on). Off where the record is known to hold a signal: no coefficient of a sensor is behind that
  bool explain = true;
  /// a record that surely has more holds a signal, too
  std::optional<detail::AtRest> at_rest;
  /// of the record's first differences, where it is known: spikes are looked for above an alarm
  std::optional<double> difference_kurtosis;
  std::string unit;             ///< of the samples, in sentences
  double threshold = 5.41;      ///< likelihood-ratio threshold of presence (1 % under ½χ²₀+½χ²₁)
  double profile_above = 0.15;  ///< profile-likelihood interval when the relative sd exceeds this
  bool second_opinion = true;   ///< covariance-weighted Allan fit next to the first
  int threads = 1;
};

}  // namespace libchar
