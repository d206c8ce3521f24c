#pragma once

#include <string>

#include "libchar/characterize/characterization_view.hpp"
#include "libchar/characterize/limits.hpp"
#include "libchar/core/document/json.hpp"
#include "libchar/core/text/text_table.hpp"
#include "libchar/fit/fit_result.hpp"
#include "libchar/log/inspection.hpp"
#include "libchar/log/recording.hpp"
#include "libchar/model/sensor_model.hpp"
#include "libchar/scene/simulated_scene.hpp"
#include "libchar/simulate/sensor_array.hpp"

namespace libchar {

/// A characterization in text, for a terminal: the recording in a line, then each channel's fit, what
/// a verification found, and why something is absent.
std::string characterization_text(const CharacterizationView& view, const TextLook& look = {});
std::string characterization_text(const Characterization& result, const TextLook& look = {});

// A fit in text, for a terminal.

/// One channel's noise coefficients as a table, with what was done to the data and what to think of the fit.
/// `width`: characters in a line that its table is fitted to; 0: any.
std::string fit_text(const Channel& channel, const NoiseFit& fit, const TextLook& look = {});

// The judgement of limits for a terminal.

std::string limits_text(const LimitReport& report, const TextLook& look = {});

/// What is in a log, in text, for a terminal: how it was read, what was guessed and repaired, and one line per channel.
std::string inspection_text(const Inspection& inspection, std::size_t width = 0);

// What a simulation wrote, for a terminal and for scripts.

/// The log in a line, what each device drew, and the other files.
std::string simulation_text(const ArraySimulation& simulation, const SimulatedLog& written);

/// The keys after the head of {"format":"simulation","version":1,…} (docs/json.md).
Json simulation_json(const ArraySimulation& simulation, const SimulatedLog& written);

/// A sensor model in text, for a terminal: its terms with intervals, and the same in the units of data sheets.
std::string model_text(const SensorModel& model, const TextLook& look = {});

}  // namespace libchar
