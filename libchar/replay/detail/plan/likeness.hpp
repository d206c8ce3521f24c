#pragma once
// Are two reports replays of one scene, and what else differs?

#include <string>
#include <vector>

#include "libchar/replay/comparison.hpp"

namespace libchar {

/// Names beyond so many are only counted.
inline constexpr std::size_t kMostNamed = 4;

/// Why these are not two replays of one scene, a sentence each; empty: they are.
std::vector<std::string> unlike(const ReplayReport& a, const ReplayReport& b);

/// What differs and makes no other scene of it: learning window, options, noise levels, program.
std::vector<std::string> remarks(const Comparison& comparison);

}  // namespace libchar
