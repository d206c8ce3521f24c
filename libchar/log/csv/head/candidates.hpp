#pragma once
// What separates the cells of a CSV file and which mark its decimals have: one question, as DuckDB and CleverCSV ask
// it. Every answer reads the first lines, and is worth what share of them has one width times what its cells look like.

#include <string>
#include <vector>

#include "libchar/log/csv/line.hpp"

namespace libchar::csv {

struct Candidate {
  char delimiter = ',';  ///< ' ' stands for runs of blanks and tabs
  char decimal = '.';
  std::size_t columns = 1;
  double score = 0;
};

/// Every one that agrees with `delimiter` and `decimal` (0: not known), best first; never empty.
std::vector<Candidate> candidates(const std::vector<Line>& lines, char delimiter = 0, char decimal = 0);

/// What stands between groups of three digits in three cells or more, 0 when nothing does.
char thousands_mark(const std::vector<Line>& lines, char delimiter, char decimal);

/// "tab", "space" or the character itself; throws Error(usage) for what cannot separate numbers.
char named_delimiter(const std::string& name);

/// For messages: "tab", "blanks", or the character.
std::string delimiter_name(char delimiter);

}  // namespace libchar::csv
