#include "libchar/log/csv/head/candidates.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "libchar/core/refusal.hpp"
#include "libchar/log/csv/head/columns.hpp"
#include "libchar/log/csv/rows/number.hpp"

namespace libchar::csv {

namespace {

constexpr double kOneColumn = 0.75;  // a table of one column is the last thing to be thought of
constexpr double kOddNames = 0.6;    // and so is one whose names are more or fewer than its columns
constexpr double kTabsToo = 0.5;
constexpr double kWord = 0.5;

// What a cell is worth to a table under a decimal mark: one, where it is a number, a date or blank. Any cell may be a
// word; "1,013" is a thousand under a point, and less likely so than a number under a comma.
double worth_of(const Field& field, char decimal) {
  constexpr double kGrouped = 0.95;
  const std::string& text = field.text;
  if (decimal == ',' && text.ends_with(',')) return 0;
  // A number with a point is nothing else under a comma than a thousand.
  const bool pointed = decimal == ',' && !field.quoted && text.find('.') != std::string::npos &&
                       text.find_first_not_of("+-0123456789.eE") == std::string::npos &&
                       (plain_number(text, '.') || read_cell(text, '.').kind == Cell::value);
  const CellKind kind = pointed ? CellKind::odd : cell_kind(field, {decimal});
  if (kind < CellKind::word) return 1;
  for (const char group : {decimal == ',' ? '.' : ',', ' '}) {
    if (text.find(group) == std::string::npos) continue;
    const std::string plain = without_thousands(text, {decimal, group});
    if (plain != text && read_cell(plain, decimal).kind == Cell::value)
      return text.find(decimal) != std::string::npos ? 1 : kGrouped;
  }
  const bool whole = field.quoted || text.find_first_of(",;\t") == std::string::npos;
  return kind == CellKind::word && whole ? kWord : 0;
}

struct Worth {
  double point = 0, comma = 0;
};

struct LineWorth {
  std::size_t cells = 0;
  bool ends_empty = false;  // the last cell
  Worth worth;
  bool row(std::size_t columns) const {  // more than words
    return cells == columns && std::max(worth.point, worth.comma) > kWord * (static_cast<double>(cells) + 1) - 0.1;
  }
};

LineWorth worth_of(const Line& line, char delimiter) {
  LineWorth out;
  const auto fields = split(line.text, delimiter);
  out.cells = fields.size();
  out.ends_empty = fields.size() > 1 && fields.back().text.empty() && !fields.back().quoted && delimiter != ' ';
  for (const Field& field : fields) {
    const bool mark = std::any_of(field.text.begin(), field.text.end(), [](char c) { return c == '.' || c == ','; });
    const double point = worth_of(field, '.');
    out.worth.point += point;
    out.worth.comma += mark ? worth_of(field, ',') : point;
  }
  return out;
}

// An empty last cell is missing where other lines have one there; else a delimiter ends the line.
void drop_empty_ends(std::vector<LineWorth>& lines) {
  std::size_t widest = 0;
  for (const LineWorth& line : lines)
    if (!line.ends_empty) widest = std::max(widest, line.cells);
  for (LineWorth& line : lines)
    if (line.ends_empty && line.cells != widest) --line.cells, --line.worth.point, --line.worth.comma;
}

std::size_t usual_width(const std::vector<LineWorth>& lines) {
  std::map<std::size_t, std::size_t> counts;
  for (const LineWorth& line : lines) ++counts[line.cells];
  std::size_t best = 0, width = 1;
  for (const auto& [cells, count] : counts)
    if (count >= best) best = count, width = cells;
  return width;
}

// Does the line in front of the first row have a name for every column? One that has no line in front may be.
bool names_fit(const std::vector<LineWorth>& lines, std::size_t columns) {
  const auto row = std::find_if(lines.begin(), lines.end(), [&](const LineWorth& line) { return line.row(columns); });
  if (row == lines.end() || row == lines.begin()) return true;
  const LineWorth& names = *(row - 1);
  return names.cells == columns && (columns > 1 || names.worth.point > 0);
}

// At either end: fewer of lines that have many cells, which say as much.
std::size_t lines_looked_at(const Line& one) {
  constexpr std::size_t kMost = 24, kFewest = 8, kBytes = 4096;
  return std::clamp(kBytes / std::max<std::size_t>(one.text.size(), 1), kFewest, kMost);
}

// What stands in front of a table is no table: of many lines the last ones say how it is written.
void add_candidates(const std::vector<Line>& lines, char delimiter, char decimal, std::vector<Candidate>& out) {
  std::vector<LineWorth> all;
  const std::size_t looked = lines_looked_at(lines.back());
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (i >= looked && i + looked < lines.size()) continue;
    if (lines[i].end != LineEnd::none || all.size() < 2)  // a last line without its end may be cut
      all.push_back(worth_of(lines[i], delimiter));
  }
  drop_empty_ends(all);
  const std::vector<LineWorth> body(all.begin() + (all.size() > 4 ? all.size() / 2 : 0), all.end());
  const std::size_t columns = usual_width(body);
  Worth worth;
  double cells = 0, fitting = 0;
  for (const LineWorth& line : body) {
    worth.point += line.worth.point;
    worth.comma += line.worth.comma;
    cells += static_cast<double>(line.cells);
    fitting += line.cells == columns ? 1 : 0;
  }
  const double shape = fitting / static_cast<double>(body.size()) / std::max(cells, 1.0) *
                       (columns > 1 ? 1 : kOneColumn) * (names_fit(all, columns) ? 1 : kOddNames);
  const auto rounded = [](double score) { return std::round(1e9 * score) / 1e9; };
  if (decimal != ',') out.push_back({delimiter, '.', columns, rounded(shape * worth.point)});
  if (decimal != '.') out.push_back({delimiter, ',', columns, rounded(shape * worth.comma)});
  // "398.500;21,144" as well: semicolons stand where commas are decimal marks.
  if (delimiter == ';' && decimal == 0) std::swap(out.back(), out[out.size() - 2]);
}

// "10,000,000.000,012,3 Hz", "10 000 000.000 012", "10,000,000.5": counters write groups of three digits, some on both
// sides of the point. Columns of whole numbers are not meant: those have no unit behind the last and no zeros in front.
bool counter_lines(const std::vector<Line>& lines, char group) {
  const bool blanks = group == ' ';
  const std::string allowed = std::string("+-0123456789.") + group, zero = std::string(1, group) + '0';
  std::size_t grouped = 0, padded = 0;
  bool unit = false, behind = false;
  for (const Line& line : lines) {
    const std::string_view text = trimmed(line.text);
    const std::size_t end = std::min(text.find_first_not_of(allowed), text.size());
    const std::string_view number = trimmed(text.substr(0, end));
    const std::string plain = without_thousands(number, {'.', group});
    const std::size_t point = number.find('.');
    if (point == std::string_view::npos || plain == number || read_cell(plain, '.').kind != Cell::value) continue;
    ++grouped;
    behind = behind || blanks || number.find(group, point) != std::string_view::npos;
    unit = unit || (!blanks && number_and_unit(text));
    bool zeros = false;
    for (std::size_t at = number.find(zero); at != std::string_view::npos; at = number.find(zero, at + 1))
      zeros = zeros || (at + 2 < number.size() && is_digit(number[at + 2]));
    padded += zeros ? 1 : 0;
  }
  return grouped > 2 && 4 * grouped >= 3 * lines.size() && (behind ? unit || padded > 0 : padded > 2);
}

// "19,4731", "19,0473": one comma a line, and behind it always as many digits, zeros in front of them among these; or
// "-0,7", whose -0 is no whole number.
bool digits_behind_commas(const std::vector<Line>& lines) {
  constexpr std::size_t kFewest = 3, kClock = 2;
  std::size_t found = 0, digits = 0;
  bool zeros = false, alike = true, minus = false;
  for (const Line& line : lines) {
    const std::string_view text = trimmed(line.text);
    const std::size_t comma = text.find(',');
    if (comma == std::string_view::npos) continue;
    const std::string_view behind = text.substr(comma + 1);
    if (behind.find_first_not_of("0123456789") != std::string_view::npos) return false;
    alike = alike && (found == 0 || behind.size() == digits);
    digits = behind.size();
    zeros = zeros || behind.starts_with('0');
    minus = minus || text.starts_with("-0,");
    ++found;
  }
  return found >= kFewest && (minus || (alike && zeros && digits > kClock));
}

bool occurs(const std::vector<Line>& lines, char delimiter) {
  return std::any_of(lines.begin(), lines.end(),
                     [&](const Line& line) { return line.text.find(delimiter) != std::string_view::npos; });
}

}  // namespace

std::vector<Candidate> candidates(const std::vector<Line>& lines, char delimiter, char decimal) {
  std::vector<Candidate> out;
  if (delimiter == 0 && decimal != ',' && (counter_lines(lines, ',') || counter_lines(lines, ' ')))
    return {{';', '.', 1, kOneColumn}};
  bool whole = false;  // lines of one cell are looked at once
  for (const char one : {',', ';', '\t', ' ', '|'}) {
    if (delimiter != 0 && one != ',') break;
    const char by = delimiter != 0 ? delimiter : one;
    if (delimiter == 0 && !occurs(lines, by) && std::exchange(whole, true)) continue;
    add_candidates(lines, by, decimal, out);
  }
  // Tabs count as blanks, and names behind tabs have blanks inside: those must win clearly.
  const bool tabs = std::any_of(out.begin(), out.end(),
                                [](const Candidate& one) { return one.delimiter == '\t' && one.columns > 1; });
  for (Candidate& one : out)
    if (one.delimiter == ' ' && tabs) one.score *= kTabsToo;
  const bool padded = delimiter == 0 && decimal == 0 && digits_behind_commas(lines);
  for (Candidate& one : out)
    if (padded && one.delimiter == ',' && one.columns > 1) one.score *= kOneColumn * kOneColumn;
  std::stable_sort(out.begin(), out.end(), [](const Candidate& a, const Candidate& b) {
    return a.score != b.score ? a.score > b.score : a.columns > b.columns;
  });
  return out;
}

char thousands_mark(const std::vector<Line>& lines, char delimiter, char decimal) {
  constexpr std::size_t kEnough = 3;
  std::map<char, std::size_t> found;
  for (const Line& line : lines)
    for (const Field& field : split(line.text, delimiter)) {
      const char other = decimal == ',' ? '.' : ',';
      const auto mark = [&](char c) { return c == other || c == '\'' || c == ' '; };
      if (std::none_of(field.text.begin(), field.text.end(), mark)) continue;
      if (cell_kind(field, {decimal}) == CellKind::number) continue;
      for (const char group : {',', '.', '\'', ' '}) {
        if (group == decimal || field.text.find(group) == std::string::npos || (group == ' ' && delimiter == ' '))
          continue;
        const auto measured = number_and_unit(field.text);
        const std::string_view number = measured ? measured->number : field.text;
        const std::string plain = without_thousands(number, {decimal, group});
        const bool grouped = plain != number && read_cell(plain, decimal).kind == Cell::value;
        if (grouped && ++found[group] == kEnough) return group;
      }
    }
  return 0;
}

char named_delimiter(const std::string& name) {
  if (name == "tab" || name == "\\t" || name == "\t") return '\t';
  if (name == "space" || name == " ") return ' ';
  if (name.size() == 1 && !is_digit(name[0]) && name[0] != '"' && name[0] != '\r' && name[0] != '\n' &&
      name[0] != '-' && name[0] != '+')
    return name[0];
  throw usage_error("E0202", "`delimiter`")
      .says("unknown delimiter")
      .got(name)
      .hint("use auto, tab, space, or one character such as , or ;");
}

std::string delimiter_name(char delimiter) {
  if (delimiter == '\t') return "tab";
  if (delimiter == ' ') return "blanks";
  return std::string(1, delimiter);
}

}  // namespace libchar::csv
