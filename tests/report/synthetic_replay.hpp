#pragma once
// Results of a replay made from formulas and a seed: what its reports have to be able to show.

#include <cstddef>
#include <limits>
#include <random>
#include <string>

#include "libchar/replay/replay_result.hpp"
#include "tests/report/synthetic.hpp"

namespace test {

inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

ErrorScore synthetic_score(double rmse, double bias);

Timeline synthetic_track(std::size_t series, std::size_t bins, double level, double duration_s,
                         std::mt19937_64& random);

InputScore synthetic_input(double rmse, double optimum, std::mt19937_64& random);

/// Algorithm `index` of the registry as it might have fared.
AlgorithmResult synthetic_algorithm(const ReplayResult& r, std::size_t index, std::mt19937_64& random);

void judge(ReplayResult& r);

/// `sensors` sensors, `inputs` true inputs, all algorithms; a third of them with moving weights and
/// variances, three tilt filters skipped.
ReplayResult synthetic_replay(std::size_t sensors = 5, std::size_t inputs = 1);

/// No reference: leave-one-out and split-array scores alone.
ReplayResult without_reference();

/// Scores that could not be computed.
ReplayResult nothing_scored();

/// Every text that comes from a file tries to become part of the page.
ReplayResult hostile_replay();

ReplayResult synthetic_replay_of_kind(const std::string& kind);

}  // namespace test
