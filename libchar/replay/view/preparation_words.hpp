#pragma once
// What was done to sensors and reference before fusion, in sentences: terminal, Markdown and page print them alike.

#include <string>
#include <vector>

#include "libchar/replay/replay_result.hpp"

namespace libchar {

/// Trends, filter, offset of the reference; empty: nothing was done. Plain text, units as the reference says them.
std::vector<std::string> preparation_words(const ReplayResult& result);

/// Of the filter and the trends alone.
std::vector<std::string> preparation_words(const Scene& scene);

/// Until the filter has settled, in s.
double settling_s(const ScenePreparation& preparation);

}  // namespace libchar
