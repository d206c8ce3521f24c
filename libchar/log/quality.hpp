#pragma once
// What a channel's samples say about the instrument behind them, before any noise analysis.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "libchar/core/hidden.hpp"
#include "libchar/core/numeric/halving.hpp"
#include "libchar/core/numeric/state_archive.hpp"
#include "libchar/log/recording.hpp"

namespace libchar {

struct ChannelQuality {
  /// Kinds of values other than measurements.
  struct Signs {
    /// why the channel is a clock or a counter ("rises by 1 with every sample"); "" otherwise
    std::string counter;
    /// jumps by the whole range: a phase or an angle that starts again at the other end
    std::uint64_t wraps = 0;
    double period = 0;          ///< of them, with as many digits as the jumps agree in
    std::vector<double> marks;  ///< extremes that look like marks for missing values
    std::vector<double> ends;   ///< saturated extremes
    bool apart = false;         ///< no value comes near one of them: ends of the range, or marks
    double resting_value = 0;   ///< the first that was repeated eight times
    std::uint64_t at_rest = 0;  ///< samples at it from there on; 0: no value did
    /// runs of one value of eight and more, and the samples in them that only repeat
    std::uint64_t frozen_runs = 0, frozen = 0;
    using Place = std::pair<std::uint64_t, std::uint64_t>;  ///< from, to: samples of the record
    std::vector<Place> frozen_at;                           ///< the first ones
    /// longest runs of one value
    struct Longest {
      /// of a hundred and more: left by a usual step, and by a jump or not at all
      std::uint64_t rest = 0, jump = 0;
      std::uint64_t second = 0;  ///< but for the longest one
    } longest;
    /// on straight lines, of `least` steps and more, as chance does not give them
    struct Lines {
      std::uint64_t runs = 0, samples = 0, least = 0;
      std::vector<Place> at;
      bool throughout = false;  ///< straight lines between samples, and nothing nearly straight
    } lines;
    double roughness = 0;             ///< mean square of second differences over that of the first
    double held_times = 1;            ///< each value is recorded, on average, where a slower sensor was polled
    std::uint64_t marked = 0;         ///< samples at `marks`
    std::uint64_t other_repeats = 0;  ///< samples that equal the one before and are not 0
    std::uint64_t zeros = 0;          ///< samples that are exactly 0
    bool zero_is_end = false;         ///< of the range, with values on the way to it
    double nearest_to_zero = 0;       ///< least magnitude of the others
  };
  std::uint64_t samples = 0;  ///< not missing
  std::uint64_t missing = 0;
  std::uint64_t beyond = 0;  ///< of the missing ones: larger than `kLargestSample`, no measurement
  /// the deviation is NaN where its square does not fit into a double
  double mean = 0, standard_deviation = 0, minimum = 0, maximum = 0;
  std::optional<double> resolution;   ///< least step between distinct values (LSB), when the values lie on a grid
  std::uint64_t distinct_values = 0;  ///< counted up to 4096, then 4096
  /// samples at the minimum or maximum, if three are consecutive and the value next to it has less than half as many
  std::uint64_t saturated = 0;
  std::uint64_t longest_stuck = 0;  ///< longest run of one value
  std::uint64_t at_minimum = 0, at_maximum = 0;
  std::uint64_t repeats = 0;       ///< samples that equal the one right before
  double difference_kurtosis = 3;  ///< kurtosis of first differences: 3 Gaussian, above = spikes
  double difference_sd = 0;        ///< standard deviation of first differences
  Signs signs;
  bool float32 = false;           ///< every value is exactly representable in 32 bits
  double float32_step = 0;        ///< spacing of 32-bit floats at the largest magnitude
  std::vector<Finding> findings;  ///< what makes the samples doubtful
};

/// Streaming, constant memory; the result does not depend on block boundaries.
class QualityMeter {
 public:
  QualityMeter();
  void push(std::span<const double> samples);
  /// `rate_hz`: for the times in findings; 0: without them.
  ChannelQuality finish(double rate_hz = 0) const;

  /// The samples that `later` has seen follow directly: as if they had been pushed here, but for
  /// rounding, and for a counter, which both parts must show.
  void join(const QualityMeter& later);
  void write_state(StateWriter& to) const;
  void read_state(StateReader& from);

 private:
  struct State;
  detail::Hidden<State> state_;
};

/// A record small enough to be drawn: the least and the largest value of each of a few hundred blocks, in one pass and
/// constant memory.
struct Trace {
  std::uint64_t block = 1;  ///< samples in each
  /// Of each block, from the record's first sample on; NaN where all of it is missing. The last may be shorter.
  std::vector<double> low, high;
  std::vector<std::uint64_t> missing;  ///< samples of each
};

/// Takes a record in pieces of any size. Blocks have a power of two of samples: 400 to 800 hold any longer record.
class TraceMeter {
 public:
  void push(std::span<const double> samples) { all_.push(samples); }
  Trace finish(std::size_t most = kMost) const;  ///< of no more blocks than that
  std::uint64_t samples() const { return all_.samples(); }
  void join(TraceMeter later) { all_.join(std::move(later.all_)); }
  void write_state(StateWriter& to) const { all_.write_state(to); }
  void read_state(StateReader& from) { all_.read_state(from, "the trace of a channel"); }

 private:
  struct Block {
    double low = __builtin_inf(), high = -__builtin_inf();
    std::uint64_t missing = 0;
    void take(std::span<const double> samples);
    void join(const Block& later);
    static void layout(auto& at, auto& block) { at(block.low, block.high, block.missing); }
  };

  static constexpr std::size_t kMost = 800;
  detail::Halving<Block, kMost> all_;
};

namespace detail {
/// Values in a row: no noise of many levels repeats so often.
inline constexpr std::uint64_t kFrozenRun = 8;
/// Samples of a run of one value from which on the sensor or the link hung; 0: none, or of a quantity that may rest.
std::uint64_t frozen_run(const ChannelQuality& quality);
/// `fewest` and more equal samples in a row are missing.
void forget_frozen(std::span<double> samples, std::uint64_t fewest);
/// So are those inside of straight lines of `fewest` samples and more; the ends of a line are samples.
void forget_lines(std::span<double> samples, std::uint64_t fewest);
/// What gives a log without a rate one: a column that could be its time, where it has one, and a stated rate.
std::string rate_remedy(const TimeBase& time);
}  // namespace detail

/// The sampling rate. Throws Error(numeric) where it is not known.
double known_rate_hz(const LogInfo& info);

}  // namespace libchar
