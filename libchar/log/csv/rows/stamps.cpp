#include "libchar/log/csv/rows/stamps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>

#include "libchar/core/text/text.hpp"
#include "libchar/log/time/time_column.hpp"

namespace libchar::csv {
namespace {

// Two columns that are one stamp.
struct StampPair {
  std::size_t first = 0, second = 0;
  bool calendar = false;     // a date and its clock time; else seconds and nanoseconds
  bool days = false;         // days since 1858-11-17 and seconds of the day
  std::int64_t rest_ns = 1;  // of the second where that is no clock time
};

// "MJD" and "sod", "Day (MJD)" and "Seconds of day [s]".
bool days_and_seconds(std::string_view a, std::string_view b) {
  const std::string days = ascii_lower(a), seconds = ascii_lower(b);
  return days.find("mjd") != std::string::npos && (seconds.starts_with("so") || seconds.starts_with("sec") ||
                                                   seconds.starts_with("tod") || seconds.starts_with("utc"));
}

bool is_calendar(ColumnKind kind) {
  return kind == ColumnKind::calendar || kind == ColumnKind::date || kind == ColumnKind::clock;
}

std::optional<std::int64_t> whole_number(const Cells& row, std::size_t column) {
  if (column >= row.size()) return std::nullopt;
  std::int64_t out = 0;
  std::size_t offset = 0;
  return read_stamp(row[column].text, '.', 1, out, offset) == StampDefect::none &&
                 row[column].text.find_first_of(".eE") == std::string::npos
             ? std::optional(out)
             : std::nullopt;
}

/// ".secs" and ".nsecs", "tv_sec" and "tv_usec": ns in the smaller unit; 0 where they are no pair.
std::int64_t unit_of_rest(const StampStudy& study, const Dialect& dialect, std::size_t column) {
  static constexpr std::array<std::pair<std::string_view, std::int64_t>, 6> kParts = {
      {{"nano", 1}, {"n", 1}, {"micro", 1000}, {"u", 1000}, {"milli", 1000000}, {"m", 1000000}}};
  const std::vector<Cells>& rows = study.rows;
  const std::string first = ascii_lower(dialect.columns[column].text),
                    second = ascii_lower(dialect.columns[column + 1].text);
  for (const std::string_view seconds : {"seconds", "secs", "sec"}) {
    if (!first.ends_with(seconds)) continue;
    const std::string front = first.substr(0, first.size() - seconds.size());
    for (const auto& [part, ns] : kParts) {
      if (second != fmt::format("{}{}{}", front, part, seconds)) continue;
      bool rest = ns == 1;  // else two clocks, as long as no whole second is seen in front of what is less than one
      for (const Cells& row : rows) {
        const auto whole = whole_number(row, column), more = whole_number(row, column + 1);
        if (ns != 1 && (!whole || !more || *more * ns >= 1000000000)) return 0;
        rest = rest || *whole != 0;
      }
      if (rest || !study.whole_head) return rest ? ns : 0;
      const std::vector<Cells> whole = study.whole_head(column), more = study.whole_head(column + 1);
      for (std::size_t i = 0; i < std::min(whole.size(), more.size()); ++i) {
        const auto seconds_here = whole_number(whole[i], 0), rest_here = whole_number(more[i], 0);
        if (!seconds_here || !rest_here || *rest_here * ns >= 1000000000) return 0;
        rest = rest || *seconds_here != 0;
      }
      return rest ? ns : 0;
    }
  }
  return 0;
}

/// "Time" and "ms" beside it, which is what is left of its whole seconds: the two rise together, the first stands at
/// times. ns in the smaller unit; 0 where they are no pair.
std::int64_t unit_of_fraction(const StampStudy& study, const Dialect& dialect, std::size_t column) {
  constexpr std::int64_t kSecond = 1000000000;
  const std::int64_t unit = unit_said({dialect.columns[column + 1].text, dialect.columns[column + 1].unit_below});
  if (!is_calendar(study.kinds[column]) || study.kinds[column + 1] != ColumnKind::number ||
      (unit != 1 && unit != 1000 && unit != 1000000))
    return 0;
  const StampPart first{static_cast<int>(column), true};
  std::optional<std::int64_t> last, last_whole;
  bool stands = false;
  for (const Cells& row : study.rows) {
    std::int64_t whole = 0;
    std::size_t offset = 0;
    const auto rest = whole_number(row, column + 1);
    if (column >= row.size() || read_part(row[column].text, first, dialect, whole, offset) != StampDefect::none ||
        !rest || *rest < 0 || *rest >= kSecond / unit || whole % kSecond != 0)
      return 0;
    if (last && whole + *rest * unit <= *last) return 0;
    stands = stands || last_whole == whole;
    last = whole + *rest * unit;
    last_whole = whole;
  }
  return stands ? unit : 0;
}

// Without names: seconds since 1970, then what is left of them in nanoseconds (ros2 topic echo --csv).
bool epoch_and_rest(const std::vector<Cells>& rows) {
  std::int64_t last = 0, largest = 0;
  for (const Cells& row : rows) {
    const auto s = whole_number(row, 0), ns = whole_number(row, 1);
    if (!s || !ns || *s < 1000000000 || *s > 2200000000 || *ns < 0 || *ns >= 1000000000) return false;
    const std::int64_t stamp = *s * 1000000000 + *ns;
    if (stamp <= last) return false;
    last = stamp;
    largest = std::max(largest, *ns);
  }
  return rows.size() > 2 && largest >= 1000000;
}

/// "125959.50" as nanoseconds of the day; nothing where it is no time of day.
std::optional<std::int64_t> clock_of_digits(std::int64_t digits_ns) {
  constexpr std::int64_t kSecond = 1000000000;
  const std::int64_t digits = digits_ns / kSecond, minutes = digits / 100 % 100;
  if (digits_ns < 0 || digits >= 240000 || minutes >= 60 || digits % 100 >= 60) return std::nullopt;
  return (digits / 10000 * 3600 + minutes * 60 + digits % 100) * kSecond + digits_ns % kSecond;
}

/// "20240501" in all rows, or such dates with their clock times, which rise.
bool dates_in_digits(const StampStudy& study, std::size_t column, bool with_clock) {
  constexpr std::size_t kDate = 8, kFewest = 3;
  constexpr std::int64_t kYear = std::int64_t{31556952} * 1000000000;
  std::int64_t first = 0, last = 0;
  std::size_t rows = 0;
  for (const Cells& row : study.rows) {
    if (column >= row.size() || row[column].text.empty()) continue;
    const auto date = read_date_digits(row[column].text);
    if (!date || (!with_clock && row[column].text.size() != kDate)) return false;
    if (date->ns < 10 * kYear || date->ns > 110 * kYear || (rows > 0 && date->ns < last)) return false;
    first = rows++ == 0 ? date->ns : first;
    last = date->ns;
  }
  return rows >= kFewest && (!with_clock || last > first);
}

/// "DATE" and "TIME" of digits, side by side.
bool digits_in_two(const StampStudy& study, const Dialect& dialect, std::size_t column) {
  const std::string date = ascii_lower(dialect.columns[column].text),
                    time = ascii_lower(dialect.columns[column + 1].text);
  const bool named = date.find("dat") != std::string::npos &&
                     (time.find("time") != std::string::npos || time.find("utc") != std::string::npos);
  return named && dates_in_digits(study, column, false) &&
         std::all_of(study.rows.begin(), study.rows.end(), [&](const Cells& row) {
           std::int64_t ns = 0;
           std::size_t offset = 0;
           return column + 1 < row.size() &&
                  read_stamp(row[column + 1].text, study.style.decimal, 1000000000, ns, offset) == StampDefect::none &&
                  clock_of_digits(ns);
         });
}

std::optional<StampPair> find_pair(const StampStudy& study, const Dialect& dialect) {
  const auto place = [&](ColumnKind kind) {
    return std::find(study.kinds.begin(), study.kinds.end(), kind) - study.kinds.begin();
  };
  const auto date = static_cast<std::size_t>(place(ColumnKind::date)),
             clock = static_cast<std::size_t>(place(ColumnKind::clock));
  if (date < study.kinds.size() && clock < study.kinds.size()) return StampPair{date, clock, true};
  if (dialect.has_header) {
    for (std::size_t c = 0; c + 1 < dialect.columns.size(); ++c) {
      const std::string &first = dialect.columns[c].text, &second = dialect.columns[c + 1].text;
      if (const std::int64_t ns = unit_of_rest(study, dialect, c); ns != 0)
        return StampPair{c, c + 1, false, false, ns};
      if (const std::int64_t ns = unit_of_fraction(study, dialect, c); ns != 0)
        return StampPair{c, c + 1, false, false, ns};
      if (digits_in_two(study, dialect, c)) return StampPair{c, c + 1, true};
      if (days_and_seconds(first, second) && !study.rows.empty() && whole_number(study.rows.front(), c))
        return StampPair{c, c + 1, false, true, 1000000000};
    }
  } else if (dialect.columns.size() > 2 && epoch_and_rest(study.rows)) {
    return StampPair{0, 1, false};
  }
  return std::nullopt;
}

FirstValues first_numbers(const StampStudy& study, std::size_t column) {
  FirstValues first;
  for (const Cells& row : study.rows) {
    if (column >= row.size()) continue;
    const std::string& text = row[column].text;
    const Cell cell = read_sampled(text, study.style);
    if (cell.kind == Cell::value) first.values.push_back(cell.number);
    first.integers = first.integers && text.find_first_of(".,eE") == std::string::npos;
  }
  return first;
}

/// How many steps are far from the usual one.
std::size_t odd_steps(const std::vector<double>& values) {
  const double usual = usual_step(values);
  std::size_t odd = 0;
  for (std::size_t i = 1; i < values.size(); ++i)
    odd += std::fabs(values[i] - values[i - 1] - usual) > 0.5 * std::fabs(usual);
  return odd;
}

/// YYYYMMDDhhmmss, NMEA's hhmmss.ss, and the like: all are dates, or times of day that step more evenly than numbers.
bool is_clock_digits(const StampStudy& study, std::size_t column, const std::string& named_so) {
  const auto times = [&](const std::vector<Cells>& rows, std::size_t at, auto&& take) {
    for (const Cells& row : rows) {
      if (at >= row.size()) continue;
      std::int64_t ns = 0;
      std::size_t offset = 0;
      if (read_stamp(row[at].text, study.style.decimal, 1000000000, ns, offset) != StampDefect::none) continue;
      const auto clock = clock_of_digits(ns);
      if (!clock) return false;
      if (!take(1e-9 * static_cast<double>(ns), 1e-9 * static_cast<double>(*clock))) return false;
    }
    return true;
  };
  if (study.kinds[column] != ColumnKind::number || study.rows.empty() || column >= study.rows.front().size())
    return false;
  if (dates_in_digits(study, column, true)) return true;
  std::vector<double> numbers, clocks;
  const auto collect = [&](double number, double clock) {
    const bool rises = numbers.empty() || number >= numbers.back() || number < 1;
    numbers.push_back(number);
    clocks.push_back(clock);
    return rises;
  };
  if (!times(study.rows, column, collect) || numbers.size() < 3) return false;
  // 93059 is 9:30:59. Fewer digits are a clock's shortly after midnight, and any elapsed seconds.
  constexpr std::size_t kFewestDigits = 5;
  constexpr double kFastest = 0.09;  // receivers of that kind: at most 10 Hz
  const std::string& front = study.rows.front()[column].text;
  const std::string name = ascii_lower(named_so);
  const auto called = [&](std::string_view word) { return name.find(word) != std::string::npos; };
  const bool named = called("utc") || called("hhmmss") || (called("time") && usual_step(numbers) > kFastest);
  if (!named && std::min(front.find(study.style.decimal), front.size()) < kFewestDigits) return false;
  numbers.clear();
  clocks.clear();
  if (!study.whole_head || !times(study.whole_head(column), 0, collect)) return false;
  return odd_steps(clocks) < odd_steps(numbers);
}

// Seconds after the first, so that a double holds them.
FirstValues first_stamps(const StampStudy& study, const Dialect& dialect, const StampPart& part,
                         const StampPart& more) {
  FirstValues first;
  std::optional<std::int64_t> begin;
  for (const Cells& row : study.rows) {
    std::int64_t sum = 0;
    bool good = true;
    for (const StampPart* one : {&part, &more}) {
      if (one->column < 0) continue;
      std::int64_t ns = 0;
      std::size_t offset = 0;
      const auto column = static_cast<std::size_t>(one->column);
      good = good && column < row.size() && read_part(row[column].text, *one, dialect, ns, offset) == StampDefect::none;
      good = good && !__builtin_add_overflow(sum, ns, &sum);
    }
    if (!good) continue;
    if (!begin) begin = sum;
    first.values.push_back(static_cast<double>(sum - *begin) * 1e-9);
  }
  return first;
}

void choose_date_order(const StampStudy& study, const ReadOptions& options, Dialect& dialect, LogInfo& info) {
  std::vector<std::string_view> texts;
  std::string example;
  std::size_t dates = 0;
  for (const Cells& row : study.rows)
    for (std::size_t c = 0; c < std::min(row.size(), study.kinds.size()); ++c)
      if (study.kinds[c] == ColumnKind::calendar || study.kinds[c] == ColumnKind::date) {
        texts.push_back(row[c].text);
        if (example.empty()) example = row[c].text;
        dates = c;
      }
  if (texts.empty()) return;
  DateStyle style = date_style(texts, study.style.decimal == ',');
  if (style.ambiguous && options.date_order == "auto") {
    const std::vector<Cells> all = study.whole_head(dates);
    texts.assign(all.size(), "");
    std::transform(all.begin(), all.end(), texts.begin(),
                   [](const Cells& cell) { return std::string_view(cell[0].text); });
    style = date_style(texts, study.style.decimal == ',');
  }
  if (options.date_order != "auto")
    style = {options.date_order == "day"     ? DateOrder::day_first
             : options.date_order == "month" ? DateOrder::month_first
                                             : DateOrder::year_first,
             false};
  dialect.date_order = style.order;
  if (style.ambiguous)
    info.guesses.push_back(fmt::format("dates: {} is read with the {} first (`date_order` day, month or year decides)",
                                       printable(example, 40),
                                       style.order == DateOrder::day_first     ? "day"
                                       : style.order == DateOrder::month_first ? "month"
                                                                               : "year"));
}

/// "980ms", "1s", "1m0.5s": times that rise, each with its unit. Lengths of time that come and go are no stamps.
bool rises_with_units(const StampStudy& study, std::size_t column) {
  constexpr std::size_t kFewest = 3;
  std::optional<std::int64_t> first, last;
  std::size_t rows = 0;
  for (const Cells& row : study.rows) {
    if (column >= row.size() || row[column].text.empty()) continue;
    const auto elapsed = read_elapsed(row[column].text);
    if (!elapsed || (last && elapsed->ns < *last)) return false;
    last = elapsed->ns;
    first = first ? first : last;
    ++rows;
  }
  return rows >= kFewest && *last > *first;
}

void say_calendar(const StampStudy& study, Dialect& dialect, LogInfo& info) {
  const auto main = static_cast<std::size_t>(dialect.time.column);
  if (dialect.time.elapsed) {
    info.dialect.emplace_back("stamps have their units after them");
    dialect.columns[main].cell_unit.clear();
    info.time.unit = "ns";
    info.time.unit_ns = 1;
    return;
  }
  bool zone = false, of_hour = false, seconds = false, date_digits = false;
  for (const Cells& row : study.rows)
    for (const StampPart* part : {&dialect.time, &dialect.more_time})
      if (part->column >= 0 && static_cast<std::size_t>(part->column) < row.size())
        if (const std::string& text = row[static_cast<std::size_t>(part->column)].text;
            const auto stamp = part->digits ? read_date_digits(text) : read_calendar(text, dialect.date_order)) {
          zone = zone || stamp->zone;
          of_hour = of_hour || stamp->of_hour;
          seconds = seconds || stamp->seconds;
          date_digits = date_digits || part->digits;
        }
  constexpr std::int64_t kHour = std::int64_t{3600} * 1000000000;
  const bool clock_only =
      !date_digits && !dialect.more_time.calendar && (dialect.time.digits || study.kinds[main] == ColumnKind::clock);
  if (clock_only && !of_hour && !seconds && !dialect.time.digits && study.whole_head)
    for (const Cells& row : study.whole_head(main)) {  // "12:05": hours and minutes, if none is above 24
      const auto stamp = read_calendar(row[0].text);
      of_hour = of_hour || (stamp && stamp->of_hour);
    }
  dialect.time.of_hour = of_hour;
  dialect.clock_period_ns = clock_only ? (of_hour ? kHour : 24 * kHour) : 0;
  info.dialect.push_back(of_hour               ? "stamps are minutes and seconds of an hour"
                         : date_digits         ? "stamps are dates in digits, YYYYMMDDhhmmss"
                         : dialect.time.digits ? "stamps are times of day, hhmmss"
                         : clock_only          ? "stamps are times of day"
                         : zone                ? "calendar stamps, with their time zone"
                                               : "calendar stamps, as written, without a time zone");
  info.time.unit = "ns";
  info.time.unit_ns = 1;
  info.time.local = !zone;
}

/// Whether the first stamps rise, and their digits behind the mark are of one number.
struct Fractions {
  bool rise = true, alike = true;
  std::size_t most = 0;  // digits
};

Fractions fractions_of(const std::vector<std::string>& texts, const Dialect& dialect, const StampPart& part) {
  Fractions out;
  std::optional<std::int64_t> last;
  std::size_t digits = 0;
  for (const std::string& text : texts) {
    std::int64_t ns = 0;
    std::size_t offset = 0;
    if (read_part(text, part, dialect, ns, offset) != StampDefect::none) continue;
    const std::size_t mark = text.find(dialect.decimal);
    std::size_t behind = mark == std::string::npos ? 0 : text.size() - mark - 1;
    if (part.calendar) behind = read_calendar(text, dialect.date_order).value_or(CalendarStamp{}).fraction_digits;
    out.alike = out.alike && (digits == 0 || behind == digits);
    out.rise = out.rise && (!last || ns >= *last);
    digits = behind;
    out.most = std::max(out.most, behind);
    last = ns;
  }
  return out;
}

const char* word_of(std::int64_t ns) {
  return ns == 1 ? "nanoseconds" : ns == 1000 ? "microseconds" : ns == 1000000 ? "milliseconds" : "seconds";
}

// printf("%d.%d", seconds, nanoseconds) and "%d:%d:%d.%d": stamps that step to and fro as fractions, and rise as two
// numbers.
void find_split_seconds(const StampStudy& study, Dialect& dialect, LogInfo& info) {
  StampPart& part = dialect.more_time.calendar ? dialect.more_time : dialect.time;
  const auto column = static_cast<std::size_t>(part.column);
  if (part.digits || part.elapsed || (!part.calendar && part.unit_ns != 1000000000)) return;
  std::vector<std::string> texts;
  for (const Cells& row : study.rows)
    if (column < row.size()) texts.push_back(row[column].text);
  Fractions as_read = fractions_of(texts, dialect, part);
  if (as_read.alike || as_read.most > 9) return;
  const auto rise_as_numbers = [&] {
    part.fraction_ns = as_read.most > 6 ? 1 : as_read.most > 3 ? 1000 : 1000000;
    if (fractions_of(texts, dialect, part).rise) return true;
    part.fraction_ns = 0;
    return false;
  };
  if (as_read.rise && study.whole_head) {  // which takes long
    if (!rise_as_numbers()) return;
    part.fraction_ns = 0;
    texts.clear();
    for (const Cells& cell : study.whole_head(column)) texts.push_back(cell[0].text);
    as_read = fractions_of(texts, dialect, part);
  }
  if (!as_read.rise && rise_as_numbers())
    info.guesses.push_back(
        fmt::format("stamps: the digits after the mark are {} without leading zeros", word_of(part.fraction_ns)));
}

TableFront front_of(const StampStudy& study, const Dialect& dialect, const std::optional<StampPair>& pair) {
  TableFront table;
  for (std::size_t c = 0; c < dialect.columns.size(); ++c) {
    const Column& column = dialect.columns[c];
    ColumnLabel label{column.text, column.unit_below};
    label.numbered = column.name;
    const bool first = pair && c == pair->first, second = pair && c == pair->second;
    label.calendar = (c < study.kinds.size() && is_calendar(study.kinds[c])) || first;
    label.text = second || (c < study.kinds.size() &&
                            (study.kinds[c] == ColumnKind::text || study.kinds[c] == ColumnKind::empty));
    if (column.left_out) label.text = true;
    label.calendar = label.calendar || (!pair && column.elapsed);
    label.calendar = label.calendar || (!pair && !label.text && is_clock_digits(study, c, column.text));
    table.columns.push_back(label);
  }
  table.named = dialect.has_header;
  table.text = true;
  table.stated_rate_hz = study.stated_rate_hz;
  table.stated_tick_s = study.stated_tick_s;
  return table;
}

/// "Time A, A, Time B, B": what stands behind a column of stamps has those.
void find_own_clocks(const TableFront& table, std::size_t index, Dialect& dialect) {
  const std::vector<std::size_t> others = clocks_of_others(table, index);
  std::string clock;
  for (std::size_t c = 0; c < dialect.columns.size() && !others.empty(); ++c) {
    Column& column = dialect.columns[c];
    const bool other = std::find(others.begin(), others.end(), c) != others.end();
    if (other || c == index || column.clock) clock = other ? column.name : "";
    if (!other) column.own_clock = clock;
  }
}

/// Two clocks in one unit, or in two.
bool ratio_of_units(double scale, std::size_t steps) {
  constexpr std::array kUnits = {1.0, 60.0, 3600.0, 86400.0};
  constexpr double kOff = 2e-3;  // of a step
  return std::any_of(kUnits.begin(), kUnits.end(), [&](double unit) {
    return std::any_of(kUnits.begin(), kUnits.end(), [&](double other) {
      const double ratio = std::fabs(scale) * unit / other, decade = std::pow(10, std::round(std::log10(ratio)));
      return std::fabs(ratio / decade - 1) * static_cast<double>(steps) <= kOff;
    });
  });
}

/// "seconds_elapsed" beside "time": columns called time that are the stamps once more.
void find_same_clock(const TableFront& table, std::size_t index, Dialect& dialect) {
  const std::vector<double> stamps = table.first_values(index).values;
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    const ColumnLabel& column = table.columns[c];
    const auto name = time_name(name_and_unit(column.name).first);
    if (keeps_time(table, c, index)) dialect.columns[c].clock = true;
    const std::string& chosen = table.columns[index].name;
    const bool named =
        column.name == chosen || (name ? !name->letter && !name->date : numbered_alike(column.name, chosen));
    if (c == index || column.text || column.calendar || !named) continue;
    const std::vector<double> values = table.first_values(c).values;
    if (values.size() != stamps.size() || values.size() < 3) continue;
    const double scale = (values.back() - values.front()) / (stamps.back() - stamps.front());
    const double most = 1e-3 * std::fabs(usual_step(values));
    bool same = most > 0 && ratio_of_units(scale, values.size() - 1) && !clock_of_labview(column.name, chosen);
    for (std::size_t i = 0; i < values.size() && same; ++i)
      same = std::fabs(values[i] - values[0] - scale * (stamps[i] - stamps[0])) <= most;
    dialect.columns[c].clock = dialect.columns[c].clock || same;
  }
}

}  // namespace

StampDefect read_part(std::string_view text, const StampPart& part, const Dialect& dialect, std::int64_t& out,
                      std::size_t& offset) {
  if (part.elapsed) {
    offset = 0;
    const auto elapsed = read_elapsed(text);
    out = elapsed ? elapsed->ns : 0;
    if (elapsed) return StampDefect::none;
    return read_cell(text, dialect.decimal).kind == Cell::missing ? StampDefect::missing : StampDefect::malformed;
  }
  if (part.digits) {
    if (const auto date = read_date_digits(text)) {
      out = date->ns;
      return StampDefect::none;
    }
    const StampDefect defect = read_stamp(text, dialect.decimal, 1000000000, out, offset);
    if (defect != StampDefect::none) return defect;
    const auto clock = clock_of_digits(out);
    out = clock.value_or(0);
    return clock ? StampDefect::none : StampDefect::malformed;
  }
  if (!part.calendar) {
    std::string plain;
    if (dialect.thousands != 0) text = plain = without_thousands(text, {dialect.decimal, dialect.thousands});
    const std::size_t label = dialect.has_header ? 0 : label_length(text);
    if (const std::size_t mark = text.find(dialect.decimal); part.fraction_ns > 0 && mark != std::string_view::npos) {
      std::int64_t behind = 0;
      StampDefect defect = read_stamp(text.substr(mark + 1), dialect.decimal, part.fraction_ns, behind, offset);
      if (defect == StampDefect::none)
        defect = read_stamp(text.substr(label, mark - label), dialect.decimal, part.unit_ns, out, offset);
      out += defect == StampDefect::none ? behind : 0;
      return defect;
    }
    return read_stamp(text.substr(label), dialect.decimal, part.unit_ns, out, offset, part.zero);
  }
  offset = 0;
  if (!dialect.has_header) text.remove_prefix(label_length(text));
  const auto stamp = read_calendar(text, dialect.date_order);
  if (!stamp || (stamp->of_hour && !part.of_hour))
    return read_cell(text, dialect.decimal).kind == Cell::missing ? StampDefect::missing : StampDefect::malformed;
  out = part.of_hour && !stamp->of_hour && !stamp->seconds ? stamp->ns / 60 : stamp->ns;
  if (part.fraction_ns > 0) {  // digits that count
    std::int64_t one = 1000000000;
    constexpr std::size_t kMostDigits = 9;  // of nanoseconds
    for (std::size_t digit = 0; digit < std::min(stamp->fraction_digits, kMostDigits); ++digit) one /= 10;
    out += stamp->fraction_ns / one * part.fraction_ns - stamp->fraction_ns;
  }
  return StampDefect::none;
}

void choose_stamps(const StampStudy& study, const ReadOptions& options, Dialect& dialect, LogInfo& info) {
  choose_date_order(study, options, dialect, info);
  const auto pair = find_pair(study, dialect);
  const bool led = !dialect.lead.empty() && options.time_column == "auto" && study.kinds[0] != ColumnKind::empty;
  if (dialect.lead == ")" && dialect.columns[0].text.empty()) dialect.columns[0].unit_below = "ms";  // ESP-IDF
  for (std::size_t c = 0; c < dialect.columns.size(); ++c)
    dialect.columns[c].elapsed = !dialect.columns[c].cell_unit.empty() && rises_with_units(study, c);
  TableFront table = front_of(study, dialect, pair);
  const auto part_of = [&](std::size_t column) {
    const bool calendar = column < study.kinds.size() && is_calendar(study.kinds[column]);
    StampPart part{static_cast<int>(column), calendar};
    part.elapsed = !pair && !calendar && dialect.columns[column].elapsed;
    part.digits = table.columns[column].calendar && !calendar && !part.elapsed &&
                  (!pair || pair->calendar || column != pair->first);
    if (pair && pair->calendar && column == pair->second) part.digits = !calendar;
    part.calendar = part.calendar || part.digits || part.elapsed;
    if (!pair || pair->calendar) return part;
    constexpr std::int64_t kSecond = 1000000000;
    if (column == pair->first) part.unit_ns = pair->days ? 86400 * kSecond : kSecond;
    if (column == pair->first && pair->days) part.zero = 40587;
    if (column == pair->second) part.unit_ns = pair->rest_ns;
    return part;
  };
  const auto partner_of = [&](std::size_t column) {
    return pair && column == pair->first ? part_of(pair->second) : StampPart{};
  };
  std::map<std::size_t, FirstValues> known;  // many questions are about the same values
  table.first_values = [&](std::size_t column) {
    const auto found = known.find(column);
    if (found != known.end()) return found->second;
    return known[column] = table.columns[column].calendar
                               ? first_stamps(study, dialect, part_of(column), partner_of(column))
                               : first_numbers(study, column);
  };
  auto index = led ? std::optional<std::size_t>(0) : find_time_column(table, options, info);
  if (!index) return;
  if (pair && *index == pair->second) index = pair->first;
  dialect.time = part_of(*index);
  dialect.more_time = partner_of(*index);
  if (table.named) {
    find_same_clock(table, *index, dialect);
    find_own_clocks(table, *index, dialect);
  }
  const std::string& name = dialect.columns[*index].name;
  info.time.column = name.empty() ? fmt::format("c{}", *index) : name;
  if (dialect.time.calendar) {
    say_calendar(study, dialect, info);
    find_split_seconds(study, dialect, info);
  } else if (pair && *index == pair->first) {
    info.time.unit = "s";
    info.time.unit_ns = 1;
    const std::string& rest = dialect.columns[pair->second].name;
    const std::string sentence =
        fmt::format("stamps: {} in {} and {} in {}", pair->days ? "days (MJD)" : "seconds", printable(info.time.column),
                    word_of(pair->rest_ns), rest.empty() ? fmt::format("c{}", pair->second) : printable(rest));
    if (dialect.has_header)
      info.dialect.push_back(sentence);
    else
      info.guesses.push_back(sentence + " (`time_column` none keeps them as channels)");
  } else {
    const StampUnit unit = find_time_unit(table, *index, options, info);
    dialect.time.unit_ns = unit.ns;
    dialect.time.zero = unit.zero;
    find_split_seconds(study, dialect, info);
  }
}

}  // namespace libchar::csv
