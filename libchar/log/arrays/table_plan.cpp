#include "libchar/log/arrays/table_plan.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "libchar/core/refusal.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/binary/npy_header.hpp"
#include "libchar/log/detail/column_name.hpp"
#include "libchar/log/time/time_column.hpp"

namespace libchar {
namespace {

// 3 × 100000 is three channels and no table of 100000: of a shape without any other sign, at this ratio.
constexpr std::uint64_t kTurnedRatio = 32;
// A table without stamps that is this many times shorter than the longest one holds constants or a calibration.
constexpr std::uint64_t kMinorTable = 4;

std::string path_of(const LogArray& array) { return array.group.empty() ? array.name : array.group + "/" + array.name; }

// "a/b" → "a" → ""; nothing above the top.
bool go_up(std::string& group) {
  if (group.empty()) return false;
  const std::size_t slash = group.rfind('/');
  group.resize(slash == std::string::npos ? 0 : slash);
  return true;
}

bool is_record(const LogArray& array) {
  return array.fields.size() > 1 || (!array.fields.empty() && !array.fields[0].name.empty());
}

std::vector<std::uint64_t> squeezed(const LogArray& array) {
  std::vector<std::uint64_t> shape;
  for (const std::uint64_t extent : array.shape)
    if (extent != 1) shape.push_back(extent);
  return shape;
}

std::uint64_t columns_of(const std::vector<std::uint64_t>& shape) {
  std::uint64_t columns = 1;
  for (std::size_t i = 1; i < shape.size(); ++i)
    if (__builtin_mul_overflow(columns, shape[i], &columns)) return kMaxColumns + 1;
  return columns;
}

// Why an array is no table's, "" when it is.
std::string not_a_column(const LogArray& array) {
  if (!array.why_not.empty()) return array.why_not;
  const std::vector<std::uint64_t> shape = squeezed(array);
  if (std::find(shape.begin(), shape.end(), 0) != shape.end()) return "is empty";
  if (is_record(array) && shape.size() > 1) return "has records in more than one dimension";
  if (std::min(columns_of(shape), shape.size() == 2 ? shape[0] : kMaxColumns + 1) > kMaxColumns)
    return fmt::format("has more than {} columns: are they images?", kMaxColumns);
  return "";
}

bool says_time(const LogArray& array, const ArrayRows& rows) {
  if (!is_record(array)) return rows.columns == 1 && called_time(array.name);
  return std::any_of(array.fields.begin(), array.fields.end(),
                     [](const ElementField& field) { return field.count == 1 && called_time(field.name); });
}

std::string plain_word(std::string_view name) {
  std::string word;
  for (const char c : ascii_lower(name))
    if (c != '_' && c != ' ' && c != '-') word += c;
  return word;
}

// The sampling rate that a single number of this name is, 0 when it is none.
double rate_said(const std::string& name, double value) {
  static constexpr std::array kRateWords = {"fs",
                                            "rate",
                                            "ratehz",
                                            "samplerate",
                                            "samplingrate",
                                            "sampleratehz",
                                            "samplingratehz",
                                            "samplefrequency",
                                            "samplingfrequency",
                                            "frequency",
                                            "freq",
                                            "fshz",
                                            "hz",
                                            "odr",
                                            "imurate",
                                            "imuratehz",
                                            "datarate",
                                            "updaterate"};
  static constexpr std::array kStepWords = {
      "dt",     "ts",  "sampletime", "sampleinterval", "samplinginterval", "sampleperiod", "samplingperiod",
      "deltat", "dts", "timestep"};
  const std::string word = plain_word(name);
  const auto among = [&](const auto& words) {
    return std::any_of(words.begin(), words.end(), [&](const char* w) { return word == w; });
  };
  const double hz = among(kRateWords) ? value : among(kStepWords) ? 1 / value : 0;
  return std::isfinite(hz) && hz >= 1e-5 && hz <= 1e9 ? hz : 0;
}

class Planner {
 public:
  Planner(const ArrayContainer& container, const std::function<double(std::size_t)>& single, const std::string& file)
      : arrays_(container.arrays()), file_(file) {
    plan_.rows.resize(arrays_.size());
    refuse_doubles();
    for (const SaidNumber& number : container.said()) add_single(number.group, number.name, number.value);
    for (std::size_t i = 0; i < arrays_.size(); ++i) look_at(i, single);
    turn_arrays();
    for (const std::size_t i : columns_) times_.emplace(group_key(i), false);
    for (const std::size_t i : columns_)
      if (says_time(arrays_[i], plan_.rows[i]) && !is_record(arrays_[i])) times_[group_key(i)] = true;
  }

  TablePlan finish() {
    std::vector<std::pair<Key, std::vector<std::size_t>>> tables;
    for (const std::size_t i : columns_) {
      const Key key = table_of(i);
      const auto known =
          std::find_if(tables.begin(), tables.end(), [&](const auto& table) { return table.first == key; });
      if (known == tables.end())
        tables.push_back({key, {i}});
      else
        known->second.push_back(i);
    }
    for (const auto& [key, members] : tables) add_table(key, members, tables.size());
    mark_sensors();
    std::stable_sort(plan_.tables.begin(), plan_.tables.end(),
                     [](const auto& a, const auto& b) { return a.topic.rows > b.topic.rows; });
    say_left_out();
    return std::move(plan_);
  }

 private:
  // A table: where it stands, its length, and the array that is one by itself (records with stamps of their own).
  struct Key {
    std::string home;
    std::uint64_t rows = 0;
    std::size_t alone = 0;
    bool operator==(const Key&) const = default;
  };

  void refuse_doubles() const {
    std::set<std::string> names;
    for (const LogArray& array : arrays_)
      if (!names.insert(path_of(array)).second)
        throw input_error("E0307", file_)
            .says("two arrays have one name")
            .got(path_of(array))
            .hint("save it again with names that differ");
  }

  void look_at(std::size_t i, const std::function<double(std::size_t)>& single) {
    const LogArray& array = arrays_[i];
    if (std::string why = not_a_column(array); !why.empty()) {
      left_out_.emplace_back(i, std::move(why));
      return;
    }
    const std::vector<std::uint64_t> shape = squeezed(array);
    if (shape.empty()) {
      if (is_record(array))
        left_out_.emplace_back(i, "is a single record");
      else
        add_single(array.group, array.name, single(i));
      return;
    }
    plan_.rows[i] = {shape[0], columns_of(shape), array.first_fastest && shape.size() > 1, false};
    columns_.push_back(i);
  }

  void add_single(const std::string& group, const std::string& name, double value) {
    if (const double hz = rate_said(name, value); hz > 0) rates_.push_back({group, name, hz});
  }

  // Lengths of the vectors of a group, those only that say time or all.
  std::set<std::uint64_t> lengths(const std::string& group, bool times_only) const {
    std::set<std::uint64_t> found;
    for (const std::size_t i : columns_)
      if (arrays_[i].group == group && squeezed(arrays_[i]).size() == 1 &&
          (!times_only || says_time(arrays_[i], plan_.rows[i])))
        found.insert(plan_.rows[i].rows);
    return found;
  }

  // Is an array of a × b one of b rows? As the stamps nearest above say, else the other vectors, else its shape.
  bool is_turned(const LogArray& array, std::uint64_t a, std::uint64_t b) const {
    if (a == b) return false;
    for (const bool times_only : {true, false}) {
      std::string group = array.group;
      do {
        const std::set<std::uint64_t> known = lengths(group, times_only);
        if (known.contains(a)) return false;
        if (known.contains(b) && (times_only || b > a)) return true;
      } while (go_up(group));
    }
    return b / kTurnedRatio >= a;
  }

  void turn_arrays() {
    std::vector<std::string> turned;
    for (const std::size_t i : columns_) {
      const std::vector<std::uint64_t> shape = squeezed(arrays_[i]);
      if (shape.size() != 2 || !is_turned(arrays_[i], shape[0], shape[1])) continue;
      turned_.push_back(i);
      turned.push_back(fmt::format("{} ({} × {})", printable(path_of(arrays_[i])), shape[0], shape[1]));
    }
    for (const std::size_t i : turned_) {
      ArrayRows& rows = plan_.rows[i];
      rows = {rows.columns, rows.rows, !rows.planar, true};
    }
    if (turned.empty()) return;
    const std::size_t shown = std::min<std::size_t>(turned.size(), 3);
    plan_.said.push_back(fmt::format("rows along the second dimension: {}{}",
                                     fmt::join(turned.begin(), turned.begin() + shown, ", "),
                                     turned.size() > shown ? ", …" : ""));
  }

  std::pair<std::string, std::uint64_t> group_key(std::size_t i) const {
    return {arrays_[i].group, plan_.rows[i].rows};
  }

  // The nearest group from its own upwards that has stamps for its rows; its own when none has.
  Key table_of(std::size_t i) const {
    const LogArray& array = arrays_[i];
    const std::uint64_t rows = plan_.rows[i].rows;
    if (is_record(array) && says_time(array, plan_.rows[i])) return {array.group, rows, i + 1};
    std::string group = array.group;
    do {
      const auto known = times_.find({group, rows});
      if (known != times_.end() && known->second) return {group, rows, 0};
    } while (go_up(group));
    return {array.group, rows, 0};
  }

  // A field that is no time stands for a table that has no better name.
  std::string name_of_table(const Key& key, const std::vector<std::size_t>& members, std::size_t tables) const {
    if (key.alone != 0) return path_of(arrays_[key.alone - 1]);
    if (tables == 1 && key.home.empty() && members.size() > 1) return "arrays";
    bool only = !key.home.empty();  // the only length of its group?
    for (const std::size_t i : columns_) only = only && (!(arrays_[i].group == key.home) || table_of(i) == key);
    if (only) return key.home;
    for (const std::size_t i : members)
      if (!says_time(arrays_[i], plan_.rows[i])) return path_of(arrays_[i]);
    return path_of(arrays_[members.front()]);
  }

  void add_table(const Key& key, const std::vector<std::size_t>& members, std::size_t tables) {
    ArrayTable table;
    table.topic.name = name_of_table(key, members, tables);
    table.topic.rows = key.rows;
    for (const std::size_t i : members) add_array(key, i, members.size() == 1, table);
    for (const std::size_t i : members)
      for (const std::string& field : arrays_[i].left_out)
        say(fmt::format("left out of {}: {}", printable(path_of(arrays_[i])), printable(field)));
    std::set<std::string> names;
    for (const Channel& field : table.topic.fields)
      if (!names.insert(field.name).second)
        throw input_error("E0307", file_).says("two columns have one name").got(field.name);
    table.rate_hz = rate_of(key, members);
    table.topic.rate_hz = table.rate_hz;
    plan_.tables.push_back(std::move(table));
  }

  void add_array(const Key& key, std::size_t i, bool alone, ArrayTable& table) {
    const LogArray& array = arrays_[i];
    const ArrayRows& rows = plan_.rows[i];
    std::uint64_t numbers = 0;
    for (const ElementField& field : array.fields) numbers += field.count;
    if (table.fields.size() + rows.columns * numbers > kMaxColumns) {
      left_out_.emplace_back(i, fmt::format("would be more than {} columns with the others", kMaxColumns));
      return;
    }
    std::string base = path_of(array);
    if (!key.home.empty()) base = base.substr(key.home.size() + 1);
    for (std::uint64_t c = 0; c < rows.columns; ++c) {
      const std::string column = rows.columns > 1 ? fmt::format("{}_{}", base, c) : base;
      for (const ElementField& field : array.fields) add_field(i, c, field, column, alone, table);
    }
  }

  void add_field(std::size_t i, std::uint64_t column, const ElementField& field, const std::string& column_name,
                 bool alone, ArrayTable& table) {
    for (std::uint64_t k = 0; k < field.count; ++k) {
      std::string name = field.name.empty() ? column_name : alone ? field.name : column_name + "." + field.name;
      std::string unit =
          !field.unit.empty() ? field.unit : name_and_unit(field.name.empty() ? arrays_[i].name : field.name).second;
      if (field.array) name += fmt::format("_{}", k);
      const bool integer = !is_float(field.number.type) && !field.real;
      table.topic.fields.push_back({std::move(name), std::move(unit), integer});
      table.fields.push_back({i, column, field.byte + k * size_of(field.number.type), field.number, integer});
    }
  }

  // Beside an array, else the nearest group above; two that contradict each other say nothing.
  double rate_of(const Key& key, const std::vector<std::size_t>& members) {
    std::vector<std::pair<std::string, double>> found;
    for (const std::size_t i : members)
      for (const SaidNumber& number : arrays_[i].said)
        if (const double hz = rate_said(number.name, number.value); hz > 0) found.emplace_back(number.name, hz);
    std::string group = key.home;
    do {
      if (!found.empty()) break;
      for (const SaidNumber& rate : rates_)
        if (rate.group == group) found.emplace_back(rate.name, rate.value);
    } while (go_up(group));
    if (found.empty()) return 0;
    for (const auto& [name, hz] : found) {
      if (std::abs(hz / found[0].second - 1) < 1e-6) continue;
      say(fmt::format("{} says {} Hz and {} {} Hz: neither is used", printable(found[0].first),
                      shortest(found[0].second), printable(name), shortest(hz)));
      return 0;
    }
    say(fmt::format("{} says {} Hz", printable(found[0].first), shortest(found[0].second)));
    return found[0].second;
  }

  void say(std::string text) {
    if (std::find(plan_.said.begin(), plan_.said.end(), text) == plan_.said.end())
      plan_.said.push_back(std::move(text));
  }

  // Those with stamps, else the long ones with a rate, else all long ones.
  void mark_sensors() {
    std::uint64_t longest = 0;
    for (const ArrayTable& table : plan_.tables) longest = std::max(longest, table.topic.rows);
    const auto stamped = [](const ArrayTable& table) {
      return std::any_of(table.topic.fields.begin(), table.topic.fields.end(),
                         [](const Channel& f) { return called_time(f.name); });
    };
    const auto any = [&](const ArrayTable& table) { return table.topic.rows >= longest / kMinorTable; };
    const auto rated = [&](const ArrayTable& table) { return table.rate_hz > 0 && any(table); };
    const auto mark = [&](auto has) {
      bool found = false;
      for (ArrayTable& table : plan_.tables) {
        table.topic.sensor = table.topic.rows > 1 && !table.topic.fields.empty() && has(table);
        found = found || table.topic.sensor;
      }
      return found;
    };
    if (!mark(stamped) && !mark(rated)) mark(any);
  }

  // Said in a sentence, and, when there is nothing else, the topics of the file.
  void say_left_out() {
    if (left_out_.empty()) return;
    std::vector<std::string> words;
    for (const auto& [i, why] : left_out_) {
      const std::string name = path_of(arrays_[i]);
      if (words.size() < 4) words.push_back(fmt::format("{} {}", printable(name), why));
    }
    if (left_out_.size() > words.size()) words.push_back(fmt::format("and {} more", left_out_.size() - words.size()));
    plan_.said.push_back(fmt::format("left out: {}", fmt::join(words, "; ")));
    if (!plan_.tables.empty()) return;
    for (const auto& [i, why] : left_out_) {
      ArrayTable table;
      table.topic.name = path_of(arrays_[i]);
      table.topic.why_not = why;
      plan_.tables.push_back(std::move(table));
    }
  }

  const std::vector<LogArray>& arrays_;
  std::vector<SaidNumber> rates_;  // in Hz
  const std::string& file_;
  TablePlan plan_;
  std::vector<std::size_t> columns_, turned_;  // arrays with rows; of these, those that are turned
  std::vector<std::pair<std::size_t, std::string>> left_out_;
  std::map<std::pair<std::string, std::uint64_t>, bool> times_;  // has a group stamps for this many rows?
};

}  // namespace

TablePlan plan_tables(const ArrayContainer& container, const std::function<double(std::size_t array)>& single,
                      const std::string& file) {
  return Planner(container, single, file).finish();
}

}  // namespace libchar
