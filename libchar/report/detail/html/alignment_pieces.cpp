#include "libchar/report/detail/html/alignment_pieces.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "libchar/core/text/text.hpp"
#include "libchar/replay/view/alignment_words.hpp"
#include "libchar/report/detail/html/html_tables.hpp"

namespace libchar {
namespace {

/// More sensors than these fill a terminal.
constexpr std::size_t kMostTextRows = 16;

// Width by characters, not by bytes: "±" is one.
std::size_t characters(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(
      text.begin(), text.end(), [](unsigned char c) { return (c & 0xC0U) != 0x80U; }));
}

std::string columns(const WordTable& table) {
  std::vector<std::size_t> widths(table.head.size(), 0);
  const auto measure = [&](const std::vector<std::string>& row) {
    for (std::size_t c = 0; c < row.size(); ++c)
      widths[c] = std::max(widths[c], characters(printable(row[c])));
  };
  measure(table.head);
  for (const auto& row : table.rows) measure(row);
  std::string out;
  const auto add = [&](const std::vector<std::string>& row) {
    for (std::size_t c = 0; c < row.size(); ++c) {
      const std::string cell = printable(row[c]);
      const std::string space(widths[c] - characters(cell), ' ');
      out += c == 0 ? cell + space : "  " + space + cell;
    }
    out += "\n";
  };
  add(table.head);
  for (const auto& row : table.rows) add(row);
  return out;
}

std::string markdown_table(const WordTable& table) {
  std::string out = "|", line = "\n|";
  for (const std::string& head : table.head) {
    out += " " + markdown_text(head) + " |";
    line += "---|";
  }
  out += line + "\n";
  for (const auto& row : table.rows) {
    out += "|";
    for (const std::string& cell : row) out += " " + markdown_text(cell) + " |";
    out += "\n";
  }
  return out;
}

std::string html_table(const WordTable& table) {
  std::string out = "<div class=\"wide\"><table>\n" + table_head(table.head);
  for (const auto& row : table.rows) out += table_row(row);
  return out + "</tbody></table></div>\n";
}

}  // namespace

std::string alignment_text(const ReplayView& view) {
  const ReplayResult& r = *view.result;
  if (!r.alignment) return "";
  const AlignmentWords words = alignment_words(r, *r.alignment);
  std::string out = "\n" + printable(fmt::format("{}", fmt::join(words.sentences, " "))) + "\n";
  if (r.sensors.size() > kMostTextRows) return out;
  return out + "\n" + columns(words.learnt) + "\nerror budget, shares of the mean square\n" +
         columns(words.budget);
}

std::string alignment_markdown(const ReplayView& view) {
  const ReplayResult& r = *view.result;
  if (!r.alignment) return "";
  const AlignmentWords words = alignment_words(r, *r.alignment);
  return "\n## Alignment\n\n" + markdown_text(fmt::format("{}", fmt::join(words.sentences, " "))) +
         "\n\n" + markdown_table(words.learnt) + "\n## Error budget\n\n" +
         markdown_table(words.budget);
}

std::string alignment_html(const ReplayView& view) {
  const ReplayResult& r = *view.result;
  if (!r.alignment) return "";
  const AlignmentWords words = alignment_words(r, *r.alignment);
  std::string out = "<section class=\"part\" id=\"alignment\">\n<h2>Alignment</h2>\n";
  for (const std::string& sentence : words.sentences) out += "<p>" + html_text(sentence) + "</p>\n";
  return out + "<div class=\"copy-place\" data-copy=\"alignment\"></div>\n" +
         html_table(words.learnt) + "<h3>Error budget</h3>\n" + html_table(words.budget) +
         "<p class=\"note\">Shares of each sensor’s mean square error over the evaluation, with "
         "95 % intervals; last row: what the fused error would lose. Jitter: the part of what "
         "alignment leaves that follows the square of the input’s slope.</p>\n</section>\n";
}

}  // namespace libchar
