#pragma once
// A leaf of a log, one channel of it: taken by fresh stages that see nothing else, so that what they find depends on its samples only;
// and two neighbours made one.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "libchar/allan/allan_pyramid.hpp"
#include "libchar/allan/allan_sums.hpp"
#include "libchar/characterize/characterization.hpp"
#include "libchar/fit/power_sums.hpp"
#include "libchar/fit/spike_cleaner.hpp"
#include "libchar/spectrum/welch_sums.hpp"

namespace libchar {

/// What is fitted.
struct FittedSums {
  AllanSums allan;
  PowerSums bins;
};

/// What the stages of a channel have found of a run of leaves.
struct ChannelSums {
  std::uint64_t beyond = 0;  ///< samples that are no measurement
  QualityMeter quality;
  TraceMeter trace;
  AllanSums allan;
  WelchSums spectrum;
  PowerSums bins;
  /// with the spikes left out of the leaves that have some; none: no leaf has, and these would be those above
  std::optional<FittedSums> cleaned;
  SpikeCount spikes;
};

/// Takes and joins the leaves of a channel.
class LeafStage {
 public:
  /// All must live as long. `options.spectrum.segment` > 0.
  LeafStage(const CharacterizeOptions& options, WelchWorkspace& workspace);

  /// Samples as the log has them; `last`: no leaf follows.
  ChannelSums take(std::span<const double> samples, bool last);
  /// Adds the leaves that follow directly.
  void join(ChannelSums& sums, ChannelSums later);

  /// What is written is let go of.
  static void write_state(ChannelSums sums, StateWriter& to);
  ChannelSums read_state(StateReader& from) const;

 private:
  bool wants_fit() const { return options_->wanted.fit || options_->wanted.allan; }
  void fit_parts(std::span<const double> samples, bool last, ChannelSums& sums) const;
  void clean(std::span<const double> samples, bool last, ChannelSums& sums) const;

  const CharacterizeOptions* options_;
  WelchParts spectrum_;
  std::vector<double> usable_, rate_;  // scratch
};

}  // namespace libchar
