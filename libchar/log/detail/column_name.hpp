#pragma once
// What the name of a column says: its name proper, and its unit.

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "libchar/log/recording.hpp"

namespace libchar {

/// Without blanks and tabs at its ends.
std::string_view trimmed(std::string_view text);

/// "gyro_x [deg/s]", "Time (s)", "t_ns" → name and unit ("" when there is none); a suffix behind
/// '_' counts only when it is a known unit.
std::pair<std::string, std::string> name_and_unit(std::string_view column);

/// Are the channels called c0, c1… in this order, as a reader calls channels without names?
bool unnamed(const std::vector<Channel>& channels);

}  // namespace libchar
