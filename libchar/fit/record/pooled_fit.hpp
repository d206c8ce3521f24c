#pragma once
// Several records of one sensor in one likelihood: one set of coefficients, one band, one shape; and whether the
// records have them in common.

#include <cstdint>
#include <span>
#include <vector>

#include "libchar/fit/noise_fit.hpp"

namespace libchar {

struct RunRecord {
  std::vector<PowerBin> bins;  ///< NoiseFit::bins of its own fit
  std::uint64_t samples = 0;   ///< without the missing ones
};

/// Bins of each run inside the band of the common fit, their expectations times its shape.
using RunBins = std::vector<std::vector<PowerBin>>;

struct PooledFit {
  NoiseFit fit;  ///< `samples` and `duration_s` of all runs together
  RunBins runs;
  std::array<bool, kTerms> terms{};  ///< those that were offered
};

/// Sum of the records' log-likelihoods at its maximum. All records have one rate; at least one is needed. Throws as
/// fit_power_bins.
PooledFit fit_pooled(std::span<const RunRecord> records, double rate_hz, const FitOptions& options = {});

/// How much better coefficients of its own describe a run than those of all runs do, the shape held.
struct RunRatios {
  std::vector<double> run;  ///< 2 (ln L with own - ln L with common coefficients), >= 0
  double total = 0;         ///< their sum, the common coefficients at the maximum of all
  Mixture common{};         ///< squared coefficients
};
RunRatios run_ratios(const RunBins& runs, const std::array<bool, kTerms>& terms);

/// Mean energy that the coefficients let expect in each bin of a run.
std::vector<double> expected_energy(const std::vector<PowerBin>& bins, const Mixture& theta);

}  // namespace libchar
