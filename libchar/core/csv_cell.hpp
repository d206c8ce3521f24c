#pragma once
#include <string>
#include <string_view>

namespace libchar {

/// A text cell of a table that may be opened in a spreadsheet: quoted when needed (RFC 4180), and
/// an apostrophe put in front of = + - @ TAB CR, which would start a formula. For results: the
/// columns of a log keep their names, which must read back as they were.
std::string csv_cell(std::string_view text);

}  // namespace libchar
