#pragma once
// All channels of a log on their way through, as many at a time as memory allows.

#include <string>
#include <vector>

#include "libchar/characterize/detail/channel_stage.hpp"
#include "libchar/core/parallel/parallel.hpp"
#include "libchar/core/process/progress.hpp"
#include "libchar/log/read.hpp"

namespace libchar {

/// A pass over a log: some of its channels side by side, each through a stage of its own.
class ChannelStages final : public BlockSink {
 public:
  /// Of the channels from `first` on as many as memory allows, or all. The workspace must live as
  /// long.
  ChannelStages(const CharacterizeOptions& options,
                CharacterizeWorkspace& workspace,
                std::size_t first,
                bool all);

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

}  // namespace libchar
