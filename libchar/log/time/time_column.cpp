#include "libchar/log/time/time_column.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "libchar/core/numeric/median.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/core/units.hpp"
#include "libchar/log/detail/channel_choice.hpp"
#include "libchar/log/detail/column_name.hpp"

namespace libchar {

namespace {

bool counts_something(const std::string& words) {
  static constexpr std::array<std::string_view, 19> kCounters = {
      "frame",  "frames", "index",   "idx",    "seq", "sequence", "count", "counter", "packet", "packetcounter",
      "record", "sample", "samples", "number", "no",  "nr",       "row",   "id",      "packets"};
  const std::string_view last = std::string_view(words).substr(words.rfind(' ') + 1);  // npos + 1 is 0
  return std::find(kCounters.begin(), kCounters.end(), last) != kCounters.end();
}

bool near_uniform_and_rising(const std::vector<double>& values) {
  if (values.size() < 3) return false;
  const double step = usual_step(values);
  for (std::size_t i = 1; i < values.size(); ++i) {
    const double d = values[i] - values[i - 1];
    if (!(d > 0) || d > 10 * step) return false;
  }
  return step > 0;
}

// The name of a column without its unit.
std::string stem_of(const ColumnLabel& column) { return name_and_unit(column.name).first; }

std::size_t named_column(const TableFront& table, const std::string& wanted, const ReadOptions& options,
                         const std::string& file) {
  const auto& columns = table.columns;
  const auto same = [&](const ColumnLabel& c) { return c.name == wanted; };
  const auto same_stem = [&](const ColumnLabel& c) { return stem_of(c) == wanted; };
  auto found = std::find_if(columns.begin(), columns.end(), same);
  if (found == columns.end())
    found = std::find_if(columns.begin(), columns.end(), [&](const auto& c) { return c.numbered == wanted; });
  if (found != columns.end()) return static_cast<std::size_t>(found - columns.begin());
  if (std::count_if(columns.begin(), columns.end(), same_stem) == 1)
    return static_cast<std::size_t>(std::find_if(columns.begin(), columns.end(), same_stem) - columns.begin());
  if (const auto index = position_in(wanted, columns.size())) return *index;
  std::vector<std::string> names;
  names.reserve(columns.size());
  for (const ColumnLabel& column : columns)
    names.push_back(column.name.empty() ? fmt::format("c{}", names.size()) : column.name);
  throw usage_error("E0320", file)
      .says("there is no column of this name for the time")
      .got(wanted)
      .hint(channel_hint(wanted, names, options));
}

// What the first values of a column say.
struct TimeCandidate {
  std::size_t column = 0;
  Clock clock = Clock::unknown;
  bool rises = false;
  double scatter = 0;  // about the line through them, in steps
  bool letter = false;
};

// How far values stand off their line, in its steps: a device's whole seconds are worse than a
// host's steady milliseconds.
double scatter_of(const std::vector<double>& values) {
  const double step = (values.back() - values.front()) / static_cast<double>(values.size() - 1);
  if (!(step > 0)) return std::numeric_limits<double>::infinity();
  std::vector<double> off;
  for (std::size_t i = 0; i < values.size(); ++i)
    off.push_back(values[i] - values.front() - step * static_cast<double>(i));
  std::vector<double> sorted = off;
  const double middle = median_in_place(sorted, Middle::lower);
  for (double& value : off) value = std::fabs(value - middle);
  return kMadToSd * median_in_place(off) / step;
}

TimeCandidate time_candidate(const TableFront& table, std::size_t column, Clock clock) {
  const std::vector<double> values = table.first_values(column).values;
  TimeCandidate out{column, clock, values.size() < 2, 0};
  if (values.size() < 2) return out;
  std::size_t back = 0;
  for (std::size_t i = 1; i < values.size(); ++i) back += values[i] < values[i - 1];
  out.rises = values.back() > values.front() && 5 * back < values.size();
  out.scatter = scatter_of(values);
  return out;
}

// Whatever its name: no value steps back, nearly all steps are alike, and it does not count the rows.
bool steady_clock(const std::vector<double>& values) {
  constexpr std::size_t kFewest = 8;
  if (values.size() < kFewest) return false;
  const double usual = usual_step(values);
  std::size_t alike = 0;
  bool counts = true;
  for (std::size_t i = 1; i < values.size(); ++i) {
    const double step = values[i] - values[i - 1];
    if (step < 0) return false;
    alike += std::fabs(step - usual) <= 0.5 * usual;
    counts = counts && step == 1;
  }
  return usual > 0 && !counts && 10 * alike >= 8 * (values.size() - 1);
}

bool has_unit(const ColumnLabel& column) { return !column.unit.empty() || !name_and_unit(column.name).second.empty(); }

bool unit_of_time(const ColumnLabel& column) { return unit_behind(column) != 0; }

bool unit_of_another_quantity(const ColumnLabel& column) {
  return !unit_of_time(column) && find_unit(column.unit.empty() ? name_and_unit(column.name).second : column.unit);
}

// "T", "T1", "TC2", "T_air": a temperature where its values are such and begin far from zero, however evenly they rise.
bool like_a_temperature(const ColumnLabel& column, const FirstValues& first) {
  constexpr double kColdest = -100, kHottest = 1500, kNearZero = 10;  // degrees, steps
  const std::string name = stem_of(column);
  if (!(name.starts_with('T') || name.starts_with("t_")) || unit_of_time(column) ||
      (name.size() > 1 && std::string_view("0123456789C_").find(name[1]) == name.npos) || first.integers ||
      first.values.empty())
    return false;
  const double front = first.values.front();
  return front > kColdest && front < kHottest && std::fabs(front) > kNearZero * usual_step(first.values);
}

// "T", "T_min", "t_h": as well a temperature's letter, where neither values nor unit say more.
bool temperature_or_time(const std::string& name) {
  return name == "T" || name.starts_with("T_") || name.starts_with("t_");
}

// A temperature t goes up and down, or rises with noise.
bool wanders(const TableFront& table, std::size_t column) {
  const FirstValues first = table.first_values(column);
  const std::vector<double>& values = first.values;
  std::size_t down = 0, up = 0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    up += values[i] > values[i - 1];
    down += values[i] < values[i - 1];
  }
  constexpr std::size_t kFewest = 8;
  if (values.size() < kFewest) return false;
  const std::size_t both = std::min(up, down);
  if (5 * both > values.size() || (up + down >= kFewest && 3 * both > up + down)) return true;
  const std::string name = stem_of(table.columns[column]);
  const bool clock = steady_clock(values) || (name.size() > 1 && usual_step(values) == 1);  // a count of minutes
  return temperature_or_time(name) && (!clock || like_a_temperature(table.columns[column], first));
}

bool speaks_of_time(const ColumnLabel& column) {
  static constexpr std::array<std::string_view, 8> kWords = {"time",  "stamp", "clock", "tick",
                                                             "epoch", "utc",   "tow",   " ts"};
  std::string name = ascii_lower(stem_of(column));
  std::replace(name.begin(), name.end(), '_', ' ');
  return time_name(stem_of(column)) || std::any_of(kWords.begin(), kWords.end(), [&](std::string_view word) {
           return name.find(word) != std::string::npos;
         });
}

// Numbers that never fall and are dates since 2008, in seconds or as whole numbers in any unit.
bool counts_since_1970(const FirstValues& first) {
  const std::vector<double>& values = first.values;
  if (values.size() < 3 || !std::is_sorted(values.begin(), values.end())) return false;
  for (const double unit : {1.0, 1e3, 1e6, 1e9})
    if ((first.integers || unit == 1) && values.front() >= 1.2e9 * unit && values.back() < 2.2e9 * unit)
      return values.back() > values.front();
  return false;
}

// With packets, pauses or rows that changed places it may be a clock all the same, if somebody says so.
bool rises_mostly(const std::vector<double>& values) {
  constexpr double kRising = 0.8;
  if (values.size() < 3 || !(values.back() > values.front())) return false;
  std::size_t falls = 0;
  for (std::size_t i = 1; i < values.size(); ++i) falls += values[i] < values[i - 1];
  return static_cast<double>(falls) < (1 - kRising) * static_cast<double>(values.size());
}

// The first column that is a clock by its values, one whose name speaks of time before others; said as
// a guess. A rate that is known leaves it a channel.
std::optional<std::size_t> column_like_a_clock(const TableFront& table, const ReadOptions& options, LogInfo& info) {
  if (options.rate_hz || table.stated_rate_hz || info.time.rate_hz > 0 || table.columns.size() < 2) return std::nullopt;
  std::optional<std::size_t> found;
  bool named = false;
  for (std::size_t c = 0; c < table.columns.size() && !named; ++c) {
    const ColumnLabel& column = table.columns[c];
    std::string name = ascii_lower(stem_of(column));
    std::replace(name.begin(), name.end(), '_', ' ');
    if (column.text || unit_of_another_quantity(column) || name.find("temp") != std::string::npos ||
        name.find("year") != std::string::npos || name == "t" || (has_unit(column) && !unit_of_time(column)))
      continue;
    named = speaks_of_time(column) && name.find("tick") == std::string::npos;  // whose unit is nobody's
    const FirstValues first = table.first_values(c);
    // "index" of pandas may be a count of the rows, or their stamps.
    if (counts_something(name) && !speaks_of_time(column) && !counts_since_1970(first)) continue;
    if ((named || !found) && (counts_since_1970(first) || steady_clock(first.values)) &&
        !like_a_temperature(column, first))
      found = c;
    else if (std::exchange(named, false) && rises_mostly(first.values) && info.time.candidate.empty())
      info.time.candidate = column.name;
  }
  if (found) info.time.candidate.clear();
  if (found)
    info.guesses.push_back(fmt::format(
        "time column: {}, because it is a steady clock (`time_column` none keeps it as a channel)",
        table.columns[*found].name.empty() ? fmt::format("c{}", *found) : printable(table.columns[*found].name)));
  return found;
}

// Of a clock that does not tell its own samples apart, the one that does and rises with it, whatever its name.
std::optional<std::size_t> finer_clock(const TableFront& table, std::size_t chosen) {
  for (std::size_t c = 0; c < table.columns.size(); ++c)
    if (keeps_time(table, chosen, c) && steady_clock(table.first_values(c).values)) return c;
  return std::nullopt;
}

std::vector<TimeCandidate> time_candidates(const TableFront& table) {
  std::vector<TimeCandidate> out;
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    const ColumnLabel& column = table.columns[c];
    if (column.text || unit_of_another_quantity(column)) continue;
    const auto name = time_name(stem_of(column));
    if (!column.calendar &&
        (!name || name->date || (name->letter && (wanders(table, c) || (has_unit(column) && !unit_of_time(column))))))
      continue;
    out.push_back(time_candidate(table, c, name ? name->clock : Clock::unknown));
    out.back().letter = name && name->letter;
  }
  if (out.size() > 1) std::erase_if(out, [](const TimeCandidate& one) { return one.letter && !one.rises; });
  // "x-axis" in seconds: nothing else says time.
  if (out.empty() && table.columns.size() > 1 && !table.columns[0].text && unit_of_time(table.columns[0]))
    if (const TimeCandidate first = time_candidate(table, 0, Clock::unknown); first.rises) out.push_back(first);
  return out;
}

bool steadier(const TimeCandidate& a, const TimeCandidate& b) { return a.scatter * 3 < b.scatter && b.scatter > 0.01; }

// A device's clock that does not tell its own samples apart.
bool coarser(const TimeCandidate& a, const TimeCandidate& b) { return a.scatter > 0.1 && steadier(b, a); }

bool of_the_whole(const ColumnLabel& column) {
  const std::string name = ascii_lower(stem_of(column));
  return name.starts_with("total") || name.starts_with("cumul") || name.starts_with("test");
}

std::string names_of(const TableFront& table, const std::vector<TimeCandidate>& which, std::size_t but) {
  std::vector<std::string> names;
  for (const TimeCandidate& other : which)
    if (const ColumnLabel& column = table.columns[other.column]; other.column != but)
      names.push_back(printable(column.name == table.columns[but].name ? column.numbered : column.name));
  return fmt::format("{}", fmt::join(names, ", "));
}

// Of those that rise a device's clock, else the steadiest, else the first that is no host's.
std::optional<std::size_t> column_called_time(const TableFront& table, const ReadOptions& options, LogInfo& info) {
  std::vector<TimeCandidate> all = time_candidates(table);
  if (all.empty()) return column_like_a_clock(table, options, info);
  std::vector<TimeCandidate> rising;
  for (const TimeCandidate& one : all)
    if (one.rises) rising.push_back(one);
  // "Total Time" goes on where "Time" is that of a step and begins again.
  const auto in_parts = [&](const TimeCandidate& one) { return !of_the_whole(table.columns[one.column]); };
  if (!std::all_of(rising.begin(), rising.end(), in_parts)) std::erase_if(rising, in_parts);
  const std::vector<TimeCandidate>& among = rising.empty() ? all : rising;
  TimeCandidate best = among.front();
  for (const TimeCandidate& one : among) {
    const bool device = one.clock == Clock::device && best.clock != Clock::device && !coarser(one, best);
    const bool beaten = best.clock == Clock::device && one.clock != Clock::device && !coarser(best, one);
    if (device ||
        (!beaten && (steadier(one, best) || (one.clock < best.clock && !steadier(best, one) && !coarser(one, best)))))
      best = one;
  }
  if (all.size() < 2) return best.column;
  const std::string others = names_of(table, all, best.column);
  const bool steadiest =
      std::any_of(among.begin(), among.end(), [&](const TimeCandidate& one) { return steadier(best, one); });
  info.guesses.push_back(fmt::format("time column: {}, {} {} (`time_column` takes another one)",
                                     printable(table.columns[best.column].name),
                                     best.clock == Clock::device ? "the device's own clock, not"
                                     : steadiest                 ? "steadier than"
                                     : among.size() < all.size() ? "which rises, not"
                                                                 : "not",
                                     others));
  return best.column;
}

// Rows of several sources, named in front, have each stamp as many times.
void take_one_of_each(std::vector<double>& values) {
  std::vector<double> once = values;
  once.erase(std::unique(once.begin(), once.end()), once.end());
  const double n = static_cast<double>(values.size()), m = static_cast<double>(once.size());
  if (m > 0 && std::fabs(n - std::round(n / m) * m) < n / m) values = std::move(once);
}

// Counts the rows by ones.
bool counts_rows(const std::vector<double>& values) {
  return usual_step(values) == 1 && values.back() - values.front() == static_cast<double>(values.size() - 1);
}

// Without names: a first column, behind words and a count of the rows, that rises evenly or holds dates.
std::optional<std::size_t> column_that_rises(const TableFront& table, const ReadOptions& options, LogInfo& info) {
  std::size_t c = 0;
  while (c < table.columns.size() && table.columns[c].text) ++c;
  if (table.text && c + 2 < table.columns.size() && !table.columns[c + 1].text &&
      counts_rows(table.first_values(c).values))
    if (const FirstValues next = table.first_values(c + 1); next.integers && steady_clock(next.values)) ++c;
  const std::size_t columns = table.columns.size();
  const auto epoch = [&](std::size_t at) {
    return table.text && at < columns && !table.columns[at].text && counts_since_1970(table.first_values(at));
  };
  for (std::size_t later = c + 1; later < columns && !epoch(c); ++later)  // "temp 21.3 1714564800"
    if (epoch(later)) c = later;
  if (columns < 2 || (c + 1 >= columns && !epoch(c))) return std::nullopt;
  if (!table.text && (options.rate_hz || info.time.rate_hz > 0)) return std::nullopt;
  const FirstValues first = table.first_values(c);
  std::vector<double> values = first.values;
  if (c > 0) take_one_of_each(values);
  const bool dates = table.text && counts_since_1970(first);
  if (!dates && !near_uniform_and_rising(values) && !(table.text && steady_clock(values))) return std::nullopt;
  const bool counts = !dates && counts_rows(values) && (first.integers || !table.text);  // "1.000" is a time
  const std::string name = fmt::format("c{}", c);
  if (counts || !table.text) {
    if (!counts) info.time.candidate = name;
    info.guesses.push_back(fmt::format("first column: {}, kept as a channel (`time_column` {} takes it as time)",
                                       counts ? "counts the rows by ones" : "rises evenly", name));
    return std::nullopt;
  }
  info.guesses.push_back(fmt::format("time column: {}, because it {} (`time_column` none keeps it as a channel)",
                                     c == 0 ? "the first" : name,
                                     dates ? "counts the time since 1970" : "rises evenly"));
  return c;
}

}  // namespace

bool called_count(std::string_view name) {
  std::string words = ascii_lower(name);
  std::replace(words.begin(), words.end(), '_', ' ');
  return counts_something(words);
}

bool keeps_time(const TableFront& table, std::size_t coarse, std::size_t fine) {
  constexpr double kDecade = 0.1, kCount = 1.05;
  constexpr std::size_t kFewest = 3;
  const ColumnLabel &one = table.columns[coarse], &other = table.columns[fine];
  if (coarse == fine || one.text || other.text || one.calendar) return false;
  const FirstValues counts = table.first_values(coarse);
  const auto clock = [&](const ColumnLabel& column, const FirstValues& values) {
    return !unit_of_another_quantity(column) &&
           (column.calendar || counts_since_1970(values) || speaks_of_time(column) || unit_of_time(column));
  };
  if (!counts.integers || !clock(one, counts)) return false;
  const FirstValues stamps = table.first_values(fine);
  const std::vector<double>&a = counts.values, &b = stamps.values;
  if (a.size() != b.size() || a.size() < kFewest || !clock(other, stamps)) return false;
  std::size_t steps = 0;
  for (std::size_t i = 1; i < a.size(); ++i) {
    if (a[i] < a[i - 1] || a[i] != std::floor(a[i])) return false;
    steps += a[i] > a[i - 1];
  }
  const double all = a.back() - a.front(), scale = (b.back() - b.front()) / all;
  if (steps < kFewest || 5 * steps > 4 * a.size() || !(scale > 0)) return false;
  const double decade = std::pow(10, std::round(std::log10(scale)));  // the units of both are decades apart
  if (std::fabs(scale / decade - 1) > std::max(kDecade, 2 / all)) return false;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (std::fabs(b[i] - b[0] - decade * (a[i] - a[0])) > kCount * decade) return false;
  return true;
}

bool called_time(const std::string& name) { return time_name(name_and_unit(name).first).has_value(); }

double usual_step(const std::vector<double>& values) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < values.size(); ++i) steps.push_back(values[i] - values[i - 1]);
  return steps.empty() ? 0 : median_in_place(steps, Middle::lower);
}

bool clock_of_labview(const std::string& column, const std::string& chosen) {
  constexpr std::string_view kName = "X_Value";
  return column != chosen && column.starts_with(kName) && chosen.starts_with(kName);
}

bool numbered_alike(const std::string& a, const std::string& b) {
  const auto letters = [](const std::string& name) { return name.find_last_not_of("0123456789") + 1; };
  if (a == b) return true;
  const std::size_t front = letters(a);
  return front > 0 && front < a.size() && front == letters(b) && front < b.size() &&
         a.compare(0, front, b, 0, front) == 0;
}

std::vector<std::size_t> clocks_of_others(const TableFront& table, std::size_t chosen) {
  constexpr double kAlike = 0.02, kSame = 1e-6;
  const auto step_of = [&](std::size_t c) { return usual_step(table.first_values(c).values); };
  const auto is_clock = [&](std::size_t c) {
    return speaks_of_time(table.columns[c]) || unit_of_time(table.columns[c]);
  };
  const std::int64_t unit = unit_said(table.columns[chosen]);
  const double step = table.columns[chosen].calendar ? 0 : step_of(chosen);
  std::vector<std::size_t> out;
  for (std::size_t c = 0; c + 1 < table.columns.size() && step > 0; ++c) {
    const ColumnLabel& column = table.columns[c];
    const bool labview = clock_of_labview(column.name, table.columns[chosen].name);
    const bool numbered = labview || numbered_alike(column.name, table.columns[chosen].name);
    if (c == chosen || column.text || column.calendar || !(numbered || is_clock(c))) continue;
    const std::int64_t own = labview ? unit : unit_said(column);
    const bool beside = is_clock(c + 1) || (c > 0 && is_clock(c - 1));
    if (unit_of_another_quantity(column) || beside || (own == 0) != (unit == 0)) continue;
    const double units = own == 0 ? 1 : static_cast<double>(own) / static_cast<double>(unit);
    if (steady_clock(table.first_values(c).values) &&
        (labview || std::fabs(step_of(c) * units / step - 1) > (numbered ? kSame : kAlike)))
      out.push_back(c);
  }
  return out;
}

std::optional<std::size_t> find_time_column(const TableFront& table, const ReadOptions& options, LogInfo& info) {
  if (options.time_column == "none") return std::nullopt;
  if (options.time_column != "auto") return named_column(table, options.time_column, options, info.file);
  if (table.named) {
    const auto named = column_called_time(table, options, info);
    const auto finer = named ? finer_clock(table, *named) : std::nullopt;
    if (finer)
      info.guesses.push_back(fmt::format("time column: {}, finer than {} (`time_column` takes another one)",
                                         printable(table.columns[*finer].name), printable(table.columns[*named].name)));
    return finer ? finer : named;
  }
  for (std::size_t c = 0; c < table.columns.size(); ++c)
    if (table.columns[c].calendar && !table.columns[c].text) return c;
  return column_that_rises(table, options, info);
}

}  // namespace libchar
