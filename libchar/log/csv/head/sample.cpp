#include "libchar/log/csv/head/sample.hpp"

#include <algorithm>

#include "libchar/core/refusal.hpp"
#include "libchar/log/csv/head/columns.hpp"
#include "libchar/log/csv/head/dialect.hpp"
#include "libchar/log/csv/rows/number.hpp"
#include "libchar/log/time/calendar.hpp"

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

// The last lines have as many cells as each other, with a number in each, by one of the usual signs.
bool rows_alike(const std::vector<Line>& lines) {
  constexpr std::size_t kLast = 8;
  if (lines.size() < kLast) return true;
  const auto from = lines.end() - static_cast<std::ptrdiff_t>(kLast);
  for (const char sign : {',', ';', '\t', ' ', '|'}) {
    const std::size_t cells = split(from->text, sign).size();
    if (std::all_of(from, lines.end(), [&](const Line& line) {
          const auto row = split(line.text, sign);
          return row.size() == cells && std::any_of(row.begin(), row.end(), [](const Field& field) {
                   return read_sampled(field.text, {}).kind == Cell::value || read_calendar(field.text);
                 });
        }))
      return true;
  }
  return false;
}

}  // namespace

Sample sample_lines(std::string_view head, bool whole, std::size_t offset, std::uint64_t number,
                    const std::string& file) {
  Sample sample;
  sample.semicolon_comments = semicolons_comment(head, offset);
  constexpr std::size_t kMost = 8 * kSample, kFewest = 32, kBytes = 12288, kLook = 8;
  std::size_t wanted = kSample, bytes = 0;
  bool found = false;
  while (offset < head.size()) {
    const std::size_t so_far = sample.lines.size();  // of wide tables fewer lines say as much
    if (wanted == kSample && so_far >= kFewest && so_far % kLook == 0 && bytes > kBytes && rows_alike(sample.lines))
      break;
    if (sample.lines.size() == wanted) {  // behind a long preamble as many lines again are those of a table
      const bool rows = rows_alike(sample.lines);
      if (found || (rows && wanted == kSample) || wanted >= kMost) break;
      found = rows;
      wanted = rows ? 2 * wanted : wanted + kSample;
    }
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
      bytes += text.size();
    }
    offset = line.after;
    number += line.lines;
  }
  if (sample.lines.size() > kSample && !found && !rows_alike(sample.lines)) sample.lines.resize(kSample);
  return sample;
}

}  // namespace libchar::csv
