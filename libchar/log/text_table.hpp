#pragma once
// A small CSV table whose header names its columns and whose cells may be text: curves and figures that other programs
// wrote. Delimiter, decimal mark, line ends, quotes and comments are those of logs (docs/formats.md).

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace libchar {

struct TextCell {
  std::string text;          ///< without quotes and outer blanks
  std::uint64_t column = 1;  ///< of its first byte in its line
};

struct TextRow {
  std::uint64_t line = 1;
  std::vector<TextCell> cells;
};

struct TextTable {
  TextRow header;             ///< no cells when the file holds nothing but blanks and comments
  std::vector<TextRow> rows;  ///< as long as they are; nothing is known yet of their widths
  char decimal = '.';
  std::uint64_t bytes = 0;
  std::string sha256;
};

/// Reads a table of at most `max_bytes`; nothing for a larger file. Throws Error(input) when the file cannot be opened.
std::optional<TextTable> read_text_table(const std::string& path, std::size_t max_bytes);

namespace detail {
/// The header alone, of a file of any size; no cells if there is none. Throws Error(input) when the file cannot be
/// opened.
TextRow header_of_text_table(const std::string& path);
}  // namespace detail

/// The finite number in a cell of a table with this decimal mark; nothing when there is none.
std::optional<double> number_in(const TextCell& cell, char decimal);

}  // namespace libchar
