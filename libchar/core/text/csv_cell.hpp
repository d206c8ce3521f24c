#pragma once
#include <string>
#include <string_view>

namespace libchar {

/// A spreadsheet takes a cell that begins with = + - @ TAB CR for a formula.
bool begins_like_a_formula(std::string_view text);

/// A text cell of a table that may be opened in a spreadsheet: quoted when needed (RFC 4180), and
/// an apostrophe put in front of what would start a formula. For results: the
/// columns of a log keep their names, which must read back as they were.
std::string csv_cell(std::string_view text);

}  // namespace libchar
