// Stamps of which each number has a column of its own ("year,month,day,hour,minute,second", "year,doy,hhmm",
// "date,hour", "month,day,hour"): one stamp in the place of the first of them, as ISO 8601 writes it.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/csv/made_text.hpp"
#include "libchar/log/csv/signs/signs.hpp"
#include "libchar/log/detail/column_name.hpp"
#include "libchar/log/time/calendar.hpp"
#include "libchar/log/time/time_column.hpp"

namespace libchar::csv {
namespace {

enum class DatePart : std::uint8_t {
  year,
  month,
  day,
  of_year,
  date,
  hour,
  minute,
  second,
  hhmm,
  of_day,
  ms,
  us,
  ns,
  none
};
constexpr std::size_t kDateParts = static_cast<std::size_t>(DatePart::none);

struct PartName {
  std::string_view name;
  DatePart part;
};
constexpr PartName kPartNames[] = {{"year", DatePart::year},
                                   {"years", DatePart::year},
                                   {"yr", DatePart::year},
                                   {"yyyy", DatePart::year},
                                   {"yy", DatePart::year},
                                   {"jahr", DatePart::year},
                                   {"annee", DatePart::year},
                                   {"anno", DatePart::year},
                                   {"ano", DatePart::year},
                                   {"month", DatePart::month},
                                   {"mo", DatePart::month},
                                   {"mon", DatePart::month},
                                   {"monat", DatePart::month},
                                   {"mois", DatePart::month},
                                   {"mes", DatePart::month},
                                   {"day", DatePart::day},
                                   {"dd", DatePart::day},
                                   {"dy", DatePart::day},
                                   {"tag", DatePart::day},
                                   {"jour", DatePart::day},
                                   {"dia", DatePart::day},
                                   {"doy", DatePart::of_year},
                                   {"jday", DatePart::of_year},
                                   {"yday", DatePart::of_year},
                                   {"dayofyear", DatePart::of_year},
                                   {"yearday", DatePart::of_year},
                                   {"julianday", DatePart::of_year},
                                   {"yyyyddd", DatePart::date},
                                   {"yyyydoy", DatePart::date},
                                   {"yyyymmdd", DatePart::date},
                                   {"hrmn", DatePart::hhmm},
                                   {"hourmin", DatePart::hhmm},
                                   {"sod", DatePart::of_day},
                                   {"secofday", DatePart::of_day},
                                   {"secondofday", DatePart::of_day},
                                   {"secondsofday", DatePart::of_day},
                                   {"date", DatePart::date},
                                   {"datum", DatePart::date},
                                   {"fecha", DatePart::date},
                                   {"hour", DatePart::hour},
                                   {"hours", DatePart::hour},
                                   {"hr", DatePart::hour},
                                   {"hh", DatePart::hour},
                                   {"h", DatePart::hour},
                                   {"stunde", DatePart::hour},
                                   {"heure", DatePart::hour},
                                   {"hora", DatePart::hour},
                                   {"minute", DatePart::minute},
                                   {"minutes", DatePart::minute},
                                   {"min", DatePart::minute},
                                   {"mn", DatePart::minute},
                                   {"m", DatePart::minute},
                                   {"minuto", DatePart::minute},
                                   {"second", DatePart::second},
                                   {"seconds", DatePart::second},
                                   {"sec", DatePart::second},
                                   {"ss", DatePart::second},
                                   {"s", DatePart::second},
                                   {"sekunde", DatePart::second},
                                   {"seconde", DatePart::second},
                                   {"segundo", DatePart::second},
                                   {"hhmm", DatePart::hhmm},
                                   {"ms", DatePart::ms},
                                   {"msec", DatePart::ms},
                                   {"millisecond", DatePart::ms},
                                   {"milliseconds", DatePart::ms},
                                   {"us", DatePart::us},
                                   {"usec", DatePart::us},
                                   {"microsecond", DatePart::us},
                                   {"microseconds", DatePart::us},
                                   {"ns", DatePart::ns},
                                   {"nanosecond", DatePart::ns},
                                   {"nanoseconds", DatePart::ns}};

/// "utc_year", "Hour (UTC)", "#YY"; "mm" is the month in front of the hour, "time" behind a date may be "hhmm".
DatePart part_of_name(std::string_view cell, bool hour_seen, bool date_seen) {
  std::string word = ascii_lower(trimmed(cell.substr(0, cell.find_first_of("[("))));  // "utc_second" has no unit
  while (!word.empty() && (word[0] == '#' || word[0] == '%' || word[0] == ' ')) word.erase(0, 1);
  word.erase(word.find_last_not_of('_') + 1);  // "Time_(HHMM)"
  std::string joined = word;
  std::erase_if(joined, [](char c) { return std::string_view("_. -").find(c) != std::string_view::npos; });
  word.erase(0, word.find_last_of("_. /") + 1);  // npos + 1 is 0
  if (word == "mm") return hour_seen ? DatePart::minute : DatePart::month;
  if (date_seen && (word == "time" || word == "utc" || word == "gmt")) return DatePart::hhmm;
  for (const std::string& name : {joined, word})
    for (const PartName& known : kPartNames)
      if (known.name == name) return known.part;
  return DatePart::none;
}

/// The cells of a line; a blank as delimiter stands for runs of them.
std::vector<std::string_view> cells_of(std::string_view line, char delimiter) {
  std::vector<std::string_view> out;
  bool quoted = false;
  std::size_t from = 0;
  for (std::size_t i = 0; i <= line.size(); ++i) {
    if (i < line.size() && line[i] == '"') quoted = !quoted;
    if (i < line.size() && (quoted || line[i] != delimiter)) continue;
    if (delimiter != ' ' || i > from) out.push_back(line.substr(from, i - from));
    from = i + 1;
  }
  return out;
}

std::string_view bare(std::string_view cell) {
  cell = trimmed(cell);
  if (cell.size() > 1 && cell.front() == '"' && cell.back() == '"') cell = trimmed(cell.substr(1, cell.size() - 2));
  return cell;
}

/// Columns side by side that are the parts of one stamp.
struct SpreadStamp {
  char delimiter = 0;  ///< 0: none was found
  bool named = true;
  std::size_t first = 0, count = 0;
  int year = 2001;                              ///< where none is written: one without a leap day, as typical years are
  std::array<std::size_t, kDateParts> at = {};  ///< 1 + column; 0: there is none

  std::size_t& of(DatePart part) { return at[static_cast<std::size_t>(part)]; }
  bool has(DatePart part) const { return at[static_cast<std::size_t>(part)] > 0; }
  bool dated() const {
    return has(DatePart::date) || has(DatePart::of_year) || (has(DatePart::month) && has(DatePart::day)) ||
           (has(DatePart::year) && has(DatePart::month));
  }
  bool clocked() const { return has(DatePart::hour) || has(DatePart::hhmm) || has(DatePart::of_day); }
  /// Nothing is left open between the day and what stands last.
  bool whole() const {
    const bool clock = has(DatePart::hour) && (!has(DatePart::second) || has(DatePart::minute));
    const bool rest = has(DatePart::ms) || has(DatePart::us) || has(DatePart::ns);
    if (has(DatePart::month) && !has(DatePart::day)) return false;
    if (rest && !has(DatePart::second)) return false;
    return dated() ? clock || has(DatePart::hhmm) || has(DatePart::of_day) ||
                         (!has(DatePart::date) && !rest && !has(DatePart::minute))
                   : clock && has(DatePart::second);
  }
};

/// By the names of a line; `delimiter` 0 where they are no such.
SpreadStamp spread_by_names(std::string_view line, char delimiter) {
  SpreadStamp found;
  const std::vector<std::string_view> cells = cells_of(line, delimiter);
  std::vector<std::string_view> others;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const DatePart part = part_of_name(bare(cells[c]), found.has(DatePart::hour), found.dated() && !found.clocked());
    const bool goes_on = found.count > 0 && c == found.first + found.count;
    if (part == DatePart::none || (found.count > 0 && !goes_on) || (goes_on && found.has(part))) {
      others.push_back(bare(cells[c]));
      continue;
    }
    if (!goes_on) found.first = c;
    ++found.count;
    found.of(part) = c + 1;
  }
  if (found.has(DatePart::year) && !found.has(DatePart::month) && found.has(DatePart::day))
    found.of(DatePart::of_year) = std::exchange(found.of(DatePart::day), 0);
  if (found.count < 2 || others.empty() || !found.whole()) return {};
  const auto is_stamp = [](std::string_view cell) {
    const auto name = time_name(name_and_unit(std::string(cell)).first);
    return name && !name->letter;
  };
  if (std::any_of(others.begin(), others.end(), is_stamp)) return {};  // there is one already
  found.delimiter = delimiter;
  return found;
}

/// A whole number of that range.
std::optional<int> whole_part(const SpreadStamp& where, const std::vector<std::string_view>& cells, DatePart part,
                              int least, int most) {
  const std::size_t at = where.at[static_cast<std::size_t>(part)];
  if (at == 0) return least == 1 ? 1 : 0;
  const auto value = parse_double(bare(cells[at - 1]));
  if (!value || !(*value >= least && *value <= most) || *value != static_cast<int>(*value)) return std::nullopt;
  return static_cast<int>(*value);
}

/// "2024-05-01", and of digits "2024122" and "20240501".
std::optional<std::string> one_date(const std::string& date) {
  constexpr std::size_t kYear = 4, kOfYear = 7, kMonth = 8;
  if (date.find_first_not_of("0123456789") == date.npos) {
    if (date.size() == kOfYear) return fmt::format("{}-{}T", date.substr(0, kYear), date.substr(kYear));
    if (date.size() == kMonth)
      return fmt::format("{}-{}-{}T", date.substr(0, kYear), date.substr(kYear, 2), date.substr(kYear + 2));
    return std::nullopt;
  }
  const auto stamp = read_calendar(date);
  return stamp && stamp->date && !stamp->clock ? std::optional(date + "T") : std::nullopt;
}

/// The day of the year; a fraction of it is a clock time where there is no other.
std::optional<double> day_of_year(const SpreadStamp& where, const std::vector<std::string_view>& cells) {
  constexpr double kLast = 367;
  const auto day = parse_double(bare(cells[where.at[static_cast<std::size_t>(DatePart::of_year)] - 1]));
  const bool good = day && *day >= 1 && *day < kLast && (!where.clocked() || *day == std::floor(*day));
  return good ? day : std::nullopt;
}

std::optional<std::string> date_text(const SpreadStamp& where, const std::vector<std::string_view>& cells) {
  if (where.has(DatePart::date))
    return one_date(std::string(bare(cells[where.at[static_cast<std::size_t>(DatePart::date)] - 1])));
  if (!where.dated()) return "";
  auto year = where.has(DatePart::year) ? whole_part(where, cells, DatePart::year, 0, 2199) : where.year;
  if (year && *year < 100) *year += *year < 70 ? 2000 : 1900;
  if (!year || *year < 1900) return std::nullopt;
  const auto month = whole_part(where, cells, DatePart::month, 1, 12),
             day = whole_part(where, cells, DatePart::day, 1, 31);
  const auto text = month && day ? std::optional(fmt::format("{:04}-{:02}-{:02}T", *year, *month, *day)) : std::nullopt;
  if (!where.has(DatePart::of_year)) return text;
  const auto of_year = day_of_year(where, cells);
  if (!of_year) return std::nullopt;
  const std::string other = fmt::format("{:04}-{:03}T", *year, static_cast<int>(*of_year));
  if (!where.has(DatePart::month) || !where.has(DatePart::day)) return other;
  constexpr std::string_view kMidnight = "00:00:00";  // both are written, and have to be one day
  const auto a = text ? read_calendar(*text + kMidnight.data()) : std::nullopt,
             b = read_calendar(other + kMidnight.data());
  return a && b && a->ns == b->ns ? text : std::nullopt;
}

/// So many seconds of a day.
std::string clock_of(double seconds) {
  constexpr std::int64_t kSecond = 1000000000;
  const auto ns = clamped_whole<std::int64_t>(std::round(seconds * 1e6)) * 1000;
  const std::int64_t whole = ns / kSecond;
  return fmt::format("{:02}:{:02}:{:02}.{:09}", whole / 3600, whole / 60 % 60, whole % 60, ns % kSecond);
}

/// "13.5" of an hour without minutes.
std::optional<std::string> hours_and_fraction(const SpreadStamp& where, const std::vector<std::string_view>& cells) {
  constexpr double kDay = 24, kMsInHour = 3600e3;
  if (!where.has(DatePart::hour) || where.has(DatePart::minute)) return std::nullopt;
  const auto hour = parse_double(bare(cells[where.at[static_cast<std::size_t>(DatePart::hour)] - 1]));
  if (!hour || *hour == std::floor(*hour) || *hour < 0 || *hour >= kDay) return std::nullopt;
  const auto ms = clamped_whole<int>(std::round(*hour * kMsInHour));
  return fmt::format("{:02}:{:02}:{:02}.{:03}", ms / 3600000, ms / 60000 % 60, ms / 1000 % 60, ms % 1000);
}

std::optional<std::string> clock_text(const SpreadStamp& where, const std::vector<std::string_view>& cells) {
  if (where.has(DatePart::hhmm)) {
    constexpr std::size_t kDigits = 4;
    const auto both = whole_part(where, cells, DatePart::hhmm, 0, 2400);
    const bool longer = bare(cells[where.at[static_cast<std::size_t>(DatePart::hhmm)] - 1]).size() > kDigits;
    return both && *both % 100 < 60 && !longer ? std::optional(fmt::format("{:02}:{:02}:00", *both / 100, *both % 100))
                                               : std::nullopt;
  }
  constexpr double kDay = 86400;
  if (where.has(DatePart::of_day)) {
    const auto seconds = parse_double(bare(cells[where.at[static_cast<std::size_t>(DatePart::of_day)] - 1]));
    return seconds && *seconds >= 0 && *seconds < kDay ? std::optional(clock_of(*seconds)) : std::nullopt;
  }
  if (where.has(DatePart::of_year) && !where.clocked()) {
    const auto day = day_of_year(where, cells);
    return day ? std::optional(clock_of(std::min((*day - std::floor(*day)) * kDay, kDay - 1e-6))) : std::nullopt;
  }
  if (const auto clock = hours_and_fraction(where, cells)) return clock;
  const auto hour = whole_part(where, cells, DatePart::hour, 0, 24),
             minute = whole_part(where, cells, DatePart::minute, 0, 59);
  if (!hour || !minute) return std::nullopt;
  std::string second = "00";
  if (where.has(DatePart::second)) {
    second = bare(cells[where.at[static_cast<std::size_t>(DatePart::second)] - 1]);
    std::replace(second.begin(), second.end(), ',', '.');
    const auto value = parse_double(second);
    if (!value || *value < 0 || *value >= 61 || second.find_first_not_of("0123456789.") != second.npos)
      return std::nullopt;
    if (second.find('.') == 1 || second.size() == 1) second.insert(0, 1, '0');
  }
  for (const auto& [part, digits] :
       {std::pair(DatePart::ms, 3), std::pair(DatePart::us, 6), std::pair(DatePart::ns, 9)})
    if (where.has(part)) {
      const auto rest = whole_part(where, cells, part, 0,
                                   part == DatePart::ms   ? 999
                                   : part == DatePart::us ? 999999
                                                          : 999999999);
      if (!rest || second.find('.') != second.npos) return std::nullopt;
      second += fmt::format(".{:0{}}", *rest, digits);
    }
  return fmt::format("{:02}:{:02}:{}", *hour, *minute, second);
}

std::optional<std::string> stamp_text(const SpreadStamp& where, const std::vector<std::string_view>& cells) {
  if (cells.size() < where.first + where.count) return std::nullopt;
  const auto date = date_text(where, cells), clock = clock_text(where, cells);
  return date && clock ? std::optional(*date + *clock) : std::nullopt;
}

/// How numbers without names may follow each other.
struct Layout {
  std::vector<DatePart> parts;
  bool only_even = false;  ///< no year says what they are: their steps do
};

std::vector<Layout> layouts() {
  using enum DatePart;
  return {{{year, of_year, month, day, hour, minute}},
          {{year, month, day, hour, minute, second}},
          {{year, month, day, hour, minute}},
          {{year, month, day, hour}},
          {{year, of_year, hour, minute, second}},
          {{year, of_year, hour, minute}},
          {{year, of_year, hhmm}},
          {{year, of_year, hour}},
          {{date, hhmm}, true},
          {{of_year, hhmm}, true}};
}

constexpr double kEven = 0.1;  // mean deviation of the steps; a value may look like seconds

/// Mean deviation of the steps from the usual one; nothing where they are no stamps, or say too little.
std::optional<double> unevenness(const std::vector<std::vector<std::string_view>>& rows, const SpreadStamp& found,
                                 const Layout& layout) {
  constexpr std::size_t kMostBefore = 3;
  constexpr double kSlowest = 7200;  // s, where no year is written
  std::vector<double> stamps, last;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto& cells = rows[i];
    const auto text = cells.size() > found.first + layout.parts.size() ? stamp_text(found, cells) : std::nullopt;
    const auto stamp = text ? read_calendar(*text) : std::nullopt;
    const bool names = 2 * cells.size() >= rows.back().size() && bare(cells[0]).find_first_of("0123456789+-.") != 0;
    if (!stamp && stamps.empty() && i < kMostBefore && !names) continue;
    if (!stamp) return std::nullopt;
    stamps.push_back(static_cast<double>(stamp->ns) * 1e-9);
    last.push_back(parse_double(bare(cells[found.first + layout.parts.size() - 1])).value_or(0));
  }
  const double step = usual_step(stamps), plain = usual_step(last);
  double off = 0;
  bool rises = true, carries = false;  // "2359" and "0", "59" and "100"
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    off += std::fabs(stamps[i] - stamps[i - 1] - step);
    rises = rises && stamps[i] > stamps[i - 1];
    carries = carries || last[i] - last[i - 1] != plain;
  }
  off /= step * static_cast<double>(stamps.size());
  if (!(step > 0) || (off >= kEven && (!rises || layout.only_even)) ||
      (layout.only_even && (!carries || step > kSlowest)))
    return std::nullopt;
  return off;
}

/// Where a year may stand in front of the numbers, behind a number of the row.
bool may_begin(std::string_view cell, DatePart part) {
  const std::string_view text = bare(cell);
  constexpr std::size_t kYear = 4;
  if (text.empty() || text.find_first_not_of("0123456789") != text.npos) return false;
  if (part == DatePart::of_year) return text.size() < kYear;
  return (text.starts_with("19") || text.starts_with("20")) && (part == DatePart::year) == (text.size() == kYear);
}

/// Without names: such numbers in front, or behind a number of the row, that step evenly in all rows behind the first
/// few lines, or with a year in front that rise.
SpreadStamp spread_by_numbers(const std::vector<std::string_view>& lines) {
  constexpr std::size_t kFewest = 8, kMost = 100;
  if (lines.size() < kFewest) return {};
  const std::string_view middle = trimmed(lines[std::min(lines.size(), kMost) / 2]);
  const std::size_t digits = middle.find_first_not_of("\"0123456789");
  if (digits == 0 || digits == middle.npos || std::string_view(",;\t ").find(middle[digits]) == middle.npos) return {};
  const char delimiter = middle[digits];
  const auto in_middle = cells_of(middle, delimiter);
  std::vector<std::vector<std::string_view>> rows;
  for (std::size_t i = 0; i < std::min(lines.size(), kMost); ++i) rows.push_back(cells_of(lines[i], delimiter));
  SpreadStamp best;
  double least = std::numeric_limits<double>::infinity();
  for (const Layout& layout : layouts())
    for (const std::size_t first : {std::size_t{0}, std::size_t{1}}) {
      if (first >= in_middle.size() || (first > 0 && layout.only_even)) continue;
      if (!may_begin(in_middle[first], layout.parts[0])) continue;
      SpreadStamp found{delimiter, false, first, layout.parts.size()};
      for (std::size_t c = 0; c < layout.parts.size(); ++c) found.of(layout.parts[c]) = first + c + 1;
      const auto off = unevenness(rows, found, layout);
      if (!off || (*off < kEven ? *off >= least : *off + kEven > least)) continue;
      least = *off;
      best = found;
    }
  return best;
}

/// A header with such names in front of rows that all have such numbers, but for one of units; or such numbers alone.
SpreadStamp spread_of(std::string_view front) {
  constexpr std::size_t kFewest = 2, kMostHeader = 2;
  std::vector<std::string_view> lines;
  const char sign = front.find('\n') == std::string_view::npos ? '\r' : '\n';
  for (std::size_t end = front.find(sign); end != std::string_view::npos; end = front.find(sign)) {
    if (end == 0 && sign == '\r' && lines.empty()) {
      front.remove_prefix(1);
      continue;
    }
    lines.push_back(front.substr(0, end));
    if (lines.back().ends_with('\r')) lines.back().remove_suffix(1);
    front.remove_prefix(end + 1);
  }
  if (const SpreadStamp found = spread_by_numbers(lines); found.delimiter != 0) return found;
  for (std::size_t head = 0; head < lines.size(); ++head) {
    if (lines[head].find_first_of("0123456789+-.") == 0) continue;  // a row of numbers: the most of them
    for (const char delimiter : {',', ';', '\t', '|', ' '}) {
      const SpreadStamp found = spread_by_names(lines[head], delimiter);
      if (found.delimiter == 0) continue;
      std::size_t rows = 0, others = 0;
      for (std::size_t k = head + 1; k < lines.size(); ++k)
        ++(stamp_text(found, cells_of(lines[k], delimiter)) ? rows : others);
      if (rows >= kFewest && others < kMostHeader) return found;
    }
  }
  return {};
}

class FromSpreadDates final : public CleanedLines {
 public:
  using CleanedLines::CleanedLines;
  std::string_view what() const override {
    return where_.dated() && !where_.has(DatePart::year) && !where_.has(DatePart::date)
               ? "stamps in a column for each of their numbers, without a year (2001 is put there)"
               : "stamps in a column for each of their numbers";
  }

 private:
  void begin(std::string_view front) override {
    where_ = spread_of(front);
    headed_ = !where_.named;
  }
  void clean(std::string& line) override {
    const std::vector<std::string_view> cells = cells_of(line, where_.delimiter);
    if (cells.size() < where_.first + where_.count) return;
    const bool names = !headed_ && spread_by_names(line, where_.delimiter).delimiter != 0;
    headed_ = headed_ || names;
    if (!headed_) return;
    if (!where_.has(DatePart::year)) count_years(cells);
    const auto stamp = stamp_text(where_, cells);
    if (!stamp && !where_.named && !begun_) {  // a line before the first row
      if (line.find_first_of("0123456789") == line.find_first_not_of(" \t\"")) line.insert(0, "# ");
      return;
    }
    begun_ = begun_ || stamp;
    const std::string mark = where_.first == 0 && cells[0].starts_with('#') ? "#" : "";
    std::string out;
    for (std::size_t c = 0; c < cells.size(); ++c) {
      if (c > where_.first && c < where_.first + where_.count) continue;
      if (c > 0) out += where_.delimiter;
      out += c != where_.first ? std::string(cells[c]) : names ? mark + "time" : stamp.value_or(mark);
    }
    line = std::move(out);
  }

  /// A month or a day of the year that begins again is one of the next year.
  void count_years(const std::vector<std::string_view>& cells) {
    const DatePart part = where_.has(DatePart::month) ? DatePart::month : DatePart::of_year;
    if (!where_.has(part)) return;
    const double now = parse_double(bare(cells[where_.of(part) - 1])).value_or(0);
    where_.year += now < last_ / 2 && now < 2 ? 1 : 0;
    last_ = now;
  }

  SpreadStamp where_;
  double last_ = 0;
  bool headed_ = false, begun_ = false;
};

}  // namespace

bool has_spread_dates(std::string_view front) { return spread_of(front).delimiter != 0; }

std::unique_ptr<Unpacker> open_spread_dates(std::function<std::size_t(char*, std::size_t)> stored) {
  return std::make_unique<FromSpreadDates>(std::move(stored));
}

}  // namespace libchar::csv
