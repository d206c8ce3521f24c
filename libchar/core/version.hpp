#pragma once
#include <string_view>

namespace libchar {
/// Version of this library and of the program, "major.minor.patch".
std::string_view version();
}  // namespace libchar
