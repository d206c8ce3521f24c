#pragma once
// The plan of a replay in words.

#include <string>
#include <vector>

#include "libchar/replay/detail/plan.hpp"

namespace libchar {

/// The plan in words, a sentence a line.
std::vector<std::string> sentences(const ReplayPlan& plan,
                                   const Scene& scene,
                                   const Instants& instants,
                                   const SensorKnowledge& knowledge);

}  // namespace libchar
