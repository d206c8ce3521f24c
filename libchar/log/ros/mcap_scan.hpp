#pragma once
// Messages of an MCAP file in the order in which they stand there, and what its summary says of them.

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "libchar/core/finding.hpp"
#include "libchar/log/ros/chunked_topics.hpp"
#include "libchar/log/ros/file_window.hpp"

namespace libchar {

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

/// Nothing where the content is too short for what it is said to be.
std::optional<std::string> read_mcap_profile(std::span<const std::byte> content);
std::optional<std::pair<std::uint16_t, McapSchema>> read_mcap_schema(
    std::span<const std::byte> content);
std::optional<std::pair<std::uint16_t, McapChannel>> read_mcap_channel(
    std::span<const std::byte> content);
std::optional<McapMessageFront> read_mcap_message(std::span<const std::byte> content);
/// `content` may end behind the front.
std::optional<McapChunkFront> read_mcap_chunk(std::span<const std::byte> content);
std::optional<McapChunkIndex> read_mcap_chunk_index(std::span<const std::byte> content);
std::optional<McapStatistics> read_mcap_statistics(std::span<const std::byte> content);
std::optional<McapFooter> read_mcap_footer(std::span<const std::byte> content);

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

/// Nothing when there is none, or none that can be relied on (then counted).
std::optional<McapSummary> read_mcap_summary(MovingWindow& file, Findings& warnings);

/// Are the records of an MCAP file to follow? Throws Error(input) where they are not.
void check_mcap_magic(MovingWindow& file);

class McapScan final : public ChunkScan {
 public:
  McapScan(MovingWindow& file, McapCatalog& catalog) : ChunkScan(file), catalog_(catalog) {}
  void begin_at(std::uint64_t at) override;

 private:
  Step file_record(RawMessage& message, StreamId& channel, Findings& warnings) override;
  bool chunk_record(RawMessage& message, StreamId& channel, Findings& warnings) override;
  void enter_chunk(std::uint64_t content_at, std::uint64_t length, Findings& warnings);
  void unpack_chunk(const McapChunkFront& front,
                    std::span<const std::byte> packed,
                    bool whole,
                    Findings& warnings);
  bool ends_well();
  void note_catalog(McapOp op, std::span<const std::byte> content, Findings& warnings);
  void note_crc(std::uint64_t bytes);
  void check_crc(std::span<const std::byte> content, Findings& warnings) const;

  McapCatalog& catalog_;
  std::uint32_t crc_ = 0;
  bool crc_covers_ = false;  // everything so far, and no chunk has one of its own
};

}  // namespace libchar
