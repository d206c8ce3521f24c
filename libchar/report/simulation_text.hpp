#pragma once
// What a simulation wrote, for a terminal and for scripts.

#include <string>
#include <vector>

#include "libchar/core/json.hpp"
#include "libchar/simulate/sensor_array.hpp"

namespace libchar {

/// What a simulation made, and of which draws.
struct SimulationSummary {
  const ArraySimulation* simulation = nullptr;
  std::vector<DeviceDraw> draws;   ///< one a sensor
  std::vector<std::string> files;  ///< written, the log first
  std::size_t channels = 0;        ///< of the log
};

/// The log in a line, what each device drew, and the other files.
std::string simulation_text(const SimulationSummary& summary);

/// The keys behind the head of {"format":"simulation","version":1,…} (docs/json.md).
Json simulation_json(const SimulationSummary& summary);

}  // namespace libchar
