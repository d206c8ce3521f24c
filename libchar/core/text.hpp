#pragma once
// Text at the borders: escaping of untrusted strings, numbers that read back to the same double,
// spelling help.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace libchar {

/// The text with C0, DEL, C1, bidirectional and zero-width controls and invalid UTF-8 written as
/// \xHH or \u{HHHH}, and cut to `limit` characters with "…" behind (0 = no limit). Safe for a
/// terminal and for one line.
std::string printable(std::string_view text, std::size_t limit = 0);

/// Shortest decimal that reads back to the same double ("0.1", "1e-05", "nan", "inf").
std::string shortest(double value);

/// As `shortest`, with a decimal point always present ("200.0", "1.0e-05"): YAML 1.1 readers take
/// "1e-05" for a string.
std::string shortest_yaml(double value);

/// A double-quoted YAML scalar that reads back to the same text: quotes, backslashes and what is not
/// printable are escaped. Bytes that are no UTF-8 cannot stand in YAML: they become \\xHH to read.
std::string quoted_yaml(std::string_view text);

/// `digits` significant digits ("0.0123", "1.23e-05").
std::string significant(double value, int digits);

/// The candidate nearest to `word` by edit distance, if it is near enough to be a slip (distance <=
/// 2, or <= a third of the word's length).
std::optional<std::string> nearest(std::string_view word,
                                   const std::vector<std::string>& candidates);

/// Number of single-character edits (insert, delete, replace, swap of neighbours) between two
/// words.
std::size_t edit_distance(std::string_view a, std::string_view b);

/// The whole text as one finite double (std::from_chars rules: no leading '+' or blanks, no
/// locale), else nothing.
std::optional<double> parse_double(std::string_view text);

/// Capitals A to Z made small, everything else as it is.
std::string ascii_lower(std::string_view text);

/// Position of the first byte that is not valid UTF-8, or npos.
std::size_t first_invalid_utf8(std::string_view text);

/// Each byte of ISO 8859-1 as the character that it is.
std::string latin1_to_utf8(std::string_view text);

/// Length of the valid UTF-8 sequence that starts at text[i], 0 when there is none; `code` receives
/// the code point.
std::size_t decode_utf8(std::string_view text, std::size_t i, std::uint32_t& code);

}  // namespace libchar
