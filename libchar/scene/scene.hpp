#pragma once
// A scene: a recording (or a simulation of one) plus what is known about it (docs/scenes.md).

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/core/document/document.hpp"
#include "libchar/core/finding.hpp"
#include "libchar/log/read.hpp"
#include "libchar/simulate/fault.hpp"
#include "libchar/simulate/sensor_array.hpp"

namespace libchar {

struct SceneSensor {
  std::string name;                  ///< unique in the scene
  std::string channel;               ///< of the recording; the name when the file does not say
  std::optional<SensorModel> model;  ///< inline or from a file next to the scene
  std::vector<double> h = {1};       ///< row of the observation matrix
  double scale = 1;                  ///< the recording's samples are multiplied by it on reading
  /// Of the samples after `scale`; empty: what the recording says, which another scale makes untrue.
  std::string unit = {};
  /// Standard deviation of a sample's noise, in the unit after `scale`.
  std::optional<double> noise = std::nullopt;
  std::vector<std::string> cross = {};  ///< channels of the same device's other axes
};

/// Which sensors (by index) a tilt filter reads: tilt = atan2(accelerometer_x, accelerometer_z).
struct SceneTilt {
  std::size_t gyroscope = 0, accelerometer_x = 0, accelerometer_z = 0;
};

/// A stretch of the recording, in seconds from its first sample.
struct TimeWindow {
  double from_s = 0;
  double to_s = std::numeric_limits<double>::infinity();
};

struct SceneReference {
  /// One a truth input; or several whose mean is the truth (`mean`).
  std::vector<std::string> channels;
  bool mean = false;
  std::optional<std::string> recording;  ///< a log of its own (resolved path), else the scene's
  ReadOptions reading;                   ///< of that log
  double lag_s = 0;                      ///< the sensors lag the reference by this
  bool estimate_lag = false;
  double offset = 0;             ///< offset relative to the sensors; in its own unit
  bool estimate_offset = false;  ///< found in the learning window, else in the evaluation
  /// A mean over the interval after the stamp, before it or around it; the value at the stamp.
  static constexpr std::string_view kReadings[] = {"mean_after", "mean_before", "mean_centred", "instant"};
  /// What the values of one that is slower than the sensors stand for: of kReadings, or estimate.
  std::string samples = "estimate";
  /// false: nothing is learnt from it unless a window is said; else the first half of a recording teaches where
  /// neither windows nor an alignment are.
  bool teach = true;
};

/// What all sensors and the reference go through alike, before anything is learnt or fused.
struct ScenePreparation {
  std::string detrend = "none";  ///< of kDetrends: what is subtracted from each, of the whole recording
  double from_hz = 0;            ///< corner of a high-pass; 0: no filter
  double to_hz = 0;              ///< corner of a low-pass behind it; 0: none
  bool filters() const { return from_hz > 0; }
};
inline constexpr std::string_view kDetrends[] = {"none", "mean", "line"};

/// What is taken out of the sensors before they are fused.
struct SceneAlign {
  std::string learn;                 ///< rest, learning, run; empty: `window`
  std::optional<TimeWindow> window;  ///< learnt there
  std::vector<std::string> terms;    ///< of kAlignTerms; empty: all (bias only without `rest`)
  std::string by;                    ///< reference, sensors; empty: the reference if there is one
  std::string interpolation = "sinc";
  bool choose = false;  ///< terms are tried one by one and taken where they pay on the other half of the window
  bool apply = true;    ///< false: the error budget alone, algorithms see the samples as recorded
};
inline constexpr std::string_view kAlignTerms[] = {"delay", "bias", "gain", "misalignment"};

struct SceneAlgorithm {
  std::string name;
  std::vector<std::pair<std::string, double>> options;  ///< numbers, as the algorithm's table names them
  int line = 0, column = 0;
};

/// What a simulated recording is known to hold; nothing of it is injected again.
struct SimulatedFrom {
  std::uint64_t seed = 1;
  std::vector<SensorFault> faults;
  std::uint64_t oversampling = 1;  ///< says how much noise its models gave a sample
  bool truth_columns = true;       ///< the log has those of the true inputs and of the temperature
  bool deterministic = false;      ///< with the steps, warm-ups and ramps of the models' recordings
  /// Weights of the true inputs, sensor after sensor, where the scene's rows h are others: its
  /// reference names some inputs only.
  std::vector<double> rows;
  std::vector<std::string> command;  ///< that simulated it, without the program; for people
  /// The whole simulation, which makes the log again. Empty in older scenes, and where a true input
  /// comes from a log that nobody asked to read.
  std::optional<ArraySimulation> simulation;
};

struct Scene {
  std::string file;         ///< of the scene
  std::string sha256;       ///< of its file; "" where none was read
  std::uint64_t bytes = 0;  ///< of its file
  std::string name;
  std::string recording;              ///< resolved path; empty for a simulation
  ReadOptions reading;                ///< rate, delimiter, names… of the recording
  std::optional<double> resample_hz;  ///< uneven stamps: interpolated to this rate
  std::optional<ArraySimulation> simulate;
  std::vector<SceneSensor> sensors;
  std::optional<SceneReference> reference;
  std::optional<SceneTilt> tilt;  ///< then the reference is the tilt, and rows h say nothing
  std::optional<TimeWindow> learning, evaluation;
  std::optional<TimeWindow> rest;      ///< the true inputs are zero there
  std::optional<double> fault_free_s;  ///< time from the start of the evaluation in which no sensor fails
  /// From the start of the evaluation: run, but not scored.
  std::optional<double> warm_up_s;
  std::vector<SensorFault> faults;
  std::optional<SimulatedFrom> simulated;  ///< of a recording that `simulate` wrote
  std::optional<SceneAlign> align;
  ScenePreparation preparation;
  std::vector<SceneAlgorithm> algorithms;  ///< empty: all whose needs the scene meets
  std::vector<std::string> files;          ///< every file that was named and found, resolved
  Findings warnings;
};

inline constexpr std::size_t kMostSensors = 10000;

}  // namespace libchar
