#include "libchar/report/detail/npz_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <limits>

#include "libchar/core/crc32.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/text.hpp"
#include "libchar/core/utf8.hpp"

namespace libchar {
namespace {

static_assert(std::endian::native == std::endian::little,
              "arrays are written as they are in memory");

constexpr std::size_t kNpyBlock = 64;
constexpr std::size_t kPieceOfTexts = std::size_t{1} << 16U;
/// Without extensions an archive's sizes and places have 32 bits.
constexpr std::uint64_t kMostBytes = std::numeric_limits<std::uint32_t>::max();

void append(std::string& to, std::uint64_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) to += static_cast<char>((value >> (8 * i)) & 0xFFU);
}

/// What local and central headers have in common: version 2.0, UTF-8 name, stored, 1980-01-01, checksum, sizes, length of the name.
void append_member(std::string& to, std::uint32_t crc, std::uint32_t bytes, std::size_t name) {
  append(to, 20, 2);
  append(to, 0x0800, 2);
  append(to, 0, 2);
  append(to, 0, 2);
  append(to, 0x0021, 2);
  append(to, crc, 4);
  append(to, bytes, 4);
  append(to, bytes, 4);
  append(to, name, 2);
  append(to, 0, 2);
}

std::string npy_header(const std::string& type, std::size_t count) {
  std::string text =
      fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({},), }}", type, count);
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
  const std::string valid =
      first_invalid_utf8(text) == std::string_view::npos ? text : printable(text);
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
  if (written_ > kMostBytes)
    throw Error(
        {ErrorKind::output,
         "E0754",
         "",
         "a table of arrays (.npz) would be larger than 4 GiB, which its format does not hold",
         "",
         "write the fleet in parts, or take the CSV"});
  take_(bytes);
}

void NpzWriter::add_array(const std::string& name,
                          const std::string& type,
                          std::size_t count,
                          std::uint64_t bytes_of_data,
                          const GiveData& give) {
  const std::string file = name + ".npy", header = npy_header(type, count);
  const std::uint64_t bytes = header.size() + bytes_of_data;
  std::uint32_t crc = crc32_of(as_span(header));
  give([&](std::string_view piece) { crc = crc32_of(as_span(piece), crc); });
  Member member{file,
                crc,
                static_cast<std::uint32_t>(std::min(bytes, kMostBytes)),
                static_cast<std::uint32_t>(written_)};
  std::string local = "PK\x03\x04";
  append_member(local, member.crc, member.bytes, file.size());
  put(local + file);
  put(header);
  give([&](std::string_view piece) { put(piece); });
  members_.push_back(std::move(member));
}

void NpzWriter::add_bytes(const std::string& name,
                          const std::string& type,
                          std::size_t count,
                          std::string_view data) {
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

void NpzWriter::add(const std::string& name,
                    std::size_t count,
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
    std::string entry = "PK\x01\x02";
    append(entry, 20, 2);
    append_member(entry, member.crc, member.bytes, member.name.size());
    append(entry, 0, 2);  // comment
    append(entry, 0, 2);  // disk
    append(entry, 0, 2);  // attributes
    append(entry, 0, 4);
    append(entry, member.at, 4);
    put(entry + member.name);
  }
  const std::uint64_t size = written_ - at;
  std::string end("PK\x05\x06", 4);
  append(end, 0, 4);
  append(end, members_.size(), 2);
  append(end, members_.size(), 2);
  append(end, size, 4);
  append(end, at, 4);
  append(end, 0, 2);
  put(end);
}

}  // namespace libchar
