#pragma once
// What a replay knows of its array when it begins to run, as the file that applies it holds it.

#include <optional>

#include "libchar/fusion/array.hpp"
#include "libchar/replay/detail/align/aligned_pass.hpp"
#include "libchar/replay/detail/plan/plan.hpp"
#include "libchar/replay/detail/plan/sensor_knowledge.hpp"
#include "libchar/replay/detail/plan/step_noise.hpp"
#include "libchar/replay/fusion_file.hpp"

namespace libchar {

/// Everything but the algorithms. `alignment`: what is taken out of the sensors; none: nothing.
LearntFusion learnt_of(const Scene& scene, const ReplayPlan& plan, const Instants& instants,
                       const SensorKnowledge& knowledge, const SceneAlignment* alignment);

/// Into the sensors that were not left out.
void note_step_noise(const std::vector<std::optional<StepNoise>>& noise, LearntFusion& learnt);

void note_readings(const std::vector<std::optional<LearntSensor::Reading>>& readings, LearntFusion& learnt);

/// What algorithms were told, from the file: an array of the sensors that were not left out.
fusion::Array array_of(const LearntFusion& learnt);

/// The alignment of the file for samples at `rate_hz`, of the sensors at these places.
SceneAlignment alignment_of(const LearntFusion& learnt, const std::vector<std::size_t>& sensors, double rate_hz);

}  // namespace libchar
