#include "libchar/log/csv/head/sample.hpp"

#include <algorithm>

#include "libchar/core/error.hpp"
#include "libchar/log/csv/head/dialect.hpp"

namespace libchar::csv {
namespace {

// A header may hold newlines inside quotes: the line goes on until its quotes are closed.
void join_quoted_lines(std::string_view head, Line& line) {
  const auto open = [](std::string_view text) {
    return std::count(text.begin(), text.end(), '"') % 2 != 0;
  };
  if (!open(line.text)) return;
  Line longer = line;
  while (open(longer.text) && longer.after < head.size() && longer.text.size() < kMaxField) {
    const Line next = line_at(head, longer.after, 0);
    longer.text = head.substr(longer.offset, next.offset + next.text.size() - longer.offset);
    longer.after = next.after;
    longer.end = next.end;
    ++longer.lines;
  }
  if (!open(longer.text)) line = longer;
}

}  // namespace

Sample sample_lines(std::string_view head,
                    bool whole,
                    std::size_t offset,
                    std::uint64_t number,
                    const std::string& file) {
  Sample sample;
  while (offset < head.size() && sample.lines.size() < kSample) {
    Line line = line_at(head, offset, number);
    if (line.end == LineEnd::none && !whole) {
      if (sample.lines.empty())  // else the row parser tells
        throw Error({ErrorKind::input,
                     "E0305",
                     at(file, line.number, 1, line.offset),
                     "line longer than 1 MiB",
                     "",
                     "is this a text file with line ends?"});
      break;
    }
    const std::string_view text = trimmed(line.text);
    if (sample.lines.empty() && is_comment(text)) {
      sample.comments.push_back(line);
    } else if (!text.empty() && !is_comment(text)) {
      if (sample.lines.empty()) join_quoted_lines(head, line);
      sample.lines.push_back(line);
    }
    offset = line.after;
    number += line.lines;
  }
  return sample;
}

}  // namespace libchar::csv
