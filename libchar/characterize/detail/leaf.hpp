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

inline constexpr std::uint64_t kSettledHeight = 4;  ///< of the tree's nodes that are settled
inline constexpr std::uint64_t kSettledLeaves = std::uint64_t{1} << kSettledHeight;

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
  /// All must live as long. `options.spectrum.segment` > 0. `samples`: of the whole log.
  LeafStage(const CharacterizeOptions& options, WelchWorkspace& workspace, std::uint64_t samples);

  /// Samples as the log has them; `last`: no leaf follows.
  ChannelSums take(std::span<const double> samples, bool last);
  /// Adds the leaves that follow directly.
  void join(ChannelSums& sums, ChannelSums later);
  /// Of a run of 16 leaves that begins at a multiple of them: of a long log, what grows with its length is made less.
  void settle(ChannelSums& sums, std::uint64_t first_leaf) const;

  static void write_state(const ChannelSums& sums, StateWriter& to);
  ChannelSums read_state(StateReader& from) const;

 private:
  bool wants_fit() const { return options_->wanted.fit || options_->wanted.allan; }
  void fit_parts(std::span<const double> samples, bool last, ChannelSums& sums) const;
  void clean(std::span<const double> samples, bool last, ChannelSums& sums) const;

  const CharacterizeOptions* options_;
  std::uint64_t samples_;
  WelchParts spectrum_;
  std::vector<double> usable_, rate_;  // scratch
};

}  // namespace libchar
