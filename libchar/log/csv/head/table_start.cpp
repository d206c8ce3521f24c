#include "libchar/log/csv/head/table_start.hpp"

#include <algorithm>
#include <array>

#include "libchar/core/text/text.hpp"
#include "libchar/core/units.hpp"
#include "libchar/log/time/calendar.hpp"

namespace libchar::csv {
namespace {

struct LineCensus {
  bool fits = false;              // as many cells as the table has columns
  std::size_t good = 0, bad = 0;  // cells that are what their column holds, and those that are not
  bool row() const { return fits && bad == 0; }
  bool words() const { return fits && good == 0 && bad > 0; }
};

LineCensus census_of(const Cells& line, const std::vector<ColumnKind>& kinds, NumberStyle style) {
  LineCensus out;
  out.fits = line.size() == kinds.size();
  for (std::size_t c = 0; c < std::min(line.size(), kinds.size()); ++c) {
    const std::string& text = line[c].text;
    if (kinds[c] == ColumnKind::text || kinds[c] == ColumnKind::empty) continue;
    const Cell cell = read_sampled(text, style);
    if (cell.kind == Cell::missing) continue;
    const bool number = cell.kind != Cell::bad;
    const bool calendar = !number && (read_calendar(text, DateOrder::day_first) ||
                                      read_calendar(text, DateOrder::month_first));
    ++(kinds[c] == ColumnKind::number ? (number ? out.good : out.bad)
                                      : (calendar ? out.good : out.bad));
  }
  return out;
}

// "(ms)", "V", "second", and what stands there for columns without a unit.
bool unit_cell(std::string_view text) {
  static constexpr std::array<std::string_view, 6> kNone = {
      "ts", "rn", "sequence", "-", "n/a", "none"};
  if (text.size() > 2 &&
      ((text.front() == '(' && text.back() == ')') || (text.front() == '[' && text.back() == ']')))
    return true;
  const std::string lower = ascii_lower(text);
  return find_unit(text) || std::find(kNone.begin(), kNone.end(), lower) != kNone.end();
}

bool line_of_units(const Cells& line) {
  std::size_t units = 0, others = 0;
  for (const Field& field : line)
    if (!field.text.empty()) ++(unit_cell(field.text) ? units : others);
  return units > 0 && units >= others;
}

// Campbell's table-oriented ASCII: station, names, units, what was done with the values.
bool campbell(const std::vector<Cells>& lines) {
  return lines.size() > 4 && (lines[0][0].text == "TOA5" || lines[0][0].text == "TOACI1");
}

// A line of words with one cell too many or too few, directly in front of the rows.
bool names_off_by_one(const Cells& line, std::size_t columns) {
  if (line.size() + 1 != columns && line.size() != columns + 1) return false;
  return line.size() > 1 && std::all_of(line.begin(), line.end(), [](const Field& field) {
           return read_cell(field.text, '.').kind == Cell::bad &&
                  read_cell(field.text, ',').kind == Cell::bad;
         });
}

}  // namespace

TableStart find_table_start(const std::vector<Cells>& lines,
                            const std::vector<ColumnKind>& kinds,
                            NumberStyle style) {
  if (campbell(lines)) return {4, 1, 2};
  TableStart out;
  std::vector<LineCensus> census;
  census.reserve(lines.size());
  for (const Cells& line : lines) census.push_back(census_of(line, kinds, style));
  const auto first_row = std::find_if(census.begin(), census.end(), [](const LineCensus& line) {
    return line.row() && line.good > 0;
  });
  if (first_row == census.end() && census[0].fits && census[0].bad > 0) {  // a header, then damage
    out.names = 0;
    out.data = 1;
    return out;
  }
  const auto rows_at = static_cast<std::size_t>(first_row - census.begin());
  if (first_row == census.end() || rows_at == 0) return out;
  out.data = rows_at;
  if (!census[rows_at - 1].fits && names_off_by_one(lines[rows_at - 1], kinds.size())) {
    out.names = rows_at - 1;
    return out;
  }
  std::size_t last = rows_at;  // the last line in front that is words only
  while (last > 0 && !census[last - 1].words()) --last;
  if (last > 0) {
    out.data = last;
    out.names = last - 1;
    const bool named_above = last > 1 && census[last - 2].fits && census[last - 2].bad > 0;
    if (named_above && line_of_units(lines[last - 1]) && !line_of_units(lines[last - 2])) {
      out.units = last - 1;
      out.names = last - 2;
    }
    return out;
  }
  // No line of words: names with numbers among them (c, 1, 2), a row that is damaged, or lines that do not fit.
  const auto fitting =
      std::find_if(census.begin(), first_row, [](const LineCensus& line) { return line.fits; });
  if (fitting != first_row) {
    const auto at = static_cast<std::size_t>(fitting - census.begin());
    out.names = at;
    out.data = at + 1;
    return out;
  }
  // Names, one too many or too few, directly in front of the rows.
  const std::size_t cells = lines[rows_at - 1].size();
  const std::size_t off = cells > kinds.size() ? cells - kinds.size() : kinds.size() - cells;
  if (cells > 1 && 2 * off <= kinds.size() + 1) out.names = rows_at - 1;
  return out;
}

}  // namespace libchar::csv
