#include "libchar/log/csv/long_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>

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
  static constexpr std::array<std::string_view, 18> kThings = {
      "imu",    "sensor",  "device", "node", "module", "unit",    "channel",     "station", "tag",
      "beacon", "vehicle", "addr",   "can",  "msg",    "message", "arbitration", "arb",     "pgn"};
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
  double spread = 0;                  // of all of them from a multiple of the usual one: rows that are lost are even
  bool steady() const { return 10 * standing < all && scatter < 0.3; }
};

Steps steps_of(const std::vector<double>& steps) {
  Steps out;
  std::vector<double> rising;
  std::copy_if(steps.begin(), steps.end(), std::back_inserter(rising), [](double step) { return step > 0; });
  out.all = steps.size();
  out.standing = out.all - rising.size();
  if (rising.empty()) return out;
  const double usual = median_in_place(rising, Middle::lower);
  std::vector<double> off;
  off.reserve(rising.size());
  auto squares = static_cast<double>(out.standing);
  for (const double step : rising) {
    off.push_back(std::fabs(step - usual));
    const double parts = step / usual, residual = parts - std::max(1.0, std::round(parts));
    squares += residual * residual;
  }
  const auto most = off.begin() + static_cast<std::ptrdiff_t>(3 * (off.size() - 1) / 4);
  std::nth_element(off.begin(), most, off.end());
  out.scatter = *most / usual;
  out.spread = std::sqrt(squares / static_cast<double>(out.all));
  return out;
}

/// The steps of rows that follow each other, within each of these stretches, as a whole and by kind.
struct KindSteps {
  std::vector<double> whole;
  std::map<std::string, std::vector<double>> kinds;
};

KindSteps steps_by_kind(std::span<const std::vector<Cells>> stretches, std::size_t column, const Dialect& dialect) {
  KindSteps out;
  for (const std::vector<Cells>& rows : stretches) {
    std::optional<std::int64_t> last;
    std::map<std::string_view, std::int64_t> last_of_kind;
    for (const Cells& row : rows) {
      const auto stamp = stamp_of(row, dialect);
      if (!stamp || column >= row.size()) continue;
      const auto since = [now = static_cast<double>(*stamp)](std::int64_t then) {
        return now - static_cast<double>(then);
      };
      const std::string& kind = row[column].text;
      std::vector<double>& own = out.kinds[kind];
      const auto [before, first] = last_of_kind.try_emplace(kind, *stamp);
      if (last) out.whole.push_back(since(*last));
      if (!first) own.push_back(since(before->second));
      before->second = *stamp;
      last = stamp;
    }
  }
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

/// Uneven as a whole, and even by kind.
bool even_by_kind(const KindSteps& steps) {
  constexpr double kUneven = 0.1, kEven = 0.2, kMost = 0.75;
  constexpr std::size_t kFewest = 6;  // steps
  double judged = 0, squares = 0;
  for (const auto& [kind, some] : steps.kinds) {
    if (some.size() < kFewest) continue;
    const double spread = steps_of(some).spread, count = static_cast<double>(some.size());
    judged += count;
    squares += spread * spread * count;
  }
  const double spread = steps_of(steps.whole).spread;
  return steps.kinds.size() > 1 && judged > kMost * static_cast<double>(steps.whole.size()) && spread > kUneven &&
         std::sqrt(squares / judged) < kEven * spread;
}

// Stamps that stand or scatter as a whole; where the name of the column says nothing of kinds, that
// stand, and rise by kind. In any case those that are uneven as a whole, and even by kind.
bool told_apart(const std::vector<Cells>& rows, std::size_t column, bool named, const Dialect& dialect) {
  const KindSteps steps = steps_by_kind({&rows, 1}, column, dialect);
  if (even_by_kind(steps)) return true;
  const Steps whole = steps_of(steps.whole);
  if (whole.steady()) return false;
  if (named) return true;
  std::size_t standing = 0;
  for (const auto& [kind, some] : steps.kinds) standing += steps_of(some).standing;
  return 10 * whole.standing >= whole.all && 10 * standing < whole.standing && 3 * steps.kinds.size() <= rows.size();
}

/// Whole numbers in no order, and rows of several at one stamp: the vehicles of a simulation, the nodes of a network.
bool many_numbered(const std::vector<Cells>& rows, std::size_t column, const Dialect& dialect) {
  std::vector<double> numbers;
  for (const Cells& row : rows) {
    if (column >= row.size()) continue;
    const Cell cell = read_cell(row[column].text, '.');
    if (cell.kind != Cell::value || !cell.integer || !stamp_of(row, dialect)) return false;
    numbers.push_back(cell.number);
  }
  const Steps whole = steps_of(steps_by_kind({&rows, 1}, column, dialect).whole);
  return numbers.size() > kMostNumbers && 3 * whole.standing >= whole.all &&
         !std::is_sorted(numbers.begin(), numbers.end());
}

/// More words than the first rows repeat, most of them at the stamp of the one before: a column called after kinds.
bool many_words(const std::vector<Cells>& rows, std::size_t column, const Dialect& dialect) {
  const Steps whole = steps_of(steps_by_kind({&rows, 1}, column, dialect).whole);
  return 3 * whole.standing >= 2 * whole.all;
}

bool whole_numbers(const std::vector<std::string>& values) {
  return std::all_of(values.begin(), values.end(), [](const auto& text) {
    const Cell cell = read_cell(text, '.');
    return cell.kind == Cell::value && cell.integer;
  });
}

[[noreturn]] void refuse(const std::string& name, const std::vector<std::string>& values, const LogInfo& info) {
  throw input_error("E0327", info.file)
      .says("the rows are of several kinds: {} is {}", name, first_names(values))
      .hint("`where` {} reads one of them, `group_by` {} makes channels of each, `channels` '!{}' reads all rows",
            shell_word(name + "=" + values.front()), shell_word(name), name);
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

/// Of a file in which a column called after kinds tells rows apart further on than the first ones do.
void refuse_kinds_of_file(const std::string& name, const RowsOfFile& all, std::size_t column, bool words,
                          const Dialect& dialect, const LogInfo& info) {
  std::vector<Cells> rows;
  for (const auto& some : all()) rows.insert(rows.end(), some.begin(), some.end());
  const std::vector<std::string> values = values_of(rows, column, kMostGroups);
  const auto fraction = [](const std::string& value) { return value.find('.') != std::string::npos; };
  if (values.size() < 2 || values.size() > kMostGroups) return;
  if (!words && std::any_of(values.begin(), values.end(), fraction)) return;  // 120 and 1A0 are both numbers of a bus
  if (even_by_kind(steps_by_kind(all(), column, dialect))) refuse(name, values, info);
}

/// All rows of one value come before those of the next, of several.
bool in_blocks(const Stretches& stretches, std::size_t column) {
  std::vector<std::string> values;
  std::size_t rows = 0;
  for (const auto& some : stretches)
    for (const Cells& row : some) {
      if (column >= row.size()) continue;
      ++rows;
      const std::string& value = row[column].text;
      if (!values.empty() && values.back() == value) continue;
      if (std::find(values.begin(), values.end(), value) != values.end() || values.size() > kMostGroups) return false;
      values.push_back(value);
    }
  return values.size() > 1 && rows > 2 * values.size();
}

/// The time goes back with each new value, and with these alone.
bool begins_with_each(const Stretches& stretches, std::size_t column, const Dialect& dialect) {
  std::optional<std::int64_t> last;
  std::string value;
  for (const auto& some : stretches)
    for (const Cells& row : some) {
      const auto stamp = stamp_of(row, dialect);
      if (!stamp || column >= row.size()) continue;
      if (last && (*stamp < *last) != (row[column].text != value)) return false;
      last = stamp;
      value = row[column].text;
    }
  return last.has_value();
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

void choose_groups(const std::vector<Cells>& rows, const RowsOfFile& all, const ReadOptions& options, Dialect& dialect,
                   LogInfo& info) {
  if (options.kinds.group_by.empty()) return;
  const std::size_t column = column_named(options.kinds.group_by, dialect, info);
  dialect.group_column = static_cast<int>(column);
  dialect.groups = values_of(rows, column, kMostGroups);
  for (const auto& more : all())
    for (std::string& value : values_of(more, column, kMostGroups))
      if (std::find(dialect.groups.begin(), dialect.groups.end(), value) == dialect.groups.end())
        dialect.groups.push_back(std::move(value));
  if (dialect.groups.size() > kMostGroups)
    throw usage_error("E0328", info.file)
        .says("more than {} values in the column of `group_by`", kMostGroups)
        .got(options.kinds.group_by)
        .hint("a column of names of sensors was expected");
  bool cyclic = true, together = true;
  const std::size_t n = dialect.groups.size();
  for (std::size_t i = 1; i < rows.size(); ++i) {
    if (column >= rows[i].size() || column >= rows[i - 1].size()) continue;
    cyclic = cyclic && rows[i][column].text == dialect.groups[i % n];
    if (dialect.time.column >= 0 && i % n != 0)
      together = together && stamp_of(rows[i], dialect) == stamp_of(rows[i - 1], dialect);
  }
  dialect.cycles = n > 1 && cyclic && !together && !options.kinds.own_stamps;
  if (dialect.cycles && dialect.time.column >= 0) say_apart(dialect.groups, turns_of(rows, dialect), info.warnings);
  dialect.sorted = in_blocks(all(), column);
}

void refuse_long_table(const std::vector<Cells>& rows, const RowsOfFile& all, const std::vector<ColumnKind>& kinds,
                       const ReadOptions& options, Dialect& dialect, const LogInfo& info) {
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
    if (timed && numbers_kinds(column.name)) refuse_kinds_of_file(name, all, c, words, dialect, info);
    if (values.size() > kMostKinds && !(timed && numbers_kinds(column.name) && many_words(rows, c, dialect))) continue;
    if (values.size() > kMostKinds) refuse(name, values_of(rows, c, rows.size()), info);
    if (values.size() == 1) {
      if (words && names_kinds(column.name)) dialect.filters.push_back({static_cast<int>(c), values[0], true});
    } else if (words && names_kinds(column.name) && !timed) {
      refuse(name, values, info);
    } else if (timed && !words && dialect.filters.empty() && values.size() > kMostNumbers &&
               numbers_kinds(column.name) && many_numbered(rows, c, dialect)) {
      refuse(name, values_of(rows, c, rows.size()), info);
    } else if (timed && (options.channels.empty() || names_kinds(column.name)) &&
               (words || (values.size() <= kMostNumbers && whole_numbers(values))) &&
               (told_apart(rows, c, words && names_kinds(column.name), dialect) ||
                ((numbers_kinds(column.name) || (words && !dialect.has_header)) && in_turn(rows, c)))) {
      refuse(name, values, info);
    }
  }
}

std::optional<SortedRows> sorted_by(const Stretches& rows, const Dialect& dialect) {
  for (std::size_t c = 0; c < dialect.columns.size(); ++c) {
    if (static_cast<int>(c) == dialect.time.column || static_cast<int>(c) == dialect.more_time.column) continue;
    if (!in_blocks(rows, c) || !begins_with_each(rows, c, dialect)) continue;
    const std::string& name = dialect.columns[c].name;
    return SortedRows{name.empty() ? fmt::format("c{}", c) : name, rows.front().front().at(c).text};
  }
  return std::nullopt;
}

}  // namespace libchar::csv
