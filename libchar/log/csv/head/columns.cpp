#include "libchar/log/csv/head/columns.hpp"

#include <algorithm>

#include "libchar/core/text/utf8.hpp"
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

bool letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

struct Census {
  std::size_t numbers = 0, dates = 0, clocks = 0, stamps = 0, words = 0, odd = 0, blanks = 0;

  void add(const Field& field, NumberStyle style) {
    const std::string_view text = field.text;
    const Cell cell = read_sampled(text, style);
    if (cell.kind == Cell::missing) {
      ++blanks;
    } else if (cell.kind != Cell::bad) {
      ++numbers;
    } else if (const auto stamp = read_calendar(text, DateOrder::day_first),
               other = read_calendar(text, DateOrder::month_first);
               stamp || other) {
      const CalendarStamp& s = stamp ? *stamp : *other;
      ++(s.date && s.clock ? stamps : s.date ? dates : clocks);
    } else {
      ++(!field.quoted && (number_and_unit(text) || !like_words(text)) ? odd : words);
    }
  }

  ColumnKind kind() const {
    const std::size_t most = std::max({numbers, dates, clocks, stamps, words, odd});
    if (most == 0) return ColumnKind::empty;
    if (stamps == most) return ColumnKind::calendar;
    if (dates == most) return ColumnKind::date;
    if (clocks == most) return ColumnKind::clock;
    return words + blanks > 1 && numbers + dates + clocks + stamps + odd == 0 ? ColumnKind::text
                                                                              : ColumnKind::number;
  }
};

}  // namespace

bool like_words(std::string_view text) {
  const auto outside = static_cast<unsigned char>(text[0]);
  const bool typeset = text.starts_with("\xE2\x88\x92") || text.starts_with("\xE2\x80\x8B");
  if (letter(text[0]) || text[0] == '/' || text[0] == '<' || (outside >= 0x80 && !typeset))
    return true;
  return std::count_if(text.begin(), text.end(), letter) > 1 ||
         text.find(':') != std::string_view::npos;
}

std::string without_thousands(std::string_view text, NumberStyle style) {
  if (style.thousands == 0) return std::string(text);
  std::string out;
  std::size_t i = !text.empty() && (text[0] == '-' || text[0] == '+') ? 1 : 0;
  out = text.substr(0, i);
  std::size_t group = 0, groups = 0;
  for (; i < text.size() && (is_digit(text[i]) || text[i] == style.thousands); ++i) {
    if (is_digit(text[i])) {
      out += text[i];
      ++group;
      continue;
    }
    if (groups == 0 ? group < 1 || group > 3 : group != 3) return std::string(text);
    ++groups;
    group = 0;
  }
  if (groups == 0 || group != 3 || (i < text.size() && text[i] != style.decimal))
    return std::string(text);
  return out + std::string(text.substr(i));
}

std::size_t label_length(std::string_view text) {
  if (text.empty() || !letter(text[0])) return 0;
  std::size_t i = 1;
  while (i < text.size() && (letter(text[i]) || is_digit(text[i]) || text[i] == '.' ||
                             text[i] == '-' || text[i] == '[' || text[i] == ']'))
    ++i;
  while (i < text.size() && text[i] == ' ') ++i;
  if (i + 1 >= text.size() || (text[i] != '=' && text[i] != ':')) return 0;
  ++i;
  while (i < text.size() && text[i] == ' ') ++i;
  return i < text.size() ? i : 0;
}

Cell read_styled(std::string_view text, NumberStyle style) {
  const Cell plain = read_cell(text, style.decimal);
  if (plain.kind != Cell::bad) return plain;
  if (const std::size_t label = label_length(text); label > 0)
    return read_styled(text.substr(label), style);
  return style.thousands == 0 ? plain : read_cell(without_thousands(text, style), style.decimal);
}

std::optional<MeasuredCell> number_and_unit(std::string_view text) {
  const std::size_t end = text.find_first_not_of(kOfNumbers);
  if (end == 0 || end == std::string_view::npos || text.find_first_of("0123456789") >= end)
    return std::nullopt;
  const MeasuredCell cell{trimmed(text.substr(0, end)), text.substr(end)};
  const auto unit = find_unit(utf8_of(cell.unit));
  return unit && !dimensionless(unit->symbol) ? std::optional(cell) : std::nullopt;
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

std::vector<ColumnKind> column_kinds(const std::vector<Cells>& rows,
                                     std::size_t columns,
                                     NumberStyle style) {
  std::vector<Census> census(columns);
  for (const Cells& row : rows)
    for (std::size_t c = 0; c < std::min(columns, row.size()); ++c) census[c].add(row[c], style);
  std::vector<ColumnKind> kinds;
  kinds.reserve(census.size());
  for (const Census& one : census) kinds.push_back(one.kind());
  return kinds;
}

}  // namespace libchar::csv
