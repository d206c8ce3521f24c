#pragma once
// The line of a text file that an error is about, as compilers show it.

#include <string>

#include "libchar/core/error.hpp"

namespace sensorchar {

/// "\n  | 0.163,-4,4\n  |          ^" for a place FILE:LINE:COLUMN (byte N), as docs/errors.md defines
/// it; "" where the text is not readable, or the line has characters that no terminal shows.
std::string marked_line(const libchar::Problem& problem);

}  // namespace sensorchar
