#pragma once
// What the columns of a table hold, from its first rows.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/log/csv/line.hpp"
#include "libchar/log/csv/rows/number.hpp"

namespace libchar::csv {

/// Of numbers like 0x1F2A, which do not say whether they have a sign.
inline constexpr const char* kHexadecimal =
    "perl -pe 's/0x([0-9a-f]+)/hex($1)/gie' FILE > log.csv writes decimal numbers";

using Cells = std::vector<Field>;

/// Rows that follow each other, at several places of a file in its order.
using Stretches = std::vector<std::vector<Cells>>;

/// How numbers are written.
struct NumberStyle {
  char decimal = '.';
  char thousands = 0;  ///< between groups of three digits; 0 = none
};

/// "1,234.5" → "1234.5" where that is what the style says; else as it is.
std::string without_thousands(std::string_view text, NumberStyle style);

/// read_cell, with thousands and a label in front ("ax=0.01", "ax: 0.01").
Cell read_styled(std::string_view text, NumberStyle style);

/// "21.3 °C", "5V": a number in front of a unit that is known, as it stands in the file.
struct MeasuredCell {
  std::string_view number, unit;
};
std::optional<MeasuredCell> number_and_unit(std::string_view text);

/// A unit of a quantity of which none is converted: current, power, force, length, data.
bool unconverted_unit(std::string_view text);

/// Two spellings of one unit, in UTF-8 or Windows-1252.
bool same_unit(std::string_view a, std::string_view b);

/// Digits with one decimal mark at most: a number, without reading it.
bool plain_number(std::string_view text, char decimal);

/// read_styled for cells that are studied, where a unit behind the number does no harm; rows must
/// have the unit of their column.
Cell read_sampled(std::string_view text, NumberStyle style);

/// Length of a label and its sign in front of a number, "ax=" or "ax:"; 0 when there is none.
std::size_t label_length(std::string_view text);

/// What a cell looks like: a date with its clock time, a date, a clock time; odd is what is none of these.
enum class CellKind { blank, number, stamp, date, clock, word, odd };
CellKind cell_kind(const Field& field, NumberStyle style);

enum class ColumnKind {
  empty,     ///< no cell with anything in it
  number,    ///< numbers, and what cannot be read among them
  calendar,  ///< dates with clock times
  date,
  clock,
  text,  ///< words in every cell that is not empty, of two cells or more
};

/// Of the rows that have `columns` cells.
std::vector<ColumnKind> column_kinds(const std::vector<Cells>& rows, std::size_t columns, NumberStyle style);

}  // namespace libchar::csv
