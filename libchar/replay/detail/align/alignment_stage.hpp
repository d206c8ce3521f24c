#pragma once
// The alignment of a scene: learnt where the scene says, measured on what is judged.

#include "libchar/replay/detail/align/aligned_pass.hpp"
#include "libchar/replay/detail/plan/plan.hpp"
#include "libchar/replay/replay_result.hpp"

namespace libchar {

/// Throws Error(input) for a window outside the recording and for several true inputs,
/// Error(numeric) when nothing can be learnt there. A long window is learnt from 64 stretches of it.
SceneAlignment learn_scene_alignment(const Scene& scene, const ReplayPlan& plan, const Instants& instants,
                                     Progress& progress);

/// Takes the terms that pay into the scene's alignment (`choose`); it is applied where there is one. Nothing to learn
/// from there: no trials.
std::vector<AlignmentResult::Trial> choose_scene_terms(Scene& scene, const ReplayPlan& plan, const Instants& instants,
                                                       Progress& progress);

/// What the alignment is, and the error budget of the run.
AlignmentResult measure_alignment(const Scene& scene, const ReplayPlan& plan, const Instants& instants,
                                  const SceneAlignment& alignment, Findings& warnings, Progress& progress);

}  // namespace libchar
