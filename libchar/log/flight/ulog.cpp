// PX4's ULog: every subscription ("sensor_gyro 0") is a topic with stamps of its own. The samples of a FIFO message are
// rows: sample k of n was taken at timestamp_sample - (n - 1 - k) dt, and is scale · count. Source: docs.px4.io, "ULog
// File Format"; PX4's SensorGyroFifo.msg; the rule of the stamps is that of PX4's flight review.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/detail/format.hpp"
#include "libchar/log/detail/odd_values.hpp"
#include "libchar/log/flight/ulog_format.hpp"
#include "libchar/log/flight/ulog_listing.hpp"

namespace libchar {
namespace {

constexpr std::uint64_t kLargestStamp = 9200000000000000;  // µs that fit 64-bit nanoseconds

double number_at(const std::byte* at, NumberType type) {
  double value = 0;
  read_numbers(at, 0, {type, false}, {&value, 1});
  return value;
}

class UlogReader final : public TopicReader {
 public:
  UlogReader(const std::string& path, const ReadOptions& options)
      : file_(path),
        block_bytes_(options.block_bytes),
        by_publication_(options.time_source == "log" || options.time_source == "publish"),
        header_(read_ulog_header(file_, header_losses_)),
        log_(list_ulog(file_, header_, block_bytes_, by_publication_)) {
    for (std::size_t topic = 0; topic < log_.topics.size(); ++topic) correct_pressure(topic);
  }

  const std::vector<LogTopic>& topics() const override { return log_.topics; }

  std::vector<std::string> dialect() const override {
    std::vector<std::string> lines = {fmt::format("ULog version {}", header_.version)};
    std::string system;
    for (const char* key : {"sys_name", "ver_hw", "ver_sw_release"})
      if (const auto found = log_.info.find(key); found != log_.info.end())
        system += (system.empty() ? "" : " ") + printable(found->second, 40);
    if (!system.empty()) lines.push_back(system);
    if (header_.stretches.size() > 1)
      lines.push_back(fmt::format("data appended at byte {}", header_.stretches[1].first));
    return lines;
  }

  std::uint64_t bytes_read() const override { return walk_ ? walk_->position() : std::uint64_t{0}; }

  // Of a sensor's messages what it measures; of others all but stamps, identities and counters.
  std::vector<std::size_t> usual_fields(std::size_t topic) const override {
    std::vector<std::size_t> usual;
    const LogTopic& about = log_.topics[topic];
    for (std::size_t i = 0; i < about.fields.size(); ++i) {
      const std::string_view name = plain_name(about.fields[i].name);
      if (px4_no_sample(name)) continue;
      if (!about.sensor || px4_unit(about.type, name)) usual.push_back(i);
    }
    return usual;
  }

  std::string stamps(std::size_t topic) const override {
    const UlogTopic& content = log_.contents[topic];
    const UlogStamps& stamps = stamps_of(content);
    if (!stamps.byte) return "";
    return &stamps == &content.sampled ? "timestamp_sample" : "timestamp";
  }

  FirstValues first_values(std::size_t topic, std::size_t field) override {
    const UlogTopic& content = log_.contents[topic];
    FirstValues first;
    if (content.fifo || content.messages == 0) return first;
    const UlogField& wanted = content.layout.fields[field];
    first.integers = !is_float(wanted.type);
    Findings ignored;
    UlogWalk walk(file_, block_bytes_, header_.stretches, log_.sizes, ignored);
    walk.go_to(content.first_byte);
    while (first.values.size() < kFirstRows) {
      const auto data = next_data(walk, topic);
      if (!data) break;
      const double value = number_at(data->data() + wanted.byte, wanted.type);
      if (std::isfinite(value)) first.values.push_back(value);
    }
    return first;
  }

  void select(std::size_t topic, const std::vector<std::size_t>& fields, std::optional<std::size_t> time,
              StampUnit unit) override {
    topic_ = topic;
    chosen_ = fields;
    time_ = time;
    unit_ns_ = unit.ns;
    walk_.emplace(file_, block_bytes_, header_.stretches, log_.sizes, losses_again_);
    walk_->go_to(log_.contents[topic].first_byte);
  }

  bool next(RowBlock& block, std::size_t most, Findings& warnings) override {
    const UlogTopic& content = log_.contents[topic_];
    while (block.rows < most) {
      if (fifo_sample_ < fifo_samples_) {
        add_samples(block, most, warnings);
        continue;
      }
      const auto data = next_data(*walk_, topic_);
      if (!data) break;
      if (!content.fifo) {
        add_row(*data, block, warnings);
        continue;
      }
      begin_samples(*data, warnings);
    }
    return block.rows > 0;
  }

  void finish(Findings& warnings) override {
    warnings.merge(header_losses_);
    warnings.merge(log_.losses);
    if (log_.dropouts == 0) return;
    const std::string message = fmt::format(
        "the logger lost messages, {} ms in all: gaps of every topic, which spoil Allan deviations near their length",
        log_.dropped_ms);
    for (const std::string& place : log_.dropout_places) warnings.add("dropout", message, place);
    if (log_.dropouts > log_.dropout_places.size())
      warnings.add("dropout", message, "", log_.dropouts - log_.dropout_places.size());
  }

 private:
  using Data = std::span<const std::byte>;  // of a message, behind its id

  // Pressure was in hPa before version 1.14, in Pa from then on: nothing but the values says which.
  void correct_pressure(std::size_t topic) {
    LogTopic& about = log_.topics[topic];
    if (about.type != "sensor_baro" || !about.why_not.empty()) return;
    for (std::size_t i = 0; i < about.fields.size(); ++i) {
      if (about.fields[i].name != "pressure") continue;
      const FirstValues first = first_values(topic, i);
      if (!first.values.empty() && first.values.front() < 2000) about.fields[i].unit = "hPa";
    }
  }

  const UlogStamps& stamps_of(const UlogTopic& content) const { return ulog_stamps(content, by_publication_); }

  // The next message of this topic whose size is right, its data behind the id.
  std::optional<Data> next_data(UlogWalk& walk, std::size_t topic) {
    const UlogTopic& content = log_.contents[topic];
    UlogMessage message;
    while (walk.position() <= content.last_byte && walk.next(message)) {
      if (message.type != 'D' || message.byte > content.last_byte) continue;
      const auto id = static_cast<std::size_t>(little_endian<2>(message.body.data()));
      if (id >= log_.topic_of_id.size() || log_.topic_of_id[id] != topic) continue;
      const Data data = message.body.subspan(2);
      if (data.size() >= content.layout.least_bytes && data.size() <= content.layout.bytes) return data;
    }
    return std::nullopt;
  }

  // PX4 writes zero where it does not know the time. One zero in front of a log that soon goes on is
  // its beginning; where all are zero there is no time axis, which is for the caller to say.
  bool stamp_usable(std::uint64_t stamp, std::uint64_t messages_before) const {
    const UlogStamps& stamps = stamps_of(log_.contents[topic_]);
    if (stamp != 0 || stamps.last == 0) return stamp <= kLargestStamp;
    return messages_before == 0 && stamps.zeros == 1 && stamps.first < 1000000;
  }

  void add_row(Data data, RowBlock& block, Findings& warnings) {
    const UlogTopic& content = log_.contents[topic_];
    const std::uint64_t message = messages_read_++;
    if (time_) {
      block.time_ns.push_back(time_of_field(data));
    } else if (const UlogStamps& stamps = stamps_of(content); stamps.byte) {
      const std::uint64_t stamp = little_endian<8>(data.data() + *stamps.byte);
      if (!stamp_usable(stamp, message)) {
        warnings.add("unusable_stamp", "messages whose stamp is zero or beyond 64-bit nanoseconds were left out",
                     fmt::format("message {}", message));
        return;
      }
      block.time_ns.push_back(static_cast<std::int64_t>(stamp) * 1000);
    }
    for (std::size_t c = 0; c < chosen_.size(); ++c) {
      const UlogField& field = content.layout.fields[chosen_[c]];
      double value = 0;
      if (read_numbers(data.data() + field.byte, 0, {field.type, false}, {&value, 1}).count > 0)
        warnings.add("rounded_integer", kRoundedIntegers,
                     fmt::format("{} of message {}", printable(field.name), message));
      block.columns[c].push_back(value);
    }
    ++block.rows;
  }

  void begin_samples(Data data, Findings& warnings) {
    const UlogFifo& fifo = *log_.contents[topic_].fifo;
    ++messages_read_;
    fifo_data_.assign(data.begin(), data.end());
    const auto samples = std::to_integer<std::uint32_t>(data[fifo.samples]);
    fifo_samples_ = std::min(samples, fifo.room);
    fifo_sample_ = 0;
    if (samples > fifo.room)
      warnings.add("too_many_samples", fmt::format("messages that say more samples than the {} they hold", fifo.room),
                   fmt::format("message {}", messages_read_ - 1));
  }

  // Samples of the message in hand, as many as there is room for.
  void add_samples(RowBlock& block, std::size_t most, Findings& warnings) {
    const UlogTopic& content = log_.contents[topic_];
    const UlogFifo& fifo = *content.fifo;
    const std::byte* data = fifo_data_.data();
    const std::uint64_t stamp = little_endian<8>(data + *content.sampled.byte);
    const double dt_ns = number_at(data + fifo.dt, NumberType::f32) * 1000;
    const double scale = number_at(data + fifo.scale, NumberType::f32);
    // 255 samples of an hour are no FIFO.
    if (!stamp_usable(stamp, messages_read_ - 1) || !(dt_ns > 0 && dt_ns < 1e12)) {
      warnings.add("unusable_stamp", "messages whose stamp is zero or beyond 64-bit nanoseconds were left out",
                   fmt::format("message {}", messages_read_ - 1));
      fifo_sample_ = fifo_samples_;
      return;
    }
    for (; fifo_sample_ < fifo_samples_ && block.rows < most; ++fifo_sample_, ++block.rows) {
      const double back = (fifo_samples_ - 1 - fifo_sample_) * dt_ns;
      block.time_ns.push_back(static_cast<std::int64_t>(stamp) * 1000 - clamped_whole<std::int64_t>(std::round(back)));
      for (std::size_t c = 0; c < chosen_.size(); ++c) {
        const std::byte* count = data + fifo.axes[chosen_[c]] + 2 * fifo_sample_;
        block.columns[c].push_back(static_cast<std::int16_t>(little_endian<2>(count)) * scale);
      }
    }
  }

  std::int64_t time_of_field(Data data) const {
    const UlogField& field = log_.contents[topic_].layout.fields[*time_];
    const auto refusal = [&](const char* code, double got) {
      return input_error(code, fmt::format("{} (message {} of {}, field {})", file_.path(), messages_read_,
                                           printable(log_.topics[topic_].name), printable(field.name)))
          .got(shortest(got))
          .hint("`time_column` auto takes the stamps of the messages");
    };
    const double value = number_at(data.data() + field.byte, field.type);
    std::int64_t stamp = 0;
    if (is_float(field.type)) {
      if (std::isnan(value)) throw refusal("E0313", value).says("missing time stamp");
      const double ns = value * static_cast<double>(unit_ns_);
      if (!(std::abs(ns) < 9.2e18)) throw refusal("E0314", value).says("a time stamp does not fit 64-bit nanoseconds");
      return clamped_whole<std::int64_t>(std::round(ns));
    }
    if (read_integers(data.data() + field.byte, 0, {field.type, false}, {&stamp, 1}) ||
        __builtin_mul_overflow(stamp, unit_ns_, &stamp))
      throw refusal("E0314", value).says("a time stamp does not fit 64-bit nanoseconds");
    return stamp;
  }

  BinaryFile file_;
  std::size_t block_bytes_;
  bool by_publication_;
  Findings header_losses_, losses_again_;  // the latter are those of the listing
  UlogHeader header_;
  UlogListing log_;

  std::optional<UlogWalk> walk_;
  std::size_t topic_ = 0;
  std::vector<std::size_t> chosen_;
  std::optional<std::size_t> time_;
  std::int64_t unit_ns_ = 1;
  std::uint64_t messages_read_ = 0;
  std::vector<std::byte> fifo_data_;  // the message whose samples are being delivered
  std::uint32_t fifo_sample_ = 0, fifo_samples_ = 0;
};

}  // namespace

Format ulog_format() {
  Format row;
  row.about.name = "ulog";
  row.about.title = "PX4 ULog";
  row.about.suffixes = {".ulg"};
  row.about.units = "of PX4's sensors";
  row.about.topics = true;
  row.about.time_sources = true;
  row.certain = is_ulog;
  row.topics = open_topics<UlogReader>;
  return row;
}

}  // namespace libchar
