#include "libchar/report/detail/npz_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "libchar/core/file/crc32.hpp"
#include "libchar/core/text/text.hpp"

namespace libchar {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays are written as they are in memory");

constexpr std::size_t kNpyBlock = 64;
constexpr std::size_t kPieceOfTexts = std::size_t{1} << 16U;
/// Sizes and places have 32 bits; what they do not hold stands in an extension (ZIP64, APPNOTE 4.5.3), and this in its
/// stead.
constexpr std::uint64_t kInExtension = std::numeric_limits<std::uint32_t>::max();
constexpr std::uint64_t kVersion = 20, kWideVersion = 45, kWideExtension = 1, kExtensionHead = 4;

void append(std::string& to, std::uint64_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) to += static_cast<char>((value >> (8 * i)) & 0xFFU);
}

/// What local and central headers have in common: version, UTF-8 name, stored, 1980-01-01, checksum, sizes, lengths of
/// name and extension.
void append_member(std::string& to, std::uint32_t crc, std::uint64_t bytes, std::size_t name, std::size_t extension,
                   bool large, bool far = false) {
  append(to, large || far ? kWideVersion : kVersion, 2);
  append(to, 0x0800, 2);
  append(to, 0, 2);
  append(to, 0, 2);
  append(to, 0x0021, 2);
  append(to, crc, 4);
  append(to, large ? kInExtension : bytes, 4);
  append(to, large ? kInExtension : bytes, 4);
  append(to, name, 2);
  append(to, extension == 0 ? 0 : kExtensionHead + extension, 2);
}

/// Both sizes of a stored member.
std::string wide_sizes(std::uint64_t bytes) {
  std::string out;
  append(out, bytes, 8);
  append(out, bytes, 8);
  return out;
}

std::string as_extension(const std::string& values) {
  std::string out;
  if (values.empty()) return out;
  append(out, kWideExtension, 2);
  append(out, values.size(), 2);
  return out + values;
}

std::string npy_header(const std::string& type, std::size_t count) {
  std::string text = fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({},), }}", type, count);
  const std::size_t total = (10 + text.size() + 1 + kNpyBlock - 1) / kNpyBlock * kNpyBlock;
  text.resize(total - 11, ' ');
  text += '\n';
  std::string out("\x93NUMPY\x01\x00", 8);
  append(out, text.size(), 2);
  return out + text;
}

template <class T>
std::string_view bytes_of(std::span<const T> values) {
  return {reinterpret_cast<const char*>(values.data()), values.size_bytes()};
}

std::span<const std::byte> as_span(std::string_view bytes) {
  return std::as_bytes(std::span(bytes.data(), bytes.size()));
}

std::u32string wide_text(const std::string& text) {
  const std::string valid = first_invalid_utf8(text) == std::string_view::npos ? text : printable(text);
  std::u32string out;
  for (std::size_t i = 0; i < valid.size();) {
    std::uint32_t code = 0;
    const std::size_t length = decode_utf8(valid, i, code);
    out += static_cast<char32_t>(code);
    i += std::max<std::size_t>(length, 1);
  }
  return out;
}

}  // namespace

void NpzWriter::put(std::string_view bytes) {
  written_ += bytes.size();
  take_(bytes);
}

void NpzWriter::add_array(const std::string& name, const std::string& type, std::size_t count,
                          std::uint64_t bytes_of_data, const GiveData& give) {
  const std::string file = name + ".npy", header = npy_header(type, count);
  const std::uint64_t bytes = header.size() + bytes_of_data;
  std::uint32_t crc = crc32_of(as_span(header));
  give([&](std::string_view piece) { crc = crc32_of(as_span(piece), crc); });
  Member member{file, crc, bytes, written_};
  const bool large = bytes >= wide_from_;
  const std::string extension = large ? wide_sizes(bytes) : "";
  std::string local = "PK\x03\x04";
  append_member(local, crc, bytes, file.size(), extension.size(), large);
  put(local + file + as_extension(extension));
  put(header);
  give([&](std::string_view piece) { put(piece); });
  members_.push_back(std::move(member));
}

void NpzWriter::add_bytes(const std::string& name, const std::string& type, std::size_t count, std::string_view data) {
  add_array(name, type, count, data.size(), [&](const auto& take) { take(data); });
}

void NpzWriter::add(const std::string& name, std::span<const double> values) {
  add_bytes(name, "<f8", values.size(), bytes_of(values));
}

void NpzWriter::add(const std::string& name, std::span<const std::uint64_t> values) {
  add_bytes(name, "<u8", values.size(), bytes_of(values));
}

void NpzWriter::add(const std::string& name, std::span<const std::uint8_t> values) {
  add_bytes(name, "|u1", values.size(), bytes_of(values));
}

void NpzWriter::add(const std::string& name, std::size_t count,
                    const std::function<const std::string&(std::size_t)>& text) {
  std::size_t width = 1;
  for (std::size_t i = 0; i < count; ++i) width = std::max(width, wide_text(text(i)).size());
  add_array(name, fmt::format("<U{}", width), count, 4 * width * count, [&](const auto& take) {
    std::string piece;
    for (std::size_t i = 0; i < count; ++i) {
      const std::u32string wide = wide_text(text(i));
      piece.append(reinterpret_cast<const char*>(wide.data()), 4 * wide.size());
      piece.append(4 * (width - wide.size()), '\0');
      if (piece.size() < kPieceOfTexts && i + 1 < count) continue;
      take(piece);
      piece.clear();
    }
  });
}

void NpzWriter::finish() {
  const std::uint64_t at = written_;
  for (const Member& member : members_) {
    const bool large = member.bytes >= wide_from_, far = member.at >= wide_from_;
    std::string extension;
    if (large) extension = wide_sizes(member.bytes);
    if (far) append(extension, member.at, 8);
    std::string entry = "PK\x01\x02";
    append(entry, large || far ? kWideVersion : kVersion, 2);
    append_member(entry, member.crc, member.bytes, member.name.size(), extension.size(), large, far);
    append(entry, 0, 2);  // comment
    append(entry, 0, 2);  // disk
    append(entry, 0, 2);  // attributes
    append(entry, 0, 4);
    append(entry, far ? kInExtension : member.at, 4);
    put(entry + member.name + as_extension(extension));
  }
  finish_directory(at, written_ - at);
}

/// The place of the directory, and in front of it, where that is too far, a record that has room for it, and the place
/// of that.
void NpzWriter::finish_directory(std::uint64_t at, std::uint64_t size) {
  const bool far = at >= wide_from_ || size >= wide_from_;
  if (far) {
    constexpr std::uint64_t kBehindSize = 44;  // bytes of the record
    const std::uint64_t record_at = written_;
    std::string record("PK\x06\x06", 4);
    append(record, kBehindSize, 8);
    append(record, kWideVersion, 2);
    append(record, kWideVersion, 2);
    append(record, 0, 8);  // disks
    append(record, members_.size(), 8);
    append(record, members_.size(), 8);
    append(record, size, 8);
    append(record, at, 8);
    record.append("PK\x06\x07", 4);
    append(record, 0, 4);  // disk
    append(record, record_at, 8);
    append(record, 1, 4);  // disks in all
    put(record);
  }
  std::string end("PK\x05\x06", 4);
  append(end, 0, 4);
  append(end, members_.size(), 2);
  append(end, members_.size(), 2);
  append(end, far ? kInExtension : size, 4);
  append(end, far ? kInExtension : at, 4);
  append(end, 0, 2);
  put(end);
}

}  // namespace libchar
