#pragma once
// Tables and lists of a page, their texts escaped.

#include <algorithm>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/characterize/judgement.hpp"
#include "libchar/core/finding.hpp"
#include "libchar/core/table/table.hpp"

namespace libchar {

/// How a table stands on a page.
struct PageTable {
  const char* css = "";
  bool cards = false;     ///< its css has "cards": on a narrow screen a row is values behind heads
  bool sorted = false;    ///< its script sorts by the numbers
  std::size_t most = 0;   ///< rows shown; 0: all
  std::size_t of = 0;     ///< rows that there are, beside those that were made; 0: none
  const char* rest = "";  ///< file beside the page that has all of them
};

/// Title, table and note. Heads begin with a capital; a table whose heads are all empty has none.
std::string html_table(const Table& table, const PageTable& look = {});

/// As many as a page has of a list of any length: a table has no more rows.
template <class T>
std::span<const T> first_of(const std::vector<T>& all, std::size_t most) {
  return std::span(all).first(std::min(most, all.size()));
}

/// What can be unfolded; `summary` is HTML, escaped already.
std::string folded(const std::string& summary, const std::string& body, bool open = false);
/// A word in the colour of what it says.
std::string html_chip(std::string_view word, std::optional<Tint> tint);
/// "✓ good", "! caution", "✗ do not use": with its colour a sign and a word.
std::string rating_badge(Rating rating);
std::string_view rating_sign(Rating rating);
/// The worst first, with their help; those behind the fifth can be unfolded. Nothing where there is none.
std::string findings_list(const std::vector<Finding>& findings);
/// "<ul>…": nothing when there is no item.
std::string bullet_list(const std::vector<std::string>& items, std::string_view css_class);

}  // namespace libchar
