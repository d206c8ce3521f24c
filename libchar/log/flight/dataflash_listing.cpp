#include "libchar/log/flight/dataflash_listing.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "libchar/log/flight/dataflash_format.hpp"

namespace libchar {
namespace {

constexpr std::size_t kMostTopics = 10000, kMostFieldsInAll = 200000;

using Body = std::span<const std::byte>;  // of a message, behind its front

double number_of(const DataflashField& field, Body body) {
  double value = 0;
  read_numbers(body.data() + field.byte, 0, {field.type, false}, {&value, 1});
  return value;
}

// A whole number of a field that is known to hold one.
std::uint32_t count_of(const DataflashKind& kind, std::string_view name, char letter, Body body) {
  return static_cast<std::uint32_t>(number_of(*kind.find(name, letter), body));
}

DataflashClock clock_of(const DataflashKind& kind, std::string_view name, NumberType type) {
  DataflashClock clock;
  for (const DataflashField& field : kind.fields) {
    if (field.name != name || field.type != type || field.array || field.text) continue;
    clock.byte = field.byte;
    clock.type = type;
    clock.unit_ns = name == "TimeMS" ? 1000000 : 1000;
    clock.name = name;
    break;
  }
  return clock;
}

void note_clock(DataflashClock& clock, Body body) {
  if (!clock.byte) return;
  const std::uint64_t stamp = clock.type == NumberType::u64 ? little_endian<8>(body.data() + *clock.byte)
                                                            : little_endian<4>(body.data() + *clock.byte);
  if (clock.first == 0) clock.first = stamp;
  if (stamp != 0) clock.last = stamp;
}

std::string batch_name(const DataflashBurst& burst) {
  if (burst.type > 1) return fmt::format("ISBD type{} {}", burst.type, burst.instance);
  return fmt::format("ISBD {} {}", burst.type == 0 ? "accel" : "gyro", burst.instance);
}

// Takes the messages of a log one by one.
class DataflashLister {
 public:
  explicit DataflashLister(DataflashListing& listing) : listing_(&listing) {}

  void note(const DataflashMessage& message);

  void describe_topics() {
    listing_->formats.apply_units();
    std::map<std::string, int> names;
    for (std::size_t i = 0; i < listing_->topics.size(); ++i) {
      LogTopic& about = listing_->topics[i];
      describe_topic(listing_->contents[i], about);
      // A message whose format changed within the log is one topic before and another one behind.
      if (const int again = names[about.name]++; again > 0) about.name += fmt::format(" #{}", again + 1);
    }
  }

 private:
  DataflashTopic* topic_of(std::size_t kind, std::int64_t instance) {
    const auto [place, fresh] = of_kind_.try_emplace({kind, instance}, listing_->contents.size());
    if (!fresh) return &listing_->contents[place->second];
    if (listing_->contents.size() == kMostTopics) {
      of_kind_.erase(place);
      return nullptr;
    }
    const DataflashKind& about = listing_->formats.kind(kind);
    DataflashTopic content;
    content.kind = kind;
    content.instance = instance;
    content.logged = clock_of(about, "TimeUS", NumberType::u64);
    if (!content.logged.byte) content.logged = clock_of(about, "TimeMS", NumberType::u32);
    content.sampled = clock_of(about, "SampleUS", NumberType::u64);
    listing_->contents.push_back(std::move(content));
    listing_->topics.emplace_back();
    return &listing_->contents.back();
  }

  DataflashTopic* topic_of(const DataflashBurst& burst) {
    const auto [place, fresh] = of_batch_.try_emplace({burst.type, burst.instance}, listing_->contents.size());
    if (!fresh) return &listing_->contents[place->second];
    DataflashTopic content;
    content.instance = burst.instance;
    content.batch_type = burst.type;
    listing_->contents.push_back(std::move(content));
    listing_->topics.emplace_back();
    listing_->topics.back().name = batch_name(burst);
    return &listing_->contents.back();
  }

  void note_block(const DataflashKind& kind, const DataflashMessage& message) {
    const DataflashBurst* burst = batches_.burst_of(kind, message.body);
    if (burst == nullptr) {
      listing_->losses.add(
          "burst_without_header",
          "blocks of the batch sampler whose header is not there or says no rate and no scale were left out",
          fmt::format("byte {}", message.byte));
      return;
    }
    DataflashTopic* content = topic_of(*burst);
    const std::uint32_t first = DataflashBatches::first_sample(kind, message.body);
    if (first >= burst->samples) return;
    if (content->bursts == 0 || last_burst_ != burst->number) ++content->bursts;
    last_burst_ = burst->number;
    content->rows += std::min<std::uint32_t>(kDataflashArray, burst->samples - first);
    content->last_byte = message.byte;
    content->burst_samples = std::max(content->burst_samples, burst->samples);
    content->burst_rate_hz = burst->rate_hz;
  }

  void describe_topic(DataflashTopic& content, LogTopic& about) {
    about.rows = content.rows;
    if (!content.kind) {
      about.type = "batch sampler";
      about.sensor = true;
      about.rate_hz = content.burst_rate_hz;
      const char* unit = content.batch_type == 0 ? "m/s^2" : content.batch_type == 1 ? "rad/s" : "";
      for (const char* axis : {"x", "y", "z"}) about.fields.push_back({axis, unit, false});
      return;
    }
    const DataflashKind& kind = listing_->formats.kind(*content.kind);
    about.name = content.instance < 0 ? kind.name : fmt::format("{} {}", kind.name, content.instance);
    about.type = kind.name;
    about.sensor = dataflash_sensor(kind.name);
    about.why_not = kind.why_not;
    if (!about.why_not.empty()) return;
    if (fields_ > kMostFieldsInAll) {
      about.why_not = "the log has too many fields in all";
      return;
    }
    bool numbers = false;
    for (std::size_t f = 0; f < kind.fields.size(); ++f) {
      const DataflashField& field = kind.fields[f];
      if (field.text) continue;
      numbers = numbers || (!dataflash_no_sample(field.name) && kind.instance != f);
      const bool integer = !is_float(field.type) && field.factor == 1 && field.divisor == 1;
      for (std::uint32_t k = 0; k < (field.array ? kDataflashArray : 1U); ++k) {
        about.fields.push_back({field.array ? fmt::format("{}[{}]", field.name, k) : field.name, field.unit, integer});
        content.channels.push_back({f, field.byte + k * static_cast<std::uint32_t>(size_of(field.type))});
      }
    }
    fields_ += about.fields.size();
    if (!numbers) about.why_not = "text";
    const DataflashClock& clock = content.logged;
    if (clock.last > clock.first)
      about.rate_hz = static_cast<double>(content.rows - 1) * 1e9 /
                      (static_cast<double>(clock.last - clock.first) * static_cast<double>(clock.unit_ns));
  }

  DataflashListing* listing_;
  std::map<std::pair<std::size_t, std::int64_t>, std::size_t> of_kind_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> of_batch_;
  DataflashBatches batches_;
  std::optional<std::uint32_t> last_burst_;
  std::size_t fields_ = 0;  // described so far
};

void DataflashLister::note(const DataflashMessage& message) {
  DataflashFormats& formats = listing_->formats;
  if (formats.take(message.type, message.body)) return;
  const std::size_t index = *formats.kind_of(message.type);
  formats.note_used(index);
  const DataflashKind& kind = formats.kind(index);
  if (DataflashBatches::is_header(kind)) return batches_.take_header(kind, message.body);
  if (DataflashBatches::is_block(kind)) return note_block(kind, message);
  DataflashTopic* content = topic_of(index, dataflash_instance(kind, message.body));
  if (content == nullptr) {
    listing_->losses.add("too_many_topics", fmt::format("messages beyond the first {} topics", kMostTopics),
                         fmt::format("byte {}", message.byte));
    return;
  }
  ++content->rows;
  content->last_byte = message.byte;
  if (!kind.why_not.empty()) return;
  note_clock(content->logged, message.body);
  note_clock(content->sampled, message.body);
  if (kind.name != "MSG" || !listing_->firmware.empty()) return;
  if (const DataflashField* text = kind.find("Message", 'Z'); text != nullptr)
    listing_->firmware = dataflash_text(message.body.subspan(text->byte, 64));
}

}  // namespace

bool DataflashBatches::is_header(const DataflashKind& kind) {
  return kind.name == "ISBH" && kind.why_not.empty() && kind.find("N", 'H') != nullptr &&
         kind.find("type", 'B') != nullptr && kind.find("instance", 'B') != nullptr &&
         kind.find("mul", 'H') != nullptr && kind.find("smp_cnt", 'H') != nullptr &&
         kind.find("SampleUS", 'Q') != nullptr && kind.find("smp_rate", 'f') != nullptr;
}

bool DataflashBatches::is_block(const DataflashKind& kind) {
  return kind.name == "ISBD" && kind.why_not.empty() && kind.find("N", 'H') != nullptr &&
         kind.find("seqno", 'H') != nullptr && kind.find("x", 'a') != nullptr && kind.find("y", 'a') != nullptr &&
         kind.find("z", 'a') != nullptr;
}

void DataflashBatches::take_header(const DataflashKind& kind, Body body) {
  DataflashBurst burst;
  burst.number = count_of(kind, "N", 'H', body);
  burst.type = count_of(kind, "type", 'B', body);
  burst.instance = count_of(kind, "instance", 'B', body);
  burst.samples = count_of(kind, "smp_cnt", 'H', body);
  burst.multiplier = number_of(*kind.find("mul", 'H'), body);
  burst.rate_hz = number_of(*kind.find("smp_rate", 'f'), body);
  burst.start_us = little_endian<8>(body.data() + kind.find("SampleUS", 'Q')->byte);
  const bool usable =
      burst.multiplier > 0 && burst.rate_hz >= 1e-3 && burst.rate_hz <= 1e7 && burst.start_us <= kDataflashLargestStamp;
  if (usable)
    burst_ = burst;
  else
    burst_.reset();
}

const DataflashBurst* DataflashBatches::burst_of(const DataflashKind& kind, Body body) const {
  if (!burst_ || burst_->number != count_of(kind, "N", 'H', body)) return nullptr;
  return &*burst_;
}

std::uint32_t DataflashBatches::first_sample(const DataflashKind& kind, Body body) {
  return count_of(kind, "seqno", 'H', body) * static_cast<std::uint32_t>(kDataflashArray);
}

std::int64_t dataflash_instance(const DataflashKind& kind, Body body) {
  if (!kind.instance || !kind.why_not.empty()) return -1;
  return std::to_integer<std::int64_t>(body[kind.fields[*kind.instance].byte]);
}

DataflashListing list_dataflash(const BinaryFile& file, std::size_t block_bytes) {
  DataflashFormats formats;
  // Once more when a FMTU came behind messages that it tells apart.
  for (int round = 0;; ++round) {
    DataflashListing listing;
    listing.formats = std::move(formats);
    listing.formats.rewind();
    DataflashLister lister(listing);
    DataflashWalk walk(file, block_bytes, listing.formats, listing.losses);
    DataflashMessage message;
    while (walk.next(message)) lister.note(message);
    if (listing.formats.changed_behind() && round == 0) {
      formats = std::move(listing.formats);
      continue;
    }
    lister.describe_topics();
    return listing;
  }
}

}  // namespace libchar
