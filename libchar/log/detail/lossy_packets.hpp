#pragma once
// Packets of one stamp that lost some of their rows on the way: whole ones say the rate, and what the others lack is
// missing.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace libchar {

struct LossyPackets {
  double apart_ns = 0;    ///< from packet to packet
  std::size_t rows = 0;   ///< of a whole one
  std::size_t first = 0;  ///< rows of the first one
  bool sure = false;      ///< numbers of rows are those of losses at random, and none that beat with a clock
  bool likely = false;    ///< most packets are whole
  double interval_ns() const { return apart_ns / static_cast<double>(rows); }
};

/// Of the first stamps of a log; nothing where packets do not come evenly, or all have as many rows.
std::optional<LossyPackets> find_lossy_packets(const std::vector<std::int64_t>& stamps);

/// Gives rows of one stamp an instant each, from the packet's on: what a packet lacks is taken to be its last rows.
class PacketRows {
 public:
  PacketRows() = default;
  explicit PacketRows(const LossyPackets& packets) : packets_(packets), row_(packets.rows - packets.first) {}
  bool any() const { return packets_.rows > 0; }
  /// Replaces the stamps from `from` on.
  void spread(std::vector<std::int64_t>& stamps, std::size_t from);

 private:
  void next_packet(std::int64_t stamp);

  LossyPackets packets_;
  std::size_t row_ = 0;  // of its packet, the next one
  bool begun_ = false;
  std::int64_t stamp_ = 0;  // of the packet
  std::int64_t begin_ = 0;  // the same without the jitter of the way
};

}  // namespace libchar
