#pragma once
// Text at the borders: untrusted strings made safe for a terminal and for YAML.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace libchar {

// Characters of UTF-8, and what is not.

/// Position of the first byte that is not valid UTF-8, or npos.
std::size_t first_invalid_utf8(std::string_view text);

/// Each byte of ISO 8859-1 as the character that it is.
std::string latin1_to_utf8(std::string_view text);

/// Text of Windows-1252, which is ISO 8859-1 with more quotes, dashes and the euro sign; nothing when a byte means none
/// of its characters.
std::optional<std::string> windows1252_to_utf8(std::string_view text);

/// Length of the valid UTF-8 sequence that starts at text[i], 0 when there is none; `code` receives the code point.
std::size_t decode_utf8(std::string_view text, std::size_t i, std::uint32_t& code);

/// Adds the character `code`, below 0x10000.
void append_utf8(std::string& text, std::uint32_t code);

/// The text with C0, DEL, C1, bidirectional and zero-width controls and invalid UTF-8 written as
/// \xHH or \u{HHHH}, and cut to `limit` characters with "…" behind (0 = no limit). Safe for a
/// terminal and for one line.
std::string printable(std::string_view text, std::size_t limit = 0);

/// A double-quoted YAML scalar that reads back to the same text: quotes, backslashes and what is not
/// printable are escaped. Bytes other than UTF-8 are not allowed in YAML: they become \\xHH to read.
std::string quoted_yaml(std::string_view text);

/// Capitals A to Z made small, everything else as it is.
std::string ascii_lower(std::string_view text);

/// "1 sample", "2 samples".
std::string plural(std::uint64_t n, std::string_view noun);

/// A word quoted for a POSIX shell where it has to be.
std::string shell_word(std::string_view word);

}  // namespace libchar
