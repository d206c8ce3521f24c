#pragma once
// The messages of a DataFlash log one after the other, and what to do where bytes are damaged or missing.

#include <cstdint>
#include <span>

#include "libchar/core/warnings.hpp"
#include "libchar/log/binary/window.hpp"
#include "libchar/log/flight/dataflash_format.hpp"

namespace libchar {

struct DataflashMessage {
  std::uint64_t byte = 0;  ///< where it begins
  std::uint8_t type = 0;
  std::span<const std::byte> body;  ///< behind its front; valid until the next message is asked for
};

/// Where the fill at the end of a log begins: pages of flash that were not written are 0xff or 0.
std::uint64_t dataflash_fill(const BinaryFile& file);

class DataflashWalk {
 public:
  /// `formats` is looked at while messages are read: lengths are added as definitions come. Damage
  /// is counted in `losses`.
  DataflashWalk(const BinaryFile& file,
                std::size_t block_bytes,
                const DataflashFormats& formats,
                Warnings& losses);

  bool next(DataflashMessage& message);
  std::uint64_t position() const { return position_; }

 private:
  bool is_front(std::uint64_t byte);
  std::size_t whole_length(std::uint64_t byte);
  bool cut_by_end(std::uint64_t byte);
  bool well_followed(std::uint64_t byte);
  std::uint64_t next_good(std::uint64_t byte);
  void pass_over_damage();

  FileWindow window_;
  std::uint64_t position_ = 0, end_ = 0, fill_ = 0;
  const DataflashFormats* formats_;
  Warnings* losses_;
};

}  // namespace libchar
