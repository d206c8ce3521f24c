#include "libchar/log/ros/mcap_records.hpp"

#include "libchar/log/ros/byte_reader.hpp"

namespace libchar {
namespace {

std::int64_t stamp_of(std::uint64_t ns) {
  return static_cast<std::int64_t>(ns);
}

template <typename T>
std::optional<T> if_good(const ByteReader& in, T value) {
  if (!in.good()) return std::nullopt;
  return value;
}

}  // namespace

std::optional<std::string> read_mcap_profile(std::span<const std::byte> content) {
  ByteReader in(content);
  std::string profile = in.text();
  return if_good(in, std::move(profile));
}

std::optional<std::pair<std::uint16_t, McapSchema>> read_mcap_schema(
    std::span<const std::byte> content) {
  ByteReader in(content);
  const auto id = in.number<std::uint16_t>();
  McapSchema schema;
  schema.name = in.text();
  schema.encoding = in.text();
  schema.text = in.text();
  return if_good(in, std::pair(id, std::move(schema)));
}

std::optional<std::pair<std::uint16_t, McapChannel>> read_mcap_channel(
    std::span<const std::byte> content) {
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

}  // namespace libchar
