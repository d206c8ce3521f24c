// Bags of ROS 1, version 2.0: any message by the definition that its connection carries.
// Source: ROS wiki "Bags/Format/2.0".

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/core/finding.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/log/binary/file.hpp"
#include "libchar/log/detail/format.hpp"
#include "libchar/log/ros/chunked_topics.hpp"
#include "libchar/log/ros/decompress.hpp"
#include "libchar/log/ros/file_window.hpp"

namespace libchar {
namespace {

// Messages of a bag of ROS 1 in the order in which they stand there, and what its index says of them. Source: ROS wiki
// "Bags/Format/2.0": records of a header (u32 length, then fields u32 length "name=value") and data (u32 length).

inline constexpr std::string_view kBagMagic = "#ROSBAG V";
inline constexpr std::uint64_t kFirstBagRecord = 13;  ///< behind "#ROSBAG V2.0\n"

struct BagConnection {
  std::string topic, type, definition;
};

struct BagCatalog {
  std::map<StreamId, BagConnection> connections;
};

struct BagIndex {
  BagCatalog catalog;
  std::vector<ChunkPlace> chunks;
  std::map<StreamId, StreamCount> counts;
  std::uint64_t at = 0;  ///< byte of the file at which it begins: the end of the messages
};

enum class BagOp { none = 0, message = 2, header = 3, index = 4, chunk = 5, chunk_info = 6, connection = 7 };

constexpr std::uint32_t kLongestHeader = 1U << 20U;  // of a record; the largest is a topic's name
constexpr const char* kNoRecords = "no records";

std::string_view text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// The value of a field of a header; "" when it has none of this name.
std::string_view field(std::string_view header, std::string_view name) {
  while (header.size() >= 4) {
    std::uint32_t length = 0;
    std::memcpy(&length, header.data(), sizeof length);
    header.remove_prefix(4);
    if (length > header.size()) return "";
    const std::string_view one = header.substr(0, length);
    if (one.size() > name.size() && one.starts_with(name) && one[name.size()] == '=')
      return one.substr(name.size() + 1);
    header.remove_prefix(length);
  }
  return "";
}

template <typename T>
std::optional<T> number(std::string_view value) {
  T result{};
  if (value.size() != sizeof result) return std::nullopt;
  std::memcpy(&result, value.data(), sizeof result);
  return result;
}

template <typename T>
std::optional<T> number_field(std::string_view header, std::string_view name) {
  return number<T>(field(header, name));
}

BagOp op_of(std::string_view header) {
  return static_cast<BagOp>(number_field<std::uint8_t>(header, "op").value_or(0));
}

// u32 seconds, u32 nanoseconds.
std::int64_t time_of_field(std::string_view value) {
  const auto both = number<std::uint64_t>(value).value_or(0);
  return static_cast<std::int64_t>(both & 0xffffffffU) * 1000000000 + static_cast<std::int64_t>(both >> 32U);
}

std::optional<StreamId> connection_of(std::string_view header) {
  const auto id = number_field<std::uint32_t>(header, "conn");
  if (!id || *id > 0xffff) return std::nullopt;
  return static_cast<StreamId>(*id);
}

void add_connection(std::string_view header, std::string_view data, BagCatalog& catalog) {
  const auto id = connection_of(header);
  if (!id) return;
  BagConnection connection;
  connection.topic = field(header, "topic");
  connection.type = field(data, "type");
  connection.definition = field(data, "message_definition");
  catalog.connections.try_emplace(*id, std::move(connection));
}

// Where a record of a file stands; nothing when it is not whole.
struct FileRecord {
  std::uint64_t header_at = 0, data_at = 0, end = 0;
  std::uint32_t header = 0, data = 0;
  bool whole = false;  // its data too
};

std::optional<FileRecord> find_record(MovingWindow& file, std::uint64_t at, std::uint64_t end) {
  FileRecord record;
  if (at > end || end - at < 4) return std::nullopt;
  record.header = ByteReader(file.view(at, 4)).number<std::uint32_t>();
  record.header_at = at + 4;
  if (record.header > kLongestHeader || end - record.header_at < std::uint64_t{record.header} + 4) return std::nullopt;
  const std::uint64_t size_at = record.header_at + record.header;
  record.data = ByteReader(file.view(size_at, 4)).number<std::uint32_t>();
  record.data_at = size_at + 4;
  record.whole = end - record.data_at >= record.data;
  record.end = record.data_at + record.data;
  return record;
}

std::string header_of(MovingWindow& file, const FileRecord& record) {
  return std::string(text_of(file.view(record.header_at, record.header)));
}

// Times and counts of a chunk: {u32 connection, u32 count} repeated.
void add_chunk_info(std::string_view header, std::span<const std::byte> data, BagIndex& index) {
  const auto at = number_field<std::uint64_t>(header, "chunk_pos");
  if (!at) return;
  const std::int64_t first = time_of_field(field(header, "start_time")),
                     last = time_of_field(field(header, "end_time"));
  ChunkPlace place;
  place.at = *at;
  ByteReader in(data);
  while (in.left() >= 8) {
    const auto id = in.number<std::uint32_t>();
    const auto rows = in.number<std::uint32_t>();
    if (id > 0xffff) continue;
    place.streams.push_back(static_cast<StreamId>(id));
    StreamCount& count = index.counts[static_cast<StreamId>(id)];
    count.first_ns = count.rows == 0 ? first : std::min(count.first_ns, first);
    count.last_ns = count.rows == 0 ? last : std::max(count.last_ns, last);
    count.rows += rows;
  }
  index.chunks.push_back(std::move(place));
}

// Throws Error(input) where the file is no bag that is read: another version, or encrypted.
void check_bag(MovingWindow& file) {
  const auto head = text_of(file.view(0, static_cast<std::size_t>(std::min<std::uint64_t>(file.size(), 13))));
  const auto refusal = [&]() { return input_error("E0444", file.path() + " (byte 0)"); };
  constexpr std::string_view kMark = "#ROSBAG V2.0\n";
  const bool cut = head.size() < kMark.size() && kMark.starts_with(head);
  if (!head.starts_with(kBagMagic) || cut)
    throw refusal()
        .says(wrong_start(head, kMark, "a bag"))
        .got(std::string(head))
        .hint("`format` auto finds out what it is");
  if (head != kMark)
    throw refusal()
        .says("is a bag of another version than 2.0")
        .got(std::string(head))
        .hint("rosbag fix writes it again as 2.0");
  const auto record = find_record(file, kFirstBagRecord, file.size());
  if (!record) return;
  const std::string header = header_of(file, *record);
  const std::string_view encryptor = field(header, "encryptor");
  if (!encryptor.empty() && encryptor != "rosbag/NoEncryptor")
    throw refusal()
        .says("is encrypted")
        .got(std::string(encryptor))
        .hint("rosbag decrypt writes it again in the clear");
}

// Nothing when there is none (a bag that was not closed), or none that can be relied on.
std::optional<BagIndex> read_bag_index(MovingWindow& file) {
  const auto first = find_record(file, kFirstBagRecord, file.size());
  if (!first || !first->whole) return std::nullopt;
  const std::string header = header_of(file, *first);
  const std::uint64_t at = number_field<std::uint64_t>(header, "index_pos").value_or(0);
  if (op_of(header) != BagOp::header || at < first->end || at > file.size()) return std::nullopt;
  BagIndex index;
  index.at = at;
  for (std::uint64_t here = at; here < file.size();) {
    const auto record = find_record(file, here, file.size());
    if (!record || !record->whole || record->data > kLargestChunk) return std::nullopt;
    const std::string fields = header_of(file, *record);
    const auto data = file.view(record->data_at, record->data);
    if (op_of(fields) == BagOp::connection) add_connection(fields, text_of(data), index.catalog);
    if (op_of(fields) == BagOp::chunk_info) add_chunk_info(fields, data, index);
    here = record->end;
  }
  if (index.chunks.size() != number_field<std::uint32_t>(header, "chunk_count").value_or(0) ||
      index.catalog.connections.size() != number_field<std::uint32_t>(header, "conn_count").value_or(0))
    return std::nullopt;
  return index;
}

class BagScan final : public ChunkScan {
 public:
  BagScan(MovingWindow& file, BagCatalog& catalog) : ChunkScan(file), catalog_(catalog), end_(file.size()) {}
  /// The messages end here; without it they end with the file, and that is said.
  void end_at(std::uint64_t end) { end_ = end, closed_ = true; }

 private:
  Step file_record(RawMessage& message, StreamId& connection, Findings& warnings) override {
    if (at_ >= end_) return closed_ ? Step::end : cut_here(warnings, "");
    const auto record = find_record(file_, at_, end_);
    if (!record) return cut_here(warnings, "inside a record");
    const std::string header = header_of(file_, *record);
    const BagOp op = op_of(header);
    if (op == BagOp::chunk)
      enter_chunk(header, record->data_at, std::min<std::uint64_t>(record->data, end_ - record->data_at), warnings);
    if (!record->whole) return cut_here(warnings, op == BagOp::chunk ? "inside a chunk" : "inside a record");
    at_ = record->end;
    if (op == BagOp::chunk) return single_ ? Step::end : Step::other;
    if (record->data > kLargestChunk) return Step::other;
    if (op == BagOp::connection) add_connection(header, text_of(file_.view(record->data_at, record->data)), catalog_);
    if (op != BagOp::message) return Step::other;
    message.at = record->header_at - 4;
    return take_message(header, file_.view(record->data_at, record->data), message, connection) ? Step::message
                                                                                                : Step::other;
  }

  bool chunk_record(RawMessage& message, StreamId& connection, Findings& warnings) override {
    ByteReader in(chunk_);
    const auto header = text_of(in.take(in.number<std::uint32_t>()));
    const auto data = in.take(in.number<std::uint32_t>());
    if (!in.good()) {
      if (!chunk_cut_) lose_chunk(warnings, kNoRecords);
      chunk_ = {};
      return false;
    }
    chunk_ = chunk_.subspan(in.at());
    const BagOp op = op_of(header);
    if (op == BagOp::connection) add_connection(header, text_of(data), catalog_);
    message.at = chunk_at_;
    return op == BagOp::message && take_message(header, data, message, connection);
  }

  void enter_chunk(std::string_view header, std::uint64_t data_at, std::uint64_t length, Findings& warnings) {
    if (!enters(at_)) return;
    const std::string method(field(header, "compression"));
    const std::uint64_t size = number_field<std::uint32_t>(header, "size").value_or(0);
    note_packing(method, std::max(size, length), "rosbag filter IN OUT True", "rosbag decompress");
    const auto packed = file_.view(data_at, static_cast<std::size_t>(length));
    chunk_ = packed;
    chunk_cut_ = data_at + length >= file_.size() && !closed_;
    if (method != "none" && !method.empty()) {
      const std::string problem = unpack(method, packed, size, unpacked_);
      chunk_ = unpacked_;
      if (!problem.empty() && !chunk_cut_) lose_chunk(warnings, kNoRecords, problem);
    }
  }

  bool take_message(std::string_view header, std::span<const std::byte> data, RawMessage& message,
                    StreamId& connection) const {
    const auto id = connection_of(header);
    if (!id || !wanted(*id)) return false;
    connection = *id;
    message.data = data;
    message.log_ns = message.publish_ns = time_of_field(field(header, "time"));
    return true;
  }

  Step cut_here(Findings& warnings, std::string_view inside) const {
    return cut(warnings, file_.left(at_) == 0 ? "without its index" : inside, at_);
  }

  BagCatalog& catalog_;
  std::uint64_t end_ = 0;
  bool closed_ = false;
  bool chunk_cut_ = false;  // it ends with the file
};

class BagReader final : public ChunkedTopics {
 public:
  BagReader(const std::string& path, const ReadOptions& options)
      : ChunkedTopics(path, options, false, scan_, kFirstBagRecord), scan_(file(), catalog_) {
    check_bag(file());
    if (auto index = read_bag_index(file())) {
      indexed_ = true;
      catalog_ = std::move(index->catalog);
      chunks() = std::move(index->chunks);
      counts() = std::move(index->counts);
      scan_.end_at(index->at);
      find_examples();
    } else {
      count_messages();
    }
    list();
  }

  std::vector<std::string> dialect() const override {
    return {fmt::format("bag 2.0{}{}", packing(), indexed_ ? "" : ", no index")};
  }

 private:
  void list() {
    std::vector<std::pair<StreamId, RawTopic>> streams;
    for (const auto& [id, connection] : catalog_.connections) {
      RawTopic topic;
      topic.name = connection.topic;
      topic.format.type = connection.type;
      topic.format.message_encoding = "ros1";
      topic.format.definition_encoding = "ros1msg";
      topic.format.definition = connection.definition;
      streams.emplace_back(id, std::move(topic));
    }
    list_topics(std::move(streams));
  }

  BagCatalog catalog_;
  BagScan scan_;
  bool indexed_ = false;
};

}  // namespace

Format bag_format() {
  Format row;
  row.about.name = "bag";
  row.about.title = "ROS 1 bag";
  row.about.suffixes = {".bag"};
  row.about.topics = true;
  row.about.time_sources = true;
  row.topics = open_topics<BagReader>;
  row.about.units = "of ROS types";
  row.certain = [](std::string_view first_bytes) { return first_bytes.starts_with(kBagMagic); };
  return row;
}

}  // namespace libchar
