#pragma once
// Two characterizations side by side, for scripts, pages and a terminal.

#include <string>

#include "libchar/characterize/compare/characterization_comparison.hpp"
#include "libchar/core/document/json.hpp"

namespace libchar {

/// The keys behind the head of {"format":"characterization-comparison","version":1,…} (docs/recordings.md).
Json comparison_json(const CharacterizationComparison& comparison);
std::string comparison_text(const CharacterizationComparison& comparison, std::size_t width = 0);
/// One page of Markdown.
std::string comparison_markdown(const CharacterizationComparison& comparison);

}  // namespace libchar
