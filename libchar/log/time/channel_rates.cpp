#include "libchar/log/time/channel_rates.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <utility>

#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/shown.hpp"
#include "libchar/core/text/text.hpp"

namespace libchar {
namespace {

constexpr std::uint64_t kLooked = 4096;  // rows, before it is decided which are blanks between samples

struct RatedChannel {
  double rate_hz = 0, row_hz = 0;  // of its samples, of its rows
  std::uint64_t first = 0, last = 0, count = 0;
  std::deque<std::pair<std::uint64_t, double>> waiting = {};  // row, value

  std::int64_t stamp(std::uint64_t row) const {
    return clamped_whole<std::int64_t>(std::round(static_cast<double>(row) / row_hz * 1e9));
  }
};

class RatedRows final : public RowSource {
 public:
  RatedRows(std::unique_ptr<RowSource> rows, const std::vector<double>& rates_hz, double rows_hz)
      : rows_(std::move(rows)), info_(rows_->info()), rows_hz_(rows_hz) {
    if (!info_.time.column.empty())
      throw usage_error("E0205", info_.file)
          .says("rates of channels are for a log without stamps, and this one has them ({})",
                printable(info_.time.column))
          .hint("`time_column` none ignores the stamps");
    std::string said;
    for (std::size_t c = 0; c < rates_hz.size(); ++c) {
      channels_.push_back({rates_hz[c]});
      said += fmt::format("{}{} {}", c == 0 ? "" : ", ", printable(info_.channels[c].name),
                          detail::frequency_text(rates_hz[c], 6));
    }
    info_.dialect.push_back("rates as stated: " + said);
    info_.time.column = "rates of the channels";
    info_.time.unit = "ns";
    info_.time.unit_ns = 1;
    info_.time.rate_hz = 0;
  }

  const LogInfo& info() const override { return info_; }

  bool next(RowBlock& block, Findings& warnings) override {
    block.rows = 0;
    block.first_line = 0;
    block.line_offset.clear();
    block.time_ns.clear();
    block.columns.resize(channels_.size());
    for (auto& column : block.columns) column.clear();
    while (block.rows == 0) {
      if (!ended_) take(warnings);
      if (!decided_ && (ended_ || row_ >= kLooked)) decide();
      if (decided_) merge(block);
      if (ended_) break;
    }
    return block.rows > 0;
  }

  std::string place(const RowBlock& block, std::size_t i, std::uint64_t) const override {
    return fmt::format("at {} s", brief_text(1e-9 * static_cast<double>(block.time_ns[i]), 9));
  }
  void finish(Findings& warnings) override { rows_->finish(warnings); }
  std::uint64_t bytes_read() const override { return rows_->bytes_read(); }
  std::uint64_t bytes_total() const override { return rows_->bytes_total(); }
  std::string sha256() override { return rows_->sha256(); }

 private:
  void take(Findings& warnings) {
    ended_ = !rows_->next(taken_, warnings);
    if (ended_) return;
    for (std::size_t c = 0; c < channels_.size(); ++c)
      for (std::size_t i = 0; i < taken_.rows; ++i)
        if (const double value = taken_.columns[c][i]; !std::isnan(value)) {
          RatedChannel& channel = channels_[c];
          if (channel.count++ == 0) channel.first = row_ + i;
          channel.last = row_ + i;
          channel.waiting.emplace_back(row_ + i, value);
        }
    row_ += taken_.rows;
  }

  // Whether the rows of a channel are its samples, or those of the fastest with blanks between.
  void decide() {
    constexpr double kAlike = 1.25, kFewMissing = 1.5;
    decided_ = true;
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      RatedChannel& channel = channels_[c];
      channel.row_hz = channel.rate_hz;
      if (channel.count < 2) continue;
      const double every = static_cast<double>(channel.last - channel.first) / static_cast<double>(channel.count - 1);
      const double stated = rows_hz_ / channel.rate_hz;
      const bool blanks = std::fabs(std::log(every / stated)) < std::log(every);
      if (blanks) channel.row_hz = rows_hz_;
      if (blanks ? std::fabs(std::log(every / stated)) < std::log(kAlike) : every < kFewMissing) continue;
      throw input_error("E0342", info_.file)
          .says("{} has a value in one of {} rows, and the rates say one of {}", printable(info_.channels[c].name),
                brief_text(every, 3), brief_text(stated, 3))
          .hint("`channel_rate` {}={}", printable(info_.channels[c].name), brief_text(rows_hz_ / every, 4));
    }
  }

  // Samples up to the first instant of which more may come.
  void merge(RowBlock& block) {
    constexpr std::size_t kMost = std::size_t{1} << 16U;
    std::int64_t known = std::numeric_limits<std::int64_t>::max();
    for (const RatedChannel& channel : channels_)
      if (!ended_) known = std::min(known, channel.stamp(row_));
    while (block.rows < kMost) {
      std::int64_t now = known;
      for (const RatedChannel& channel : channels_)
        if (!channel.waiting.empty()) now = std::min(now, channel.stamp(channel.waiting.front().first));
      if (now == known) return;
      block.time_ns.push_back(now);
      ++block.rows;
      for (std::size_t c = 0; c < channels_.size(); ++c) {
        auto& waiting = channels_[c].waiting;
        const bool here = !waiting.empty() && channels_[c].stamp(waiting.front().first) == now;
        block.columns[c].push_back(here ? waiting.front().second : kMissing);
        if (here) waiting.pop_front();
      }
    }
  }

  std::unique_ptr<RowSource> rows_;
  LogInfo info_;
  std::vector<RatedChannel> channels_;
  RowBlock taken_;
  double rows_hz_ = 0;
  std::uint64_t row_ = 0;
  bool ended_ = false, decided_ = false;
};

}  // namespace

std::unique_ptr<RowSource> with_rates(std::unique_ptr<RowSource> rows, std::vector<double> rates_hz, double rows_hz) {
  return std::make_unique<RatedRows>(std::move(rows), rates_hz, rows_hz);
}

}  // namespace libchar
