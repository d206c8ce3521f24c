#pragma once
// A replay in a few sentences: which algorithm to use, and how sure that is.

#include <string>
#include <vector>

#include "libchar/replay/replay_result.hpp"
#include "libchar/replay/view/ranking.hpp"

namespace libchar {

/// The sentences, the first says which to use. Bounds are never recommended; a method that learns
/// from a reference is named as such, with the best one that does not; unresolved differences are
/// said to be so. `costs`: with what was measured, which differs from run to run.
std::vector<std::string> verdict_sentences(const ReplayResult& result, bool costs);

/// What the optimum of this scene is: "fixed weights", "tilt filters".
std::string optimum_of(const ReplayResult& result);

namespace detail {

/// It learnt from the reference of this replay.
bool learns(const ReplayResult& result, const AlgorithmResult& algorithm);

}  // namespace detail

}  // namespace libchar
