#pragma once
// Colour on a terminal: what asks for a look is seen first. Never in a file or a pipe unless --color always says so.

#include "libchar/core/document/enum_table.hpp"

namespace sensorchar {

enum class Colour { automatic, always, never };

/// What --color says; automatic: on a terminal that is not "dumb", where NO_COLOR is not set.
void use_colour(Colour colour);
bool colours(int descriptor);

}  // namespace sensorchar

template <>
inline constexpr auto libchar::enum_table<sensorchar::Colour> =
    libchar::enum_words<sensorchar::Colour, "auto always never">;
