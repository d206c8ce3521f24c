#pragma once
// Sensor models for the programs that consume them. One table of targets (targets.cpp), one file targets/TARGET.cpp
// each; nothing here reads or writes files. Conventions and formulas: docs/exports.md.

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "libchar/core/coefficient.hpp"
#include "libchar/core/document/enum_table.hpp"
#include "libchar/model/sensor_model.hpp"

namespace libchar {
// Models that belong to one device: who is the gyroscope, who the accelerometer, and which axis each model speaks of.

/// One model in its place, and the factor that brings its unit to rad/s, m/s^2, T, Pa…
struct PlacedModel {
  const SensorModel* model = nullptr;
  double to_si = 1;
};

/// The models of one kind along x, y and z.
struct SensorTriad {
  std::string kind;     ///< "gyroscope", "accelerometer", "magnetometer"
  std::string si_unit;  ///< "rad/s", "m/s^2", "T"
  std::array<std::optional<PlacedModel>, 3> axis;
  bool shared = false;  ///< one model without an axis stands for all three
};

struct SensorGroup {
  std::optional<SensorTriad> gyroscope, accelerometer, magnetometer;
  std::vector<const SensorModel*> others;  ///< barometers, thermometers, unknown ones
  std::vector<const SensorModel*> all;     ///< in the order given
  std::vector<std::string> unexpressed;    ///< what the models hold and the file they go to cannot say
};

/// What the user says of a channel that neither its name nor its unit says: ("imu_3", "gx"). Places
/// are gx gy gz, ax ay az, mx my mz, and g, a, m for one model that stands for all three axes.
using AxisOverrides = std::vector<std::pair<std::string, std::string>>;

/// Sorts the models (which must outlive the group). Throws Error(input) when two claim one place, when a model among
/// several says no axis, or when its unit is not that of its kind; Error(usage) for an override that names no channel
/// or no place. Axes may be missing: `require_axes` asks for them.
SensorGroup group_sensors(const std::vector<SensorModel>& models, const AxisOverrides& overrides);

/// Throws Error(input) unless all three axes (or the one named by `only`, 0…2) have a model.
void require_axes(const SensorTriad& triad, std::optional<std::size_t> only);

enum class AxisChoice {
  automatic,  ///< each axis its own number where the consumer takes three, else the largest
  max,
  rms,
  x,
  y,
  z,
};

template <>
inline constexpr auto enum_table<AxisChoice> = enum_words<AxisChoice, "auto max rms x y z">;

struct ExportOptions {
  AxisChoice axes = AxisChoice::automatic;
  double inflate = 1;                   ///< every noise number is multiplied by this (before squaring)
  std::optional<double> correlation_s;  ///< of a Gauss-Markov bias; else by `floor_tau_s`
  std::optional<double> floor_tau_s;    ///< averaging time of the flat part of the Allan curve; else
                                        ///< from the coefficients and the valid range of the model
  std::optional<double> bias_tau_s;     ///< of AirSim's bias stability; else its own 500 s and 800 s
  double filter_step_s = 0.01;          ///< PX4 EKF2 and ArduPilot EK3 predict at about this step
  std::optional<double> gravity;        ///< m/s^2, for the consumers that have a key for it
  std::string topic;                    ///< ROS; else that of the recording, else "/imu0"
  bool older = false;                   ///< for releases before the current file formats (Basalt, ORB-SLAM3)
  bool anyway = false;                  ///< also numbers of models whose noise terms do not describe their recording
  AxisOverrides axis;
};

struct Export {
  std::string text;                ///< the file
  std::vector<std::string> notes;  ///< what was converted, replaced or left out
};

enum class ExportNeeds {
  gyroscope_and_accelerometer,
  gyroscope_or_accelerometer,
  any_sensor,
};

/// "gyroscope and accelerometer", "gyroscope or accelerometer", "any sensor".
std::string needs_text(ExportNeeds needs);

/// What a target can do something with, beyond the models that it needs.
struct ExportTakes {
  bool inflate = true;        ///< `ExportOptions::inflate`; false: numbers are written as they are
  bool low_pass = false;      ///< the file can say that a sensor has one
  bool magnetometer = false;  ///< in addition to the gyroscope and the accelerometer
  bool gauss_markov = false;  ///< `correlation_s`, `floor_tau_s`
  bool bias_tau = false;      ///< `bias_tau_s`
  bool filter_step = false;   ///< `filter_step_s`
  bool gravity = false;
  bool topic = false;
  bool older = false;
  bool status = false;  ///< the file says of each number how it is known
};

struct ExportTarget {
  std::string_view name;        ///< the word for it in options: "kalibr"
  std::string_view title;       ///< who reads it
  std::string_view convention;  ///< one line: units, discrete or continuous, formulas
  std::string_view file;        ///< name that the consumer's users give it
  ExportNeeds needs;
  std::string_view terms;  ///< letters of the noise terms that the file can express
  ExportTakes takes;
  Export (*write)(const SensorGroup&, const ExportOptions&);
};

/// All targets, in the order of the documentation.
std::span<const ExportTarget> export_targets();

/// "kalibr, openvins": the targets that declare `option`, such as `&ExportTakes::topic`.
std::string targets_that_take(bool ExportTakes::*option);

/// Throws Error(usage) with the nearest name.
const ExportTarget& find_export_target(std::string_view name);

/// Throws Error(input) when models are missing or lack a number or a unit that the consumer needs.
Export export_models(const ExportTarget& target, const std::vector<SensorModel>& models,
                     const ExportOptions& options = {});

// Which number goes where: the same coefficients in the units and under the names of the programs
// and papers that ask for them (docs/exports.md). Only N, K and B are exchanged;
// everything else follows by the formula shown. The rows: detail/consumer_rows.hpp.

struct ConsumerNumber {
  std::string consumer;  ///< "Kalibr, EuRoC, OpenVINS"
  std::string key;       ///< "gyroscope_noise_density"
  std::string formula;   ///< "N"
  std::string value;     ///< to be read, "≤" in front when it is an upper limit
  std::string unit;
};

/// Rows for a channel of known quantity; for other channels those that need no convention. Empty without white noise.
std::vector<ConsumerNumber> consumer_numbers(const Coefficients& coefficients, const std::string& unit, double rate_hz);

}  // namespace libchar
