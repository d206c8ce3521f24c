#include "libchar/log/csv/head/columns.hpp"

#include <algorithm>
#include <array>
#include <numeric>

#include "libchar/core/text/text.hpp"
#include "libchar/core/units.hpp"
#include "libchar/log/detail/column_name.hpp"
#include "libchar/log/time/calendar.hpp"

namespace libchar::csv {
namespace {

constexpr std::string_view kOfNumbers = "+-0123456789.,eE ";

// Bytes outside ASCII are those of UTF-8, or of an older Windows.
std::string utf8_of(std::string_view text) {
  if (first_invalid_utf8(text) == std::string_view::npos) return std::string(text);
  return windows1252_to_utf8(text).value_or("");
}

bool letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }

// Words begin with a letter, or hold several; "+-1" and "1d5" are numbers gone wrong.
bool like_words(std::string_view text) {
  const auto outside = static_cast<unsigned char>(text[0]);
  const bool typeset = text.starts_with("\xE2\x88\x92") || text.starts_with("\xE2\x80\x8B");
  if (letter(text[0]) || text[0] == '/' || text[0] == '<' || (outside >= 0x80 && !typeset)) return true;
  if (text.starts_with("0x") || std::count(text.begin(), text.end(), '.') == 3) return true;  // addresses
  if (text.find(" / ") != std::string_view::npos) return true;                                // "13 / 18" satellites
  return std::count_if(text.begin(), text.end(), letter) > 1 || text.find(':') != std::string_view::npos;
}

using KindCounts = std::array<std::size_t, static_cast<std::size_t>(CellKind::odd) + 1>;

ColumnKind kind_of(const KindCounts& counts) {
  const auto count = [&](CellKind kind) { return counts[static_cast<std::size_t>(kind)]; };
  CellKind most = CellKind::blank;
  for (const CellKind kind :
       {CellKind::stamp, CellKind::date, CellKind::clock, CellKind::number, CellKind::word, CellKind::odd})
    if (count(kind) > (most == CellKind::blank ? 0 : count(most))) most = kind;
  switch (most) {
    case CellKind::blank:
      return ColumnKind::empty;
    case CellKind::stamp:
      return ColumnKind::calendar;
    case CellKind::date:
      return ColumnKind::date;
    case CellKind::clock:
      return ColumnKind::clock;
    default:
      break;
  }
  const std::size_t cells = std::accumulate(counts.begin(), counts.end(), std::size_t{0});
  const std::size_t words = count(CellKind::word), filled = cells - count(CellKind::blank);
  // Oscilloscopes put their settings, numbers among them, beside the first rows of a table.
  const bool beside = filled * 4 < cells && 4 * words > filled;
  return cells > 1 && (words == filled || beside) ? ColumnKind::text : ColumnKind::number;
}

}  // namespace

std::string without_thousands(std::string_view text, NumberStyle style) {
  if (style.thousands == 0) return std::string(text);
  std::size_t i = !text.empty() && (text[0] == '-' || text[0] == '+') ? 1 : 0;
  std::string out(text.substr(0, i));
  std::size_t group = 0, groups = 0;
  const auto digits = [&](std::size_t first_group) {  // false where groups are not of three
    group = 0;
    for (std::size_t here = 0; i < text.size() && (is_digit(text[i]) || text[i] == style.thousands); ++i) {
      if (is_digit(text[i])) {
        out += text[i];
        ++group;
        continue;
      }
      if (here++ == 0 ? group < 1 || group > 3 || group < first_group : group != 3) return false;
      ++groups;
      group = 0;
    }
    return true;
  };
  if (!digits(1) || (groups > 0 && group != 3)) return std::string(text);
  if (i < text.size() && text[i] != style.decimal) return std::string(text);
  const std::size_t whole = groups;
  if (i < text.size()) {  // counters group the digits behind the mark, too
    out += text[i++];
    if (!digits(3) || (groups > whole && (group < 1 || group > 3))) return std::string(text);
  }
  return groups == 0 ? std::string(text) : out + std::string(text.substr(i));
}

std::size_t label_length(std::string_view text) {
  if (text.empty() || !letter(text[0])) return 0;
  std::size_t i = 1;
  while (i < text.size() &&
         (letter(text[i]) || is_digit(text[i]) || text[i] == '.' || text[i] == '-' || text[i] == '[' || text[i] == ']'))
    ++i;
  if (i < text.size() && text[i] == '(') i = std::min(text.find(')', i), text.size() - 1) + 1;  // "ax(g): 0.02"
  while (i < text.size() && text[i] == ' ') ++i;
  if (i + 1 >= text.size() || (text[i] != '=' && text[i] != ':')) return 0;
  ++i;
  while (i < text.size() && text[i] == ' ') ++i;
  return i < text.size() ? i : 0;
}

Cell read_styled(std::string_view text, NumberStyle style) {
  const Cell plain = read_cell(text, style.decimal);
  if (plain.kind != Cell::bad) return plain;
  if (const std::size_t label = label_length(text); label > 0) return read_styled(text.substr(label), style);
  return style.thousands == 0 ? plain : read_cell(without_thousands(text, style), style.decimal);
}

std::optional<MeasuredCell> number_and_unit(std::string_view text) {
  constexpr std::size_t kLongestUnit = 24;
  const std::size_t end = text.find_first_not_of(kOfNumbers);
  if (end != std::string_view::npos && text.size() - end > kLongestUnit) return std::nullopt;
  if (end == 0 || end == std::string_view::npos || text.find_first_of("0123456789") >= end) return std::nullopt;
  const MeasuredCell cell{trimmed(text.substr(0, end)), text.substr(end)};
  std::string_view symbol = cell.unit;  // "1.2957 V DC" of multimeters
  if (symbol.ends_with(" DC") || symbol.ends_with(" AC")) symbol.remove_suffix(3);
  const auto unit = find_unit(utf8_of(symbol));
  if (unit) return dimensionless(unit->symbol) ? std::nullopt : std::optional(cell);
  // "3A" may be a number of base sixteen.
  const bool clear =
      symbol.size() > 1 || cell.number.size() < end || cell.number.find_first_of(".,") != cell.number.npos;
  return clear && unconverted_unit(symbol) ? std::optional(cell) : std::nullopt;
}

bool unconverted_unit(std::string_view text) {
  static constexpr std::array<std::string_view, 37> kUnits = {
      "m/s", "km/h", "knots", "mph", "a",   "ma",  "ua",  "w",  "mw", "kw",    "wh",        "kwh", "m",
      "mm",  "cm",   "km",    "ft",  "ohm", "lux", "n",   "kn", "lb", "lbs",   "lbf",       "kg",  "mg/l",
      "l",   "ml",   "db",    "dbm", "kib", "mib", "gib", "kb", "mb", "w/m^2", "umol/s/m^2"};
  return std::find(kUnits.begin(), kUnits.end(), ascii_lower(text)) != kUnits.end();
}

bool same_unit(std::string_view a, std::string_view b) {
  if (a == b) return true;
  const auto one = find_unit(utf8_of(a)), other = find_unit(utf8_of(b));
  return one && other && one->symbol == other->symbol;
}

Cell read_sampled(std::string_view text, NumberStyle style) {
  const Cell cell = read_styled(text, style);
  if (cell.kind != Cell::bad) return cell;
  const auto measured = number_and_unit(text);
  return measured ? read_styled(measured->number, style) : cell;
}

bool plain_number(std::string_view text, char decimal) {
  constexpr std::size_t kLongest = 18;  // no double overflows by so many digits
  std::size_t i = !text.empty() && (text[0] == '-' || text[0] == '+') ? 1 : 0, digits = 0, marks = 0;
  for (; i < text.size(); ++i) {
    digits += is_digit(text[i]) ? 1 : 0;
    marks += text[i] == decimal ? 1 : 0;
    if (!is_digit(text[i]) && (text[i] != decimal || marks > 1)) return false;
  }
  return digits > 0 && text.size() <= kLongest;
}

CellKind cell_kind(const Field& field, NumberStyle style) {
  const std::string_view text = field.text;
  if (plain_number(text, style.decimal)) return CellKind::number;
  const Cell cell = read_sampled(text, style);
  if (cell.kind == Cell::missing) return CellKind::blank;
  if (cell.kind != Cell::bad) return CellKind::number;
  constexpr std::size_t kLongestDate = 128;  // longer ones are whole lines, split by another delimiter
  if (const auto stamp = text.size() > kLongestDate ? std::nullopt : read_calendar(text))
    return !stamp->clock ? CellKind::date : stamp->date ? CellKind::stamp : CellKind::clock;
  if (const std::size_t label = label_length(text); label > 0 && !field.quoted && is_digit(text[label])) {
    const CellKind behind = cell_kind({std::string(text.substr(label)), 0, false}, style);  // "time=2024-05-01T…"
    if (behind == CellKind::stamp || behind == CellKind::date || behind == CellKind::clock) return behind;
  }
  const bool word = field.quoted || (like_words(text) && !number_and_unit(text));
  return word ? CellKind::word : CellKind::odd;
}

std::vector<ColumnKind> column_kinds(const std::vector<Cells>& rows, std::size_t columns, NumberStyle style) {
  std::vector<KindCounts> counts(columns, KindCounts{});
  for (const Cells& row : rows)
    for (std::size_t c = 0; c < std::min(columns, row.size()); ++c)
      ++counts[c][static_cast<std::size_t>(cell_kind(row[c], style))];
  std::vector<ColumnKind> kinds;
  kinds.reserve(columns);
  for (const KindCounts& one : counts) kinds.push_back(kind_of(one));
  return kinds;
}

}  // namespace libchar::csv
