#pragma once
// Hard inputs through every estimator, simulator and fusion algorithm: how many digits are right,
// what is refused in a sentence, and what is neither.

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "libchar/core/document/enum_table.hpp"
#include "libchar/core/process/progress.hpp"

namespace libchar {

struct StressBenchOptions {
  bool quick = false;  ///< without the records of 1e8 samples
  std::uint64_t seed = 1;
};

enum class StressOutcome {
  digits,   ///< compared with a reference: exact, or of an input that must give the same
  held,     ///< no reference: finite, in the range of what came in, no negative variance
  refused,  ///< in a sentence
  wrong     ///< fewer digits than stated, or not held
};

template <>
inline constexpr auto enum_table<StressOutcome> =
    enum_words<StressOutcome, "digits held refused wrong">;

/// One subject on one input.
struct StressCell {
  std::string subject, input;
  StressOutcome outcome = StressOutcome::held;
  /// right decimal digits of the worst number, at most 16
  double digits = std::numeric_limits<double>::quiet_NaN();
  /// at least so many are stated; NaN: none, a method as published
  double stated = std::numeric_limits<double>::quiet_NaN();
  std::string what;  ///< the refusal, or what is wrong
};

struct StressBench {
  std::uint64_t seed = 1;
  std::vector<StressCell> cells;  ///< worst first: wrong, then by digits beyond the stated ones
  std::size_t count(StressOutcome outcome) const;
};

StressBench bench_stress(const StressBenchOptions& options, Progress& progress = no_progress());

}  // namespace libchar
