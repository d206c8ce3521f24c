#pragma once
// Text at the borders: untrusted strings made safe for a terminal and for YAML.

#include <cstdint>
#include <string>
#include <string_view>

namespace libchar {

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
