#include "libchar/core/file/file_name.hpp"

#include "libchar/core/text/utf8.hpp"

namespace libchar {
namespace {

constexpr std::size_t kLongest = 100;  // bytes; file systems take 255, and suffixes follow

bool plain_ascii(std::uint32_t c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' ||
         c == '_' || c == '-';
}

// What beyond ASCII is no letter, digit or sign with a shape of its own: controls, blanks, invisible and private characters.
bool unusual(std::uint32_t c) {
  return c <= 0xA0 || c == 0xAD || c == 0x061C || c == 0x1680 || c == 0x180E ||
         (c >= 0x2000 && c <= 0x206F) || c == 0x3000 || (c >= 0xE000 && c <= 0xF8FF) ||
         c == 0xFEFF || (c >= 0xFFF0 && c <= 0xFFFF) || c >= 0xE0000;
}

// Small letters for capitals of the scripts that have them in pairs: Latin, Greek, Cyrillic.
std::uint32_t small(std::uint32_t c) {
  if ((c >= 'A' && c <= 'Z') || (c >= 0xC0 && c <= 0xDE && c != 0xD7) ||
      (c >= 0x391 && c <= 0x3A9) || (c >= 0x410 && c <= 0x42F))
    return c + 0x20;
  if (c >= 0x400 && c <= 0x40F) return c + 0x50;
  const bool even_capitals = (c >= 0x100 && c <= 0x137) || (c >= 0x14A && c <= 0x177);
  const bool odd_capitals = (c >= 0x139 && c <= 0x148) || (c >= 0x179 && c <= 0x17E);
  return (even_capitals && c % 2 == 0) || (odd_capitals && c % 2 == 1) ? c + 1 : c;
}

std::string folded(std::string_view name) {
  std::string out;
  for (std::size_t i = 0; i < name.size();) {
    std::uint32_t code = 0;
    const std::size_t length = decode_utf8(name, i, code);
    if (length > 0 && code < 0x800)
      append_utf8(out, small(code));
    else
      out.append(name.substr(i, length > 0 ? length : 1));
    i += length > 0 ? length : 1;
  }
  return out;
}

// At most `bytes` of a text, whole characters only.
std::string_view cut(std::string_view text, std::size_t bytes) {
  if (text.size() <= bytes) return text;
  while (bytes > 0 && (static_cast<unsigned char>(text[bytes]) & 0xC0U) == 0x80U) --bytes;
  return text.substr(0, bytes);
}

}  // namespace

std::string file_name_for(std::string_view channel) {
  std::string name;
  for (std::size_t i = 0; i < channel.size() && name.size() <= kLongest;) {
    std::uint32_t code = 0;
    const std::size_t length = decode_utf8(channel, i, code);
    if (length > 0 && (code < 0x80 ? plain_ascii(code) : !unusual(code)))
      name.append(channel.substr(i, length));
    else
      name += '_';
    i += length > 0 ? length : 1;
  }
  if (name.empty() || name[0] == '.') name.insert(0, "_");
  return std::string(cut(name, kLongest));
}

std::string unused_file_name_for(std::string_view channel, std::set<std::string>& taken) {
  const std::string stem = file_name_for(channel);
  std::string name = stem;
  for (int again = 2; !taken.insert(folded(name)).second; ++again) {
    const std::string suffix = "_" + std::to_string(again);
    name = std::string(cut(stem, kLongest - suffix.size())) + suffix;
  }
  return name;
}

}  // namespace libchar
