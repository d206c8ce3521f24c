#pragma once
// What a simulation wrote, for a terminal and for scripts.

#include <string>

#include "libchar/core/document/json.hpp"
#include "libchar/scene/simulated_log.hpp"
#include "libchar/simulate/sensor_array.hpp"

namespace libchar {

/// The log in a line, what each device drew, and the other files.
std::string simulation_text(const ArraySimulation& simulation, const SimulatedLog& written);

/// The keys behind the head of {"format":"simulation","version":1,…} (docs/json.md).
Json simulation_json(const ArraySimulation& simulation, const SimulatedLog& written);

}  // namespace libchar
