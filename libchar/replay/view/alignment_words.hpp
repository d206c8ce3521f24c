#pragma once
// The alignment of a replay in words: what terminal, Markdown and page print alike.

#include <string>
#include <vector>

#include "libchar/core/table/table.hpp"
#include "libchar/replay/replay_result.hpp"

namespace libchar {

struct AlignmentWords {
  std::vector<std::string> sentences;
  Table learnt;  ///< a row a sensor: its terms with their standard errors
  Table budget;  ///< a row a sensor, and one of all: shares of the mean square error
};

/// Name of a part, in tables and JSON: offset, gain, cross, delay, jitter, noise.
std::string_view name_of(fusion::ErrorPart part);

AlignmentWords alignment_words(const ReplayResult& result, const AlignmentResult& alignment);

}  // namespace libchar
