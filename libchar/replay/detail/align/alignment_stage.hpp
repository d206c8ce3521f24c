#pragma once
// The alignment of a scene: learnt where the scene says, measured on what is judged.

#include "libchar/fusion/alignment_learning.hpp"
#include "libchar/replay/detail/align/aligned_pass.hpp"
#include "libchar/replay/detail/plan/plan.hpp"
#include "libchar/replay/replay_result.hpp"

namespace libchar {

/// Which terms of an alignment pay.
struct TermChoice {
  fusion::AlignmentOptions options;            ///< what is kept
  std::vector<AlignmentResult::Trial> trials;  ///< in their order, the first as recorded; empty: nothing could be tried
  bool any() const { return options.delay || options.bias || options.gain || options.misalignment; }
};

/// Tries the terms that `allowed` names one by one, bias first, then delay (by either interpolation), gain, other axes.
/// A term is learnt on one half of the data and judged on the other, in turns; it is kept where it brings the error of
/// the mean or of learnt weights down by the practical tolerance and lets neither grow. With a truth only.
TermChoice choose_terms(const fusion::AlignmentData& data, const fusion::AlignmentOptions& allowed);

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
