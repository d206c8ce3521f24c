#include "libchar/log/flight/ulog_listing.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "libchar/log/flight/ulog_format.hpp"

namespace libchar {
namespace {

using Data = std::span<const std::byte>;  // of a message, behind its id

const UlogField* find_field(const UlogLayout& layout, std::string_view name, NumberType type) {
  for (const UlogField& field : layout.fields)
    if (field.name == name) return field.type == type ? &field : nullptr;
  return nullptr;
}

std::optional<UlogFifo> fifo_of(const std::string& message, const UlogLayout& layout) {
  if (!message.ends_with("_fifo")) return std::nullopt;
  const UlogField* dt = find_field(layout, "dt", NumberType::f32);
  const UlogField* scale = find_field(layout, "scale", NumberType::f32);
  const UlogField* samples = find_field(layout, "samples", NumberType::u8);
  if (dt == nullptr || scale == nullptr || samples == nullptr) return std::nullopt;
  UlogFifo fifo{dt->byte, scale->byte, samples->byte, {}, 255};
  for (std::size_t a = 0; a < 3; ++a) {
    const char axis = "xyz"[a];
    std::uint32_t room = 0;
    while (const UlogField* count = find_field(layout, fmt::format("{}[{}]", axis, room), NumberType::i16)) {
      if (room == 0) fifo.axes[a] = count->byte;
      ++room;
    }
    fifo.room = std::min(fifo.room, room);
  }
  if (fifo.room == 0) return std::nullopt;
  return fifo;
}

void note_stamp(UlogStamps& stamps, Data data) {
  const std::uint64_t stamp = little_endian<8>(data.data() + *stamps.byte);
  if (stamp == 0) {
    ++stamps.zeros;
    return;
  }
  if (stamps.first == 0) stamps.first = stamp;
  stamps.last = stamp;
}

UlogTopic new_topic(const std::string& message, UlogLayout layout) {
  UlogTopic content;
  content.message = message;
  content.layout = std::move(layout);
  if (const UlogField* stamp = find_field(content.layout, "timestamp", NumberType::u64))
    content.published.byte = stamp->byte;
  if (const UlogField* stamp = find_field(content.layout, "timestamp_sample", NumberType::u64))
    content.sampled.byte = stamp->byte;
  if (content.sampled.byte) content.fifo = fifo_of(message, content.layout);
  return content;
}

std::vector<Channel> fields_of(const UlogTopic& content) {
  std::vector<Channel> fields;
  const auto unit = [&](std::string_view name) {
    return std::string(px4_unit(content.message, plain_name(name)).value_or(""));
  };
  if (content.fifo)
    for (const std::string_view axis : {"x", "y", "z"}) fields.push_back({std::string(axis), unit(axis), false});
  else
    for (const UlogField& field : content.layout.fields)
      fields.push_back({field.name, unit(field.name), !is_float(field.type)});
  return fields;
}

// Takes the messages of a log one by one.
class Lister {
 public:
  Lister(UlogListing& listing, bool by_publication) : listing_(&listing), by_publication_(by_publication) {}

  void note(const UlogMessage& message) {
    if (message.type == 'D') return note_data(message);
    if (message.type == 'A') return subscribe(message.body);
    if (message.type == 'O') return note_dropout(message);
    if (message.type == 'F')
      return formats_.add({reinterpret_cast<const char*>(message.body.data()), message.body.size()});
    if (message.type != 'I' || listing_->info.size() >= 100) return;
    UlogInfo info = read_ulog_info(message.body);
    if (!info.value.empty()) listing_->info.emplace(std::move(info.key), std::move(info.value));
  }

  /// Of topics that have messages: vehicles announce many that never come.
  void describe_topics() {
    drop_empty_topics();
    for (std::size_t topic = 0; topic < listing_->topics.size(); ++topic) describe_topic(topic);
  }

 private:
  void subscribe(Data body) {
    const auto instance = std::to_integer<unsigned>(body[0]);
    const auto id = static_cast<std::size_t>(little_endian<2>(body.data() + 1));
    const std::string message(reinterpret_cast<const char*>(body.data()) + 3, body.size() - 3);
    const std::string name = fmt::format("{} {}", message, instance);
    const auto [place, fresh] = topic_of_name_.try_emplace(name, listing_->topics.size());
    if (fresh) {
      listing_->contents.push_back(new_topic(message, formats_.layout(message)));
      listing_->topics.emplace_back();
      listing_->topics.back().name = name;
    }
    if (id >= listing_->sizes.size()) {
      listing_->sizes.resize(id + 1);
      listing_->topic_of_id.resize(id + 1);
    }
    if (listing_->topic_of_id[id].value_or(place->second) != place->second) {
      for (const std::size_t topic : {*listing_->topic_of_id[id], place->second})
        listing_->topics[topic].why_not = fmt::format("its number {} is that of another topic too", id);
      return;
    }
    listing_->topic_of_id[id] = place->second;
    const UlogLayout& layout = listing_->contents[place->second].layout;
    listing_->sizes[id] = layout.why_not.empty() ? UlogSizes{true, layout.least_bytes, layout.bytes} : UlogSizes{};
  }

  void note_data(const UlogMessage& message) {
    const auto id = static_cast<std::size_t>(little_endian<2>(message.body.data()));
    Findings& losses = listing_->losses;
    if (id >= listing_->topic_of_id.size() || !listing_->topic_of_id[id]) {
      losses.add("unknown_message", "messages of data that no subscription announces were left out",
                 fmt::format("byte {}", message.byte));
      return;
    }
    UlogTopic& content = listing_->contents[*listing_->topic_of_id[id]];
    const Data data = message.body.subspan(2);
    if (!content.layout.why_not.empty()) {
      ++content.messages;
      return;
    }
    if (data.size() < content.layout.least_bytes || data.size() > content.layout.bytes) {
      losses.add("wrong_size", "messages that are shorter or longer than their format were left out",
                 fmt::format("byte {}", message.byte));
      return;
    }
    std::uint64_t rows = 1;
    if (content.fifo)
      rows = std::min<std::uint64_t>(std::to_integer<unsigned>(data[content.fifo->samples]), content.fifo->room);
    if (content.messages == 0) {
      content.first_byte = message.byte;
      content.rows_of_first = rows;
    }
    content.last_byte = message.byte;
    ++content.messages;
    content.rows += rows;
    if (content.published.byte) {
      note_stamp(content.published, data);
      last_stamp_ = std::max(last_stamp_, content.published.last);
    }
    if (content.sampled.byte) note_stamp(content.sampled, data);
  }

  void note_dropout(const UlogMessage& message) {
    const std::uint64_t ms = little_endian<2>(message.body.data());
    ++listing_->dropouts;
    listing_->dropped_ms += ms;
    if (listing_->dropout_places.size() < 3)
      listing_->dropout_places.push_back(fmt::format("{} ms at {:.3f} s", ms, static_cast<double>(last_stamp_) * 1e-6));
  }

  void drop_empty_topics() {
    std::vector<LogTopic> topics;
    std::vector<UlogTopic> contents;
    std::vector<std::optional<std::size_t>> kept(listing_->topics.size());
    for (std::size_t t = 0; t < kept.size(); ++t) {
      if (listing_->contents[t].messages == 0) continue;
      kept[t] = topics.size();
      topics.push_back(std::move(listing_->topics[t]));
      contents.push_back(std::move(listing_->contents[t]));
    }
    listing_->topics = std::move(topics);
    listing_->contents = std::move(contents);
    for (std::optional<std::size_t>& topic : listing_->topic_of_id)
      if (topic) topic = kept[*topic];
  }

  void describe_topic(std::size_t topic) {
    const UlogTopic& content = listing_->contents[topic];
    LogTopic& about = listing_->topics[topic];
    about.rows = content.layout.why_not.empty() ? content.rows : content.messages;
    about.type = content.message;
    about.sensor = px4_sensor(content.message);
    if (about.why_not.empty()) about.why_not = content.layout.why_not;
    if (about.why_not.empty() && formats_.contradicted()) about.why_not = formats_.layout(content.message).why_not;
    if (!about.why_not.empty()) return;
    about.fields = fields_of(content);
    const UlogStamps& stamps = ulog_stamps(content, by_publication_);
    if (stamps.last > stamps.first)
      about.rate_hz = static_cast<double>(content.rows - content.rows_of_first) * 1e6 /
                      static_cast<double>(stamps.last - stamps.first);
  }

  UlogListing* listing_;
  bool by_publication_;
  UlogFormats formats_;
  std::map<std::string, std::size_t> topic_of_name_;
  std::uint64_t last_stamp_ = 0;
};

}  // namespace

const UlogStamps& ulog_stamps(const UlogTopic& content, bool by_publication) {
  const bool sampled = content.sampled.byte && (content.sampled.last != 0 || content.messages == 0);
  return sampled && (!by_publication || content.fifo) ? content.sampled : content.published;
}

UlogListing list_ulog(const BinaryFile& file, const UlogHeader& header, std::size_t block_bytes, bool by_publication) {
  UlogListing listing;
  Lister lister(listing, by_publication);
  UlogWalk walk(file, block_bytes, header.stretches, listing.sizes, listing.losses);
  UlogMessage message;
  while (walk.next(message)) lister.note(message);
  lister.describe_topics();
  return listing;
}

}  // namespace libchar
