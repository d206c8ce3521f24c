#pragma once
// Messages of a bag of ROS 1 in the order in which they stand there, and what its index says of them.
// Source: ROS wiki "Bags/Format/2.0": records of a header (u32 length, then fields u32 length
// "name=value") and data (u32 length).

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/core/warnings.hpp"
#include "libchar/log/ros/chunked_topics.hpp"
#include "libchar/log/ros/file_window.hpp"

namespace libchar {

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

/// Throws Error(input) where the file is no bag that is read: another version, or encrypted.
void check_bag(FileWindow& file);

/// Nothing when there is none (a bag that was not closed), or none that can be relied on.
std::optional<BagIndex> read_bag_index(FileWindow& file);

class BagScan final : public MessageScan {
 public:
  BagScan(FileWindow& file, BagCatalog& catalog)
      : file_(file), catalog_(catalog), end_(file.size()) {}
  /// The messages end here; without it they end with the file, and that is said.
  void end_at(std::uint64_t end) { end_ = end, closed_ = true; }
  void begin_at(std::uint64_t at) override;
  void stop_behind_chunk() override { single_ = true; }
  void only(std::vector<bool> streams, std::vector<std::uint64_t> skip) override;
  bool next(RawMessage& message, StreamId& connection, Warnings& warnings) override;
  std::uint64_t at() const override { return at_; }
  /// "" when no chunk was seen; "none", "lz4"…, as far as chunks were seen.
  const std::string& packed_with() const { return packed_with_; }

 private:
  enum class Step { message, other, end };
  Step file_record(RawMessage& message, StreamId& connection, Warnings& warnings);
  bool chunk_record(RawMessage& message, StreamId& connection, Warnings& warnings);
  void enter_chunk(std::string_view header,
                   std::uint64_t data_at,
                   std::uint64_t length,
                   std::uint64_t here,
                   Warnings& warnings);
  bool take_message(std::string_view header,
                    std::span<const std::byte> data,
                    RawMessage& message,
                    StreamId& connection) const;
  Step cut(Warnings& warnings, std::string_view inside);

  FileWindow& file_;
  BagCatalog& catalog_;
  std::uint64_t at_ = 0, end_ = 0;
  bool closed_ = false, single_ = false, ended_ = false;
  std::vector<bool> streams_;
  std::vector<std::uint64_t> skip_;
  std::vector<std::byte> unpacked_;
  std::span<const std::byte> chunk_;  // what is left of the chunk that is being read
  bool chunk_cut_ = false;            // it ends with the file
  std::uint64_t chunk_at_ = 0;
  std::string packed_with_;
};

}  // namespace libchar
