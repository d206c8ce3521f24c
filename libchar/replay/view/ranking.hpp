#pragma once
// The algorithms of a replay in order: best first, on a front of error against cost, or skipped.

#include <string>
#include <vector>

#include "libchar/replay/replay_result.hpp"

namespace libchar {

/// Those that ran, best first; those without a score behind.
std::vector<const AlgorithmResult*> ranked(const ReplayResult& result);

/// The same by the RMSE of one input; those that have no estimate of it are left out.
std::vector<const AlgorithmResult*> ranked_by_input(const ReplayResult& result, std::size_t input);

/// Why algorithms did not run: a reason and the labels it holds for.
struct SkippedAlgorithms {
  std::string reason;
  std::vector<std::string> labels;
};
std::vector<SkippedAlgorithms> skipped_algorithms(const ReplayResult& result);

/// On the front of error against a cost: no other method is at least as good in both and better in
/// one. Bounds are not on it and do not dominate.
struct ParetoFront {
  std::vector<bool> time, memory;  ///< one per algorithm
};
ParetoFront pareto_front(const ReplayResult& result);

// A replay in a few sentences: which algorithm to use, and how sure that is.

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
