#include "libchar/log/csv/line.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace libchar::csv {

Line line_at(std::string_view head, std::size_t offset, std::uint64_t number) {
  Line line;
  line.offset = offset;
  line.number = number;
  const std::size_t end = head.find_first_of("\r\n", offset);
  if (end == std::string_view::npos) {
    line.text = head.substr(offset);
    line.after = head.size();
    return line;
  }
  line.text = head.substr(offset, end - offset);
  const bool pair = head[end] == '\r' && end + 1 < head.size() && head[end + 1] == '\n';
  line.end = pair ? LineEnd::crlf : head[end] == '\r' ? LineEnd::cr : LineEnd::lf;
  line.after = end + (pair ? 2 : 1);
  return line;
}

std::string at(const std::string& file,
               std::uint64_t line,
               std::uint64_t column,
               std::uint64_t byte) {
  return fmt::format("{}:{}:{} (byte {})", file, line, column, byte);
}

bool is_comment(std::string_view line) {
  line = trimmed(line);
  return !line.empty() && (line[0] == '#' || line[0] == '%' || line.substr(0, 2) == "//");
}

std::vector<Field> split(std::string_view line, char delimiter, bool* open_quote) {
  std::vector<Field> fields;
  const auto blank = [](char c) { return c == ' ' || c == '\t'; };
  const auto pad = [&](char c) { return blank(c) && (c != delimiter || delimiter == ' '); };
  const auto is_end = [&](char c) { return delimiter == ' ' ? blank(c) : c == delimiter; };
  std::size_t i = 0;
  for (;;) {
    while (i < line.size() && pad(line[i])) ++i;
    if (delimiter == ' ' && i == line.size() && !fields.empty()) break;
    Field field;
    field.offset = i;
    if (i < line.size() && line[i] == '"') {
      field.quoted = true;
      for (++i;; ++i) {
        if (i >= line.size()) {
          if (open_quote != nullptr) *open_quote = true;
          break;
        }
        if (line[i] == '"') {
          if (i + 1 >= line.size() || line[i + 1] != '"') break;
          ++i;
        }
        field.text += line[i];
      }
      i = std::min(i + 1, line.size());
      field.text = std::string(trimmed(field.text));
      while (i < line.size() && pad(line[i]) && !is_end(line[i])) ++i;
      for (; i < line.size() && !is_end(line[i]); ++i) field.text += line[i];
    } else {
      const std::size_t start = i;
      while (i < line.size() && !is_end(line[i])) ++i;
      field.text = std::string(trimmed(line.substr(start, i - start)));
    }
    fields.push_back(std::move(field));
    if (i >= line.size()) break;
    ++i;  // the delimiter
  }
  return fields;
}

std::optional<Field> lead_of(std::string_view line, std::string_view lead, std::size_t& after) {
  constexpr std::size_t kLongest = 48;
  const std::size_t end = line.substr(0, kLongest).find(lead);
  if (end == std::string_view::npos) return std::nullopt;
  std::size_t begin = line.find_first_not_of(" \t");
  if (lead == "]") {
    if (line[begin] != '[') return std::nullopt;
    ++begin;
  }
  if (begin >= end) return std::nullopt;
  after = std::min(line.find_first_not_of(" \t,;:", end + lead.size()), line.size());
  return Field{std::string(trimmed(line.substr(begin, end - begin))), begin, false};
}

}  // namespace libchar::csv
