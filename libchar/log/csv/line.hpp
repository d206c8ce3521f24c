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

inline constexpr std::size_t kMaxField = std::size_t{1} << 17U;  // 128 KiB

enum class LineEnd : std::uint8_t { none, lf, crlf, cr };

struct Line {
  std::string_view text;
  std::size_t offset = 0;    ///< in the head
  std::uint64_t number = 1;  ///< physical line
  std::size_t after = 0;     ///< offset behind its line end
  std::uint64_t lines = 1;   ///< physical lines it spans (quoted cells may hold newlines)
  LineEnd end = LineEnd::none;
};

/// Where the row that begins at `from` ends: the first line end outside quoted cells, else the end
/// of the text. `open` is set where a quoted cell may close in what follows the text; one that does
/// not within 128 KiB is no quoted cell. `delimiter` 0: not known.
std::size_t row_end(std::string_view text, std::size_t from, char delimiter = 0, bool* open = nullptr);

/// The row at `offset`, without its line end. One that reaches the end of a head that is not the whole file is cut.
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

/// Cell `column` of a line, without splitting the others where it can be; nothing when the line has fewer.
std::optional<Field> cell_at(std::string_view line, std::size_t column, char delimiter);

inline constexpr std::string_view kDivided = " ,";

/// The stamp in front of a line of a terminal or a logger, up to `lead`: "[2024-05-01 12:00:00.123] 1,2" and
/// "[   12.345678] 1,2" ("]"), "12:00:00.123 -> 1,2" ("->"), "I (12345) tag: 1,2" (")"), "2024-05-01 12:00:00,123
/// INFO:1,2" (","), "2024-05-01 12:00:00.123 INFO imu: x=1, y=2" ("=", up to the first name), "May 01 12:00:00 host:
/// 1,2" (" ", among words; kDivided where one comma divides two whole numbers and makes no decimal one of them);
/// nothing when the line has none. `after` is where the cells begin.
std::optional<Field> lead_of(std::string_view line, std::string_view lead, std::size_t& after);

/// "---- --", "+-----+----+", "|---|:--|": a line that is drawn between names and rows.
bool is_ruler(std::string_view line);

/// Is this line such, or does it start with a comment sign (#, %, //, where `semicolons` ;)?
bool is_comment(std::string_view line, bool semicolons = false);

/// "FILE:LINE:COL (byte N)".
std::string at(const std::string& file, std::uint64_t line, std::uint64_t column, std::uint64_t byte);

}  // namespace libchar::csv
