#pragma once
// Names chosen by patterns, and the order in which they are counted.

#include <string_view>

namespace libchar {

/// Does it hold a * or a ?, so that it may stand for several names?
bool is_pattern(std::string_view word);

/// * stands for any characters, none too; ? for one (a whole UTF-8 character); all else for itself.
bool matches(std::string_view pattern, std::string_view name);

/// Runs of digits count as numbers: gyro2 comes before gyro10. A strict order of all texts.
bool comes_before(std::string_view a, std::string_view b);

}  // namespace libchar
