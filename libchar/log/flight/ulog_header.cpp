#include "libchar/log/flight/ulog_header.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "libchar/core/error.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/binary/wrong_start.hpp"

namespace libchar {
namespace {

constexpr std::string_view kUlogMagic = "ULog\x01\x12\x35";
constexpr std::string_view kUlogEncrypted = "ULogEnc";
constexpr std::size_t kFlagBytes = 40;  // 8 that may be ignored, 8 that may not, 3 offsets

[[noreturn]] void refuse(const char* code, std::string where, std::string what, std::string hint) {
  throw Error({ErrorKind::input, code, std::move(where), std::move(what), "", std::move(hint)});
}

// Bits that change how the file has to be read: only "data were appended" is known.
void refuse_unknown_flags(std::span<const std::byte> flags, const std::string& path) {
  for (std::size_t i = 0; i < flags.size(); ++i) {
    const auto bits = std::to_integer<unsigned>(flags[i]) & (i == 0 ? 0xfeU : 0xffU);
    if (bits == 0) continue;
    refuse("E0482",
           fmt::format("{} (byte {}, field incompat_flags)", path, kUlogHeader + 3 + 8 + i),
           fmt::format(
               "needs a later reader: bits 0x{:02x} of the flags that may not be ignored are set",
               bits),
           "convert it with PX4's own tools");
  }
}

void split_at_appended(std::span<const std::byte> offsets,
                       const BinaryFile& file,
                       UlogHeader& header,
                       Warnings& warnings) {
  for (std::size_t i = 0; i < 3; ++i) {
    const std::uint64_t offset = little_endian<8>(offsets.data() + 8 * i);
    if (offset == 0) return;
    UlogStretch& last = header.stretches.back();
    if (offset <= last.first || offset >= file.size()) {
      warnings.add(
          "appended_lost",
          fmt::format("data were appended at byte {}, which the file does not hold", offset));
      return;
    }
    last.end = offset;
    header.stretches.push_back({offset, file.size()});
  }
}

}  // namespace

bool is_ulog(std::string_view first_bytes) {
  return first_bytes.starts_with(kUlogMagic) || first_bytes.starts_with(kUlogEncrypted);
}

UlogHeader read_ulog_header(const BinaryFile& file, Warnings& warnings) {
  const std::string head = file.head(kUlogHeader + 3 + kFlagBytes);
  const std::string& path = file.path();
  if (head.starts_with(kUlogEncrypted))
    refuse("E0481",
           path,
           "is an encrypted ULog",
           "decrypt it first, with PX4's Tools/decrypt_ulog.py");
  if (!head.starts_with(kUlogMagic))
    refuse("E0480", path, wrong_start(head, kUlogMagic, "a ULog"), "");
  if (head.size() < kUlogHeader)
    refuse("E0480",
           fmt::format("{} (byte {})", path, head.size()),
           fmt::format("is cut inside the {} bytes of its header", kUlogHeader),
           "");
  UlogHeader header;
  header.version = static_cast<unsigned char>(head[7]);
  header.stretches = {{kUlogHeader, file.size()}};
  const auto bytes = std::as_bytes(std::span(head)).subspan(kUlogHeader);
  const bool flags = bytes.size() == 3 + kFlagBytes && static_cast<char>(bytes[2]) == 'B' &&
                     little_endian<2>(bytes.data()) >= kFlagBytes;
  if (!flags) return header;
  refuse_unknown_flags(bytes.subspan(3 + 8, 8), path);
  if ((std::to_integer<unsigned>(bytes[3 + 8]) & 1U) != 0)
    split_at_appended(bytes.subspan(3 + 16), file, header, warnings);
  return header;
}

UlogInfo read_ulog_info(std::span<const std::byte> body) {
  if (body.empty()) return {};
  const auto length = std::to_integer<std::size_t>(body[0]);
  if (1 + length > body.size()) return {};
  const auto text = [&](std::size_t from, std::size_t count) {
    return std::string(reinterpret_cast<const char*>(body.data()) + from, count);
  };
  const std::string key = text(1, length);
  const std::size_t blank = key.find(' ');
  if (blank == std::string::npos) return {};
  UlogInfo info;
  info.key = key.substr(blank + 1);
  const std::size_t value = 1 + length;
  if (key.starts_with("char[")) {
    info.value = text(value, std::min<std::size_t>(body.size() - value, 64));
  } else if (key.starts_with("uint32_t ") && body.size() - value == 4) {
    const auto number = static_cast<std::uint32_t>(little_endian<4>(body.data() + value));
    info.value = fmt::format("v{}.{}.{}", number >> 24U, number >> 16U & 255U, number >> 8U & 255U);
    const std::uint32_t kind = number & 255U;
    if (kind < 255)
      info.value += kind >= 192   ? " (RC)"
                    : kind >= 128 ? " (beta)"
                    : kind >= 64  ? " (alpha)"
                                  : " (development)";
  }
  return info;
}

}  // namespace libchar
