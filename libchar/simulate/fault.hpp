#pragma once
// Faults that a sensor shows over an interval, injected into simulated or recorded samples.

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "libchar/core/document/enum_table.hpp"
#include "libchar/simulate/random.hpp"

namespace libchar {

enum class FaultKind {
  scale,       ///< y * value
  bias,        ///< y + value
  ramp,        ///< y + value * (t - from), value in U/s
  stuck,       ///< the last sample before the fault, held
  saturation,  ///< clamped to +-value
  noise,       ///< y + white noise of standard deviation `value`
  dropout,     ///< missing
};

struct SensorFault {
  std::size_t sensor = 0;  ///< index into the sensors of the scene
  FaultKind kind = FaultKind::bias;
  double value = 0;
  double from_s = 0;
  /// the first sample at or after it is healthy again
  double to_s = std::numeric_limits<double>::infinity();
};

template <>
inline constexpr auto enum_table<FaultKind> = enum_words<FaultKind, "scale bias ramp stuck saturation noise dropout">;

/// Applies the faults of one sensor to consecutive blocks, in the order of the list.
class FaultInjector {
 public:
  FaultInjector(std::vector<SensorFault> faults, double rate_hz, std::uint64_t seed, std::uint64_t sensor);
  bool idle() const { return faults_.empty(); }
  /// `y` holds the samples that follow those of the last call.
  void apply(std::span<double> y);

 private:
  std::vector<SensorFault> faults_;
  std::vector<DeviateStream> noise_;
  double rate_hz_;
  std::uint64_t done_ = 0;
  /// last sample outside every stuck fault
  double last_ = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace libchar
