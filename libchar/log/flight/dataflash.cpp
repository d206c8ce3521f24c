// ArduPilot's DataFlash log: every message that holds numbers is a topic, of several sensors one each ("GYR 0", "GYR
// 1"). The batch sampler's messages (ISBH, a header, and ISBD, blocks of 32 samples) are bursts: sample k was taken at
// the header's SampleUS + k / smp_rate, and is count / mul in m/s² (type 0) or rad/s (type 1). Source: ArduPilot's
// libraries/AP_Logger/LogStructure.h, libraries/AP_InertialSensor/{LogStructure.h,BatchSampler.cpp}.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/detail/format.hpp"
#include "libchar/log/detail/odd_values.hpp"
#include "libchar/log/flight/dataflash_format.hpp"
#include "libchar/log/flight/dataflash_listing.hpp"

namespace libchar {
namespace {

constexpr std::string_view kDataflashMagic = "\xa3\x95";

class DataflashReader final : public TopicReader {
 public:
  DataflashReader(const std::string& path, const ReadOptions& options)
      : file_(path),
        block_bytes_(options.block_bytes),
        by_logging_(options.time_source == "log" || options.time_source == "publish"),
        log_(list_dataflash(file_, block_bytes_)) {}

  const std::vector<LogTopic>& topics() const override { return log_.topics; }

  std::vector<std::string> dialect() const override {
    std::vector<std::string> lines = {"DataFlash log"};
    if (!log_.firmware.empty()) lines.push_back(printable(log_.firmware, 60));
    return lines;
  }

  std::uint64_t bytes_read() const override { return walk_ ? walk_->position() : std::uint64_t{0}; }

  // Of a sensor's messages what it measures, in a unit; of others all but clocks and instances.
  std::vector<std::size_t> usual_fields(std::size_t topic) const override {
    const LogTopic& about = log_.topics[topic];
    const DataflashTopic& content = log_.contents[topic];
    std::vector<std::size_t> usual;
    for (std::size_t i = 0; i < about.fields.size(); ++i) {
      const Channel& field = about.fields[i];
      const bool instance = content.kind && log_.formats.kind(*content.kind).instance == content.channels[i].field;
      if (instance || dataflash_no_sample(field.name)) continue;
      if (!about.sensor || (!field.unit.empty() && field.unit != "s" && field.unit != "Hz")) usual.push_back(i);
    }
    return usual;
  }

  std::string stamps(std::size_t topic) const override {
    const DataflashTopic& content = log_.contents[topic];
    if (!content.kind) return "SampleUS";
    const DataflashClock& clock = clock_of(content);
    return clock.byte ? clock.name : "";
  }

  FirstValues first_values(std::size_t topic, std::size_t field) override {
    FirstValues first;
    const DataflashTopic& content = log_.contents[topic];
    if (!content.kind) return first;
    topic_ = topic;
    begin();
    first.integers = log_.topics[topic].fields[field].integer;
    Findings ignored;
    while (first.values.size() < kFirstRows) {
      const auto body = next_body();
      if (!body) break;
      const double value = value_of(content.channels[field], *body, ignored);
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
    begin();
  }

  bool next(RowBlock& block, std::size_t most, Findings& warnings) override {
    const bool bursts = !log_.contents[topic_].kind;
    while (block.rows < most) {
      if (sample_ < samples_) {
        add_samples(block, most);
        continue;
      }
      const auto body = next_body();
      if (!body) break;
      if (!bursts) {
        add_row(*body, block, warnings);
        continue;
      }
      sample_ = 0;
      samples_ = std::min<std::uint32_t>(kDataflashArray, burst_.samples - first_sample_);
    }
    return block.rows > 0;
  }

  void finish(Findings& warnings) override {
    warnings.merge(log_.losses);
    for (const std::string& field : log_.formats.contradictions())
      warnings.add("two_scales",
                   "fields whose format letter and multiplier say different scales: the multiplier is taken",
                   printable(field));
    if (!walk_ || log_.contents[topic_].kind) return;
    const DataflashTopic& content = log_.contents[topic_];
    warnings.add("bursts",
                 fmt::format("bursts of at most {} samples at {} Hz with gaps between them: good for a spectrum, no "
                             "good for Allan deviations beyond {}",
                             content.burst_samples, brief_text(content.burst_rate_hz, 6),
                             duration_text(content.burst_samples / content.burst_rate_hz)),
                 "", content.bursts);
  }

 private:
  using Body = std::span<const std::byte>;

  const DataflashClock& clock_of(const DataflashTopic& content) const {
    const bool sampled = content.sampled.byte && content.sampled.last != 0;
    return sampled && !by_logging_ ? content.sampled : content.logged;
  }

  void begin() {
    formats_ = log_.formats;
    formats_.rewind();
    batches_ = {};
    walk_.emplace(file_, block_bytes_, formats_, losses_again_);
    messages_read_ = 0;
    sample_ = samples_ = 0;
  }

  // The next message of the topic, or block of its bursts.
  std::optional<Body> next_body() {
    const DataflashTopic& content = log_.contents[topic_];
    DataflashMessage message;
    while (walk_->position() <= content.last_byte && walk_->next(message)) {
      if (formats_.take(message.type, message.body)) continue;
      const std::size_t index = *formats_.kind_of(message.type);
      if (content.kind) {
        if (index != *content.kind) continue;
        if (dataflash_instance(formats_.kind(index), message.body) == content.instance) return message.body;
        continue;
      }
      const DataflashKind& kind = formats_.kind(index);
      if (DataflashBatches::is_header(kind)) batches_.take_header(kind, message.body);
      if (!DataflashBatches::is_block(kind)) continue;
      const DataflashBurst* burst = batches_.burst_of(kind, message.body);
      if (burst == nullptr || burst->type != content.batch_type || burst->instance != content.instance) continue;
      burst_ = *burst;
      first_sample_ = DataflashBatches::first_sample(kind, message.body);
      if (first_sample_ >= burst_.samples) continue;
      constexpr std::array<std::string_view, 3> kAxes = {"x", "y", "z"};
      for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t k = 0; k < kDataflashArray; ++k)
          counts_[a][k] =
              static_cast<std::int16_t>(little_endian<2>(message.body.data() + kind.find(kAxes[a], 'a')->byte + 2 * k));
      return message.body;
    }
    return std::nullopt;
  }

  double value_of(const DataflashChannel& channel, Body body, Findings& warnings) const {
    const DataflashField& field = log_.formats.kind(*log_.contents[topic_].kind).fields[channel.field];
    double value = 0;
    if (read_numbers(body.data() + channel.byte, 0, {field.type, false}, {&value, 1}).count > 0)
      warnings.add("rounded_integer", kRoundedIntegers,
                   fmt::format("{} of message {}", printable(field.name), messages_read_));
    return value * field.factor / field.divisor;
  }

  std::int64_t time_of_field(Body body) const {
    const DataflashChannel& channel = log_.contents[topic_].channels[*time_];
    const DataflashField& field = log_.formats.kind(*log_.contents[topic_].kind).fields[channel.field];
    Findings ignored;
    const double value = value_of(channel, body, ignored);
    const auto refusal = [&](const char* code) {
      return input_error(code, fmt::format("{} (message {} of {}, field {})", file_.path(), messages_read_,
                                           printable(log_.topics[topic_].name), printable(field.name)))
          .got(shortest(value))
          .hint("`time_column` auto takes the stamps of the messages");
    };
    if (std::isnan(value)) throw refusal("E0313").says("missing time stamp");
    std::int64_t stamp = 0;
    if (!is_float(field.type) && field.factor == 1 && field.divisor == 1) {
      if (!read_integers(body.data() + channel.byte, 0, {field.type, false}, {&stamp, 1}) &&
          !__builtin_mul_overflow(stamp, unit_ns_, &stamp))
        return stamp;
      throw refusal("E0314").says("a time stamp does not fit 64-bit nanoseconds");
    }
    const double ns = value * static_cast<double>(unit_ns_);
    if (!(std::abs(ns) < 9.2e18)) throw refusal("E0314").says("a time stamp does not fit 64-bit nanoseconds");
    return clamped_whole<std::int64_t>(std::round(ns));
  }

  // False where the stamp is none, which is counted.
  bool add_stamp(Body body, RowBlock& block, Findings& warnings) const {
    if (time_) {
      block.time_ns.push_back(time_of_field(body));
      return true;
    }
    const DataflashClock& clock = clock_of(log_.contents[topic_]);
    if (!clock.byte) return true;
    const std::byte* at = body.data() + *clock.byte;
    const std::uint64_t stamp = clock.type == NumberType::u64 ? little_endian<8>(at) : little_endian<4>(at);
    if (stamp > kDataflashLargestStamp) {
      warnings.add("unusable_stamp", "messages whose stamp is beyond 64-bit nanoseconds were left out",
                   fmt::format("message {}", messages_read_));
      return false;
    }
    block.time_ns.push_back(static_cast<std::int64_t>(stamp) * clock.unit_ns);
    return true;
  }

  void add_row(Body body, RowBlock& block, Findings& warnings) {
    const DataflashTopic& content = log_.contents[topic_];
    if (add_stamp(body, block, warnings)) {
      for (std::size_t c = 0; c < chosen_.size(); ++c)
        block.columns[c].push_back(value_of(content.channels[chosen_[c]], body, warnings));
      ++block.rows;
    }
    ++messages_read_;
  }

  // Samples of the block in hand, as many as there is room for.
  void add_samples(RowBlock& block, std::size_t most) {
    for (; sample_ < samples_ && block.rows < most; ++sample_, ++block.rows) {
      const double after_ns = (first_sample_ + sample_) * 1e9 / burst_.rate_hz;
      block.time_ns.push_back(static_cast<std::int64_t>(burst_.start_us) * 1000 +
                              clamped_whole<std::int64_t>(std::round(after_ns)));
      for (std::size_t c = 0; c < chosen_.size(); ++c)
        block.columns[c].push_back(counts_[chosen_[c]][sample_] / burst_.multiplier);
    }
  }

  BinaryFile file_;
  std::size_t block_bytes_;
  bool by_logging_;
  DataflashListing log_;

  DataflashFormats formats_;  // as they hold where the reading is
  Findings losses_again_;     // those of the listing
  std::optional<DataflashWalk> walk_;
  DataflashBatches batches_;
  std::size_t topic_ = 0;
  std::vector<std::size_t> chosen_;
  std::optional<std::size_t> time_;
  std::int64_t unit_ns_ = 1;
  std::uint64_t messages_read_ = 0;
  DataflashBurst burst_;  // whose samples are being delivered
  std::array<std::array<std::int16_t, kDataflashArray>, 3> counts_{};
  std::uint32_t first_sample_ = 0, sample_ = 0, samples_ = 0;
};

// A log begins with the FMT of FMT, as a rule: 89 bytes that say so.
bool surely_dataflash(std::string_view first_bytes) {
  const auto bytes = std::as_bytes(std::span(first_bytes.data(), first_bytes.size()));
  return first_bytes.size() >= kDataflashFmtLength && first_bytes.starts_with(kDataflashMagic) &&
         static_cast<std::uint8_t>(first_bytes[2]) == kDataflashFmt &&
         is_dataflash_fmt(bytes.subspan(kDataflashFront, kDataflashFmtLength - kDataflashFront));
}

std::unique_ptr<TopicReader> open_dataflash(const std::string& path, const ReadOptions& options) {
  auto reader = std::make_unique<DataflashReader>(path, options);
  // Of a log that begins as one, what it lost says why (E0426).
  if (reader->topics().empty() && !surely_dataflash(BinaryFile(path).head(kDataflashFmtLength)))
    throw input_error("E0485", path)
        .says("is not a DataFlash log: it defines no message, or has none of those it defines");
  return reader;
}

}  // namespace

Format dataflash_format() {
  Format row;
  row.about.name = "dataflash";
  row.about.title = "ArduPilot DataFlash";
  row.about.brief = "DataFlash .bin";
  row.about.otherwise = "`.bin` that begins like one";
  row.about.topics = true;
  row.about.time_sources = true;
  row.certain = surely_dataflash;
  row.topics = open_dataflash;
  return row;
}

}  // namespace libchar
