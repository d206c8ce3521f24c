#include "libchar/log/binary/rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "libchar/core/refusal.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/log/binary/file.hpp"
#include "libchar/log/binary/stamps.hpp"
#include "libchar/log/detail/channel_choice.hpp"
#include "libchar/log/detail/odd_values.hpp"
#include "libchar/log/time/time_column.hpp"

namespace libchar {

namespace {

constexpr std::size_t kOrderProbe = 4096;  // rows looked at for a wrong byte order

bool is_integer(const BinaryColumn& column) {
  return !is_float(column.number.type) && column.scale == 1 && column.offset == 0;
}

// A column that is read: where its values of the current block stand in memory.
struct Wanted {
  BinaryColumn column;
  std::vector<double> probe;  // its first values, as stored
};

class BinaryRows final : public RowSource {
 public:
  BinaryRows(std::unique_ptr<BinaryFile> file, BinaryLayout layout, LogInfo info, const ReadOptions& options)
      : file_(std::move(file)),
        layout_(std::move(layout)),
        info_(std::move(info)),
        overflow_as_missing_(options.missing.overflow),
        hash_(*file_, options.hash) {
    info_.file = file_->path();
    const TableFront table = front();
    const auto time = find_time_column(table, options, info_);
    TableColumns columns;
    columns.time = time;
    for (const BinaryColumn& column : layout_.columns) columns.names.push_back(column.name);
    std::uint64_t row_bytes = 0;
    for (const std::size_t i : choose_channels(columns, options, file_->path())) {
      const BinaryColumn& column = layout_.columns[i];
      values_.push_back({column, {}});
      info_.channels.push_back({column.name, column.unit, is_integer(column)});
      row_bytes += size_of(column.number.type);
    }
    missing_per_channel_.assign(values_.size(), 0);
    if (layout_.rows == 0) throw input_error("E0322", file_->path()).says("holds no samples");
    if (time) {
      time_ = layout_.columns[*time];
      info_.time.column = time_->name;
      unit_ = find_time_unit(table, *time, options, info_);
      row_bytes += size_of(time_->number.type);
    }
    if (!layout_.column_major) row_bytes = layout_.columns.front().stride;
    rows_per_block_ = std::max<std::size_t>(1, options.block_bytes / static_cast<std::size_t>(row_bytes));
    info_.bytes = file_->size();
    info_.rows = end_row_ = layout_.rows;
    layout_.columns.clear();
  }

  const LogInfo& info() const override { return info_; }
  std::uint64_t bytes_read() const override { return bytes_read_; }
  std::uint64_t bytes_total() const override {
    return layout_.column_major ? layout_.data_byte + column_bytes() * layout_.rows : file_->size();
  }

  bool restrict_rows(std::uint64_t first, std::uint64_t end, ChannelRange channels) override {
    restricted_ = true;
    channels_ = channels;
    next_row_ = std::min(first, layout_.rows);
    end_row_ = std::min(end, layout_.rows);
    return true;
  }

  bool next(RowBlock& block, Findings& warnings) override {
    if (next_row_ == 0) {
      if (channels_.first == 0) warnings.merge(layout_.warnings);
      hash_.start();
    }
    block.rows =
        static_cast<std::size_t>(std::min<std::uint64_t>(rows_per_block_, end_row_ - std::min(end_row_, next_row_)));
    block.columns.resize(values_.size());
    block.time_ns.clear();
    block.first_line = 0;
    block.line_offset.clear();
    if (block.rows == 0) return false;
    if (!layout_.column_major) read_interleaved(block.rows);
    rows_in_file_block_ = block.rows;
    for (std::size_t c = 0; c < values_.size(); ++c) {
      block.columns[c].resize(block.rows);
      if (channels_.has(c)) read_values(values_[c], block.columns[c], block.rows, warnings);
    }
    if (time_) read_times(block);
    next_row_ += rows_in_file_block_;
    bytes_read_ = layout_.column_major ? layout_.data_byte + column_bytes() * next_row_
                                       : layout_.data_byte + next_row_ * stride();
    if (next_row_ == layout_.rows) bytes_read_ = bytes_total();
    return true;
  }

  void finish(Findings& warnings) override {
    const auto say = [&](const OddPlaces& odd, const char* code, std::string_view sentence) {
      odd.say(
          code, sentence,
          [this](std::uint64_t row, std::size_t channel) { return place_of(values_[channel].column, row); }, warnings);
    };
    say(odd_.rounded, "rounded_integer", kRoundedIntegers);
    say(odd_.infinite, "infinite_value", kInfiniteValues);
    say(odd_.too_small, "number_too_small", kNumbersTooSmall);
    say(odd_.out_of_range, "number_out_of_range", kNumbersOutOfRange);
    // Of a part it says no counts a channel: they would be those of the first part.
    say(odd_.missing, "missing_cell",
        restricted_ ? missing_cells({}, {}) : missing_cells(info_.channels, missing_per_channel_));
  }

  std::string place(const RowBlock&, std::size_t i, std::uint64_t rows_before) const override {
    const BinaryColumn& column = values_.front().column;
    return fmt::format("row {} (byte {})", rows_before + i, column.first_byte + (rows_before + i) * column.stride);
  }

  std::string sha256() override { return hash_.finish(); }

 private:
  std::uint64_t stride() const { return values_.front().column.stride; }
  std::uint64_t column_bytes() const {
    std::uint64_t bytes = time_ ? size_of(time_->number.type) : 0;
    for (const Wanted& wanted : values_) bytes += size_of(wanted.column.number.type);
    return bytes;
  }

  void read_interleaved(std::size_t rows) {
    bytes_.resize(rows * static_cast<std::size_t>(stride()));
    file_->read(layout_.data_byte + next_row_ * stride(), bytes_);
  }

  // First byte of the block's values of one column, and the distance between two.
  const std::byte* locate(const BinaryColumn& column, std::size_t rows) {
    if (!layout_.column_major) return bytes_.data() + (column.first_byte - layout_.data_byte);
    bytes_.resize(rows * static_cast<std::size_t>(column.stride));
    file_->read(column.first_byte + next_row_ * column.stride, bytes_);
    return bytes_.data();
  }

  std::size_t channel_of(const Wanted& wanted) const { return static_cast<std::size_t>(&wanted - values_.data()); }

  std::string place_of(const BinaryColumn& column, std::uint64_t row) const {
    return fmt::format("row {} (byte {}, field {})", row, column.first_byte + row * column.stride, column.name);
  }

  void read_values(Wanted& wanted, std::vector<double>& out, std::size_t rows, Findings& warnings) {
    const BinaryColumn& column = wanted.column;
    const Rounded rounded =
        read_numbers(locate(column, rows), static_cast<std::size_t>(column.stride), column.number, out);
    odd_.rounded.add_block(next_row_ + rounded.first, channel_of(wanted), rounded.count);
    probe_byte_order(wanted, out, warnings);
    if (is_float(column.number.type)) drop_non_finite(channel_of(wanted), out);
    if (column.scale != 1 || column.offset != 0) to_unit(column, channel_of(wanted), out);
  }

  // number * scale + offset may leave the range of a double at either end, like a number of a text.
  void to_unit(const BinaryColumn& column, std::size_t channel, std::vector<double>& out) {
    for (std::size_t i = 0; i < out.size(); ++i) {
      const double stored = out[i], scaled = stored * column.scale;
      out[i] = scaled + column.offset;
      if (scaled == 0 && stored != 0) odd_.too_small.add(next_row_ + i, channel);
      if (!std::isinf(out[i])) continue;
      if (!overflow_as_missing_)
        throw input_error("E0312", fmt::format("{} {}", file_->path(), place_of(column, next_row_ + i)))
            .says("number out of range: with its scale and offset no double can hold it")
            .got(shortest(stored))
            .hint("`overflow_as_missing` counts it as missing");
      odd_.out_of_range.add(next_row_ + i, channel);
      out[i] = kMissing;
    }
  }

  // Infinity is no sample; every NaN becomes the one that means "missing".
  void drop_non_finite(std::size_t channel, std::vector<double>& out) {
    std::size_t odd = 0;
    for (const double x : out) odd += !(std::abs(x) <= std::numeric_limits<double>::max());
    if (odd == 0) return;
    for (std::size_t i = 0; i < out.size(); ++i) {
      if (std::isfinite(out[i])) continue;
      if (!std::isinf(out[i])) ++missing_per_channel_[channel];
      (std::isinf(out[i]) ? odd_.infinite : odd_.missing).add(next_row_ + i, channel);
      out[i] = kMissing;
    }
  }

  void probe_byte_order(Wanted& wanted, const std::vector<double>& out, Findings& warnings) const {
    if (next_row_ >= kOrderProbe || size_of(wanted.column.number.type) < 4 || !is_float(wanted.column.number.type))
      return;
    const std::size_t missing =
        static_cast<std::size_t>(std::min<std::uint64_t>(kOrderProbe, layout_.rows)) - wanted.probe.size();
    wanted.probe.insert(wanted.probe.end(), out.begin(),
                        out.begin() + static_cast<std::ptrdiff_t>(std::min(missing, out.size())));
    if (wanted.probe.size() < std::min<std::uint64_t>(kOrderProbe, layout_.rows)) return;
    if (looks_byte_swapped(wanted.probe, wanted.column.number.type)) {
      warnings.add("implausible_magnitude",
                   fmt::format("values as small as 10⁻¹⁰⁰ or as large as 10¹⁰⁰ that would be ordinary in {}-endian "
                               "order: is the byte order right?",
                               wanted.column.number.big_endian ? "little" : "big"),
                   "field " + wanted.column.name);
    }
    wanted.probe = {};
  }

  TableFront front() const {
    TableFront table;
    table.named = layout_.named;
    for (const BinaryColumn& column : layout_.columns) table.columns.push_back({column.name, column.unit});
    table.first_values = [this](std::size_t column) { return first_values(layout_.columns[column]); };
    return table;
  }

  FirstValues first_values(const BinaryColumn& column) const {
    FirstValues first;
    first.integers = is_integer(column);
    std::vector<std::byte> bytes(size_of(column.number.type));
    const std::uint64_t rows = std::min<std::uint64_t>(layout_.rows, kFirstRows);
    for (std::uint64_t row = 0; row < rows; ++row) {
      double value = 0;
      file_->read(column.first_byte + row * column.stride, bytes);
      read_numbers(bytes.data(), bytes.size(), column.number, {&value, 1});
      value = value * column.scale + column.offset;
      if (std::isfinite(value)) first.values.push_back(value);
    }
    return first;
  }

  void read_times(RowBlock& block) {
    block.time_ns.resize(block.rows);
    const std::byte* first = locate(*time_, block.rows);
    read_stamps(first, static_cast<std::size_t>(time_->stride),
                {time_->number, time_->scale, time_->offset - unit_.zero, unit_.ns}, block.time_ns,
                [this](std::size_t i) { return fmt::format("{} {}", file_->path(), place_of(*time_, next_row_ + i)); });
  }

  std::unique_ptr<BinaryFile> file_;
  BinaryLayout layout_;
  LogInfo info_;
  std::vector<Wanted> values_;
  std::optional<BinaryColumn> time_;
  StampUnit unit_{1};
  std::size_t rows_per_block_ = 1, rows_in_file_block_ = 0;
  std::uint64_t next_row_ = 0, end_row_ = 0, bytes_read_ = 0;
  std::vector<std::byte> bytes_;
  std::vector<std::uint64_t> missing_per_channel_;
  struct {
    OddPlaces missing, infinite, too_small, out_of_range, rounded;
  } odd_;
  bool overflow_as_missing_ = false, restricted_ = false;
  ChannelRange channels_;  ///< to be read
  FileHash hash_;
};

}  // namespace

std::unique_ptr<RowSource> open_binary_rows(std::unique_ptr<BinaryFile> file, BinaryLayout layout, LogInfo info,
                                            const ReadOptions& options) {
  return std::make_unique<BinaryRows>(std::move(file), std::move(layout), std::move(info), options);
}

}  // namespace libchar
