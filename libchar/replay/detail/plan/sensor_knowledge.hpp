#pragma once
// What is found out about the sensors before the plan: offsets and noise levels.

#include <string>
#include <vector>

#include "libchar/core/process/progress.hpp"
#include "libchar/replay/detail/align/instants.hpp"

namespace libchar {

/// What was found out about each sensor before the plan.
struct SensorKnowledge {
  std::vector<double> offsets;
  std::vector<double> noise_variances;     ///< NaN: not known
  std::vector<std::string> noise_sources;  ///< "the scene", "the models", "rest", ""
};

/// What the numbers of a sensor's model are multiplied by to be in the unit that its channel is recorded in. Throws
/// Error(usage) where it is of another quantity.
double model_factor(const Scene& scene, const Instants& instants, std::size_t sensor);

/// Measures the rest when the scene has one, and asks scene and models for noise levels.
SensorKnowledge know_sensors(const Scene& scene, const Instants& instants, Progress& progress);

}  // namespace libchar
