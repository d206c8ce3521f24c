#pragma once
// The bytes of a member of a ZIP archive in their order.

#include <algorithm>
#include <string>

#include "libchar/core/refusal.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/arrays/zip_directory.hpp"
#include "libchar/log/csv/unpacker.hpp"

namespace libchar {

class MemberText {
 public:
  /// The file outlives this.
  MemberText(const BinaryFile& file, const ZipMember& member)
      : bytes_(file, member.stretch, printable(member.name)),
        where_(file.path() + ", " + printable(member.name)),
        left_(member.stretch.bytes),
        crc_(member.crc) {
    if (!member.why_not.empty()) throw input_error("E0462", where_).says(member.why_not);
    if (csv::is_bomb(left_, member.stretch.packed_bytes, csv::kMostPacked))
      throw input_error("E0462", where_)
          .says("unpacks to more than {} times its size", csv::kMostPacked)
          .hint("unpack it");
  }
  /// Up to n of them, 0 at the end, where the checksum has to be right.
  std::size_t read(char* to, std::size_t n) {
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(n, left_));
    if (count == 0) return 0;
    bytes_.read(std::as_writable_bytes(std::span(to, count)));
    left_ -= count;
    if (left_ == 0 && bytes_.crc() != crc_)
      throw input_error("E0462", where_).says("does not match its checksum").hint("copy the file again");
    return count;
  }

 private:
  PackedBytes bytes_;
  std::string where_;
  std::uint64_t left_;
  std::uint32_t crc_;
};

}  // namespace libchar
