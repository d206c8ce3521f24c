#pragma once
// The sampling interval from the first stamps of a log, and what kind of clock wrote them.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace libchar {

/// How stamps and samples go together.
enum class StampPattern {
  steps,     ///< a stamp for each sample, as far as the clock can tell; longer steps are gaps
  equal,     ///< so many equal stamps that the clock cannot tell rows apart
  coarse,    ///< on the grid of a coarse clock, never more than a step off an even rate
  packets,   ///< rows that arrive together have stamps of their arrival
  disputed,  ///< most steps say one rate, all of them together another, and gaps do not explain it
};

struct FirstInterval {
  double ns = 0;            ///< sampling interval; what tells a gap from a step
  double longest_step = 0;  ///< a longer one is a gap: 1.5 dt, or more where stamps scatter, ns
  StampPattern pattern = StampPattern::steps;
  double step_ns = 0;  ///< the common step alone
  double span_ns = 0;  ///< span of the stamps / (rows - 1)
};

/// From the first stamps, in file order. `rate_hz` decides where stamps can be read in two ways.
FirstInterval first_interval(const std::vector<std::int64_t>& stamps,
                             std::optional<double> rate_hz = {});

}  // namespace libchar
