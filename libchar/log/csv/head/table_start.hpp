#pragma once
// Where in the first lines of a file its table begins: what stands in front, the line of names, the line of units, the rows.

#include <cstddef>
#include <optional>
#include <vector>

#include "libchar/log/csv/head/columns.hpp"

namespace libchar::csv {

struct TableStart {
  std::size_t data = 0;              ///< index of the first row of numbers
  std::optional<std::size_t> names;  ///< of the line of names
  std::optional<std::size_t> units;  ///< of a line of units below it
};

/// `lines` are the cells of the first lines, an empty cell behind a delimiter at the end of a line taken off; `kinds` what the
/// columns hold further down.
TableStart find_table_start(const std::vector<Cells>& lines,
                            const std::vector<ColumnKind>& kinds,
                            NumberStyle style);

}  // namespace libchar::csv
