#pragma once
// What a channel's samples say about the instrument behind them, before any noise analysis.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libchar/core/numeric/state_archive.hpp"
#include "libchar/log/recording.hpp"

namespace libchar {

struct ChannelQuality {
  std::uint64_t samples = 0;  ///< not missing
  std::uint64_t missing = 0;
  std::uint64_t beyond = 0;  ///< of the missing ones: larger than `kLargestSample`, no measurement
  /// the deviation is NaN where its square does not fit into a double
  double mean = 0, standard_deviation = 0, minimum = 0, maximum = 0;
  std::optional<double>
      resolution;  ///< least step between distinct values (LSB), when the values lie on a grid
  std::uint64_t distinct_values = 0;  ///< counted up to 4096, then 4096
  /// samples at the minimum or maximum, where three stand in a row and the value next to it has
  /// less than half as many
  std::uint64_t saturated = 0;
  std::uint64_t longest_stuck = 0;  ///< longest run of one value
  std::uint64_t at_minimum = 0, at_maximum = 0;
  std::uint64_t repeats = 0;       ///< samples that equal the one right before
  double difference_kurtosis = 3;  ///< kurtosis of first differences: 3 Gaussian, above = spikes
  double difference_sd = 0;        ///< standard deviation of first differences
  /// why the channel is a clock or a counter and no measurement ("rises by 1 with every sample"); ""
  /// when it is none
  std::string counter;
  bool float32 = false;     ///< every value is exactly representable in 32 bits
  double float32_step = 0;  ///< spacing of 32-bit floats at the largest magnitude
  std::vector<std::string>
      suggestions;  ///< in sentences ("2 distinct values: quantization-limited, record with more gain")
};

/// Streaming, constant memory; the result does not depend on block boundaries.
class QualityMeter {
 public:
  QualityMeter();
  ~QualityMeter();
  QualityMeter(QualityMeter&&) noexcept;
  QualityMeter& operator=(QualityMeter&&) noexcept;
  void push(std::span<const double> samples);
  ChannelQuality finish() const;

  /// The samples that `later` has seen follow directly: as if they had been pushed here, but for
  /// rounding, and for a counter, which both parts must show.
  void join(const QualityMeter& later);
  void write_state(StateWriter& to) const;
  void read_state(StateReader& from);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// What of a channel's quality makes the recording doubtful for noise analysis, as warnings
/// (read_recording and inspect).
void quality_warnings(const Channel& channel, const ChannelQuality& quality, Warnings& warnings);

/// The sampling rate. Throws Error(numeric) where it is not known.
double known_rate_hz(const LogInfo& info);

}  // namespace libchar
