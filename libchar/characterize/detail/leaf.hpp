#pragma once
// A leaf of a log, one channel of it: taken by fresh stages that see nothing else, so that what
// they find depends on its samples only; and two neighbours made one.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "libchar/allan/noise_type.hpp"
#include "libchar/characterize/characterization.hpp"
#include "libchar/core/numeric/leaf_tree.hpp"
#include "libchar/fit/record/record_sums.hpp"
#include "libchar/spectrum/welch_sums.hpp"

namespace libchar {

/// Of the samples as the log has them.
struct SampleMeters {
  QualityMeter quality;
  TraceMeter trace;
  bool traces = true;  ///< else nobody looks at it

  void push(std::span<const double> samples);
};

/// What the stages of a channel have found of a run of leaves.
struct ChannelSums {
  SampleMeters meters;
  /// of a log of one leaf, the samples as it has them in place of the sums below
  std::vector<double> kept;
  WelchSums spectrum;
  RecordSums record;
  DigitalSums digital;
  std::vector<NoiseType> types;  ///< of a clock, by its first leaf
};

/// Of a clock, by the sum of its rate.
std::vector<NoiseType> types_of_rate(std::span<const double> rate, double dt_s);

/// Differences of a phase, a sample fewer.
void difference(std::vector<double>& phase);
ValueCensus census_of(const ChannelQuality& quality);

/// Of a record of more than one leaf, unless another segment is asked for.
inline constexpr std::uint64_t kStreamedSegment = std::uint64_t{1} << 16U;
WelchOptions streamed_spectrum(WelchOptions options);
std::string streamed_segment_note();
/// A record of more than a leaf needs all of its samples at once for its spectrum.
bool spectrum_of_all(const CharacterizeOptions& options);
/// "" or why the spectrum is not one of leaves: its samples must come one leaf after the other.
std::string why_not_in_leaves(const CharacterizeOptions& options);

/// Takes and joins the leaves of a channel.
class LeafStage {
 public:
  using Sums = ChannelSums;

  /// Both must live as long.
  LeafStage(const CharacterizeOptions& options, WelchWorkspace& workspace);

  /// Rows of a leaf that a stage is given: of phase one more, the first of the leaf that follows.
  std::uint64_t rows() const { return kLeafSamples + (is_phase() ? 1 : 0); }
  /// Samples as the log has them; `last`: no leaf follows. `meters` of the leaf.
  ChannelSums take(std::span<const double> samples, bool last, SampleMeters meters);
  /// The same where nobody has metered them.
  ChannelSums take(std::span<const double> samples, bool last);
  /// Samples as a rate: what is no measurement is missing, a frequency about its nominal one, differences of a phase.
  void make_rate(std::vector<double>& samples) const;

  void join(ChannelSums& sums, ChannelSums later);
  void settle(ChannelSums& sums, std::uint64_t height, std::uint64_t first_leaf) const;

  static void write_state(const ChannelSums& sums, StateWriter& to);
  ChannelSums read_state(StateReader& from) const;

 private:
  bool is_phase() const { return options_->data == SampleKind::phase; }
  WelchParts& spectrum() const;
  bool wants_fit() const { return options_->wanted.fit || options_->wanted.allan; }

  const CharacterizeOptions* options_;
  WelchWorkspace* workspace_;
  /// Its plan and window are of 1.5 MB: made for the first leaf, which thousands of short channels never fill.
  mutable std::optional<WelchParts> spectrum_;
  bool wants_spectrum_ = false;  ///< from leaves
  BlockTransforms blocks_;       ///< of the fit, where the spectrum has others
  std::vector<double> rate_;     // scratch
};

using ChannelTree = LeafTree<LeafStage>;
using ChannelNode = LeafNode<ChannelSums>;

}  // namespace libchar
