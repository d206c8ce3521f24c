#pragma once
// What an algorithm asks for and how it was set, in words.

#include <string>
#include <vector>

#include "libchar/core/table/table.hpp"
#include "libchar/fusion/registry.hpp"
#include "libchar/replay/replay_result.hpp"

namespace libchar {

/// What an algorithm asks of a scene, a phrase each; empty: nothing beyond the samples.
std::vector<std::string> needs_in_words(const fusion::Description& description);

/// Options that differ from the table's standard, "gamma = 0.99".
std::string settings_in_words(const fusion::Settings& settings);

// The alignment of a replay in words: what terminal, Markdown and page print alike.

struct AlignmentWords {
  std::vector<std::string> sentences;
  Table learnt;  ///< one row per sensor: its terms with their standard errors
  Table budget;  ///< one row per sensor, and one of all: shares of the mean square error
};

/// Name of a part, in tables and JSON: offset, gain, cross, delay, jitter, noise.
std::string_view name_of(fusion::ErrorPart part);

AlignmentWords alignment_words(const ReplayResult& result, const AlignmentResult& alignment);

// What was done to sensors and reference before fusion, in sentences: terminal, Markdown and page print them alike.

/// Trends, filter, offset of the reference; empty: nothing was done. Plain text, units as the reference says them.
std::vector<std::string> preparation_words(const ReplayResult& result);

/// Of the filter and the trends alone.
std::vector<std::string> preparation_words(const Scene& scene);

/// Until the filter has settled, in s.
double settling_s(const ScenePreparation& preparation);

}  // namespace libchar
