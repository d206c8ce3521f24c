#pragma once
// Signs around and inside of cells that are no part of a number, and that a text loses on its way: apostrophes that
// stand for quotes; brackets of printed lists, codes of a terminal's colours, checksums behind '*', exponents of
// Fortran (1.5D+03), narrow blanks between thousands, days of the week in front of dates ("Sun, 22 Nov 2026"), lines
// drawn between columns, byte-order marks in each line, and samples of one channel that go on from line to line
// (SLIST). And stamps that stand in several columns, and several numbers in a cell.

#include <functional>
#include <memory>

#include "libchar/log/csv/unpacker.hpp"

namespace libchar::csv {

/// The first line has cells in apostrophes, from its beginning to its end.
bool in_apostrophes(std::string_view front);
std::unique_ptr<Unpacker> open_apostrophes(std::function<std::size_t(char*, std::size_t)> stored);

/// Which of the other signs the first lines hold.
struct Signs {
  bool colours = false, brackets = false, checksums = false, exponents = false, typeset = false, weekdays = false,
       boxes = false, listed = false, marks = false;
  bool any() const {
    return colours || brackets || checksums || exponents || typeset || weekdays || boxes || listed || marks;
  }
};
Signs signs_of(std::string_view front);
std::unique_ptr<Unpacker> open_signs(std::function<std::size_t(char*, std::size_t)> stored);

/// Names like year, month, day, hour, minute, second side by side, and their numbers below.
bool has_spread_dates(std::string_view front);
/// One column of stamps in their place.
std::unique_ptr<Unpacker> open_spread_dates(std::function<std::size_t(char*, std::size_t)> stored);

/// Cells with several numbers, "(1.0, 2.0, 3.0)".
bool has_tuples(std::string_view front);
std::unique_ptr<Unpacker> open_tuples(std::function<std::size_t(char*, std::size_t)> stored);

}  // namespace libchar::csv
