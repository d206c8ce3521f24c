#include "libchar/log/csv/line.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "libchar/log/csv/head/columns.hpp"
#include "libchar/log/csv/rows/number.hpp"
#include "libchar/log/time/calendar.hpp"

namespace libchar::csv {

namespace {

bool padding(char c) { return c == ' ' || c == '\t'; }

bool separates(char c, char delimiter) {
  if (delimiter == 0) return c == ',' || c == ';' || c == '|' || padding(c);
  return c == delimiter || (delimiter == ' ' && c == '\t');
}

// A quote opens a cell at the beginning of one; anywhere else it is a letter like others.
bool opens_cell(std::string_view text, std::size_t from, std::size_t quote, char delimiter) {
  while (quote > from && padding(text[quote - 1]) && !separates(text[quote - 1], delimiter)) --quote;
  return quote == from || separates(text[quote - 1], delimiter);
}

// The quote that closes the cell whose opening one this is, the end of the text where it has none;
// nothing where the cell does not end behind it.
std::optional<std::size_t> closing_quote(std::string_view text, std::size_t quote, char delimiter) {
  std::size_t close = text.find('"', quote + 1);
  while (close < text.size() - 1 && text[close + 1] == '"') close = text.find('"', close + 2);
  if (close >= text.size() || close + 1 == text.size()) return std::min(close, text.size());
  const char next = text[close + 1];
  const bool ends = next == '\n' || next == '\r' || padding(next) || separates(next, delimiter);
  return ends ? std::optional(close) : std::nullopt;
}

}  // namespace

std::size_t row_end(std::string_view text, std::size_t from, char delimiter, bool* open) {
  const auto line_end = [&](std::size_t at) {
    constexpr std::size_t kWindow = 512;  // lines may end in CR alone
    for (; at < text.size(); at += kWindow) {
      const std::string_view window = text.substr(at, kWindow);
      const std::size_t end = window.find('\n'), cr = window.substr(0, end).find('\r');
      if (cr != std::string_view::npos || end != std::string_view::npos) return at + std::min(cr, end);
    }
    return text.size();
  };
  const std::string_view near = text.substr(0, std::min(text.size(), from + kMaxField));
  std::size_t end = line_end(from);
  for (std::size_t at = from; at < end; ++at) {
    at = text.substr(0, end).find('"', at);
    if (at == std::string_view::npos) break;
    if (!opens_cell(text, from, at, delimiter)) continue;
    const auto close = closing_quote(near, at, delimiter);
    const bool closed = close && *close < near.size();
    if (open != nullptr && close && !closed && near.size() == text.size()) *open = true;
    if (!closed) continue;
    if (*close > end) end = line_end(*close);
    at = *close;
  }
  return end;
}

Line line_at(std::string_view head, std::size_t offset, std::uint64_t number) {
  Line line;
  line.offset = offset;
  line.number = number;
  const std::size_t end = row_end(head, offset);
  line.text = head.substr(offset, end - offset);
  line.after = end;
  if (end == head.size()) return line;
  const bool pair = head[end] == '\r' && end + 1 < head.size() && head[end + 1] == '\n';
  line.end = pair ? LineEnd::crlf : head[end] == '\r' ? LineEnd::cr : LineEnd::lf;
  line.after = end + (pair ? 2 : 1);
  const char sign = line.end == LineEnd::cr ? '\r' : '\n';
  if (line.text.find(sign) != std::string_view::npos)
    line.lines += static_cast<std::uint64_t>(std::count(line.text.begin(), line.text.end(), sign));
  return line;
}

std::string at(const std::string& file, std::uint64_t line, std::uint64_t column, std::uint64_t byte) {
  return fmt::format("{}:{}:{} (byte {})", file, line, column, byte);
}

bool is_ruler(std::string_view line) {
  static constexpr std::array<std::string_view, 3> kDrawn = {"----", "====", "____"};  // "-- --" are missing values
  const std::size_t first = line.find_first_not_of(" \t");
  if (first == std::string_view::npos) return false;
  if (line.substr(first).starts_with("\xE2\x94") || line.substr(first).starts_with("\xE2\x95"))  // ┌───┬───┐
    return std::all_of(line.begin(), line.end(), [](char c) { return (c & 0x80) != 0 || c == ' '; });
  if (line.find_first_not_of("-+|=_: \t", first) != std::string_view::npos) return false;
  if (line.find("--") != line.npos && (line[first] == '|' || line.find('+') != line.npos)) return true;
  constexpr std::size_t kLong = 10;  // a shorter one alone is the missing value of a display
  const std::string_view text = trimmed(line);
  return (text.size() >= kLong || text.find(' ') != text.npos) &&
         std::any_of(kDrawn.begin(), kDrawn.end(), [&](std::string_view four) { return text.find(four) != text.npos; });
}

bool is_comment(std::string_view line, bool semicolons) {
  const std::size_t first = line.find_first_not_of(" \t");
  if (first == std::string_view::npos || (line[first] >= '0' && line[first] <= '9')) return false;  // most lines
  line = trimmed(line);
  constexpr std::string_view kChrony = "Date (UTC) Time     ";  // every 32 rows
  if (is_ruler(line) || line.starts_with(kChrony)) return true;
  if (line.size() > 1 && (line[0] == '#' || line[0] == '%') &&
      std::string_view(",;\t|").find(line[1]) != std::string_view::npos)
    return false;  // "#,ax,ay": the name of a count of the rows; "%;deg/s;N": units
  return !line.empty() &&
         (line[0] == '#' || line[0] == '%' || line.substr(0, 2) == "//" || (semicolons && line[0] == ';'));
}

std::vector<Field> split(std::string_view line, char delimiter, bool* open_quote) {
  std::vector<Field> fields;
  if (delimiter != ' ') fields.reserve(static_cast<std::size_t>(std::count(line.begin(), line.end(), delimiter)) + 1);
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
      while (field.text.ends_with('\n') || field.text.ends_with('\r'))
        field.text.pop_back();  // println() of the sender
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

std::optional<Field> cell_at(std::string_view line, std::size_t column, char delimiter) {
  std::size_t from = 0;
  for (std::size_t left = column; left > 0 && from != std::string_view::npos; --left) {
    from = line.find(delimiter, from);
    from += from == std::string_view::npos ? 0 : 1;
  }
  const std::size_t end = from == std::string_view::npos ? from : line.find(delimiter, from);
  if (delimiter == ' ' || line.substr(0, end).find('"') != std::string_view::npos) {
    std::vector<Field> fields = split(line, delimiter);
    return column < fields.size() ? std::optional(std::move(fields[column])) : std::nullopt;
  }
  if (from == std::string_view::npos) return std::nullopt;
  return Field{std::string(trimmed(line.substr(from, end - from))), from, false};
}

namespace {

/// Where "x=1" or "x: 1" begins behind a blank; npos: nowhere.
std::size_t first_named(std::string_view line) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  for (std::size_t from = 1; from < line.size(); ++from) {
    if (line[from - 1] != ' ' || !letter(line[from])) continue;
    std::size_t to = from;
    while (to < line.size() && (letter(line[to]) || is_digit(line[to]) || line[to] == '.')) ++to;
    if (to == line.size() || (line[to] != '=' && line[to] != ':')) continue;
    const std::size_t value = line.find_first_not_of(' ', to + 1);
    if (value != line.npos && (is_digit(line[value]) || line[value] == '-' || line[value] == '+' || line[value] == '.'))
      return from;
  }
  return line.npos;
}

/// The stamp is what stands in digits and signs in front: "2024-05-01 12:00:00,123", "1714564800.25", "20".
std::optional<Field> lead_of_names(std::string_view line, std::size_t& after) {
  const std::size_t named = first_named(line);
  if (named == line.npos || !is_digit(line[0]) || line.find_first_of(",;", named) == line.npos) return std::nullopt;
  std::size_t to = line.find(' ');
  const std::size_t next = line.find(' ', to + 1);
  if (next <= named && is_digit(line[to + 1]) && line.substr(to, next - to).find(':') != line.npos) to = next;
  if (line[to - 1] == ',' || line[to - 1] == ';') return std::nullopt;  // a cell of its own
  after = named;
  return Field{std::string(line.substr(0, to)), 0, false};
}

bool is_number(std::string_view text) { return read_sampled(trimmed(text), {}).kind == Cell::value; }

/// Where the cells begin: behind words in front of the first one, "[info] 0.1, 0.2" and "imu - INFO - 0.1 0.2". What
/// one comma divides may be one number: "INFO 1,5".
std::size_t behind_words(std::string_view line, std::size_t from, bool divides = false) {
  const std::string_view text = line.substr(from);
  const std::size_t end = text.find_first_of(",;\t");
  if (end == text.npos) {
    const std::size_t dash = text.rfind(" - ");
    return dash != text.npos && is_number(text.substr(dash + 3, text.find(' ', dash + 3) - dash - 3)) ? from + dash + 3
                                                                                                      : from;
  }
  const std::size_t blank = trimmed(text.substr(0, end)).rfind(' ');
  if (blank == text.npos || label_length(trimmed(text.substr(0, end))) > 0) return from;
  const std::size_t begin = text.find(trimmed(text.substr(0, end))) + blank + 1;
  const std::string_view first = text.substr(begin, end - begin), rest = text.substr(end + 1);
  const bool one = text[end] == ',' && rest.find_first_not_of("0123456789") == rest.npos &&
                   first.find_first_not_of("+-0123456789") == first.npos && !divides;
  return !one && is_number(first) && is_number(rest.substr(0, rest.find_first_of(",;\t"))) ? from + begin : from;
}

/// A stamp among the words in front of the cells: "May 01 12:00:00 host imu[12]:", "12:00:00.123 00>",
/// "1714564800.25"; empty where there is only the sign of a terminal, "00>".
std::optional<Field> lead_of_words(std::string_view line, std::size_t& after, bool divides) {
  constexpr std::size_t kWords = 3, kLongest = 4;
  constexpr double kEpoch = 1e9;
  const std::size_t begin = line.find_first_not_of(" \t"), cells = behind_words(line, begin, divides);
  const std::string_view words = trimmed(line.substr(begin, cells - begin));
  if (words.empty() || line.substr(0, cells).find('"') != line.npos ||
      read_calendar(trimmed(line.substr(begin, line.find_first_of(",;\t") - begin))))
    return std::nullopt;
  after = cells;
  std::size_t from = 0;
  for (std::size_t word = 0; word < kWords && from < words.size(); ++word) {
    std::size_t to = from;
    std::optional<Field> found;
    for (std::size_t n = 0; n < kLongest && to < words.size(); ++n) {
      to = std::min(words.find(' ', to + 1), words.size());
      if (read_calendar(words.substr(from, to - from)))
        found = Field{std::string(words.substr(from, to - from)), begin + from, false};
    }
    if (found) return found;
    from = words.find_first_not_of(' ', std::min(words.find(' ', from), words.size()));
  }
  const std::string_view first = words.substr(0, words.find(' '));
  if (const Cell number = read_cell(first, '.'); number.kind == Cell::value && number.number >= kEpoch)
    return Field{std::string(first), begin, false};
  return words.back() == '>' ? std::optional(Field{"", begin, false}) : std::nullopt;
}

}  // namespace

std::optional<Field> lead_of(std::string_view line, std::string_view lead, std::size_t& after) {
  constexpr std::size_t kLongest = 48;
  std::size_t begin = line.find_first_not_of(" \t");
  if (begin == std::string_view::npos) return std::nullopt;
  if (lead == "=") return lead_of_names(line, after);
  if (lead == " " || lead == kDivided) return lead_of_words(line, after, lead == kDivided);
  if (lead == ",") {  // the comma of the seconds
    constexpr std::size_t kComma = 19, kLength = 23;
    if (line.size() <= kLength || line[kComma] != ',' || line[kLength] != ' ' || begin > 0) return std::nullopt;
    after = std::min(line.find_first_not_of(" \t-", kLength), line.size());
    if (after < line.size() && after > 0 && line[after - 1] == '-') --after;  // a sign
    after = behind_words(line, after);
    return Field{std::string(line.substr(0, kLength)), 0, false};
  }
  if (lead == ")") {
    if (line[begin] < 'A' || line[begin] > 'Z' || line.substr(begin + 1, 2) != " (") return std::nullopt;
    begin += 3;
  } else if (lead == "]") {
    if (line[begin] != '[') return std::nullopt;
    ++begin;
    const std::size_t level = line.find("] [", begin);  // "[INFO] [1711111111.25]: 1 2"
    if (level != line.npos && line.substr(begin, level - begin).find_first_of("0123456789") == line.npos)
      begin = level + 3;
  }
  const std::size_t end = line.substr(0, begin + kLongest).find(lead, begin);
  if (end == std::string_view::npos || begin >= end) return std::nullopt;
  after = std::min(line.find_first_not_of(" \t,;:", end + lead.size()), line.size());
  after = behind_words(line, after);
  const std::string_view stamp = trimmed(line.substr(begin, end - begin));
  return Field{std::string(stamp), static_cast<std::size_t>(stamp.data() - line.data()), false};
}

}  // namespace libchar::csv
