#include "libchar/report/detail/html/alignment_pieces.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "libchar/core/text/text.hpp"
#include "libchar/replay/view/alignment_words.hpp"
#include "libchar/report/detail/html/html_tables.hpp"

namespace libchar {
namespace {

/// More sensors than these fill a terminal.
constexpr std::size_t kMostTextRows = 16;

}  // namespace

std::string alignment_text(const ReplayView& view, const TextLook& look) {
  const ReplayResult& r = *view.result;
  if (!r.alignment) return "";
  const AlignmentWords words = alignment_words(r, *r.alignment);
  std::string out = "\n" + printable(fmt::format("{}", fmt::join(words.sentences, " "))) + "\n";
  if (r.sensors.size() > kMostTextRows) return out;
  return out + "\n" + terminal_table(words.learnt, look, "") + "\n" +
         terminal_table(words.budget, look, "");
}

std::string alignment_markdown(const ReplayView& view) {
  const ReplayResult& r = *view.result;
  if (!r.alignment) return "";
  const AlignmentWords words = alignment_words(r, *r.alignment);
  return "\n## Alignment\n\n" + markdown_text(fmt::format("{}", fmt::join(words.sentences, " "))) +
         "\n\n" + table_text(words.learnt) + "\n" + table_text(words.budget);
}

std::string alignment_html(const ReplayView& view) {
  const ReplayResult& r = *view.result;
  if (!r.alignment) return "";
  const AlignmentWords words = alignment_words(r, *r.alignment);
  std::string out = "<section class=\"part\" id=\"alignment\">\n<h2>Alignment</h2>\n";
  for (const std::string& sentence : words.sentences) out += "<p>" + html_text(sentence) + "</p>\n";
  return out + "<div class=\"copy-place\" data-copy=\"alignment\"></div>\n" +
         html_table(words.learnt) + html_table(words.budget) +
         "<p class=\"note\">Shares are of each sensor’s mean square error over the evaluation, "
         "with "
         "95 % intervals; last row: what the fused error would lose. Jitter: the part of what "
         "alignment leaves that follows the square of the input’s slope.</p>\n</section>\n";
}

}  // namespace libchar
