#include "libchar/log/csv/head/first_lines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>

#include "libchar/core/error.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/core/units.hpp"
#include "libchar/log/csv/line.hpp"
#include "libchar/log/reading_fields.hpp"
#include "libchar/log/time/calendar.hpp"
#include "libchar/log/time/time_column.hpp"

namespace libchar::csv {

namespace {

constexpr std::string_view kBetween = " \t:=,;\"'()[]";

// The key in front of the first number of a line, its letters only, and what stands behind.
struct Statement {
  std::string key;
  std::optional<double> number;
  std::string_view unit;
  bool of_a_name = false;  // the number of "<Tau20>"
};

Statement statement_in(std::string_view lower) {
  Statement out;
  const std::size_t word = lower.find("rate");
  const std::size_t at = lower.find_first_of("0123456789", word == std::string_view::npos ? 0 : word);
  if (at == std::string_view::npos) return out;
  for (const char c : lower.substr(0, at))
    if (c >= 'a' && c <= 'z') out.key += c;
  out.of_a_name = at > 0 && lower[at - 1] >= 'a' && lower[at - 1] <= 'z';
  std::size_t end = at;
  while (end < lower.size() &&
         ((lower[end] >= '0' && lower[end] <= '9') || lower[end] == '.' || lower[end] == '+' || lower[end] == '-' ||
          (lower[end] == 'e' && end + 1 < lower.size() &&
           std::string_view("+-0123456789").find(lower[end + 1]) != std::string_view::npos)))
    ++end;
  std::string text(lower.substr(at, end - at));
  while (!text.empty() && (text.back() == '.' || text.back() == '-')) text.pop_back();
  if (end < lower.size() && lower[end] == ',' && end + 1 < lower.size() && lower[end + 1] >= '0' &&
      lower[end + 1] <= '9' && text.find('.') == std::string::npos &&
      lower.substr(0, at).find(',') == std::string_view::npos) {  // a decimal comma
    const std::size_t stop = std::min(lower.find_first_not_of("0123456789", end + 1), lower.size());
    text += "." + std::string(lower.substr(end + 1, stop - end - 1));
    end = stop;
  }
  out.number = parse_double(text);
  const std::size_t unit = lower.find_first_not_of(kBetween, end);
  const bool next_key = lower.find('{') != std::string_view::npos && end < lower.size() && lower[end] == ',';  // JSON
  if (unit != std::string_view::npos && !next_key &&
      (lower[unit] < '0' || lower[unit] > '9')) {  // else of the next column
    const std::size_t stop = std::min(lower.find_first_of(kBetween, unit), lower.size());
    out.unit = lower.substr(unit, stop - unit);
  }
  return out;
}

template <std::size_t N>
bool ends_with_any(std::string_view key, const std::array<std::string_view, N>& ends) {
  return std::any_of(ends.begin(), ends.end(), [&](std::string_view end) { return key.ends_with(end); });
}

double hertz_of(const Statement& said) {
  static constexpr std::array<std::string_view, 16> kKeys = {
      "samplerate",        "samplingrate",    "samplesrate", "outputrate",
      "updaterate",        "acquisitionrate", "scanrate",    "datarate",
      "samplingfrequency", "samplefrequency", "samplefreq",  "samplingfreq",
      "loggingrate",       "recordingrate",   "imurate",     "odr"};
  std::string_view key = said.key;
  double factor = said.unit.starts_with("khz") ? 1e3 : said.unit.starts_with("mhz") ? 1e6 : 1;
  bool hertz = said.unit.starts_with("hz") || said.unit.starts_with("khz") || said.unit.starts_with("mhz") ||
               said.unit.starts_with("sps") || said.unit.starts_with("samples/s");
  const bool rate = key.find("rate") != std::string_view::npos || key.find("frequency") != std::string_view::npos;
  static constexpr std::array<std::string_view, 5> kOthers = {"baud", "filter", "cutoff", "pass", "band"};
  const bool other = std::any_of(kOthers.begin(), kOthers.end(),
                                 [&](std::string_view word) { return key.find(word) != std::string_view::npos; });
  if (rate && hertz && !other) return *said.number * factor;
  if (key.ends_with("hz")) {  // "Sample Rate (Hz)": 100, "Sampling Freq(Hz) 100Hz"
    hertz = true;
    key.remove_suffix(2);
    if (key.ends_with("k")) {
      factor = said.unit.empty() ? 1e3 : factor;
      key.remove_suffix(1);
    }
  }
  return (hertz || said.unit.empty()) && (ends_with_any(key, kKeys) || key == "fs") ? *said.number * factor : 0;
}

double interval_of(const Statement& said) {
  static constexpr std::array<std::string_view, 13> kKeys = {
      "intervalseconds",  "acquisitionperiod", "acquisitioninterval", "logginginterval", "sampleinterval",
      "samplinginterval", "sampleperiod",      "samplingperiod",      "deltax",          "timestep",
      "sampletime",       "samplingtime",      "xincrement"};
  std::string_view key = said.key, unit = said.unit;
  for (const std::string_view known : {"ms", "us", "ns", "s"})  // "Sampling period (ms)": 4
    if (unit.empty() && key.ends_with(known) && ends_with_any(key.substr(0, key.size() - known.size()), kKeys)) {
      key.remove_suffix(known.size());
      unit = known;
    }
  const auto known = find_unit(unit);
  const bool said_of_time = known && known->quantity == Quantity::time;
  const double factor = said_of_time ? known->to_si : 1;
  static constexpr std::array<std::string_view, 6> kWithUnit = {
      "loginterval", "recordinginterval", "measurementinterval", "messintervall", "abtastintervall", "abtastzeit"};
  const bool interval = said_of_time && (key == "interval" || key == "intervall" || ends_with_any(key, kWithUnit));
  const bool clock = key == "clock" && (factor < 1 || unit == "s");  // "#CLOCK=400.000uS" of Hantek
  const bool step = (key == "dt" || key == "tau") && !said.of_a_name;
  return ends_with_any(key, kKeys) || step || clock || interval ? *said.number * factor : 0;
}

/// "Epoch Period (hh:mm:ss) 00:00:15" of ActiGraph: seconds.
std::optional<double> interval_of_clock(std::string_view lower) {
  if (lower.find("period") == std::string_view::npos && lower.find("interval") == std::string_view::npos)
    return std::nullopt;
  std::string_view text = trimmed(lower.substr(0, lower.find_last_not_of(",; \t\"") + 1));  // npos + 1 is 0
  text = text.substr(text.find_last_of(" \t,;=\"") + 1);
  const auto clock = read_calendar(text);
  const bool seconds = clock && clock->clock && clock->seconds && !clock->date && clock->ns > 0;
  return seconds ? std::optional(static_cast<double>(clock->ns) * 1e-9) : std::nullopt;
}

}  // namespace

std::optional<double> stated_rate_hz(std::string_view line) {
  const std::string lower = ascii_lower(line);
  const std::size_t sps = lower.find(" sps,");  // "12000 samples, 20 sps, 2018-01-01T00:00:00, SLIST"
  const std::size_t before = sps == std::string::npos ? sps : lower.rfind(',', sps);
  if (before != std::string::npos)
    return parse_double(trimmed(std::string_view(lower).substr(before + 1, sps - before - 1)));
  // "NPTS= 4096, DT= .005 SEC", "4096  .0050  NPTS, DT" of PEER
  if (lower.find("npts") != std::string::npos) {
    const std::size_t step = lower.find("dt="), end = step == std::string::npos ? lower.find("npts") : lower.size();
    std::size_t from =
        step == std::string::npos ? lower.find_first_of(" \t", lower.find_first_of("0123456789")) : step + 3;
    from = std::min(lower.find_first_of(".0123456789", from), end);
    const std::size_t to = std::min(lower.find_first_not_of(".0123456789e-", from), lower.size());
    const auto interval = parse_double(std::string_view(lower).substr(from, to - from));
    return interval && *interval > 0 ? std::optional(1 / *interval) : std::nullopt;
  }
  // "sampled at 50 Hz", "Data File Created By ActiGraph … at 30 Hz": no cutoff of a filter.
  if (const std::size_t at = lower.find(" at "); at != std::string::npos && at + 4 < lower.size())
    if (const Statement rate = statement_in(std::string_view(lower).substr(at)); rate.number && rate.key == "at")
      for (const std::string_view taken : {"sampl", "record", "created"})
        if (rate.unit.starts_with("hz") && *rate.number > 0 && lower.find(taken) < at) return rate.number;
  if (const auto interval = interval_of_clock(lower)) return 1 / *interval;
  const Statement said = statement_in(lower);
  if (!said.number || said.key.empty()) return std::nullopt;
  double rate = hertz_of(said);
  if (rate == 0)
    if (const double interval = interval_of(said); interval > 0) rate = 1 / interval;
  if (!(rate >= kRates.lowest && rate <= kRates.highest)) return std::nullopt;
  return rate;
}

bool speaks_of_time(std::string_view line) {
  static constexpr std::array<std::string_view, 9> kWords = {"time", "rate", "freq",      "period",  "interval",
                                                             " hz",  "sps",  "increment", "duration"};
  const std::string lower = ascii_lower(line);
  return lower.find_first_of("0123456789") != std::string::npos &&
         std::any_of(kWords.begin(), kWords.end(),
                     [&](std::string_view word) { return lower.find(word) != std::string::npos; });
}

std::optional<double> stated_count(std::string_view line, std::string_view key) {
  const std::string lower = ascii_lower(line);
  const Statement said = statement_in(lower);
  return said.key == key && said.number && *said.number > 0 ? said.number : std::nullopt;
}

namespace {

struct LineCensus {
  bool fits = false;              // as many cells as the table has columns, and more than a title in the first
  bool undated = false;           // a word where the rows have dates
  std::size_t good = 0, bad = 0;  // cells that are what their column holds, and those that are not
  bool row() const { return fits && bad == 0; }
  bool words() const { return fits && good == 0 && bad > 0; }
};

LineCensus census_of(const Cells& line, const std::vector<ColumnKind>& kinds, NumberStyle style, bool labels) {
  LineCensus out;
  const bool title = line.size() > 2 && std::all_of(line.begin() + 1, line.end(), [](const Field& field) {
                       return field.text.empty() && !field.quoted;
                     });
  out.fits = line.size() == kinds.size() &&
             !(title && (is_ruler(line[0].text) || cell_kind(line[0], style) >= CellKind::word));
  for (std::size_t c = 0; c < std::min(line.size(), kinds.size()); ++c) {
    if (kinds[c] == ColumnKind::text || kinds[c] == ColumnKind::empty) continue;
    const CellKind kind = cell_kind(line[c], style);
    if (kind == CellKind::blank) continue;
    const bool labelled = !labels && label_length(line[c].text) > 0;  // "Serial: 12345" above plain numbers
    const bool good = !labelled && (kinds[c] == ColumnKind::number ? kind == CellKind::number
                                                                   : kind > CellKind::number && kind < CellKind::word);
    ++(good ? out.good : out.bad);
    out.undated = out.undated || (kinds[c] != ColumnKind::number && kind == CellKind::word);
  }
  return out;
}

// "(ms)", "V", "second", and what stands there for columns without a unit.
bool unit_cell(std::string_view text) {
  static constexpr std::array<std::string_view, 6> kNone = {"ts", "rn", "sequence", "-", "n/a", "none"};
  if (text.size() > 2 && ((text.front() == '(' && text.back() == ')') || (text.front() == '[' && text.back() == ']')))
    return true;
  return find_unit(text) || unconverted_unit(text) ||
         std::find(kNone.begin(), kNone.end(), ascii_lower(text)) != kNone.end();
}

/// Two cells alike, which are no names.
bool has_doubles(const Cells& line) {
  std::vector<std::string_view> texts;
  for (const Field& field : line)
    if (!field.text.empty()) texts.push_back(field.text);
  std::sort(texts.begin(), texts.end());
  return std::adjacent_find(texts.begin(), texts.end()) != texts.end();
}

/// "5s", "15s", "20d", "14n" below the names: widths and types of an RDB table (USGS).
bool line_of_types(const Cells& line) {
  return line.size() > 1 && std::all_of(line.begin(), line.end(), [](const Field& field) {
           const std::size_t digits = field.text.find_first_not_of("0123456789");
           return !field.text.empty() && digits > 0 && digits + 1 == field.text.size() &&
                  std::string_view("sdn").find(field.text.back()) != std::string_view::npos;
         });
}

bool line_of_units(const Cells& line) {
  std::size_t units = 0, others = 0;
  for (const Field& field : line)
    if (!field.text.empty()) ++(unit_cell(field.text) ? units : others);
  return units > 0 && units >= others;
}

// "Time,a" above "sec,counts": the unit of the time alone says that these are units.
bool unit_of_the_time(const Cells& names, const Cells& units) {
  for (std::size_t c = 0; c < std::min(names.size(), units.size()); ++c)
    if (const auto unit = find_unit(units[c].text);
        unit && unit->quantity == Quantity::time && called_time(names[c].text))
      return true;
  return false;
}

bool any_empty(const Cells& line) {
  return std::any_of(line.begin(), line.end(), [](const Field& field) { return field.text.empty(); });
}

// Names, units, and in front of the rows at `rows` what some of the columns are from or what was done with them:
// ",,100: gps" of RaceChrono, ",,Avg" of Campbell's without the line of the station.
bool sources_below_units(const std::vector<Cells>& lines, std::size_t rows) {
  const Cells &names = lines[rows - 3], &units = lines[rows - 2], &sources = lines[rows - 1];
  return names.size() == sources.size() && !any_empty(names) && any_empty(sources) && !line_of_units(names) &&
         !line_of_units(sources) && (line_of_units(units) || unit_of_the_time(names, units));
}

// Shimmer has a line between names and units that says what was done with the values; columns that it adds itself have
// their names once more.
bool states_calibration(const Cells& line, const Cells& above) {
  const auto stated = [](const Field& field) { return field.text == "CAL" || field.text == "RAW"; };
  if (std::none_of(line.begin(), line.end(), stated)) return false;
  for (std::size_t c = 0; c < line.size(); ++c)
    if (!stated(line[c]) && !line[c].text.empty() && (c >= above.size() || line[c].text != above[c].text)) return false;
  return true;
}

// Campbell's table-oriented ASCII: station, names, units, what was done with the values.
bool campbell(const std::vector<Cells>& lines) {
  return lines.size() > 4 && (lines[0][0].text == "TOA5" || lines[0][0].text == "TOACI1");
}

// "ERR,0.125,2": of a row with fractions one cell is no number, and none is a name of time.
bool damaged(const Cells& line, NumberStyle style) {
  bool fractions = false, named = false;
  for (const Field& field : line) {
    const Cell cell = read_styled(field.text, style);
    fractions = fractions || (cell.kind == Cell::value && field.text.find(style.decimal) != std::string::npos);
    named = named || (cell.kind == Cell::bad && (field.quoted || called_time(field.text)));
  }
  return fractions && !named;
}

// "0,1,2,3" above numbers with fractions, or eight columns and more, ",0,1" above an index: pandas numbers columns that
// have no names.
bool numbers_columns(const std::vector<Cells>& lines, NumberStyle style) {
  constexpr std::size_t kFewest = 3, kSure = 8;
  if (lines.size() < kFewest || lines[0].size() < kFewest) return false;
  const std::size_t index = lines[0][0].text.empty() ? 1 : 0;
  for (std::size_t c = index; c < lines[0].size(); ++c)
    if (lines[0][c].text != std::to_string(c - index)) return false;
  if (index > 0) return lines[1][0].text == "0" && lines[2][0].text == "1";
  if (lines[0].size() >= kSure && lines[1].back().text != std::to_string(lines[0].size())) return true;
  return std::all_of(lines.begin() + 1, lines.end(), [&](const Cells& line) {
    return std::all_of(line.begin() + 1, line.end(),
                       [&](const Field& field) { return field.text.find(style.decimal) != std::string::npos; });
  });
}

// Cell by cell of one kind: neither names the other.
bool alike(const Cells& a, const Cells& b, NumberStyle style) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [&](const Field& one, const Field& other) {
    return cell_kind(one, style) == cell_kind(other, style) && one.text.size() == other.text.size();
  });
}

// SLIST of seismology, AT2 of PEER, K-NET: behind the line that ends what they say of the record.
std::optional<std::size_t> behind_record(const std::vector<Cells>& lines) {
  constexpr std::size_t kLooked = 24;
  const std::string& front = lines[0][0].text;
  if (front.starts_with("TIMESERIES ")) return 1;
  const bool knet = front.starts_with("Origin");
  for (std::size_t i = 0; i < std::min(lines.size() - 1, kLooked); ++i)
    for (const Field& field : lines[i])
      if (knet ? field.text.starts_with("Memo.") : field.text.find("NPTS") != std::string::npos) return i + 1;
  return std::nullopt;
}

/// A row of numbers, or two, in front of the names of all columns, below which all are rows: how many columns and rows
/// follow, or the numbers of the columns.
std::optional<std::size_t> names_below_numbers(const std::vector<Cells>& lines, const std::vector<LineCensus>& census) {
  constexpr std::size_t kMost = 2, kFewest = 4;
  std::size_t at = 0;
  while (at < census.size() && census[at].row()) ++at;
  if (at == 0 || at > kMost || at + kFewest > lines.size() || !census[at].words() || census[at].good > 0 ||
      lines[at].size() < 2 || has_doubles(lines[at]) || any_empty(lines[at]))
    return std::nullopt;
  const bool rows = std::all_of(census.begin() + static_cast<std::ptrdiff_t>(at) + 1, census.end(),
                                [](const LineCensus& line) { return line.row() && line.good > 0; });
  return rows && census[at].bad == lines[at].size() ? std::optional(at) : std::nullopt;
}

}  // namespace

TableStart find_table_start(const std::vector<Cells>& lines, const std::vector<ColumnKind>& kinds, NumberStyle style) {
  if (campbell(lines)) return {4, 1, 2};
  if (const auto data = behind_record(lines)) return {*data, {}, {}};
  if (numbers_columns(lines, style)) return {1, 0, {}};
  if (lines.size() > 2 && line_of_types(lines[1])) return {2, 0, {}};
  TableStart out;
  std::vector<LineCensus> census;
  census.reserve(lines.size());
  const bool labels = std::any_of(lines.back().begin(), lines.back().end(),
                                  [](const Field& field) { return label_length(field.text) > 0; });
  for (const Cells& line : lines) census.push_back(census_of(line, kinds, style, labels));
  const auto first_row =
      std::find_if(census.begin(), census.end(), [](const LineCensus& line) { return line.row() && line.good > 0; });
  if (first_row == census.end() && census[0].fits && census[0].bad > 0 &&
      !(lines.size() > 1 && alike(lines[0], lines[1], style))) {  // a header, then damage
    out.names = 0;
    out.data = 1;
    return out;
  }
  const auto rows_at = static_cast<std::size_t>(first_row - census.begin());
  if (const auto names = rows_at == 0 ? names_below_numbers(lines, census) : std::nullopt)
    return {*names + 1, *names, {}};
  if (first_row == census.end() || rows_at == 0) return out;
  out.data = rows_at;
  // Back over rows that are damaged to the last line of words alone.
  std::size_t last = rows_at;
  while (last > 0 && !census[last - 1].words() && !(census[last - 1].undated && census[last - 1].good > 0) &&
         (census[last - 1].fits || census[last - 1].good > 0))
    --last;
  if (last > 0 && census[last - 1].words()) {
    out.data = last;
    out.names = last - 1;
    const bool named_above = last > 1 && census[last - 2].fits && census[last - 2].bad > 0 &&
                             !lines[last - 2][0].text.ends_with(':');  // "Firmware: 1.2"
    if (named_above && !line_of_units(lines[last - 2]) &&
        (line_of_units(lines[last - 1]) || unit_of_the_time(lines[last - 2], lines[last - 1]) ||
         (has_doubles(lines[last - 1]) && !has_doubles(lines[last - 2])))) {
      out.units = last - 1;
      out.names = last - 2;
    }
    if (last > 2 && census[last - 2].words() && sources_below_units(lines, last)) {
      out.units = last - 2;
      out.names = last - 3;
    }
    if (last > 2 && states_calibration(lines[last - 2], lines[last - 3]) && census[last - 3].words()) {
      out.units = last - 1;
      out.names = last - 3;
    } else if (last > 1 && states_calibration(lines[last - 1], lines[last - 2]) && census[last - 2].words()) {
      out.names = last - 2;
    }
    const auto empty = [](const Field& field) { return field.text.empty() && !field.quoted; };
    if (!out.units && last < rows_at && lines[last].size() > 1 &&
        std::all_of(lines[last].begin(), lines[last].end(), empty)) {  // units of columns that have none
      out.units = last;
      ++out.data;
    }
    return out;
  }
  // No line of words: names with numbers among them (c, 1, 2), or a row that is damaged.
  const auto fitting = std::find_if(census.begin() + static_cast<std::ptrdiff_t>(last), first_row,
                                    [](const LineCensus& line) { return line.fits; });
  if (fitting != first_row && damaged(lines[static_cast<std::size_t>(fitting - census.begin())], style)) {
    out.data = static_cast<std::size_t>(fitting - census.begin());
    return out;
  }
  if (fitting != first_row) {
    const auto at = static_cast<std::size_t>(fitting - census.begin());
    out.names = at;
    out.data = at + 1;
    return out;
  }
  // Too many names or too few, which the first row tells.
  const std::size_t cells = lines[0].size();
  const std::size_t off = cells > kinds.size() ? cells - kinds.size() : kinds.size() - cells;
  if (rows_at == 1 && cells > 1 && 2 * off <= kinds.size() + 1) out.names = 0;
  return out;
}

}  // namespace libchar::csv
