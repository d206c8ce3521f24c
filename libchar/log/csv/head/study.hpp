#pragma once
// What is known of the first bytes of a CSV file while its dialect is found out: a step reads what
// those before it wrote.

#include "libchar/core/refusal.hpp"
#include "libchar/log/csv/head/columns.hpp"
#include "libchar/log/csv/head/dialect.hpp"

namespace libchar::csv {

struct Study {
  std::string_view head;
  bool whole = false;  ///< the head is all of the file
  const ReadOptions& options;
  LogInfo& info;
  Dialect dialect = {};
  std::vector<Line> sample = {};    ///< lines that are neither blank nor comments
  std::vector<Line> comments = {};  ///< before the first of them, then those before the table
  std::vector<Line> later_comments = {};
  std::vector<Line> preamble = {};  ///< those of the sample in front of the table
  std::size_t columns = 1;
  std::vector<Cells> rows = {};  ///< the first ones
  std::vector<ColumnKind> kinds = {};
  std::optional<double> rate_hz = {};  ///< that the first lines state, other than in words
  std::string names = {};              ///< the line of names, where it is not as in the file
  bool marked_utf8 = false, encoding_guessed = false;

  NumberStyle style() const { return {dialect.decimal, dialect.thousands}; }
};

/// About a place in a line.
Refusal refusal(const Study& study, const Line& line, std::size_t column, std::string code);

/// The cells of a line, a stamp in front of them first.
Cells cells_in(const Dialect& dialect, std::string_view text, bool* open = nullptr);

/// The same, without an empty one behind a delimiter at the end of the line, and those of a line of
/// names as many as the table has columns, where it is known why they are not.
Cells table_cells(const Study& study, std::string_view text);

/// The cells of each of these columns with something in them, as far as the head goes: rows of one cell, `most` of
/// them.
std::vector<std::vector<Cells>> filled_cells(const Study& study, const std::vector<std::size_t>& columns,
                                             std::size_t most);

/// The same at places all over the file, where it is longer than the head and its bytes are its text.
std::vector<Cells> cells_further_on(const Study& study, std::size_t column);

/// The rows at places all over the file, as far as they are known without unpacking it: those of a short one are all.
Stretches stretches_of(const Study& study);

/// The same of a file that is opened anew; none of a pipe.
Stretches stretches_of(const std::string& path, const Dialect& dialect);

}  // namespace libchar::csv
