#pragma once
// The table of what consumers ask for: under which key, which noise term, by which formula, in which
// unit. The files (targets/*.cpp) and the report ("which number goes where") take their numbers from
// the same rows. Conventions: docs/exports.md.

#include <numbers>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/core/noise_terms.hpp"

namespace libchar {

/// Degrees in a radian: the files of consumers are in either.
inline constexpr double kDegreesPerRadian = 180 / std::numbers::pi;

/// What factors depend on; a row uses one of them or none.
struct RowTimes {
  double rate_hz = 0;           ///< sampling rate f
  double filter_step_s = 0.01;  ///< prediction step dt of an autopilot's filter
  double bias_tau_s = 0;        ///< averaging time tau of AirSim's bias stability
};

/// One number: factor · coefficient^power, of the coefficient in SI units (in the channel's own unit
/// where `sensor` is "" or "other").
struct ConsumerRow {
  std::string_view consumer;  ///< "Kalibr, EuRoC, OpenVINS"
  std::string_view targets;   ///< export targets whose files hold it: "kalibr euroc openvins"
  std::string_view sensor;    ///< "gyroscope"…; "": any; "other": neither rotation nor acceleration
  std::string_view key;       ///< "gyroscope_noise_density"
  Term term = Term::white;
  int power = 1;             ///< of the coefficient: 1 or 2
  std::string_view formula;  ///< "N·√(2f)"
  double (*factor)(const RowTimes&) = nullptr;
  std::string_view unit;            ///< "rad/s/√Hz"; "U" stands for the channel's own
  std::string_view unit_in_file{};  ///< where the file words it otherwise than `ascii_unit(unit)`
  bool in_report = true;            ///< false: in files only
};

/// All rows, in the order of the report.
std::span<const ConsumerRow> consumer_table();

/// The rows of a target for a kind of sensor, in the order of the table.
std::vector<const ConsumerRow*> rows_of(std::string_view target, std::string_view sensor);

/// The row of a target for a term of a kind of sensor. Throws Error(internal) when there is none.
const ConsumerRow& row_of(std::string_view target, std::string_view sensor, Term term);

/// The number that a coefficient in SI units becomes.
double row_value(const ConsumerRow& row, double coefficient, const RowTimes& times = {});

/// "rad/s^2/sqrt(Hz)" for "rad/s²/√Hz".
std::string ascii_unit(std::string_view unit);

/// The row's unit as in its file.
std::string file_unit(const ConsumerRow& row);

}  // namespace libchar
