#pragma once
// The front door: what the program does with one log or one scene, as functions. docs/library.md
// walks through it and names the headers of the rest.
//
//   - inspect        what a log holds                          log/inspection.hpp
//   - characterize   curves, noise model and checks of a log   characterize/characterization.hpp
//   - fit            noise coefficients of samples in memory   here
//   - simulate       samples from sensor models                here
//   - replay         fusion algorithms on a scene              replay/replay.hpp
//   - fleet_lot      many devices side by side                 lot/fleet_lot.hpp
//   - export_models  models for the programs that take them    export/exports.hpp
//
// Times are in s, frequencies in Hz, samples in the unit of their channel; NaN marks a missing
// sample. Whatever a user can get wrong is thrown as Error (core/error.hpp).

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/allan/allan_deviation.hpp"
#include "libchar/allan/allan_pyramid.hpp"
#include "libchar/characterize/characterization.hpp"
#include "libchar/characterize/compare/verification.hpp"
#include "libchar/characterize/judgement.hpp"
#include "libchar/characterize/model_from_fit.hpp"
#include "libchar/characterize/stretches.hpp"
#include "libchar/core/document/json.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/file/whole_file.hpp"
#include "libchar/core/process/progress.hpp"
#include "libchar/core/process/version.hpp"
#include "libchar/export/exports.hpp"
#include "libchar/fit/curve/curve_fit.hpp"
#include "libchar/fit/noise_fit.hpp"
#include "libchar/fit/signs/digital.hpp"
#include "libchar/fit/signs/events.hpp"
#include "libchar/fit/signs/motion.hpp"
#include "libchar/fusion/registry.hpp"
#include "libchar/log/formats.hpp"
#include "libchar/log/inspection.hpp"
#include "libchar/log/read.hpp"
#include "libchar/log/write.hpp"
#include "libchar/model/model_file.hpp"
#include "libchar/replay/replay.hpp"
#include "libchar/replay/view/ranking.hpp"
#include "libchar/report/compare/comparison_text.hpp"
#include "libchar/report/html/fleet_report.hpp"
#include "libchar/report/html/html_report.hpp"
#include "libchar/report/replay/replay_text.hpp"
#include "libchar/report/text/curves_text.hpp"
#include "libchar/scene/scene_file.hpp"
#include "libchar/simulate/sensor_array.hpp"
#include "libchar/spectrum/welch.hpp"

namespace libchar {

/// Noise coefficients of a record in memory, with the Allan curve as second opinion unless the options
/// decline it. Throws Error(numeric) when the record is too short.
NoiseFit fit(std::span<const double> record, double rate_hz, const FitOptions& options = {});

/// A sensor model for each channel that could be fitted.
std::vector<SensorModel> sensor_models(const Characterization& result);

struct SimulateOptions {
  double duration_s = 3600;
  double rate_hz = 0;  ///< 0: the model's own
  std::uint64_t seed = 1;
  std::uint64_t devices = 1;          ///< of the same model, each with its own noise
  SignalSpec truth = SignalSpec{};    ///< what the sensors measure; standard: zero
  std::vector<SensorFault> faults{};  ///< `sensor` counts the devices from 0
};

/// Devices of one model in memory, the truth as last channel. The same seed gives the same samples on
/// every machine. Throws Error(input) when neither the model nor the options say a rate.
Recording simulate(const SensorModel& model, const SimulateOptions& options = {});

/// Any array in memory: its sensors, the true signals, the temperature if there is one. Long ones
/// stream through ArraySimulator.
Recording simulate(const ArraySimulation& array);

/// Writes a recording; the format goes by the suffix (.csv, .npy, or raw with a sidecar).
void write_recording(const std::string& path, const Recording& recording, const WriteOptions& options = {});

/// As the other `export_models`, by the target's name ("kalibr"). Throws Error(usage) for an unknown one.
Export export_models(std::string_view target, const std::vector<SensorModel>& models,
                     const ExportOptions& options = {});

}  // namespace libchar
