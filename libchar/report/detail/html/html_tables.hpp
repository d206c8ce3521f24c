#pragma once
// Tables and lists of a page, their texts escaped.

#include <string>
#include <string_view>
#include <vector>

#include "libchar/characterize/judgement.hpp"
#include "libchar/core/finding.hpp"
#include "libchar/core/table/table.hpp"
#include "libchar/core/text/term_cells.hpp"

namespace libchar {

/// How a table stands on a page.
struct PageTable {
  const char* css = "";
  bool cards = false;     ///< its css has "cards": on a narrow screen a row is values behind heads
  bool sorted = false;    ///< its script sorts by the numbers
  std::size_t most = 0;   ///< rows shown; 0: all
  const char* rest = "";  ///< file beside the page that has all of them
};

/// Title, table and note. Heads begin with a capital; a table whose heads are all empty has none.
std::string html_table(const Table& table, const PageTable& look = {});

/// What can be unfolded; `summary` is HTML, escaped already.
std::string folded(const std::string& summary, const std::string& body, bool open = false);
/// A word in the colour of what it says.
std::string html_chip(std::string_view word, std::optional<Tint> tint);
/// "✓ good", "! caution", "✗ do not use": with its colour a sign and a word.
std::string rating_badge(Rating rating);
/// The worst first, with their help; those behind the fifth can be unfolded. Nothing where there is none.
std::string findings_list(const std::vector<Finding>& findings);
std::string_view rating_sign(Rating rating);
/// "<ul>…": nothing when there is no item.
std::string bullet_list(const std::vector<std::string>& items, std::string_view css_class);

}  // namespace libchar
