// MCAP, the container of ROS 2 since Iron and of Foxglove: any message that the file itself describes in ROS's terms,
// or JSON. Source: mcap.dev/spec and its registry of profiles and encodings.

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "libchar/core/file/crc32.hpp"
#include "libchar/core/finding.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/binary/file.hpp"
#include "libchar/log/detail/format.hpp"
#include "libchar/log/ros/chunked_topics.hpp"
#include "libchar/log/ros/decompress.hpp"
#include "libchar/log/ros/file_window.hpp"

namespace libchar {
namespace {

// Messages of an MCAP file in the order in which they stand there, and what its summary says of them.

// Records of MCAP files. Source: mcap.dev/spec: u8 opcode, u64 length, content; integers little
// endian, texts with a u32 length in front.

inline constexpr std::string_view kMcapMagic = "\x89MCAP0\r\n";

enum class McapOp : std::uint8_t {
  header = 1,
  footer = 2,
  schema = 3,
  channel = 4,
  message = 5,
  chunk = 6,
  chunk_index = 8,
  statistics = 11,
  data_end = 15
};

inline constexpr std::size_t kMcapFront = 9;          // opcode and length
inline constexpr std::size_t kMcapMessageFront = 22;  // of a message, in front of its data
inline constexpr std::size_t kMcapFooter = 20;

struct McapSchema {
  std::string name, encoding, text;
};

struct McapChannel {
  std::uint16_t schema = 0;
  std::string topic, encoding;
};

struct McapMessageFront {
  std::uint16_t channel = 0;
  std::int64_t log_ns = 0, publish_ns = 0;
};

struct McapChunkFront {
  std::uint64_t unpacked = 0;
  std::uint32_t crc = 0;
  std::string compression;
  std::uint64_t packed = 0;
  std::size_t bytes = 0;  ///< of this front, up to the records
};

struct McapChunkIndex {
  std::uint64_t first_ns = 0, last_ns = 0;
  std::uint64_t at = 0, bytes = 0;
  std::vector<std::uint16_t> channels;
};

struct McapStatistics {
  std::uint64_t first_ns = 0, last_ns = 0;
  std::map<std::uint16_t, std::uint64_t> messages;  ///< by channel
};

struct McapFooter {
  std::uint64_t summary_at = 0;
  std::uint32_t crc = 0;
};

/// Schemas and channels, as they come up.
struct McapCatalog {
  std::map<std::uint16_t, McapSchema> schemas;
  std::map<std::uint16_t, McapChannel> channels;
  std::vector<std::uint16_t> order;  ///< of channels, as first seen
};

/// What stands at the end of a file that was closed.
struct McapSummary {
  McapCatalog catalog;
  std::vector<McapChunkIndex> chunks;
  McapStatistics statistics;
};

std::int64_t stamp_of(std::uint64_t ns) { return static_cast<std::int64_t>(ns); }

template <typename T>
std::optional<T> if_good(const ByteReader& in, T value) {
  if (!in.good()) return std::nullopt;
  return value;
}

/// Nothing where the content is too short for what it is said to be.
std::optional<std::string> read_mcap_profile(std::span<const std::byte> content) {
  ByteReader in(content);
  std::string profile = in.text();
  return if_good(in, std::move(profile));
}

std::optional<std::pair<std::uint16_t, McapSchema>> read_mcap_schema(std::span<const std::byte> content) {
  ByteReader in(content);
  const auto id = in.number<std::uint16_t>();
  McapSchema schema;
  schema.name = in.text();
  schema.encoding = in.text();
  schema.text = in.text();
  return if_good(in, std::pair(id, std::move(schema)));
}

std::optional<std::pair<std::uint16_t, McapChannel>> read_mcap_channel(std::span<const std::byte> content) {
  ByteReader in(content);
  const auto id = in.number<std::uint16_t>();
  McapChannel channel;
  channel.schema = in.number<std::uint16_t>();
  channel.topic = in.text();
  channel.encoding = in.text();
  return if_good(in, std::pair(id, std::move(channel)));
}

std::optional<McapMessageFront> read_mcap_message(std::span<const std::byte> content) {
  ByteReader in(content);
  McapMessageFront front;
  front.channel = in.number<std::uint16_t>();
  in.number<std::uint32_t>();  // sequence
  front.log_ns = stamp_of(in.number<std::uint64_t>());
  front.publish_ns = stamp_of(in.number<std::uint64_t>());
  return if_good(in, front);
}

/// `content` may end behind the front.
std::optional<McapChunkFront> read_mcap_chunk(std::span<const std::byte> content) {
  ByteReader in(content);
  in.number<std::uint64_t>();  // times of the first and last message
  in.number<std::uint64_t>();
  McapChunkFront front;
  front.unpacked = in.number<std::uint64_t>();
  front.crc = in.number<std::uint32_t>();
  front.compression = in.text();
  front.packed = in.number<std::uint64_t>();
  front.bytes = in.at();
  return if_good(in, std::move(front));
}

std::optional<McapChunkIndex> read_mcap_chunk_index(std::span<const std::byte> content) {
  ByteReader in(content);
  McapChunkIndex index;
  index.first_ns = in.number<std::uint64_t>();
  index.last_ns = in.number<std::uint64_t>();
  index.at = in.number<std::uint64_t>();
  index.bytes = in.number<std::uint64_t>();
  ByteReader offsets(in.take(in.number<std::uint32_t>()));
  while (offsets.left() > 0) {
    index.channels.push_back(offsets.number<std::uint16_t>());
    offsets.number<std::uint64_t>();
  }
  return if_good(in, std::move(index));
}

std::optional<McapStatistics> read_mcap_statistics(std::span<const std::byte> content) {
  ByteReader in(content);
  McapStatistics statistics;
  in.number<std::uint64_t>();  // messages in all
  in.number<std::uint16_t>();  // schemas
  in.take(16);                 // channels, attachments, metadata, chunks
  statistics.first_ns = in.number<std::uint64_t>();
  statistics.last_ns = in.number<std::uint64_t>();
  ByteReader counts(in.take(in.number<std::uint32_t>()));
  while (counts.left() > 0) {
    const auto channel = counts.number<std::uint16_t>();
    statistics.messages[channel] = counts.number<std::uint64_t>();
  }
  return if_good(in, std::move(statistics));
}

std::optional<McapFooter> read_mcap_footer(std::span<const std::byte> content) {
  ByteReader in(content);
  McapFooter footer;
  footer.summary_at = in.number<std::uint64_t>();
  in.number<std::uint64_t>();  // of the offsets of the summary
  footer.crc = in.number<std::uint32_t>();
  return if_good(in, footer);
}

constexpr std::uint64_t kFirstRecord = 8;  // behind the magic
constexpr std::string_view kNoEndMark = "without its end mark";
constexpr const char* kNotAsSaid = "not what their checksum says";

struct RecordFront {
  McapOp op{};
  std::uint64_t length = 0;
};

RecordFront read_front(std::span<const std::byte> bytes) {
  ByteReader in(bytes);
  RecordFront front;
  front.op = static_cast<McapOp>(in.number<std::uint8_t>());
  front.length = in.number<std::uint64_t>();
  return front;
}

void add_schema(std::span<const std::byte> content, McapCatalog& catalog, Findings& warnings) {
  auto read = read_mcap_schema(content);
  if (!read) return;
  const auto [at, added] = catalog.schemas.try_emplace(read->first, std::move(read->second));
  if (added) return;
  const McapSchema& known = at->second;
  if (known.name != read->second.name || known.text != read->second.text)
    warnings.add("definition_changed", "a schema or channel is repeated and differs: the first is used",
                 printable(known.name));
}

void add_channel(std::span<const std::byte> content, McapCatalog& catalog, Findings& warnings) {
  auto read = read_mcap_channel(content);
  if (!read) return;
  const std::uint16_t id = read->first;
  const auto [at, added] = catalog.channels.try_emplace(id, std::move(read->second));
  if (added) return catalog.order.push_back(id);
  if (at->second.topic != read->second.topic || at->second.schema != read->second.schema)
    warnings.add("definition_changed", "a schema or channel is repeated and differs: the first is used",
                 printable(at->second.topic));
}

// The summary's records; nothing when one of them is broken.
std::optional<McapSummary> summary_records(MovingWindow& file, std::uint64_t at, std::uint64_t end,
                                           Findings& warnings) {
  McapSummary summary;
  bool counted = false;
  while (at < end) {
    if (end - at < kMcapFront) return std::nullopt;
    const RecordFront front = read_front(file.view(at, kMcapFront));
    at += kMcapFront;
    if (front.length > end - at) return std::nullopt;
    const bool looked_at = front.op == McapOp::schema || front.op == McapOp::channel ||
                           front.op == McapOp::chunk_index || front.op == McapOp::statistics;
    if (looked_at && front.length <= kLargestChunk) {
      const auto content = file.view(at, static_cast<std::size_t>(front.length));
      if (front.op == McapOp::schema) add_schema(content, summary.catalog, warnings);
      if (front.op == McapOp::channel) add_channel(content, summary.catalog, warnings);
      if (front.op == McapOp::chunk_index)
        if (auto index = read_mcap_chunk_index(content)) summary.chunks.push_back(std::move(*index));
      if (front.op == McapOp::statistics)
        if (auto statistics = read_mcap_statistics(content)) {
          summary.statistics = std::move(*statistics);
          counted = true;
        }
    }
    at += front.length;
  }
  if (!counted || summary.catalog.channels.empty()) return std::nullopt;
  // Counts of channels that it does not describe say that channels are not repeated here.
  for (const auto& [id, count] : summary.statistics.messages)
    if (count > 0 && !summary.catalog.channels.contains(id)) return std::nullopt;
  return summary;
}

/// Are the records of an MCAP file to follow? Throws Error(input) where they are not.
void check_mcap_magic(MovingWindow& file) {
  const std::size_t size = std::min(detail::in_memory(file.size()), kMcapMagic.size());
  const auto bytes = file.view(0, size);
  const std::string_view found(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (found == kMcapMagic) return;
  throw input_error("E0441", file.path() + " (byte 0)")
      .says(wrong_start(found, kMcapMagic, "an MCAP file"))
      .got(std::string(found))
      .hint("`format` auto finds out what it is");
}

/// Nothing when there is none, or none that can be relied on (then counted).
std::optional<McapSummary> read_mcap_summary(MovingWindow& file, Findings& warnings) {
  constexpr std::uint64_t kEnd = kMcapFront + kMcapFooter + 8;
  if (file.size() < kFirstRecord + kEnd) return std::nullopt;
  const std::uint64_t footer_at = file.size() - kEnd;
  const auto bytes = file.view(footer_at, kEnd);
  const auto tail = bytes.subspan(kMcapFront + kMcapFooter);
  const RecordFront front = read_front(bytes);
  if (std::string_view(reinterpret_cast<const char*>(tail.data()), tail.size()) != kMcapMagic ||
      front.op != McapOp::footer || front.length != kMcapFooter)
    return std::nullopt;
  const auto footer = read_mcap_footer(bytes.subspan(kMcapFront, kMcapFooter));
  if (!footer || footer->summary_at < kFirstRecord || footer->summary_at > footer_at) return std::nullopt;
  std::uint32_t crc = 0;
  const std::uint64_t crc_end = footer_at + kMcapFront + kMcapFooter - sizeof crc;
  for (std::uint64_t at = footer->summary_at; footer->crc != 0 && at < crc_end;) {
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(crc_end - at, 1U << 20U));
    crc = crc32_of(file.view(at, count), crc);
    at += count;
  }
  auto summary = crc == footer->crc || footer->crc == 0 ? summary_records(file, footer->summary_at, footer_at, warnings)
                                                        : std::nullopt;
  if (crc != footer->crc && footer->crc != 0)
    warnings.add("broken_index", "the summary is not what its checksum says: the file was read whole instead",
                 fmt::format("byte {}", footer->summary_at));
  return summary;
}

class McapScan final : public ChunkScan {
 public:
  McapScan(MovingWindow& file, McapCatalog& catalog) : ChunkScan(file), catalog_(catalog) {}
  void begin_at(std::uint64_t at) override {
    ChunkScan::begin_at(at);
    crc_ = crc32_of(file_.view(0, kMcapMagic.size()));
    crc_covers_ = at == kFirstRecord;
  }

 private:
  Step file_record(RawMessage& message, StreamId& channel, Findings& warnings) override {
    const std::uint64_t left = file_.left(at_);
    const auto end = [&] { return cut(warnings, kNoEndMark, file_.size()); };
    if (left < kMcapFront) return left == 0 ? end() : cut(warnings, "inside a record", at_);
    const RecordFront front = read_front(file_.view(at_, kMcapFront));
    const std::uint64_t content_at = at_ + kMcapFront, behind = left - kMcapFront;
    if (front.op == McapOp::chunk) {
      enter_chunk(content_at, std::min(front.length, behind), warnings);
      crc_covers_ = false;
      if (front.length > behind) return cut(warnings, "inside a chunk", at_);
      at_ = content_at + front.length;
      return single_ ? Step::end : Step::other;
    }
    if (front.length > behind || static_cast<std::uint8_t>(front.op) == 0)
      return cut(warnings, front.op == McapOp::message ? "inside a message" : "inside a record", at_);
    if (front.op != McapOp::data_end) note_crc(kMcapFront + front.length);
    at_ = content_at + front.length;
    const auto size = static_cast<std::size_t>(std::min(front.length, kLargestChunk + 1));
    switch (front.op) {
      case McapOp::schema:
      case McapOp::channel:
        if (size <= kLargestChunk) note_catalog(front.op, file_.view(content_at, size), warnings);
        return Step::other;
      case McapOp::message: {
        if (size < kMcapMessageFront) break;
        const auto head = read_mcap_message(file_.view(content_at, kMcapMessageFront));
        channel = head->channel;
        if (!wanted(channel)) return Step::other;
        if (size > kLargestChunk) break;
        message = {file_.view(content_at, size).subspan(kMcapMessageFront), head->log_ns, head->publish_ns, content_at};
        return Step::message;
      }
      case McapOp::data_end:
        if (size >= 4) check_crc(file_.view(content_at, 4), warnings);
        return ends_well() ? Step::end : end();
      case McapOp::footer:
        return Step::end;
      default:
        return Step::other;
    }
    warnings.add("broken_message", "messages that are too short or too long to be any were left out",
                 fmt::format("byte {}", content_at));
    return Step::other;
  }
  bool chunk_record(RawMessage& message, StreamId& channel, Findings& warnings) override {
    const auto lose_rest = [&] {
      lose_chunk(warnings, kNotAsSaid);
      return false;
    };
    if (chunk_.size() < kMcapFront) return lose_rest();
    const RecordFront front = read_front(chunk_);
    if (front.length > chunk_.size() - kMcapFront) return lose_rest();
    const auto content = chunk_.subspan(kMcapFront, static_cast<std::size_t>(front.length));
    chunk_ = chunk_.subspan(kMcapFront + content.size());
    if (front.op != McapOp::message) {
      note_catalog(front.op, content, warnings);
      return false;
    }
    const auto head = read_mcap_message(content);
    if (!head) return lose_rest();
    channel = head->channel;
    if (!wanted(channel)) return false;
    message = {content.subspan(kMcapMessageFront), head->log_ns, head->publish_ns, chunk_at_};
    return true;
  }
  void enter_chunk(std::uint64_t content_at, std::uint64_t length, Findings& warnings);
  void unpack_chunk(const McapChunkFront& front, std::span<const std::byte> packed, bool whole, Findings& warnings) {
    const auto broken = [&](const std::string& why) { lose_chunk(warnings, kNotAsSaid, why); };
    chunk_ = packed;
    if (!front.compression.empty() && front.compression != "none") {
      const std::string problem = unpack(front.compression, packed, front.unpacked, unpacked_);
      if (whole && !problem.empty()) return broken(problem);
      chunk_ = unpacked_;
    }
    if (whole && chunk_.size() != front.unpacked)
      return broken(fmt::format("{} bytes instead of {}", chunk_.size(), front.unpacked));
    if (whole && front.crc != 0 && crc32_of(chunk_) != front.crc) return broken("checksum");
    if (whole) return;
    // The whole records in front of the cut.
    std::size_t used = 0;
    while (chunk_.size() - used >= kMcapFront) {
      const RecordFront record = read_front(chunk_.subspan(used));
      if (record.length > chunk_.size() - used - kMcapFront) break;
      used += kMcapFront + static_cast<std::size_t>(record.length);
    }
    chunk_ = chunk_.first(used);
  }
  bool ends_well() {
    const std::size_t size = kMcapMagic.size();
    if (file_.left(at_) < kMcapFront + kMcapFooter + size) return false;
    const auto tail = file_.view(file_.size() - size, size);
    return std::string_view(reinterpret_cast<const char*>(tail.data()), tail.size()) == kMcapMagic;
  }
  void note_catalog(McapOp op, std::span<const std::byte> content, Findings& warnings);
  // The checksum of the data covers every byte in front of DataEnd.
  void note_crc(std::uint64_t bytes) {
    for (std::uint64_t done = 0; crc_covers_ && done < bytes;) {
      const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(bytes - done, 1U << 18U));
      crc_ = crc32_of(file_.view(at_ + done, count), crc_);
      done += count;
    }
  }
  void check_crc(std::span<const std::byte> content, Findings& warnings) const {
    const auto said = ByteReader(content).number<std::uint32_t>();
    if (!crc_covers_ || said == 0 || said == crc_) return;
    warnings.add("checksum",
                 "the data are not what their checksum says: something has changed since they were written");
  }

  McapCatalog& catalog_;
  std::uint32_t crc_ = 0;
  bool crc_covers_ = false;  // everything so far, and no chunk has one of its own
};

void McapScan::note_catalog(McapOp op, std::span<const std::byte> content, Findings& warnings) {
  if (op == McapOp::schema) add_schema(content, catalog_, warnings);
  if (op == McapOp::channel) add_channel(content, catalog_, warnings);
}

void McapScan::enter_chunk(std::uint64_t content_at, std::uint64_t length, Findings& warnings) {
  if (!enters(content_at - kMcapFront)) return;
  const auto head =
      read_mcap_chunk(file_.view(content_at, static_cast<std::size_t>(std::min<std::uint64_t>(length, 256))));
  if (!head) return;  // cut off in the front
  const std::uint64_t packed_here = std::min(head->packed, length - head->bytes);
  note_packing(head->compression, std::max(head->unpacked, head->packed), "mcap filter", "mcap decompress");
  const auto packed = file_.view(content_at + head->bytes, static_cast<std::size_t>(packed_here));
  unpack_chunk(*head, packed, packed_here == head->packed, warnings);
}

class McapReader final : public ChunkedTopics {
 public:
  McapReader(const std::string& path, const ReadOptions& options)
      : ChunkedTopics(path, options, true, scan_, kFirstRecord), scan_(file(), catalog_) {
    check_mcap_magic(file());
    read_profile();
    if (auto summary = read_mcap_summary(file(), found_early())) {
      take_summary(std::move(*summary));
      find_examples();
    } else {
      count_messages();
    }
    list();
  }

  std::vector<std::string> dialect() const override {
    return {fmt::format("MCAP{}{}{}", profile_.empty() ? "" : ", profile " + printable(profile_, 40), packing(),
                        summary_ ? "" : ", no summary")};
  }

 private:
  void read_profile() {
    const std::uint64_t left = file().left(kFirstRecord);
    const auto bytes = file().view(kFirstRecord, static_cast<std::size_t>(std::min<std::uint64_t>(left, 4096)));
    if (bytes.size() > kMcapFront && bytes[0] == std::byte{1})
      profile_ = read_mcap_profile(bytes.subspan(kMcapFront)).value_or("");
  }

  void take_summary(McapSummary summary) {
    summary_ = true;
    catalog_ = std::move(summary.catalog);
    for (McapChunkIndex& chunk : summary.chunks) chunks().push_back({chunk.at, std::move(chunk.channels)});
    for (const auto& [id, rows] : summary.statistics.messages)
      counts()[id] = {rows,
                      static_cast<std::int64_t>(summary.statistics.first_ns),
                      static_cast<std::int64_t>(summary.statistics.last_ns),
                      {}};
    // A channel is in some chunks only: their times tell its rate better than those of the file.
    std::map<StreamId, std::pair<std::uint64_t, std::uint64_t>> spans;
    for (std::size_t i = 0; i < chunks().size(); ++i)
      for (const StreamId id : chunks()[i].streams) {
        const McapChunkIndex& chunk = summary.chunks[i];
        const auto [at, added] = spans.try_emplace(id, chunk.first_ns, chunk.last_ns);
        at->second.first = std::min(at->second.first, chunk.first_ns);
        at->second.second = std::max(at->second.second, chunk.last_ns);
      }
    for (const auto& [id, span] : spans) {
      counts()[id].first_ns = static_cast<std::int64_t>(span.first);
      counts()[id].last_ns = static_cast<std::int64_t>(span.second);
    }
  }

  void list() {
    std::vector<std::pair<StreamId, RawTopic>> streams;
    for (const StreamId id : catalog_.order) {
      const McapChannel& channel = catalog_.channels.at(id);
      RawTopic topic;
      topic.name = channel.topic;
      topic.format.message_encoding = channel.encoding;
      const auto schema = catalog_.schemas.find(channel.schema);
      if (schema != catalog_.schemas.end()) {
        topic.format.type = schema->second.name;
        topic.format.definition_encoding = schema->second.encoding;
        topic.format.definition = schema->second.text;
      }
      streams.emplace_back(id, std::move(topic));
    }
    list_topics(std::move(streams));
  }

  McapCatalog catalog_;
  McapScan scan_;
  std::string profile_;
  bool summary_ = false;
};

}  // namespace

Format mcap_format() {
  Format row;
  row.about.name = "mcap";
  row.about.title = "MCAP";
  row.about.suffixes = {".mcap"};
  row.about.topics = true;
  row.about.time_sources = true;
  row.topics = open_topics<McapReader>;
  row.about.units = "of ROS types";
  row.certain = [](std::string_view first_bytes) { return first_bytes.starts_with(kMcapMagic); };
  return row;
}

}  // namespace libchar
