#pragma once
// Sensor models for the programs that consume them. One table of targets (targets.cpp), one file
// targets/TARGET.cpp each; nothing here reads or writes files. Conventions and formulas:
// docs/exports.md.

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/core/document/enum_table.hpp"
#include "libchar/export/sensor_group.hpp"

namespace libchar {

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
  double inflate = 1;  ///< every noise number is multiplied by this (before squaring)
  std::optional<double> correlation_s;  ///< of a Gauss-Markov bias; else by `floor_tau_s`
  std::optional<double> floor_tau_s;  ///< averaging time of the flat part of the Allan curve; else
                                      ///< from the coefficients and the valid range of the model
  std::optional<double> bias_tau_s;   ///< of AirSim's bias stability; else its own 500 s and 800 s
  double filter_step_s = 0.01;        ///< PX4 EKF2 and ArduPilot EK3 predict at about this step
  std::optional<double> gravity;      ///< m/s^2, for the consumers that have a key for it
  std::string topic;                  ///< ROS; else that of the recording, else "/imu0"
  bool older = false;  ///< for releases before the current file formats (Basalt, ORB-SLAM3)
  bool anyway =
      false;  ///< also numbers of models whose noise terms do not describe their recording
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
Export export_models(const ExportTarget& target,
                     const std::vector<SensorModel>& models,
                     const ExportOptions& options = {});

}  // namespace libchar
