#pragma once
// Messages of an MCAP file in the order in which they stand there, and what its summary says of them.

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "libchar/core/warnings.hpp"
#include "libchar/log/ros/chunked_topics.hpp"
#include "libchar/log/ros/file_window.hpp"
#include "libchar/log/ros/mcap_records.hpp"

namespace libchar {

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
std::optional<McapSummary> read_mcap_summary(FileWindow& file, Warnings& warnings);

/// Are the records of an MCAP file to follow? Throws Error(input) where they are not.
void check_mcap_magic(FileWindow& file);

class McapScan final : public MessageScan {
 public:
  McapScan(FileWindow& file, McapCatalog& catalog) : file_(file), catalog_(catalog) {}
  void begin_at(std::uint64_t at) override;
  void stop_behind_chunk() override { single_ = true; }
  void only(std::vector<bool> streams, std::vector<std::uint64_t> skip) override;
  bool next(RawMessage& message, StreamId& channel, Warnings& warnings) override;
  std::uint64_t at() const override { return std::min(at_, file_.size()); }
  /// "" when no chunk was seen; "none", "lz4"…, as far as chunks were seen.
  const std::string& packed_with() const { return packed_with_; }

 private:
  enum class Step { message, other, end };
  Step file_record(RawMessage& message, StreamId& channel, Warnings& warnings);
  bool chunk_record(RawMessage& message, StreamId& channel, Warnings& warnings);
  void enter_chunk(std::uint64_t content_at, std::uint64_t length, Warnings& warnings);
  void unpack_chunk(const McapChunkFront& front,
                    std::span<const std::byte> packed,
                    bool whole,
                    Warnings& warnings);
  Step cut(Warnings& warnings, std::string_view inside);
  bool ends_well();
  bool wanted(std::uint16_t channel) const { return streams_.empty() || streams_[channel]; }
  void note_catalog(McapOp op, std::span<const std::byte> content, Warnings& warnings);
  void note_crc(std::uint64_t bytes);
  void check_crc(std::span<const std::byte> content, Warnings& warnings) const;

  FileWindow& file_;
  McapCatalog& catalog_;
  std::uint64_t at_ = 0;
  std::vector<bool> streams_;
  std::vector<std::uint64_t> skip_;
  bool single_ = false, ended_ = false;
  std::vector<std::byte> unpacked_;
  std::span<const std::byte> chunk_;  // what is left of the chunk that is being read
  std::uint64_t chunk_at_ = 0;
  std::uint32_t crc_ = 0;
  bool crc_covers_ = false;  // everything so far, and no chunk has one of its own
  std::string packed_with_;
};

}  // namespace libchar
