#pragma once
// A small table of texts: a CSV file that people write by hand or in a spreadsheet.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace libchar {

struct TableRow {
  int line = 0;                    ///< in the file, from 1
  std::vector<std::string> cells;  ///< one a head
};

struct TableText {
  std::vector<std::string> heads;
  int head_line = 0;
  std::vector<TableRow> rows;
};

/// Separated by commas, or where the head has none by semicolons, or by tabs; cells may be quoted;
/// empty lines and those that begin with # are left out. Throws Error(input) for a row of another
/// number of cells, a quote that is never closed. Nothing behind `most_rows` rows is looked at.
TableText parse_table_text(std::string_view text,
                           const std::string& path,
                           std::size_t most_rows = SIZE_MAX);

}  // namespace libchar
