#pragma once
// Text inside HTML, XML and Markdown.

#include <concepts>
#include <optional>
#include <string>
#include <string_view>

namespace libchar {

/// & < > " and ' as the entities that stand for them in the text and the attributes of HTML, SVG and XML.
std::string markup_entities(std::string_view text);

/// For Markdown: no mark of it becomes a tag, link, column or line; what does not print, an escape.
std::string markdown_text(std::string_view text);

/// A spreadsheet takes a cell that begins with = + - @ TAB CR for a formula.
bool begins_like_a_formula(std::string_view text);

/// A text cell of a table that may be opened in a spreadsheet: quoted when needed (RFC 4180), and
/// an apostrophe put before what would start a formula. For results: the
/// columns of a log keep their names, which must read back as they were.
std::string csv_cell(std::string_view text);

/// A number that reads back; nothing for what is not known or not finite (a spreadsheet makes text of "nan").
std::string csv_cell(double value);
std::string csv_cell(const std::optional<double>& value);
template <std::integral T>
std::string csv_cell(T count) {
  return std::to_string(count);
}

/// A line of such cells.
template <class... Cells>
std::string csv_line(const Cells&... cells) {
  std::string out;
  ((out += csv_cell(cells), out += ','), ...);
  out.back() = '\n';
  return out;
}

}  // namespace libchar
