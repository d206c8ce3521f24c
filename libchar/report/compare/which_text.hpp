#pragma once
// Characterizations, models and curves side by side: for scripts, papers, a terminal, and as a page.

#include <string>
#include <vector>

#include "libchar/characterize/compare/characterization_comparison.hpp"
#include "libchar/core/document/json.hpp"
#include "libchar/core/table/table.hpp"

namespace libchar {

/// The keys behind the head of {"format":"characterization-comparison","version":1,…} (docs/recordings.md).
Json comparison_json(const CharacterizationComparison& comparison);

std::string comparison_text(const CharacterizationComparison& comparison, std::size_t width = 0);
/// One page of Markdown.
std::string comparison_markdown(const CharacterizationComparison& comparison);

namespace detail {

/// Which groups a table has.
enum class TableGroups {
  summary,  ///< axes together where they are compared so, each channel otherwise
  axes,     ///< what `summary` leaves out
  all,
};

/// N, B, K and the Allan deviation at some averaging times, one row per sensor and channel; what is lowest is marked.
Table comparison_table(const CharacterizationComparison& comparison,
                       TableGroups groups = TableGroups::summary);

/// One page of HTML: verdict, a figure for each quantity, the table; `document` is what it can save.
std::string comparison_html(const CharacterizationComparison& comparison,
                            const Json& document,
                            const std::vector<std::string>& command);

}  // namespace detail

}  // namespace libchar
