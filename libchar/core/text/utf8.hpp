#pragma once
// Characters of UTF-8, and what is not.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace libchar {

/// Position of the first byte that is not valid UTF-8, or npos.
std::size_t first_invalid_utf8(std::string_view text);

/// Each byte of ISO 8859-1 as the character that it is.
std::string latin1_to_utf8(std::string_view text);

/// Text of Windows-1252, which is ISO 8859-1 with more quotes, dashes and the euro sign; nothing when a byte means none of its
/// characters.
std::optional<std::string> windows1252_to_utf8(std::string_view text);

/// Length of the valid UTF-8 sequence that starts at text[i], 0 when there is none; `code` receives the code point.
std::size_t decode_utf8(std::string_view text, std::size_t i, std::uint32_t& code);

/// Adds the character `code`, below 0x10000.
void append_utf8(std::string& text, std::uint32_t code);

}  // namespace libchar
