#pragma once
// What the tests of pages look at.

#include <algorithm>
#include <cstddef>
#include <regex>
#include <string>
#include <vector>

namespace test {

/// How often a word stands in a text.
inline std::size_t count(const std::string& text, const std::string& word) {
  std::size_t n = 0;
  for (std::size_t at = 0; (at = text.find(word, at)) != std::string::npos; at += word.size()) ++n;
  return n;
}

/// Cells of a row, those that span several counted as many.
inline std::size_t cells_of(const std::string& row) {
  static const std::regex cell("<t[hd](?: [^>]*)?>");
  static const std::regex span("colspan=\"([0-9]+)\"");
  std::size_t n = 0;
  for (auto it = std::sregex_iterator(row.begin(), row.end(), cell); it != std::sregex_iterator(); ++it) {
    std::smatch wide;
    const std::string tag = it->str();
    n += std::regex_search(tag, wide, span) ? std::stoul(wide[1]) : 1;
  }
  return n;
}

/// Rows that have more or fewer cells than the first row of their table.
inline std::vector<std::string> rows_that_do_not_fit(const std::string& page) {
  std::vector<std::string> out;
  for (std::size_t at = 0; (at = page.find("<table", at)) != std::string::npos;) {
    const std::size_t end = page.find("</table>", at);
    std::size_t columns = 0;
    for (std::size_t row = at; (row = page.find("<tr", row)) < end;) {
      const std::size_t stop = std::min(page.find("</tr>", row), end);
      const std::string text = page.substr(row, stop - row);
      if (columns == 0) columns = cells_of(text);
      if (cells_of(text) != columns) out.push_back(text);
      row = stop;
    }
    at = end;
  }
  return out;
}

}  // namespace test
