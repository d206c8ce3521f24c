#pragma once
// Tables and lists of a page, their texts escaped.

#include <string>
#include <string_view>
#include <vector>

#include "libchar/characterize/judgement.hpp"
#include "libchar/core/finding.hpp"
#include "libchar/core/text/term_cells.hpp"

namespace libchar {

/// A table row of cells, each escaped as text; the first is a row header.
std::string table_row(const std::vector<std::string>& cells);
std::string table_head(const std::vector<std::string>& cells);
/// A cell of a table that falls apart into cards on a narrow screen, where `label` stands before it. `html` is escaped already.
std::string card_cell(std::string_view label, const std::string& html, std::string_view css_class);
/// Its 95 % interval, small; nothing without one.
std::string interval_span(const ShownValue& shown);
/// What can be unfolded; `summary` is HTML, escaped already.
std::string folded(const std::string& summary, const std::string& body, bool open = false);
/// "✓ good", "! caution", "✗ do not use": with its colour a sign and a word.
std::string rating_badge(Rating rating);
/// The worst first, with their help; those behind the fifth can be unfolded. Nothing where there is none.
std::string findings_list(const std::vector<Finding>& findings);
/// "<ul>…": nothing when there is no item.
std::string bullet_list(const std::vector<std::string>& items, std::string_view css_class);

}  // namespace libchar
