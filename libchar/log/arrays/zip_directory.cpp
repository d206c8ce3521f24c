#include "libchar/log/arrays/zip_directory.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <optional>

#include "libchar/core/refusal.hpp"
#include "libchar/core/text/text.hpp"

namespace libchar {
namespace {

constexpr std::size_t kEndBytes = 22, kLocatorBytes = 20, kEnd64Bytes = 56, kEntryBytes = 46, kLocalBytes = 30;
constexpr std::uint64_t kMaxMembers = 100000, kMaxDirectoryBytes = 64U << 20U;
constexpr std::size_t kMaxMemberName = 1024;

Refusal zip_refusal(const BinaryFile& file, std::uint64_t byte) {
  return input_error("E0460", fmt::format("{} (byte {})", file.path(), byte)).hint("copy it again, or write it again");
}

Refusal member_refusal(const BinaryFile& file, const std::string& name) {
  return input_error("E0462", fmt::format("{}, {}", file.path(), name));
}

// Little-endian integers of a piece of the file.
class Bytes {
 public:
  Bytes(std::string_view bytes) : bytes_(bytes) {}
  std::uint64_t number(std::size_t at, std::size_t size) const {
    std::uint64_t value = 0;
    for (std::size_t i = size; i-- > 0;) value = value << 8U | static_cast<unsigned char>(bytes_[at + i]);
    return value;
  }
  std::uint64_t u16(std::size_t at) const { return number(at, 2); }
  std::uint64_t u32(std::size_t at) const { return number(at, 4); }
  std::uint64_t u64(std::size_t at) const { return number(at, 8); }

 private:
  std::string_view bytes_;
};

std::string text_at(const BinaryFile& file, std::uint64_t at, std::uint64_t count) {
  std::string text(static_cast<std::size_t>(count), '\0');
  file.read(at, std::as_writable_bytes(std::span(text)));
  return text;
}

struct Directory {
  std::uint64_t first_byte = 0, bytes = 0, members = 0;
};

// The end record stands at the very end, before a comment of at most 65535 bytes.
std::uint64_t find_end(const BinaryFile& file) {
  const std::uint64_t tail = std::min<std::uint64_t>(file.size(), kEndBytes + 65535);
  const std::string text = text_at(file, file.size() - tail, tail);
  for (std::size_t at = text.rfind("PK\x05\x06"); at != std::string::npos;
       at = at == 0 ? std::string::npos : text.rfind("PK\x05\x06", at - 1)) {
    if (at + kEndBytes > text.size()) continue;
    if (Bytes(text).u16(at + 20) == text.size() - at - kEndBytes) return file.size() - tail + at;
  }
  throw zip_refusal(file, file.size()).says("is cut: the directory at the end of the ZIP archive is missing");
}

// Counts above 16 and 32 bits stand in a record of their own (ZIP64), which a locator before the end record points to.
std::optional<Directory> find_directory64(const BinaryFile& file, std::uint64_t end) {
  if (end < kLocatorBytes) return std::nullopt;
  const std::string locator = text_at(file, end - kLocatorBytes, kLocatorBytes);
  if (!locator.starts_with("PK\x06\x07")) return std::nullopt;
  const std::uint64_t at = Bytes(locator).u64(8);
  if (at > end || end - at < kEnd64Bytes)
    throw zip_refusal(file, end - kLocatorBytes).says("points to a directory outside of itself");
  const std::string record = text_at(file, at, kEnd64Bytes);
  if (!record.starts_with("PK\x06\x06")) throw zip_refusal(file, at).says("has a broken end record");
  const Bytes bytes(record);
  return Directory{bytes.u64(48), bytes.u64(40), bytes.u64(32)};
}

Directory find_directory(const BinaryFile& file) {
  if (!file.head(2).starts_with("PK")) throw zip_refusal(file, 0).says("does not begin like a ZIP archive");
  if (file.size() < kEndBytes) throw zip_refusal(file, file.size()).says("is too short for a ZIP archive");
  const std::uint64_t end = find_end(file);
  const std::string record = text_at(file, end, kEndBytes);
  const Bytes bytes(record);
  Directory directory{bytes.u32(16), bytes.u32(12), bytes.u16(10)};
  if (bytes.u16(4) != 0 && bytes.u16(4) != 0xFFFF)
    throw zip_refusal(file, end).says("is one piece of an archive in several");
  if (const auto large = find_directory64(file, end)) directory = *large;
  if (directory.first_byte > end || directory.bytes > end - directory.first_byte)
    throw zip_refusal(file, end).says("has a directory that does not fit into it");
  if (directory.members > kMaxMembers || directory.bytes > kMaxDirectoryBytes)
    throw zip_refusal(file, end).says("has {} members, more than the limit of {}", directory.members, kMaxMembers);
  return directory;
}

// Sizes and offset that do not fit 32 bits stand in the extra field 1, in this order, those only
// that are 0xFFFFFFFF in the entry.
bool widen(const Bytes& extra, std::size_t begin, std::size_t end, std::initializer_list<std::uint64_t*> values) {
  for (std::size_t at = begin; at + 4 <= end;) {
    const std::uint64_t id = extra.u16(at), size = extra.u16(at + 2);
    std::size_t value = at + 4;
    at += 4 + static_cast<std::size_t>(size);
    if (at > end) return false;
    if (id != 1) continue;
    for (std::uint64_t* wide : values) {
      if (*wide != 0xFFFFFFFF) continue;
      if (value + 8 > at) return false;
      *wide = extra.u64(value);
      value += 8;
    }
    return true;
  }
  return std::none_of(values.begin(), values.end(), [](const std::uint64_t* v) { return *v == 0xFFFFFFFF; });
}

Packing packing_of(std::uint64_t method, std::uint64_t flags, std::string& why_not) {
  if ((flags & 1U) != 0) why_not = "is encrypted";
  if (method == 0) return Packing::stored;
  if (method != 8 && why_not.empty())
    why_not = fmt::format("is compressed by method {}; stored and deflate are read", method);
  return Packing::deflate;
}

// The data stand behind the local header, whose extra field has a length of its own.
std::uint64_t data_of(const BinaryFile& file, const ZipMember& member, std::uint64_t local) {
  if (local > file.size() || file.size() - local < kLocalBytes)
    throw zip_refusal(file, local).says("has a member that begins after its end");
  const std::string header = text_at(file, local, kLocalBytes);
  if (!header.starts_with(kLocalMagic))
    throw zip_refusal(file, local).says("has no member {} where its directory says", printable(member.name));
  const std::uint64_t data = local + kLocalBytes + Bytes(header).u16(26) + Bytes(header).u16(28);
  if (data > file.size() || member.stretch.packed_bytes > file.size() - data)
    throw zip_refusal(file, local).says("has a member {} that ends after its end", printable(member.name));
  return data;
}

void check_ratio(const BinaryFile& file, const ZipMember& member) {
  const PackedStretch& s = member.stretch;
  if (s.packing == Packing::stored && s.bytes != s.packed_bytes)
    throw member_refusal(file, member.name).says("is stored in {} bytes and said to have {}", s.packed_bytes, s.bytes);
  if (s.bytes / kDeflateRatio > s.packed_bytes)
    throw member_refusal(file, member.name)
        .says("is said to unpack {} bytes into {}: deflate reaches a ratio of {} at most", s.packed_bytes, s.bytes,
              kDeflateRatio);
}

ZipMember read_entry(const BinaryFile& file, std::string_view text, std::size_t at, std::uint64_t byte,
                     std::size_t* end) {
  const Bytes bytes(text);
  if (at + kEntryBytes > text.size() || text.substr(at, 4) != "PK\x01\x02")
    throw zip_refusal(file, byte + at).says("has a broken directory");
  const std::uint64_t name_bytes = bytes.u16(at + 28), extra_bytes = bytes.u16(at + 30);
  const std::size_t name_at = at + kEntryBytes, extra_at = name_at + static_cast<std::size_t>(name_bytes),
                    extra_end = extra_at + static_cast<std::size_t>(extra_bytes);
  *end = extra_end + static_cast<std::size_t>(bytes.u16(at + 32));
  if (*end > text.size()) throw zip_refusal(file, byte + at).says("has a broken directory");
  if (name_bytes > kMaxMemberName)
    throw zip_refusal(file, byte + at).says("has a name of more than {} bytes", kMaxMemberName);
  ZipMember member;
  member.name = std::string(text.substr(name_at, static_cast<std::size_t>(name_bytes)));
  member.crc = static_cast<std::uint32_t>(bytes.u32(at + 16));
  member.stretch.packed_bytes = bytes.u32(at + 20);
  member.stretch.bytes = bytes.u32(at + 24);
  std::uint64_t local = bytes.u32(at + 42);
  if (!widen(bytes, extra_at, extra_end, {&member.stretch.bytes, &member.stretch.packed_bytes, &local}))
    throw zip_refusal(file, byte + at).says("has a member whose size is not said");
  member.stretch.packing = packing_of(bytes.u16(at + 10), bytes.u16(at + 8), member.why_not);
  member.stretch.first_byte = data_of(file, member, local);
  if (member.why_not.empty()) check_ratio(file, member);
  return member;
}

// Members that share their bytes are how a small file unpacks into a great one.
void refuse_overlap(const BinaryFile& file, const std::vector<ZipMember>& members) {
  std::vector<const ZipMember*> sorted;
  for (const ZipMember& member : members)
    if (member.stretch.packed_bytes > 0) sorted.push_back(&member);
  std::sort(sorted.begin(), sorted.end(),
            [](const ZipMember* a, const ZipMember* b) { return a->stretch.first_byte < b->stretch.first_byte; });
  for (std::size_t i = 1; i < sorted.size(); ++i)
    if (sorted[i - 1]->stretch.first_byte + sorted[i - 1]->stretch.packed_bytes > sorted[i]->stretch.first_byte)
      throw member_refusal(file, sorted[i]->name).says("overlaps another member of the archive");
}

}  // namespace

std::vector<ZipMember> read_zip_directory(const BinaryFile& file) {
  const Directory directory = find_directory(file);
  const std::string text = text_at(file, directory.first_byte, directory.bytes);
  std::vector<ZipMember> members;
  std::size_t at = 0;
  for (std::uint64_t i = 0; i < directory.members; ++i)
    members.push_back(read_entry(file, text, at, directory.first_byte, &at));
  refuse_overlap(file, members);
  return members;
}

}  // namespace libchar
