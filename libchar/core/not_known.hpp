#pragma once
// The number that stands for "no value": documents write it as null, pages as a dash.

#include <limits>

namespace libchar {

inline constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

}  // namespace libchar
