#pragma once
// Lines and cells of a CSV file as text.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/log/detail/column_name.hpp"

namespace libchar::csv {

enum class LineEnd : std::uint8_t { none, lf, crlf, cr };

struct Line {
  std::string_view text;
  std::size_t offset = 0;    ///< in the head
  std::uint64_t number = 1;  ///< physical line
  std::size_t after = 0;     ///< offset behind its line end
  std::uint64_t lines = 1;   ///< physical lines it spans (a quoted header may hold newlines)
  LineEnd end = LineEnd::none;
};

/// The physical line at `offset`. A line that reaches the end of a head that is not the whole file
/// is cut.
Line line_at(std::string_view head, std::size_t offset, std::uint64_t number);

/// One cell of a line: its text without quotes and outer blanks, and where it begins in the line.
struct Field {
  std::string text;
  std::size_t offset = 0;  ///< of its first byte (of the opening quote)
  bool quoted = false;
};

/// Splits one line (without its line end). Throws nothing: an open quote takes the rest of the line
/// (`open_quote` is set).
std::vector<Field> split(std::string_view line, char delimiter, bool* open_quote = nullptr);

/// The stamp in front of a line of a terminal, "[2024-05-01 12:00:00.123] 1,2" or "12:00:00.123 -> 1,2", up to `lead`, "]" or
/// "->"; nothing when the line has none. `after` is where the cells begin.
std::optional<Field> lead_of(std::string_view line, std::string_view lead, std::size_t& after);

/// Does this line start with a comment sign (#, %, //)?
bool is_comment(std::string_view line);

/// "FILE:LINE:COL (byte N)".
std::string at(const std::string& file,
               std::uint64_t line,
               std::uint64_t column,
               std::uint64_t byte);

}  // namespace libchar::csv
