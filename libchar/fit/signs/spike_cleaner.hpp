#pragma once
// Isolated wild samples: found, left out and counted, in one pass and constant memory. What
// is a spike and what is the tail of the noise is decided at the end, from all that was found.

#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace libchar {

/// Robust standard deviations of a record's three-sample residuals and of its differences, in the
/// channel's unit; 0: there is none, and nothing is looked for.
struct SpikeScale {
  double residual = 0;  ///< of y - (y₋ + y₊)/2
  double step = 0;      ///< of y₊ - y
};

/// Takes a record in pieces of any size and learns the scale from at most 2^14 places spread evenly
/// over it. Steps of zero (a coarse grid, values held) do not count.
class SpikeScan {
 public:
  void push(std::span<const double> samples);
  SpikeScale scale() const;

 private:
  void look(double before, double at, double after);
  std::uint64_t next_ = 0, stride_ = 1;  ///< place that comes next, and the places' distance
  double two_[2] = {0, 0};               ///< the last two samples
  double largest_ = 0;                   ///< |sample| at the places
  std::uint64_t samples_ = 0;
  std::vector<double> residual_, step_;
};

}  // namespace libchar

namespace libchar::detail {

/// Sums of squared first differences. `all`: of all but steps. `near` and `far`: what they would be if the whole
/// distribution were Gaussian like its core. The core's scale is taken from the differences within `kNear` and within
/// `kFar` standard deviations of it.
struct CoreSums {
  static constexpr double kNear = 1.2, kFar = 2.2;
  double count = 0, all = 0, near = 0, far = 0;
  bool operator==(const CoreSums&) const = default;
};

/// Of the differences between neighbours that are both present.
CoreSums core_sums(std::span<const double> record);

/// Variance per sample that outliers add to a record of Gaussian noise: half of what the differences have beyond their
/// core, with its standard deviation. Where the core itself is not Gaussian they are the noise's own tails: none.
/// `expected`: larger ones were left out, so that smaller ones need not be beyond chance.
struct OutlierVariance {
  double variance = 0, sd = 0;
  bool seen = true;  ///< beyond chance by themselves
};
std::optional<OutlierVariance> outlier_variance(const CoreSums& sums, bool expected);

}  // namespace libchar::detail

namespace libchar {
using namespace detail;

/// What was found in a record.
struct SpikeCount {
  std::uint64_t samples = 0;   ///< not missing
  std::uint64_t left_out = 0;  ///< samples of spikes
  std::uint64_t spikes = 0;    ///< beyond six standard deviations and alone
  std::uint64_t shoulder = 0;  ///< between five and six
  std::uint64_t steps = 0;     ///< jumps without a return to the level
  std::uint64_t crowded = 0;   ///< beyond six, but among too many others: a loud stretch
  double log_size = 0;         ///< sum of ln(size / 5 sd) over `spikes` and `shoulder`
  CoreSums with, without;      ///< of the record as it is, and without the spikes
};

enum class SpikeVerdict {
  none,         ///< no isolated outlier
  spikes,       ///< they may be left out
  heavy_tails,  ///< the ends of the noise's own distribution
  too_many,     ///< more than 1 % of the samples
};

/// Are they spikes? Noise with tails as heavy as Student's t of three degrees of freedom passes for
/// spikes in at most 3 % of records, of lighter tails in less.
SpikeVerdict judge_spikes(const SpikeCount& count);

/// For the verdicts that leave something in: why. Else "".
std::string spike_sentence(const SpikeCount& count);

/// Takes samples in pieces of any size and gives them back with the spikes missing (NaN), some
/// fifty samples late, the same whatever the pieces.
class SpikeCleaner {
 public:
  explicit SpikeCleaner(const SpikeScale& scale) : scale_(scale) {}

  /// Cleaned samples that became certain; valid until the next call.
  std::span<const double> push(std::span<const double> samples);
  /// The last ones. The cleaner is done afterwards.
  std::span<const double> finish();

  const SpikeCount& count() const { return count_; }

 private:
  struct Event {
    std::int64_t first = 0, end = 0;
    double size = 0;  ///< in standard deviations
    bool decided = false;
  };
  double at(std::int64_t t) const { return held_[static_cast<std::size_t>(t - base_)]; }
  std::int64_t end() const { return base_ + static_cast<std::int64_t>(held_.size()); }
  double residual(std::int64_t t) const;
  bool back(std::int64_t t) const;
  void examine(bool last);
  void look_at_start();
  void look_at(std::int64_t t, bool last);
  bool look_for_run(std::int64_t t, bool last);
  void look_alone(std::int64_t t);
  void found(std::int64_t first, std::int64_t end, double size);
  void decide(std::int64_t now);
  void release(bool last);

  SpikeScale scale_;
  SpikeCount count_;
  std::vector<double> held_, ready_;
  std::deque<Event> events_;
  std::int64_t base_ = 0;      ///< position of held_[0] in the record
  std::int64_t given_ = 0;     ///< released so far
  std::int64_t now_ = 0;       ///< examined so far
  std::int64_t wild_end_ = 0;  ///< end of the last event
  bool started_ = false, has_good_ = false;
  double good_ = 0;  ///< the last sample that belongs to no event
};

/// A record without its spikes (NaN), by their scale in it, and what was found.
std::vector<double> cleaned_record(std::span<const double> record, SpikeCount& count);

}  // namespace libchar
