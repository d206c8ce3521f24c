#pragma once
// Several runs of one sensor, switched off and on between them: one set of noise coefficients by one likelihood,
// whether they have one, and how much the bias changes from one turn-on to the next.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "libchar/characterize/characterization.hpp"
#include "libchar/core/numeric/random_effects.hpp"
#include "libchar/fit/record/pooled_fit.hpp"

namespace libchar {

struct PoolOptions {
  FitOptions fit;
  SampleKind data = SampleKind::rate;  ///< what the samples were: a phase has no bias of its own
  double probability = 0.01;           ///< of calling runs unlike that are alike; and of naming any single one
  int replicates = 199;                ///< of the runs, simulated from the common coefficients
  std::uint64_t seed = 1;
};

/// One run of one channel.
struct ChannelRun {
  std::size_t run = 0;  ///< which of the recordings
  double mean = 0,
         mean_sd = 0;  ///< of the samples; sd: what noise alone moves it by, Allan deviation of the run's length
  double ratio = 0;    ///< 2 (ln L with own - ln L with common coefficients)
  double p = 1;        ///< of as large a ratio in any run, by chance
  bool differs = false;
};

struct PooledChannel {
  Channel channel;
  NoiseFit fit;                  ///< of all runs together, without those that differ where the others are alike
  std::vector<ChannelRun> runs;  ///< those that were pooled
  double ratio = 0;              ///< sum of the ratios of the runs
  double p = 1;                  ///< of as large a sum, by chance
  int simulations = 0;           ///< that the probabilities are counted in
  bool consistent = true;
  bool rest_alike = true;              ///< all runs but those that differ have one set of coefficients
  std::optional<RandomEffects> bias;   ///< turn-on bias: mean and spread; none: fewer than two runs, or of a phase
  std::vector<std::string> sentences;  ///< what is alike, and the bias
};

struct RunInfo {
  std::string file;
  std::uint64_t samples = 0;
  double duration_s = 0, rate_hz = 0;
};

struct PooledRuns {
  std::vector<RunInfo> runs;
  std::vector<PooledChannel> channels;
  std::vector<Finding> findings;  ///< channels that could not be pooled
  std::string verdict;            ///< a paragraph for all channels
};

/// Throws Error(input) where the runs are not of one sensor: channels, units or rates that differ, one file twice, a
/// run without a fit; Error(usage) for fewer than two.
PooledRuns pool_runs(std::span<const Characterization> runs, const PoolOptions& options = {});

/// The same file twice is one recording. Throws Error(input).
void refuse_same_recording(std::span<const Characterization> recordings);

}  // namespace libchar
