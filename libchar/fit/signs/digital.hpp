#pragma once
// What the converter and the link did to the samples: rails, repeated values, steps of the converter above the noise.

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "libchar/core/finding.hpp"
#include "libchar/core/numeric/state_archive.hpp"
#include "libchar/fit/fit_result.hpp"

namespace libchar {

/// Samples at the largest or smallest value, more than a tail of noise puts there.
struct Rail {
  double value = 0;
  bool high = true;
  double share = 0;  ///< of the samples
};

/// Every value is recorded several times: the log is polled faster than the sensor gives values.
struct HeldValues {
  double times = 1;           ///< on average
  double sensor_rate_hz = 0;  ///< rate of the log / times
};

/// The noise of a sample is less than the converter's step.
struct Staircase {
  double step = 0;
  double noise = 0;  ///< standard deviation between samples; an upper bound where `bounded`
  bool bounded = false;
};

struct DigitalFaults {
  /// Rounding to a step that is coarse against the differences of samples, and fine against their noise: independent
  /// from sample to sample, white noise behind the sensor's.
  struct Rounding {
    double step = 0;
    double variance = 0;     ///< of a sample
    double sd = 0;           ///< of `variance`: it depends on where between two steps the mean is
    bool of_counts = false;  ///< the noise is skewed, as counts are that nobody rounded
  };
  std::vector<Rail> rails;
  std::optional<HeldValues> held;
  std::optional<Staircase> staircase;
  std::optional<Rounding> rounding;  ///< none where it is not white
  std::vector<Finding> findings;
};

/// Extremes of a record, how often it is at them, and how often it repeats a value.
struct ValueCensus {
  double low = 0, high = 0;  ///< low > high: no value at all
  std::uint64_t at_low = 0, at_high = 0, repeats = 0;
  double held_times = 1;  ///< that each value is recorded, where the log is faster than the sensor
};

/// Samples of a leaf, or of several, at rails.
struct DigitalSums {
  struct AtRail {
    double value = 0;
    double count = 0;  ///< 0: no rail
  };
  /// Samples at zero and at the two steps on both sides of it, where values of both signs are.
  struct AtZero {
    double step = 0;  ///< least distance from zero; 0: nothing was counted
    double zeros = 0, nearest = 0, next = 0;
  };
  /// Second differences of samples that lie on a coarse grid: sums of squares and cubes.
  struct Skew {
    double count = 0, squares = 0, cubes = 0;
  };
  double present = 0;
  AtRail low, high;
  AtZero zero;
  Skew skew;
};

/// `census` of the same samples, and how many of them are missing.
DigitalSums digital_sums(std::span<const double> samples, const ValueCensus& census, std::uint64_t missing);
/// Adds those of the leaf that follows.
void join(DigitalSums& sums, const DigitalSums& later);
void write_state(const DigitalSums& sums, StateWriter& to);
DigitalSums read_digital_sums(StateReader& from);

/// `step`: the least step between values, where they lie on a grid (ChannelQuality's `resolution`). `census` of the
/// record. No finding in a record of noise that is sampled and rounded finely, whatever its length.
DigitalFaults find_digital_faults(const DigitalSums& sums, const ValueCensus& census, double rate_hz,
                                  std::optional<double> step = {}, std::string_view unit = {});

/// Coefficients of a record that shows the converter's rounding (a staircase) or its rails instead
/// of the noise are a misfit: their intervals reach to what the noise may be.
void doubt_digital(const DigitalFaults& faults, NoiseFit& fit);

namespace detail {
/// Of the readings of a phase: where most repeat the one before, their rounding hides the noise of the clock.
/// `resolution`: the counter's step; `unit`: of both.
std::optional<Finding> find_coarse_counter(const ValueCensus& census, std::uint64_t samples,
                                           std::optional<double> resolution, std::string_view unit);
}  // namespace detail

}  // namespace libchar
