#include "libchar/log/csv/head/sample.hpp"

#include "libchar/core/refusal.hpp"
#include "libchar/log/csv/head/dialect.hpp"

namespace libchar::csv {
namespace {

// ';' begins a comment where it does not separate cells: the first line that begins with something else has none.
bool semicolons_comment(std::string_view head, std::size_t offset) {
  for (bool any = false; offset < head.size();) {
    const Line line = line_at(head, offset, 0);
    const std::string_view text = trimmed(line.text);
    offset = line.after;
    if (!text.empty() && text[0] != ';' && !is_comment(text)) return any && text.find(';') == std::string_view::npos;
    any = any || (!text.empty() && text[0] == ';');
  }
  return false;
}

}  // namespace

Sample sample_lines(std::string_view head, bool whole, std::size_t offset, std::uint64_t number,
                    const std::string& file) {
  Sample sample;
  sample.semicolon_comments = semicolons_comment(head, offset);
  while (offset < head.size() && sample.lines.size() < kSample) {
    const Line line = line_at(head, offset, number);
    if (line.end == LineEnd::none && !whole) {
      if (sample.lines.empty())  // else the row parser tells
        throw input_error("E0305", at(file, line.number, 1, line.offset))
            .says("line longer than 1 MiB")
            .hint("is this a text file with line ends?");
      break;
    }
    const std::string_view text = trimmed(line.text);
    const bool comment = is_comment(text, sample.semicolon_comments);
    if (comment) {
      (sample.lines.empty() ? sample.comments : sample.later_comments).push_back(line);
    } else if (!text.empty()) {
      sample.lines.push_back(line);
    }
    offset = line.after;
    number += line.lines;
  }
  return sample;
}

}  // namespace libchar::csv
