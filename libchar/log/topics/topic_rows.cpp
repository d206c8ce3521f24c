#include "libchar/log/topics/topic_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "libchar/core/error.hpp"
#include "libchar/core/file/log_files.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/binary/file_hash.hpp"
#include "libchar/log/detail/channel_choice.hpp"
#include "libchar/log/detail/odd_values.hpp"
#include "libchar/log/topics/topic_choice.hpp"

namespace libchar {
namespace {

class TopicRows final : public RowSource {
 public:
  TopicRows(std::unique_ptr<TopicReader> reader,
            const std::string& path,
            std::string_view format,
            const ReadOptions& options)
      : reader_(std::move(reader)), files_(open_all(path)), hash_(pointers(), options.hash) {
    info_.file = path;
    info_.format = format;
    for (const auto& file : files_) info_.bytes += file->size();
    info_.topics = reader_->topics();
    info_.dialect = reader_->dialect();
    const auto choice =
        info_.topics.empty() ? std::nullopt : choose_topic(info_.topics, options, path);
    if (!choice) {
      Warnings losses;
      reader_->finish(losses);
      refuse_without_topic(info_.topics, path, losses);
    }
    topic_ = choice->topic;
    describe_topic(*choice);
    ReadOptions chosen = options;
    chosen.channels = choice->channels;
    choose_fields(chosen);
  }

  const LogInfo& info() const override { return info_; }
  std::uint64_t bytes_read() const override { return reader_->bytes_read(); }
  std::uint64_t bytes_total() const override { return info_.bytes; }
  std::string sha256() override { return hash_.finish(); }

  bool next(RowBlock& block, Warnings& warnings) override {
    if (rows_ == 0) hash_.start();
    block.rows = 0;
    block.columns.resize(info_.channels.size());
    for (std::vector<double>& column : block.columns) column.clear();
    block.time_ns.clear();
    block.first_line = 0;
    block.line_offset.clear();
    if (!reader_->next(block, rows_per_block_, warnings)) return false;
    if (ignore_stamps_) block.time_ns.clear();
    for (std::size_t c = 0; c < block.columns.size(); ++c)
      drop_non_finite(c, block.columns[c], warnings);
    rows_ += block.rows;
    return true;
  }

  void finish(Warnings& warnings) override {
    reader_->finish(warnings);
    std::uint64_t count = 0;
    for (const std::uint64_t n : missing_per_channel_) count += n;
    if (count == 0) return;
    const std::string message = missing_cells(info_.channels, missing_per_channel_);
    for (const std::string& place : missing_places_) warnings.add("missing_cell", message, place);
    if (count > missing_places_.size())
      warnings.add("missing_cell", message, "", count - missing_places_.size());
  }

  std::string place(const RowBlock&, std::size_t i, std::uint64_t rows_before) const override {
    return place_of(rows_before + i);
  }

 private:
  static std::vector<std::unique_ptr<BinaryFile>> open_all(const std::string& path) {
    std::vector<std::unique_ptr<BinaryFile>> files;
    for (const std::string& file : files_of_log(path))
      files.push_back(std::make_unique<BinaryFile>(file));
    return files;
  }
  std::vector<const BinaryFile*> pointers() const {
    std::vector<const BinaryFile*> all;
    for (const auto& file : files_) all.push_back(file.get());
    return all;
  }

  const LogTopic& topic() const { return info_.topics[topic_]; }

  std::string place_of(std::uint64_t row) const {
    return topic().name.empty() ? fmt::format("row {}", row)
                                : fmt::format("row {} of {}", row, printable(topic().name));
  }

  void describe_topic(const TopicChoice& choice) {
    info_.topic = topic().name;
    info_.rows = topic().rows;
    if (!topic().name.empty())
      info_.dialect.push_back(topic().type.empty()
                                  ? fmt::format("topic {}", topic().name)
                                  : fmt::format("topic {}, {}", topic().name, topic().type));
    if (!choice.guess.empty()) info_.guesses.push_back(choice.guess);
  }

  void choose_fields(const ReadOptions& options) {
    const std::vector<Channel>& fields = topic().fields;
    const std::string stamps = reader_->stamps(topic_);
    const bool own_stamps = !stamps.empty() && options.time_column == "auto";
    TableColumns columns;
    for (const Channel& field : fields) columns.names.push_back(field.name);
    const TableFront table = front();
    if (!own_stamps && (stamps.empty() || options.time_column != "none"))
      columns.time = find_time_column(table, options, info_);
    StampUnit unit{1};
    if (columns.time) {
      info_.time.column = fields[*columns.time].name;
      unit = find_time_unit(table, *columns.time, options, info_);
    } else if (own_stamps) {
      info_.time.column = stamps;
      info_.time.unit = "ns";
      info_.time.unit_ns = 1;
    } else {
      info_.time.rate_hz = reader_->stated_rate_hz(topic_);
    }
    ignore_stamps_ = !own_stamps && !columns.time;
    const std::vector<std::size_t> chosen = chosen_fields(columns, options);
    for (const std::size_t i : chosen) info_.channels.push_back(fields[i]);
    missing_per_channel_.assign(chosen.size(), 0);
    rows_per_block_ =
        std::max<std::size_t>(1, options.block_bytes / (sizeof(double) * (chosen.size() + 1)));
    reader_->select(topic_, chosen, columns.time, unit);
  }

  // Those asked for, or the usual ones; fields that are left out by default are said.
  std::vector<std::size_t> chosen_fields(const TableColumns& columns, const ReadOptions& options) {
    std::vector<std::size_t> chosen = choose_channels(columns, options, info_.file);
    if (!options.channels.empty()) return chosen;
    const std::vector<std::size_t> usual = reader_->usual_fields(topic_);
    std::vector<std::size_t> kept;
    for (const std::size_t i : chosen)
      if (std::find(usual.begin(), usual.end(), i) != usual.end()) kept.push_back(i);
    if (kept.empty() || kept.size() == chosen.size()) return chosen;
    info_.dialect.push_back(
        fmt::format("{} left out that no sensor measures, such as {} (`channels` reads them)",
                    plural(chosen.size() - kept.size(), "field"),
                    printable(left_out(chosen, kept, columns))));
    return kept;
  }

  static std::string left_out(const std::vector<std::size_t>& all,
                              const std::vector<std::size_t>& kept,
                              const TableColumns& columns) {
    for (const std::size_t i : all)
      if (std::find(kept.begin(), kept.end(), i) == kept.end()) return columns.names[i];
    return "";
  }

  TableFront front() const {
    TableFront table;
    table.named = true;
    if (const double rate = reader_->stated_rate_hz(topic_); rate > 0) table.stated_rate_hz = rate;
    for (const Channel& field : topic().fields) table.columns.push_back({field.name, field.unit});
    table.first_values = [this](std::size_t field) { return reader_->first_values(topic_, field); };
    return table;
  }

  // Infinity is no sample; every NaN becomes the one that means "missing".
  void drop_non_finite(std::size_t channel, std::vector<double>& values, Warnings& warnings) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (std::isfinite(values[i])) continue;
      const std::string place =
          fmt::format("{}, field {}", place_of(rows_ + i), printable(info_.channels[channel].name));
      if (std::isinf(values[i])) {
        warnings.add("infinite_value", kInfiniteValues, place);
      } else {
        ++missing_per_channel_[channel];
        if (missing_places_.size() < 3) missing_places_.push_back(place);
      }
      values[i] = kMissing;
    }
  }

  std::unique_ptr<TopicReader> reader_;
  std::vector<std::unique_ptr<BinaryFile>> files_;
  FileHash hash_;
  LogInfo info_;
  std::size_t topic_ = 0;
  bool ignore_stamps_ = false;
  std::size_t rows_per_block_ = 1;
  std::uint64_t rows_ = 0;
  std::vector<std::uint64_t> missing_per_channel_;
  std::vector<std::string> missing_places_;
};

}  // namespace

std::unique_ptr<RowSource> open_topic_rows(std::unique_ptr<TopicReader> reader,
                                           const std::string& path,
                                           std::string_view format,
                                           const ReadOptions& options) {
  return std::make_unique<TopicRows>(std::move(reader), path, format, options);
}

}  // namespace libchar
