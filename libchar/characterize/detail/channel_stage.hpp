#pragma once
// One channel on its way through: keeps its samples while they fit, streams them through fixed-size stages when they do not.

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libchar/allan/allan_pyramid.hpp"
#include "libchar/characterize/characterization.hpp"
#include "libchar/characterize/detail/leaf.hpp"
#include "libchar/fit/allan_fit.hpp"
#include "libchar/fit/remedies.hpp"
#include "libchar/fit/spike_cleaner.hpp"
#include "libchar/spectrum/welch_stream.hpp"

namespace libchar {

/// Of a streamed spectrum unless another is asked for.
inline constexpr std::uint64_t kStreamedSegment = std::uint64_t{1} << 16U;
inline constexpr std::uint64_t kStreamedBlock = std::uint64_t{1} << 13U;

/// Of a record that is not kept.
WelchOptions streamed_spectrum(WelchOptions options);

/// The fixed-size stages of a channel whose samples are not kept.
struct ChannelStreams {
  AllanPyramid allan;
  std::optional<WelchStream> spectrum;
  // Short blocks: their transforms stay in the cache, and what is slower than a block is in the series of means anyway.
  PowerBinner bins{kStreamedBlock};
  // Where the spectrum goes by halves they are the blocks of `bins` too, and it transforms them for both: then every sample gets
  // to `bins` from `spectrum`. Points to `bins`.
  std::optional<SharedBlocks> blocks;
  SpikeScan spikes;
  // In the second pass: the samples without spikes, their bins and their curve.
  std::optional<SpikeCleaner> cleaner;
  std::optional<PowerBinner> cleaned;
  std::optional<SpikeCount> spikes_found;  // once the cleaner is done
  AllanPyramid cleaned_allan;
  bool in_leaves = false;  // all of it was taken leaf by leaf, elsewhere
};

/// What the channels of one log share, from any number of threads.
struct CharacterizeWorkspace {
  FitWorkspace fit;
  WelchWorkspace welch;
};

/// What of these options needs every sample at once ("phase data"); empty: the log may be streamed.
std::string what_needs_all_samples(const CharacterizeOptions& options);

class ChannelStage {
 public:
  /// Both must live as long.
  ChannelStage(const CharacterizeOptions& options, CharacterizeWorkspace& workspace)
      : options_(&options), workspace_(&workspace) {}

  /// Takes samples as the log has them.
  void push(std::span<const double> samples);
  /// Moves what is kept into the streaming stages and keeps nothing from now on. Only where nothing needs all samples.
  void stop_keeping();
  /// Lets go of what is kept; nothing is computed any more.
  void drop() { kept_ = std::vector<double>(); }  // `{}` would keep the memory
  std::span<const double> kept() const { return kept_; }
  /// Before `finish`: what the temperature does is taken out of the record before its noise is fitted.
  void set_temperature(std::shared_ptr<const TemperatureRecord> temperature) {
    temperature_ = std::move(temperature);
  }
  std::size_t kept_bytes() const { return kept_.capacity() * sizeof(double); }
  /// Room for a record of up to this length, so that growing neither copies nor takes twice the memory.
  void reserve(std::size_t samples);

  /// After the last push: do spikes ask for a second pass over the log, which cleans them on the way into the fit? Never for
  /// samples that were kept.
  bool needs_second_pass() const;
  void begin_second_pass();

  /// Instead of pushes: all of the record as it was found leaf by leaf.
  void take_leaves(ChannelSums sums);

  /// Curves and fit. `rate_hz` > 0, or nothing that needs a time axis is computed and the result says why.
  ChannelResult finish(const Channel& channel, double rate_hz);

 private:
  std::string unit_of_rate(const std::string& unit) const;
  void stream(std::span<const double> samples);
  void push_cleaned(std::span<const double> samples);
  bool wants_fit() const;
  AllanCurve octaves_of_kept(double rate_hz) const;
  AllanCurve wanted_of_kept(const AllanCurve& octaves, DeviationType type, double rate_hz) const;
  void add_curves(const AllanCurve& octaves, double rate_hz, ChannelResult& result) const;
  void difference_kept(double rate_hz);
  std::vector<NoiseType> types_of_kept(double rate_hz) const;
  void name_noise_types(ChannelResult& result) const;
  NoiseFit fit_of_kept(const AllanCurve& octaves, double rate_hz, const std::string& unit) const;
  NoiseFit fit_of_streams(const AllanCurve& octaves, double rate_hz);
  Quantization quantization() const;
  ChannelQuality quality_of_rate() const;
  bool is_noise(ChannelResult& result) const;
  void doubt_frequency(ChannelResult& result) const;
  bool is_at_rest(ChannelResult& result, double rate_hz, std::vector<Interval>& moving_s);
  void find_digital(ChannelResult& result, double rate_hz) const;
  void curve_and_fit(ChannelResult& curve, ChannelResult& result, double rate_hz);
  void finish_kept(ChannelResult& result, double rate_hz);
  void fit_kept(const AllanCurve& octaves, double rate_hz, ChannelResult& result);
  void finish_streams(ChannelResult& result, double rate_hz);

  const CharacterizeOptions* options_;
  CharacterizeWorkspace* workspace_;
  QualityMeter quality_;
  TraceMeter trace_;
  ChannelQuality found_;  // by quality_, at the end
  bool keeping_ = true;
  std::vector<double> kept_;
  std::unique_ptr<ChannelStreams> streams_;  // at one place: parts point to each other
  std::vector<double> fractional_;           // scratch of push
  std::vector<double> usable_;               // scratch of push
  std::uint64_t beyond_ = 0;                 // samples that are no measurement
  std::vector<NoiseType> noise_types_;
  DespikedRecord despiked_;            // rate of the phase without its spikes, when it has some
  std::optional<EventSeries> series_;  // of what is kept, where the search for motion has made it
  std::uint64_t samples_ = 0;
  std::shared_ptr<const TemperatureRecord> temperature_;
};

}  // namespace libchar
