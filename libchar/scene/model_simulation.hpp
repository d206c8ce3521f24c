#pragma once
// A simulation of the sensors that model files describe, without a scene.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libchar/simulate/sensor_array.hpp"

namespace libchar {

struct ModelSimulationOptions {
  std::optional<double> rate_hz;  ///< none: the models', which then have to agree
  std::uint64_t devices = 1;      ///< of each model, each with its own draws; numbered from 1
};

/// Reads the models; sensors are named by their channel, else by their file. How long, and what is
/// measured, is left to the caller. Throws Error(usage) when the models state several rates, and
/// what reading a model throws.
ArraySimulation simulation_of_models(const std::vector<std::string>& model_files,
                                     const ModelSimulationOptions& options = {});

}  // namespace libchar
