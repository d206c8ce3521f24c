#pragma once
// One channel on its way through: leaf by leaf, and all of its samples besides where something
// needs them.

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "libchar/characterize/detail/channel_finish.hpp"

namespace libchar {

class ChannelStage {
 public:
  /// Both must live as long. `keep`: all samples of a log of more than a leaf, too.
  ChannelStage(const CharacterizeOptions& options, CharacterizeWorkspace& workspace, bool keep);

  /// Takes samples as the log has them.
  void push(std::span<const double> samples);
  /// Room for a record of up to this length, so that growing neither copies nor takes twice the
  /// memory.
  void reserve(std::size_t samples);
  /// Lets go of everything; nothing is computed any more.
  void drop();

  /// All samples, where they are kept.
  std::span<const double> kept() const { return all_; }
  /// What the temperature does is taken out of the record before its noise is fitted.
  void set_temperature(std::shared_ptr<const TemperatureRecord> temperature) {
    temperature_ = std::move(temperature);
  }
  /// Curves and fit, as `finish_channel`. The stage is done.
  ChannelResult finish(const Channel& channel, double rate_hz);

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

}  // namespace libchar
