#pragma once
// All channels of a log on their way through: read once, kept or streamed, and fitted.

#include <tbb/task_arena.h>

#include <string>
#include <vector>

#include "libchar/characterize/detail/channel_stage.hpp"
#include "libchar/core/progress.hpp"
#include "libchar/log/read.hpp"

namespace libchar {

/// The first pass. Channels go side by side, each through a stage of its own.
class ChannelStages final : public BlockSink {
 public:
  /// The workspace must live as long.
  ChannelStages(const CharacterizeOptions& options, CharacterizeWorkspace& workspace);

  void begin(const LogInfo& so_far) override;
  void block(const SampleBlock& samples) override;

  /// After the last block: the channels that ask for a second pass, in order.
  std::vector<std::size_t> need_second_pass() const;
  std::vector<ChannelStage>& stages() { return stages_; }

  /// Curves and fits, two channels at a time: memory stays bounded however many there are. Throws Error(usage) where an option
  /// needs all samples and they do not fit.
  std::vector<ChannelResult> finish(const LogInfo& log, Progress& progress);
  /// After `finish`: the temperature that was taken out, and which channel it is; null: none was asked for.
  std::shared_ptr<const TemperatureRecord> temperature() const { return temperature_; }
  std::size_t temperature_index() const { return temperature_index_; }

 private:
  bool surely_too_long(const LogInfo& so_far) const;
  bool refused() const;
  void drop_all();
  [[noreturn]] void refuse(const LogInfo& log) const;
  void find_temperature(const LogInfo& so_far);
  void give_temperature(const LogInfo& log);

  CharacterizeOptions options_;  ///< with the segment in samples, once the rate is known
  CharacterizeWorkspace& workspace_;
  std::uint64_t budget_ = 0;
  std::uint64_t bytes_ = 0;        ///< of all samples so far, kept or not
  std::string needs_all_samples_;  ///< what does, if anything
  bool too_long_ = false;          ///< to be kept: streamed, or refused and only counted
  tbb::task_arena arena_;
  std::vector<ChannelStage> stages_;
  CharacterizeOptions temperature_options_;  ///< of the temperature: no phase, no frequency
  std::size_t temperature_index_ = 0;
  std::shared_ptr<const TemperatureRecord> temperature_;
};

/// The second pass, through the channels that asked for it and no others.
class SecondPass final : public BlockSink {
 public:
  SecondPass(ChannelStages& first, std::vector<std::size_t> channels, int threads);
  void begin(const LogInfo& so_far) override;
  void block(const SampleBlock& samples) override;

 private:
  std::vector<ChannelStage>& stages_;
  std::vector<std::size_t> channels_;
  int threads_ = 0;
  tbb::task_arena arena_;
};

}  // namespace libchar
