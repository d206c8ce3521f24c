#pragma once
// A sensor model: what is needed to simulate one sensor (docs/models.md, [RV 2.2]), and where each number came from.
//
//   y = quantize(gain * saturate(low_pass(alpha x + c1 x^2 + c2 x^3 + beta + noise)))
//
// Blocks in order; each is skipped when it is the identity. dT = temperature - reference temperature.

#include <optional>
#include <string>
#include <vector>

#include "libchar/core/coefficient.hpp"
#include "libchar/core/document/enum_table.hpp"
#include "libchar/core/finding.hpp"
#include "libchar/core/noise_terms.hpp"
#include "libchar/core/numeric/interval.hpp"
#include "libchar/core/numeric/noise_shape.hpp"

namespace libchar {

/// A first-order Gauss-Markov (Ornstein-Uhlenbeck) process: standard deviation sigma, correlation time tau, two-sided
/// density S(f) = 2 sigma² tau / (1 + (2 pi f tau)²). Sampled every dt it is
/// y_t = phi y_{t-1} + sigma sqrt(1 - phi²) w_t, phi = exp(-dt/tau).
/// What a simulation needs of it, and what is known of it.
struct GaussMarkovNoise {
  double sigma = 0;                  ///< U; 0: there is none
  double tau_s = 0;                  ///< correlation time
  std::vector<double> sigma_ci95;    ///< [low, high]; empty: not from a fit
  std::vector<double> tau_ci95_s;    ///< [low, high], [low] when the record gives no upper end
  Status status = Status::detected;  ///< undetermined: noise terms alone may explain the record as well
  bool operator==(const GaussMarkovNoise&) const = default;
};

/// Block 1: alpha = N(value, spread) * (1 + tc1 dT + tc2 dT^2), drawn once a device.
struct ScaleFactor {
  double value = 1;       ///< output per input
  double spread = 0;      ///< standard deviation from device to device
  double tc1_per_k = 0;   ///< 1/K
  double tc2_per_k2 = 0;  ///< 1/K^2
  bool operator==(const ScaleFactor&) const = default;
};

/// Block 2: quadratic (1 + tc dT) x^2 + cubic (1 + tc dT) x^3, of the raw input x.
struct Nonlinearity {
  double quadratic = 0;  ///< 1/U
  double quadratic_tc_per_k = 0;
  double cubic = 0;  ///< 1/U^2
  double cubic_tc_per_k = 0;
  bool operator==(const Nonlinearity&) const = default;
};

/// Block 3: beta = N(value, spread) + tc1 dT + tc2 dT^2 + tc3 dT^3, drawn once a device; all in U.
/// dT is that of a first-order lag behind the temperature where there is one.
struct Bias {
  double value = 0;
  double spread = 0;
  double tc1_per_k = 0;   ///< U/K
  double tc2_per_k2 = 0;  ///< U/K^2
  double tc3_per_k3 = 0;  ///< U/K^3
  double lag_s = 0;       ///< time constant of the lag
  bool operator==(const Bias&) const = default;
};

/// Block 8: the output is gain * U, in `unit` (empty: the unit U of the input).
struct Sensitivity {
  double gain = 1;
  std::string unit;
  bool operator==(const Sensitivity&) const = default;
};

/// Filters between the noise and the samples (docs/theory/simulation.md).
enum class NoiseSampling {
  per_sample,    ///< noise is made at the sampling rate and goes through the low-pass with the
                 ///< signal: what the fit assumes
  band_limited,  ///< white noise is continuous, low-passed before sampling: its aliases are in the
                 ///< samples
};

enum class NoiseStart {
  stationary,  ///< flicker has run for ever before the first sample
  zero,        ///< it starts at the first sample, as published [RV app. A]
};

/// Events other than noise in the recording of the model: a mean with a sign, at an instant of
/// that recording. A simulation has it only when asked.
struct DeterministicTerm {
  enum class Kind { step, warm_up, ramp };
  Kind kind = Kind::step;
  double at_s = 0;   ///< step: when, from the first sample
  double size = 0;   ///< in U. step: after less before; warm-up: at the first sample; ramp: over the recording
  double sd = 0;     ///< of `size`
  double tau_s = 0;  ///< warm-up: size exp(-t / tau)
  double per_s = 0;  ///< ramp: U/s
  bool operator==(const DeterministicTerm&) const = default;
};
template <>
inline constexpr auto enum_table<DeterministicTerm::Kind> = enum_words<DeterministicTerm::Kind, "step warm-up ramp">;

struct SensorModel {
  struct Recorded {
    std::string file, sha256;
    std::string topic;  ///< of a ROS bag: "/imu0"
  };
  std::string channel;
  std::string unit;
  std::string kind;  ///< "gyroscope", "accelerometer"…; empty: `kind_of` takes it from the unit
  std::string axis;  ///< "x", "y", "z"; empty: `axis_of` takes it from the channel's name
  double rate_hz = 0;

  ScaleFactor scale_factor;
  Nonlinearity nonlinearity;
  Bias bias;
  double reference_temperature_degc = 25;
  Coefficients noise;             ///< status, value, 95 % interval of the five terms, two-sided densities
  GaussMarkovNoise gauss_markov;  ///< in U, in addition to the terms; sigma 0: none
  double flicker_phase = 0;  ///< of a clock's frequency: differences of flicker over the sampling interval, times this
  NoiseSampling noise_sampling = NoiseSampling::per_sample;
  NoiseStart noise_start = NoiseStart::stationary;
  std::string flicker_method = "recursive";               ///< or "rv-truncated-iir"
  std::optional<double> white_hold_s;                     ///< white noise renewed this often and held, as a
                                                          ///< simulator's band-limited white noise block
  std::optional<double> flicker_hold_s;                   ///< flicker made at this step and held, as published
  NoiseShape noise_shape;                                 ///< multiplies the density of the noise
  std::optional<double> bandwidth_hz;                     ///< first-order low-pass behind the noise
  std::optional<double> saturation_low, saturation_high;  ///< in U
  Sensitivity sensitivity;
  std::optional<double> resolution;  ///< quantization step of the output (LSB), in the output's unit

  std::vector<DeterministicTerm> deterministic;  ///< of the recording

  double mean = 0;  ///< of the recording, removed before analysis: contains the true input at rest
  double tau_min_s = 0,
         tau_max_s = 0;  ///< range of averaging times that the coefficients were fitted on
  std::string obtained;  ///< "fit of a recording", "fit of an Allan curve", "data sheet"
  std::string method;
  Recorded recording;
  double duration_s = 0;
  std::optional<Interval> stretch_s;  ///< of the recording that was used, where that is not all of it
  std::vector<std::string> remarks;   ///< conversions on reading, what a pooled model is of
  std::vector<Finding> findings;      ///< about the recording and the numbers, the worst first

  const Coefficient& operator[](Term t) const { return noise[static_cast<std::size_t>(t)]; }
};

/// The coefficient that a simulation uses: its value, 0 for a term without one.
double simulated_value(const Coefficient& coefficient);

/// "gyroscope", "accelerometer", "magnetometer", "barometer"…, by `kind` or else by the unit's
/// quantity; "sensor" when unknown.
std::string kind_of(const SensorModel& model);

/// "x", "y" or "z", by `axis` or else by the end of the channel's name ("gyr_x", "ax", "Gyro Y
/// [deg/s]", "wz"); empty when it says none.
std::string axis_of(const SensorModel& model);

}  // namespace libchar
