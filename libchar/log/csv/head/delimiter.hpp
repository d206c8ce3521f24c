#pragma once
// Which character separates the cells of a CSV file.

#include <string>
#include <vector>

#include "libchar/log/csv/line.hpp"

namespace libchar::csv {

/// Is a cell a number under some decimal mark? `mark` receives the one it shows ('.' or ','), if
/// any.
bool numeric(const Field& field, char delimiter, char* mark = nullptr);

/// How well a delimiter explains the sample: share of lines with the commonest number of cells,
/// share of numeric cells.
struct Score {
  char delimiter = ',';
  std::size_t columns = 1;
  double quality = 0;
};

Score score(const std::vector<Line>& lines, char delimiter);

/// The best among comma, semicolon, tab and blanks; one column when none fits.
Score best_score(const std::vector<Line>& lines);

/// ',' when more numbers of the sample show a decimal comma than a point, else '.'.
char decimal_mark(const std::vector<Line>& lines, char delimiter);

/// What stands between groups of three digits in three cells or more, 0 when nothing does.
char thousands_mark(const std::vector<Line>& lines, char delimiter, char decimal);

/// "tab", "space" or the character itself; throws Error(usage) for what cannot separate numbers.
char named_delimiter(const std::string& name);

/// For messages: "tab", "blanks", or the character.
std::string delimiter_name(char delimiter);

}  // namespace libchar::csv
