#include "libchar/log/csv/long_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "libchar/core/numeric/median.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/spelling.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/csv/rows/stamps.hpp"
#include "libchar/log/detail/channel_choice.hpp"
#include "libchar/log/detail/odd_values.hpp"

namespace libchar::csv {
namespace {

constexpr std::size_t kMostKinds = 64, kMostNumbers = 16, kMostGroups = 1024;

bool names_kinds(std::string_view name) {
  static constexpr std::array<std::string_view, 25> kNames = {
      "series",       "metric", "entity_id", "sensor",   "sensorname", "sensor_name", "sensortype",
      "sensor_type",  "source", "channel",   "signal",   "topic",      "device",      "field",
      "_field",       "type",   "name",      "variable", "quantity",   "parameter",   "measurement",
      "_measurement", "tag",    "id",        "instance"};
  const std::string lower = ascii_lower(name);
  return std::find(kNames.begin(), kNames.end(), lower) != kNames.end();
}

/// The same of numbers: a counter of packets goes round as well.
bool numbers_kinds(std::string_view name) {
  static constexpr std::array<std::string_view, 13> kThings = {"imu",     "sensor",  "device",  "node", "module",
                                                               "unit",    "channel", "station", "tag",  "beacon",
                                                               "vehicle", "addr",    "can"};
  static constexpr std::array<std::string_view, 6> kNumbers = {"id", "no", "nr", "index", "number", "address"};
  const std::string lower = ascii_lower(name);
  for (const std::string_view thing : kThings) {
    if (lower.rfind(thing, 0) != 0) continue;
    std::string_view rest = std::string_view(lower).substr(thing.size());
    while (!rest.empty() && (rest[0] == '_' || rest[0] == ' ' || rest[0] == '-')) rest.remove_prefix(1);
    if (rest.empty() || std::find(kNumbers.begin(), kNumbers.end(), rest) != kNumbers.end()) return true;
  }
  return names_kinds(name);
}

std::vector<std::string> values_of(const std::vector<Cells>& rows, std::size_t column, std::size_t most = kMostKinds) {
  std::vector<std::string> values;
  for (const Cells& row : rows)
    if (column < row.size() && values.size() <= most &&
        std::find(values.begin(), values.end(), row[column].text) == values.end())
      values.push_back(row[column].text);
  return values;
}

std::optional<std::int64_t> stamp_of(const Cells& row, const Dialect& dialect) {
  std::int64_t sum = 0;
  for (const StampPart* part : {&dialect.time, &dialect.more_time}) {
    if (part->column < 0) continue;
    const auto column = static_cast<std::size_t>(part->column);
    std::int64_t ns = 0;
    std::size_t offset = 0;
    if (column >= row.size() || read_part(row[column].text, *part, dialect, ns, offset) != StampDefect::none ||
        __builtin_add_overflow(sum, ns, &sum))
      return std::nullopt;
  }
  return sum;
}

struct Steps {
  std::size_t all = 0, standing = 0;  // those that do not rise
  double scatter = 0;                 // of three quarters of the rest, in steps
  double spread = 0;                  // of all of the rest
  bool steady() const { return 10 * standing < all && scatter < 0.3; }
};

Steps steps_of(const std::vector<std::int64_t>& stamps) {
  Steps out;
  std::vector<double> rising;
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    ++out.all;
    const double step = static_cast<double>(stamps[i]) - static_cast<double>(stamps[i - 1]);
    if (step > 0)
      rising.push_back(step);
    else
      ++out.standing;
  }
  if (rising.empty()) return out;
  const double usual = median_in_place(rising, Middle::lower);
  std::vector<double> off;
  off.reserve(rising.size());
  for (const double step : rising) off.push_back(std::fabs(step - usual));
  const auto most = off.begin() + static_cast<std::ptrdiff_t>(3 * (off.size() - 1) / 4);
  std::nth_element(off.begin(), most, off.end());
  out.scatter = *most / usual;
  double squares = 0;
  for (const double one : off) squares += one * one;
  out.spread = std::sqrt(squares / static_cast<double>(off.size())) / usual;
  return out;
}

/// One kind after the other, row by row: evenly in time too, perhaps.
bool in_turn(const std::vector<Cells>& rows, std::size_t column) {
  constexpr std::size_t kRounds = 3;
  const std::vector<std::string> kinds = values_of(rows, column);
  if (kinds.size() < 2 || rows.size() < kRounds * kinds.size()) return false;
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (column >= rows[i].size() || rows[i][column].text != kinds[i % kinds.size()]) return false;
  return true;
}

// Stamps that stand or scatter as a whole; where the name of the column says nothing of kinds, that
// stand, and rise by kind. In any case those that are uneven as a whole, and even by kind.
bool told_apart(const std::vector<Cells>& rows, std::size_t column, bool named, const Dialect& dialect) {
  constexpr double kUneven = 0.1, kEven = 0.2;
  constexpr std::size_t kFewest = 6;  // steps
  std::vector<std::int64_t> all;
  std::map<std::string, std::vector<std::int64_t>> kinds;
  for (const Cells& row : rows)
    if (const auto stamp = stamp_of(row, dialect); stamp && column < row.size()) {
      all.push_back(*stamp);
      kinds[row[column].text].push_back(*stamp);
    }
  const Steps whole = steps_of(all);
  std::size_t standing = 0;
  double spread = 0;
  bool judged = kinds.size() > 1;
  for (const auto& [kind, stamps] : kinds) {
    const Steps own = steps_of(stamps);
    standing += own.standing;
    spread = std::max(spread, own.spread);
    judged = judged && own.all >= kFewest && own.standing == 0;
  }
  if (judged && whole.spread > kUneven && spread < kEven * whole.spread) return true;
  if (whole.steady()) return false;
  if (named) return true;
  return 10 * whole.standing >= whole.all && 10 * standing < whole.standing && 3 * kinds.size() <= rows.size();
}

/// Whole numbers in no order, and rows of several at one stamp: the vehicles of a simulation, the nodes of a network.
bool many_numbered(const std::vector<Cells>& rows, std::size_t column, const Dialect& dialect) {
  std::vector<double> numbers;
  std::vector<std::int64_t> stamps;
  for (const Cells& row : rows) {
    if (column >= row.size()) continue;
    const Cell cell = read_cell(row[column].text, '.');
    const auto stamp = stamp_of(row, dialect);
    if (cell.kind != Cell::value || !cell.integer || !stamp) return false;
    numbers.push_back(cell.number);
    stamps.push_back(*stamp);
  }
  const Steps whole = steps_of(stamps);
  return numbers.size() > kMostNumbers && 3 * whole.standing >= whole.all &&
         !std::is_sorted(numbers.begin(), numbers.end());
}

/// More words than the first rows repeat, most of them at the stamp of the one before: a column called after kinds.
bool many_words(const std::vector<Cells>& rows, std::size_t column, const Dialect& dialect) {
  std::vector<std::int64_t> stamps;
  for (const Cells& row : rows)
    if (const auto stamp = stamp_of(row, dialect); stamp && column < row.size()) stamps.push_back(*stamp);
  const Steps whole = steps_of(stamps);
  return 3 * whole.standing >= 2 * whole.all;
}

bool whole_numbers(const std::vector<std::string>& values) {
  return values.size() <= kMostNumbers && std::all_of(values.begin(), values.end(), [](const auto& text) {
           const Cell cell = read_cell(text, '.');
           return cell.kind == Cell::value && cell.integer;
         });
}

[[noreturn]] void refuse(const std::string& name, const std::vector<std::string>& values, const LogInfo& info) {
  throw input_error("E0327", info.file)
      .says("the rows are of several kinds: {} is {}", name, first_names(values))
      .hint("`where` {}={} reads one of them, `group_by` {} makes channels of each, `channels` '!{}' reads all rows",
            name, values.front(), name, name);
}

/// The column that "COLUMN=VALUE" or "COLUMN" names, by name, text or position c0, c1… among all. Throws Error(usage).
std::size_t column_named(const std::string& wanted, const Dialect& dialect, const LogInfo& info) {
  std::vector<std::string> names;
  for (std::size_t c = 0; c < dialect.columns.size(); ++c) {
    const Column& column = dialect.columns[c];
    if (column.name == wanted || column.text == wanted) return c;
    names.push_back(column.name.empty() ? fmt::format("c{}", c) : column.name);
  }
  if (const auto position = position_in(wanted, names.size())) return *position;
  throw usage_error("E0320", info.file)
      .says("there is no column of this name")
      .got(wanted)
      .hint(did_you_mean(nearest(wanted, names), "it has " + first_names(names)));
}

Turns turns_of(const std::vector<Cells>& rows, const Dialect& dialect) {
  const std::size_t n = dialect.groups.size();
  std::vector<std::vector<double>> behind(n);
  std::vector<double> periods;
  std::optional<std::int64_t> first;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto stamp = stamp_of(rows[i], dialect);
    if (i % n == 0) {
      if (first && stamp) periods.push_back(static_cast<double>(*stamp - *first) / 1e9);
      first = stamp;
    } else if (first && stamp) {
      behind[i % n].push_back(static_cast<double>(*stamp - *first) / 1e9);
    }
  }
  const auto middle = [](std::vector<double>& some) { return some.empty() ? 0 : median_in_place(some, Middle::lower); };
  Turns out{std::vector<double>(n), middle(periods)};
  std::transform(behind.begin(), behind.end(), out.behind_s.begin(), middle);
  return out;
}

}  // namespace

std::vector<RowFilter> filters_of(const ReadOptions& options, const Dialect& dialect, const LogInfo& info) {
  std::vector<RowFilter> out;
  for (const std::string& word : options.kinds.where) {
    const std::size_t sign = word.find('=');
    if (sign == std::string::npos || sign == 0)
      throw usage_error("E0202", "`where`").says("expected COLUMN=VALUE").got(word).hint("such as sensor=Gyroscope");
    out.push_back({static_cast<int>(column_named(word.substr(0, sign), dialect, info)), word.substr(sign + 1), false});
  }
  return out;
}

bool more_groups(const std::vector<Cells>& first, const std::vector<Cells>& more, const ReadOptions& options,
                 const Dialect& dialect, const LogInfo& info) {
  const std::size_t column = column_named(options.kinds.group_by, dialect, info);
  return values_of(more, column, more.size()).size() > values_of(first, column, first.size()).size();
}

void choose_groups(const std::vector<Cells>& rows, const ReadOptions& options, Dialect& dialect, LogInfo& info) {
  if (options.kinds.group_by.empty()) return;
  const std::size_t column = column_named(options.kinds.group_by, dialect, info);
  dialect.group_column = static_cast<int>(column);
  dialect.groups = values_of(rows, column, kMostGroups);
  if (dialect.groups.size() > kMostGroups)
    throw usage_error("E0328", info.file)
        .says("more than {} values in the column of `group_by`", kMostGroups)
        .got(options.kinds.group_by)
        .hint("a column of names of sensors was expected");
  std::size_t changes = 0;
  bool cyclic = true, together = true;
  const std::size_t n = dialect.groups.size();
  for (std::size_t i = 1; i < rows.size(); ++i) {
    if (column >= rows[i].size() || column >= rows[i - 1].size()) continue;
    changes += rows[i][column].text != rows[i - 1][column].text;
    cyclic = cyclic && rows[i][column].text == dialect.groups[i % n];
    if (dialect.time.column >= 0 && i % n != 0)
      together = together && stamp_of(rows[i], dialect) == stamp_of(rows[i - 1], dialect);
  }
  dialect.cycles = n > 1 && cyclic && !together && !options.kinds.own_stamps;
  if (dialect.cycles && dialect.time.column >= 0) say_apart(dialect.groups, turns_of(rows, dialect), info.warnings);
  if (n > 1 && changes < n && rows.size() > 2 * n)
    throw usage_error("E0328", info.file)
        .says("the rows of one kind come after those of another, and are not side by side: " +
              first_names(dialect.groups))
        .hint("`where` {}={} reads one of them", options.kinds.group_by, dialect.groups[0]);
}

void refuse_long_table(const std::vector<Cells>& rows, const std::vector<ColumnKind>& kinds, const ReadOptions& options,
                       Dialect& dialect, const LogInfo& info) {
  if (!options.kinds.where.empty() || !options.kinds.group_by.empty()) return;
  const bool timed = dialect.time.column >= 0;
  if (!timed && !options.channels.empty()) return;
  // Words first: they say more than the numbers beside them.
  for (std::size_t k = 0; k < 2 * std::min(kinds.size(), dialect.columns.size()); ++k) {
    const std::size_t c = k % dialect.columns.size();
    const Column& column = dialect.columns[c];
    const bool words = k < dialect.columns.size();
    if (kinds[c] != (words ? ColumnKind::text : ColumnKind::number)) continue;
    const std::string name = column.name.empty() ? fmt::format("c{}", c) : column.name;
    if (static_cast<int>(c) == dialect.time.column || (column.text.empty() && (!words || dialect.has_header))) continue;
    const auto& asked = options.channels;  // who leaves it out knows that it names no source
    if (std::find(asked.begin(), asked.end(), "!" + name) != asked.end()) continue;
    const std::vector<std::string> values = values_of(rows, c, words ? kMostKinds : kMostNumbers);
    if (values.size() > kMostKinds && !(timed && numbers_kinds(column.name) && many_words(rows, c, dialect))) continue;
    if (values.size() > kMostKinds) refuse(name, values_of(rows, c, rows.size()), info);
    if (values.size() == 1) {
      if (words && names_kinds(column.name)) dialect.filters.push_back({static_cast<int>(c), values[0], true});
    } else if (words && names_kinds(column.name) && !timed) {
      refuse(name, values, info);
    } else if (timed && !words && dialect.filters.empty() && values.size() > kMostNumbers &&
               numbers_kinds(column.name) && many_numbered(rows, c, dialect)) {
      refuse(name, values_of(rows, c, rows.size()), info);
    } else if (timed && (options.channels.empty() || names_kinds(column.name)) && (words || whole_numbers(values)) &&
               (told_apart(rows, c, words && names_kinds(column.name), dialect) ||
                ((numbers_kinds(column.name) || (words && !dialect.has_header)) && in_turn(rows, c)))) {
      refuse(name, values, info);
    }
  }
}

}  // namespace libchar::csv
