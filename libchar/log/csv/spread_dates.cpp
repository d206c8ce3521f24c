// Stamps of which each number has a column of its own ("year,month,day,hour,minute,second", "year,doy,hhmm",
// "date,hour"): one stamp in the place of the first of them, as ISO 8601 writes it.

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
#include "libchar/log/csv/signs.hpp"
#include "libchar/log/detail/column_name.hpp"
#include "libchar/log/time/calendar.hpp"
#include "libchar/log/time/time_column.hpp"

namespace libchar::csv {
namespace {

enum class DatePart : std::uint8_t { year, month, day, of_year, date, hour, minute, second, hhmm, ms, us, ns, none };
constexpr std::size_t kDateParts = static_cast<std::size_t>(DatePart::none);

struct PartName {
  std::string_view name;
  DatePart part;
};
constexpr PartName kPartNames[] = {
    {"year", DatePart::year},       {"years", DatePart::year},     {"yr", DatePart::year},
    {"yyyy", DatePart::year},       {"yy", DatePart::year},        {"jahr", DatePart::year},
    {"annee", DatePart::year},      {"anno", DatePart::year},      {"ano", DatePart::year},
    {"month", DatePart::month},     {"mo", DatePart::month},       {"mon", DatePart::month},
    {"monat", DatePart::month},     {"mois", DatePart::month},     {"mes", DatePart::month},
    {"day", DatePart::day},         {"dd", DatePart::day},         {"dy", DatePart::day},
    {"tag", DatePart::day},         {"jour", DatePart::day},       {"dia", DatePart::day},
    {"doy", DatePart::of_year},     {"jday", DatePart::of_year},   {"yday", DatePart::of_year},
    {"date", DatePart::date},       {"datum", DatePart::date},     {"fecha", DatePart::date},
    {"hour", DatePart::hour},       {"hours", DatePart::hour},     {"hr", DatePart::hour},
    {"hh", DatePart::hour},         {"h", DatePart::hour},         {"stunde", DatePart::hour},
    {"heure", DatePart::hour},      {"hora", DatePart::hour},      {"minute", DatePart::minute},
    {"minutes", DatePart::minute},  {"min", DatePart::minute},     {"mn", DatePart::minute},
    {"m", DatePart::minute},        {"minuto", DatePart::minute},  {"second", DatePart::second},
    {"seconds", DatePart::second},  {"sec", DatePart::second},     {"ss", DatePart::second},
    {"s", DatePart::second},        {"sekunde", DatePart::second}, {"seconde", DatePart::second},
    {"segundo", DatePart::second},  {"hhmm", DatePart::hhmm},      {"ms", DatePart::ms},
    {"msec", DatePart::ms},         {"millisecond", DatePart::ms}, {"milliseconds", DatePart::ms},
    {"us", DatePart::us},           {"usec", DatePart::us},        {"microsecond", DatePart::us},
    {"microseconds", DatePart::us}, {"ns", DatePart::ns},          {"nanosecond", DatePart::ns},
    {"nanoseconds", DatePart::ns}};

/// "utc_year", "Hour (UTC)", "#YY"; "mm" is the month in front of the hour.
DatePart part_of_name(std::string_view cell, bool hour_seen) {
  std::string word = ascii_lower(trimmed(cell.substr(0, cell.find_first_of("[("))));  // "utc_second" has no unit
  while (!word.empty() && (word[0] == '#' || word[0] == '%' || word[0] == ' ')) word.erase(0, 1);
  word.erase(0, word.find_last_of("_. /") + 1);  // npos + 1 is 0
  if (word == "mm") return hour_seen ? DatePart::minute : DatePart::month;
  const auto* const known =
      std::find_if(std::begin(kPartNames), std::end(kPartNames), [&](const PartName& one) { return one.name == word; });
  return known == std::end(kPartNames) ? DatePart::none : known->part;
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
  std::array<std::size_t, kDateParts> at = {};  ///< 1 + column; 0: there is none

  std::size_t& of(DatePart part) { return at[static_cast<std::size_t>(part)]; }
  bool has(DatePart part) const { return at[static_cast<std::size_t>(part)] > 0; }
  bool dated() const {
    return has(DatePart::date) || (has(DatePart::year) && (has(DatePart::of_year) || has(DatePart::month)));
  }
  /// Nothing is left open between the day and what stands last.
  bool whole() const {
    const bool clock = has(DatePart::hour) && (!has(DatePart::second) || has(DatePart::minute));
    const bool rest = has(DatePart::ms) || has(DatePart::us) || has(DatePart::ns);
    if (has(DatePart::month) && !has(DatePart::day)) return false;
    if (rest && !has(DatePart::second)) return false;
    return dated() ? clock || has(DatePart::hhmm) || (!has(DatePart::date) && !rest && !has(DatePart::minute))
                   : clock && has(DatePart::second);
  }
};

/// By the names of a line; `delimiter` 0 where they are no such.
SpreadStamp spread_by_names(std::string_view line, char delimiter) {
  SpreadStamp found;
  const std::vector<std::string_view> cells = cells_of(line, delimiter);
  std::vector<std::string_view> others;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const DatePart part = part_of_name(bare(cells[c]), found.has(DatePart::hour));
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
  if (!value || *value != static_cast<int>(*value) || *value < least || *value > most) return std::nullopt;
  return static_cast<int>(*value);
}

std::optional<std::string> date_text(const SpreadStamp& where, const std::vector<std::string_view>& cells) {
  if (where.has(DatePart::date)) {
    const std::string date(bare(cells[where.at[static_cast<std::size_t>(DatePart::date)] - 1]));
    const auto stamp = read_calendar(date);
    return stamp && stamp->date && !stamp->clock ? std::optional(date + "T") : std::nullopt;
  }
  if (!where.dated()) return "";
  auto year = whole_part(where, cells, DatePart::year, 0, 2199);
  if (year && *year < 100) *year += *year < 70 ? 2000 : 1900;
  if (!year || *year < 1900) return std::nullopt;
  if (where.has(DatePart::of_year)) {
    const auto day = whole_part(where, cells, DatePart::of_year, 1, 366);
    return day ? std::optional(fmt::format("{:04}-{:03}T", *year, *day)) : std::nullopt;
  }
  const auto month = whole_part(where, cells, DatePart::month, 1, 12),
             day = whole_part(where, cells, DatePart::day, 1, 31);
  return month && day ? std::optional(fmt::format("{:04}-{:02}-{:02}T", *year, *month, *day)) : std::nullopt;
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
    const auto both = whole_part(where, cells, DatePart::hhmm, 0, 2400);
    return both && *both % 100 < 60 ? std::optional(fmt::format("{:02}:{:02}:00", *both / 100, *both % 100))
                                    : std::nullopt;
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

/// Without names: year, month, day, hour (minute, second) in front, or behind a number of the row, whose stamps step
/// evenly in all rows.
SpreadStamp spread_by_numbers(const std::vector<std::string_view>& lines) {
  constexpr std::size_t kFewest = 8, kMost = 100;
  constexpr DatePart kOrder[] = {DatePart::year, DatePart::month,  DatePart::day,
                                 DatePart::hour, DatePart::minute, DatePart::second};
  if (lines.size() < kFewest) return {};
  const std::size_t row = lines[0].find_first_not_of("0123456789");
  const bool numbered = row != std::string_view::npos && row != 4;
  const std::size_t year = numbered ? lines[0].find_first_not_of(lines[0][row], row) : 0;
  if (year >= lines[0].size() || (!lines[0].substr(year).starts_with("19") && !lines[0].substr(year).starts_with("20")))
    return {};
  const char delimiter = lines[0].size() > year + 4 ? lines[0][year + 4] : '\0';
  if (delimiter == '\0' || std::string_view(",;\t ").find(delimiter) == std::string_view::npos) return {};
  SpreadStamp best;
  constexpr double kEven = 0.1;  // mean deviation of the steps; a value may look like seconds
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t parts = std::size(kOrder); parts > 3; --parts) {
    SpreadStamp found{delimiter, false, numbered ? std::size_t{1} : 0, parts};
    for (std::size_t c = 0; c < parts; ++c) found.of(kOrder[c]) = found.first + c + 1;
    std::vector<double> stamps;
    for (std::size_t i = 0; i < std::min(lines.size(), kMost); ++i) {
      const std::vector<std::string_view> cells = cells_of(lines[i], delimiter);
      const auto text = cells.size() > found.first + parts ? stamp_text(found, cells) : std::nullopt;
      const auto stamp = text ? read_calendar(*text) : std::nullopt;
      if (!stamp) break;
      stamps.push_back(static_cast<double>(stamp->ns) * 1e-9);
    }
    const double step = usual_step(stamps);
    double off = 0;
    bool rises = true;
    for (std::size_t i = 1; i < stamps.size(); ++i) {
      off += std::fabs(stamps[i] - stamps[i - 1] - step);
      rises = rises && stamps[i] > stamps[i - 1];
    }
    off /= step * static_cast<double>(stamps.size());
    if (stamps.size() < std::min(lines.size(), kMost) || !(step > 0) || (off >= kEven && !rises)) continue;
    if (off < kEven ? off >= least : off + kEven > least) continue;
    least = off;
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
  std::string_view what() const override { return "stamps in a column for each of their numbers"; }

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
    const auto stamp = stamp_text(where_, cells);
    const std::string mark = where_.first == 0 && cells[0].starts_with('#') ? "#" : "";
    std::string out;
    for (std::size_t c = 0; c < cells.size(); ++c) {
      if (c > where_.first && c < where_.first + where_.count) continue;
      if (c > 0) out += where_.delimiter;
      out += c != where_.first ? std::string(cells[c]) : names ? mark + "time" : stamp.value_or(mark);
    }
    line = std::move(out);
  }

  SpreadStamp where_;
  bool headed_ = false;
};

}  // namespace

bool has_spread_dates(std::string_view front) { return spread_of(front).delimiter != 0; }

std::unique_ptr<Unpacker> open_spread_dates(std::function<std::size_t(char*, std::size_t)> stored) {
  return std::make_unique<FromSpreadDates>(std::move(stored));
}

}  // namespace libchar::csv
