#include "libchar/log/text_table.hpp"

#include "libchar/core/error.hpp"
#include "libchar/core/file/file_text.hpp"
#include "libchar/core/file/sha256.hpp"
#include "libchar/log/csv/head/candidates.hpp"
#include "libchar/log/csv/head/sample.hpp"
#include "libchar/log/csv/line.hpp"
#include "libchar/log/csv/rows/number.hpp"

namespace libchar {
namespace {

std::optional<std::string> whole_text(const std::string& path, std::size_t max_bytes) {
  std::string text = file_text(path, max_bytes + 1);
  return text.size() > max_bytes ? std::nullopt : std::optional(text);
}

// Those that are neither blank nor comments, at most so many.
std::vector<csv::Line> lines_of(const std::string& text, std::size_t most) {
  std::vector<csv::Line> lines;
  std::uint64_t number = 1;
  std::size_t at = text.starts_with("\xEF\xBB\xBF") ? 3 : 0;
  while (at < text.size() && lines.size() < most) {
    const csv::Line line = csv::line_at(text, at, number);
    if (!trimmed(line.text).empty() && !csv::is_comment(line.text)) lines.push_back(line);
    at = line.after;
    number += line.lines;
  }
  return lines;
}

TextRow row_of(const csv::Line& line, char delimiter) {
  TextRow row{line.number, {}};
  for (csv::Field& field : csv::split(line.text, delimiter))
    row.cells.push_back({std::move(field.text), field.offset + 1});
  return row;
}

}  // namespace

std::optional<TextTable> read_text_table(const std::string& path, std::size_t max_bytes) {
  const auto text = whole_text(path, max_bytes);
  if (!text) return std::nullopt;
  TextTable table;
  table.bytes = text->size();
  Sha256 hash;
  hash.update(*text);
  table.sha256 = hash.finish();
  const std::vector<csv::Line> lines = lines_of(*text, text->size());
  if (lines.empty()) return table;
  const std::vector<csv::Line> sample(
      lines.begin(), lines.begin() + static_cast<std::ptrdiff_t>(std::min(lines.size(), csv::kSample)));
  const csv::Candidate best = csv::candidates(sample).front();
  const char delimiter = best.delimiter;
  table.decimal = best.decimal;
  table.header = row_of(lines[0], delimiter);
  for (std::size_t i = 1; i < lines.size(); ++i) table.rows.push_back(row_of(lines[i], delimiter));
  return table;
}

TextRow detail::header_of_text_table(const std::string& path) {
  // Names, and rows enough to know the delimiter by.
  constexpr std::size_t kHeadBytes = std::size_t{1} << 16U;
  const std::string head = file_text(path, kHeadBytes);
  const std::vector<csv::Line> lines = lines_of(head, csv::kSample);
  if (lines.empty()) return {};
  return row_of(lines[0], csv::candidates(lines).front().delimiter);
}

std::optional<double> number_in(const TextCell& cell, char decimal) {
  const csv::Cell read = csv::read_cell(cell.text, decimal);
  return read.kind == csv::Cell::value ? std::optional(read.number) : std::nullopt;
}

}  // namespace libchar
