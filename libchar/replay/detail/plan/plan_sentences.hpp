#pragma once
// The plan of a replay in words.

#include <string>
#include <vector>

#include "libchar/replay/detail/plan/plan.hpp"

namespace libchar {

/// The plan in words, a sentence a line.
std::vector<std::string> sentences(const ReplayPlan& plan, const Scene& scene, const Instants& instants,
                                   const SensorKnowledge& knowledge);

/// "kalman-takens: on 16 stretches, 11 % of the evaluation, all of it would take about 44 s".
std::string blind_share_text(const PlannedAlgorithm& algorithm);

}  // namespace libchar
