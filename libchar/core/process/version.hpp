#pragma once
#include <string>
#include <string_view>

namespace libchar {
/// Version of this library and of the program, "major.minor.patch".
std::string_view version();

/// How it was built: "Release, GNU 12.2.0, 1a2b3c4d5e" (build type and what differs from it, compiler, commit;
/// "unknown" without one, "-dirty" where sources differ from it).
std::string build();
}  // namespace libchar
