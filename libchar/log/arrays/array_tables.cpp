#include "libchar/log/arrays/array_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "libchar/core/text/text.hpp"
#include "libchar/log/arrays/table_plan.hpp"
#include "libchar/log/binary/stamps.hpp"
#include "libchar/log/detail/odd_values.hpp"

namespace libchar {
namespace {

constexpr std::uint64_t kBlockBytes = 4U << 20U;  // of one array, however wide it is

// A field that is read, and which of its array's pieces it is in.
struct Reading {
  TableField field;
  std::size_t array = 0, piece = 0;
};

// An array that is read.
struct OpenArray {
  std::size_t array = 0;
  std::vector<std::uint64_t> columns;
  std::unique_ptr<ArrayCursor> cursor;
  std::vector<ArrayPiece> pieces;
};

const std::byte* first_of(const OpenArray& array, const Reading& reading) {
  return array.pieces[reading.piece].first + reading.field.byte;
}

class ArrayTables final : public TopicReader {
 public:
  ArrayTables(std::unique_ptr<ArrayContainer> container, std::string path)
      : container_(std::move(container)), path_(std::move(path)) {
    plan_ = plan_tables(
        *container_, [this](std::size_t array) { return single(array); }, path_);
    for (const ArrayTable& table : plan_.tables) topics_.push_back(table.topic);
  }

  const std::vector<LogTopic>& topics() const override { return topics_; }
  std::string stamps(std::size_t) const override { return ""; }
  double stated_rate_hz(std::size_t topic) const override { return plan_.tables[topic].rate_hz; }
  std::uint64_t bytes_read() const override { return container_->bytes_read(); }

  std::vector<std::string> dialect() const override {
    std::vector<std::string> all = container_->dialect();
    all.insert(all.end(), plan_.said.begin(), plan_.said.end());
    return all;
  }

  FirstValues first_values(std::size_t topic, std::size_t field) override {
    const TableField& at = plan_.tables[topic].fields[field];
    const auto rows = static_cast<std::size_t>(std::min<std::uint64_t>(kFirstRows, plan_.tables[topic].topic.rows));
    FirstValues first;
    first.integers = at.integer;
    for (const double x : read_front(at, rows))
      if (std::isfinite(x)) first.values.push_back(x);
    return first;
  }

  void select(std::size_t topic, const std::vector<std::size_t>& fields, std::optional<std::size_t> time,
              StampUnit unit) override {
    const ArrayTable& table = plan_.tables[topic];
    table_ = &table;
    std::map<std::size_t, std::vector<std::uint64_t>> columns;
    const auto want = [&](std::size_t i) { columns[table.fields[i].array].push_back(table.fields[i].column); };
    for (const std::size_t i : fields) want(i);
    if (time) want(*time);
    std::uint64_t widest = 1;
    for (auto& [array, wanted] : columns) {
      std::sort(wanted.begin(), wanted.end());
      wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
      const ArrayRows& rows = plan_.rows[array];
      const std::uint64_t side = rows.planar ? 1 : rows.columns;
      widest = std::max(widest, side * container_->arrays()[array].element_bytes);
      open_.push_back({array, wanted, container_->open(array, rows, wanted), {}});
    }
    most_ = std::max<std::uint64_t>(1, kBlockBytes / widest);
    for (const std::size_t i : fields) readings_.push_back(reading_of(table.fields[i]));
    if (time) time_ = reading_of(table.fields[*time]);
    if (time) time_name_ = table.topic.fields[*time].name;
    for (const std::size_t i : fields) names_.push_back(table.topic.fields[i].name);
    unit_ = unit;
  }

  bool next(RowBlock& block, std::size_t most, Findings&) override {
    const std::uint64_t left = table_->topic.rows - row_;
    const auto rows = static_cast<std::size_t>(std::min({static_cast<std::uint64_t>(most), most_, left}));
    block.rows = rows;
    if (rows == 0) return false;
    for (OpenArray& array : open_) array.cursor->next(rows, array.pieces);
    for (std::size_t i = 0; i < readings_.size(); ++i) {
      const OpenArray& array = open_[readings_[i].array];
      block.columns[i].resize(rows);
      const Rounded rounded = read_numbers(first_of(array, readings_[i]), array.pieces[readings_[i].piece].stride,
                                           readings_[i].field.number, block.columns[i]);
      rounded_.add_block(row_ + rounded.first, i, rounded.count);
    }
    if (time_) read_times(block);
    row_ += rows;
    return true;
  }

  void finish(Findings& warnings) override {
    rounded_.say(
        "rounded_integer", kRoundedIntegers,
        [this](std::uint64_t row, std::size_t channel) {
          return fmt::format("{} from row {}", printable(names_[channel]), row);
        },
        warnings);
  }

 private:
  Reading reading_of(const TableField& field) const {
    Reading reading{field, 0, 0};
    while (open_[reading.array].array != field.array) ++reading.array;
    const auto& columns = open_[reading.array].columns;
    reading.piece =
        static_cast<std::size_t>(std::lower_bound(columns.begin(), columns.end(), field.column) - columns.begin());
    return reading;
  }

  void read_times(RowBlock& block) const {
    const OpenArray& array = open_[time_->array];
    block.time_ns.resize(block.rows);
    read_stamps(first_of(array, *time_), array.pieces[time_->piece].stride,
                {time_->field.number, 1, -unit_.zero, unit_.ns}, block.time_ns, [this](std::size_t i) {
                  return fmt::format("{} (row {}, field {})", path_, row_ + i, printable(time_name_));
                });
  }

  std::vector<double> read_front(const TableField& at, std::size_t rows) {
    const auto cursor = container_->open(at.array, plan_.rows[at.array], {at.column});
    std::vector<ArrayPiece> pieces;
    cursor->next(rows, pieces);
    std::vector<double> values(rows);
    read_numbers(pieces[0].first + at.byte, pieces[0].stride, at.number, values);
    return values;
  }

  double single(std::size_t array) {
    const ElementField& field = container_->arrays()[array].fields[0];
    const auto cursor = container_->open(array, {1, 1, false, false}, {0});
    std::vector<ArrayPiece> pieces;
    cursor->next(1, pieces);
    double value = 0;
    read_numbers(pieces[0].first + field.byte, pieces[0].stride, field.number, {&value, 1});
    return value;
  }

  std::unique_ptr<ArrayContainer> container_;
  std::string path_;
  TablePlan plan_;
  std::vector<LogTopic> topics_;
  const ArrayTable* table_ = nullptr;
  std::vector<OpenArray> open_;
  std::vector<Reading> readings_;
  std::optional<Reading> time_;
  std::string time_name_;
  std::vector<std::string> names_;
  StampUnit unit_{1};
  OddPlaces rounded_;
  std::uint64_t row_ = 0, most_ = 1;
};

}  // namespace

std::unique_ptr<TopicReader> array_tables(std::unique_ptr<ArrayContainer> container, const std::string& path) {
  return std::make_unique<ArrayTables>(std::move(container), path);
}

}  // namespace libchar
