#pragma once
// One channel on its way through: leaf by leaf, and all of its samples besides where something needs them.

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libchar/characterize/characterization.hpp"
#include "libchar/characterize/detail/leaf.hpp"
#include "libchar/core/parallel/parallel.hpp"
#include "libchar/core/process/progress.hpp"
#include "libchar/fit/curve/allan_fit.hpp"
#include "libchar/log/read.hpp"
#include "libchar/spectrum/welch_sums.hpp"

namespace libchar {
// What was found of a channel becomes its result: curves, fit, and why something is absent.

/// What the channels of one log share, from any number of threads.
struct CharacterizeWorkspace {
  FitWorkspace fit;
  WelchWorkspace welch;
};

/// A channel that has been read.
struct ReadChannel {
  /// of a log of one leaf its samples alone
  ChannelSums sums;
  /// all samples of a longer log as it has them, where something needs them
  std::vector<double> all;
  /// of a longer log whose spectrum is not one of leaves
  std::optional<WelchStream> spectrum;
  std::shared_ptr<const TemperatureRecord> temperature;  ///< of the log; null: none was asked for
};

/// Curves and fit. A rate > 0, or nothing that needs a time axis is computed and the result says why.
ChannelResult finish_channel(ReadChannel read, const CharacterizeOptions& options, CharacterizeWorkspace& workspace,
                             const Channel& channel, const TimeBase& time);

class ChannelStage {
 public:
  /// Both must live as long. `keep`: all samples of a log of more than a leaf, too.
  ChannelStage(const CharacterizeOptions& options, CharacterizeWorkspace& workspace, bool keep);

  /// Takes samples as the log has them.
  void push(std::span<const double> samples);
  /// Room for a record of up to this length, so that growing neither copies nor takes twice the memory.
  void reserve(std::size_t samples);
  /// Lets go of everything; nothing is computed any more.
  void drop();

  /// All samples, where they are kept.
  std::span<const double> kept() const { return all_; }
  /// What the temperature does is taken out of the record before its noise is fitted.
  void set_temperature(std::shared_ptr<const TemperatureRecord> temperature) { temperature_ = std::move(temperature); }
  /// Curves and fit, as `finish_channel`. The stage is done.
  ChannelResult finish(const Channel& channel, const TimeBase& time);

 private:
  void end_leaf(bool last);

  const CharacterizeOptions* options_;
  CharacterizeWorkspace* workspace_;
  bool keep_ = false;
  bool in_turn_ = false;              ///< the spectrum is of leaves in turn
  std::unique_ptr<LeafStage> stage_;  // at one place: the tree points to it
  ChannelTree tree_;
  std::uint64_t leaves_ = 0;
  std::vector<double> leaf_, all_;
  SampleMeters meters_;                  ///< of the leaf
  std::optional<WelchStream> spectrum_;  ///< of leaves in turn, where they cannot be joined
  std::shared_ptr<const TemperatureRecord> temperature_;
};

// All channels of a log on their way through, as many at a time as memory allows.

/// A pass over a log: some of its channels side by side, each through a stage of its own.
class ChannelStages final : public BlockSink {
 public:
  /// Of the channels from `first` on as many as memory allows, or all. The workspace must live as long.
  ChannelStages(const CharacterizeOptions& options, CharacterizeWorkspace& workspace, std::size_t first, bool all);

  void begin(const LogInfo& so_far) override;
  void block(const SampleBlock& samples) override;

  /// The first channel of the next pass.
  std::size_t end() const { return first_ + stages_.size(); }
  /// Curves and fits, two channels at a time: memory stays bounded however many there are. Throws
  /// Error(usage) where an option needs all samples and they do not fit.
  std::vector<ChannelResult> finish(const LogInfo& log, Progress& progress);
  /// After `finish`: the temperature that was taken out; null: none was asked for.
  std::shared_ptr<const TemperatureRecord> temperature() const { return temperature_; }

 private:
  bool refused() const;
  [[noreturn]] void refuse(const LogInfo& log) const;
  std::size_t channels_at_once(const LogInfo& so_far) const;
  void find_temperature(const LogInfo& so_far);
  void give_temperature(const LogInfo& log);

  CharacterizeOptions options_;  ///< with the segment in samples, once the rate is known
  CharacterizeWorkspace& workspace_;
  std::size_t first_ = 0;
  bool all_ = false;
  std::uint64_t rows_ = 0;
  std::string needs_all_samples_;  ///< what does, if anything
  parallel::Threads arena_;
  std::vector<ChannelStage> stages_;
  CharacterizeOptions temperature_options_;  ///< of the temperature: no phase, no frequency
  std::size_t temperature_index_ = 0;
  std::shared_ptr<const TemperatureRecord> temperature_;
};

/// A segment of `samples`, or of `seconds` where that is 0, before anything is set up for it: throws
/// Error(usage) where the log is shorter, with
/// the longest that fits. Only where the segment is so long that setting it up takes long is the log read for that.
void refuse_longer_segment(const std::string& path, const ReadOptions& reading, std::uint64_t samples, double seconds,
                           Progress& progress);

}  // namespace libchar
