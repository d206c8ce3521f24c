#include "libchar/core/process/version.hpp"

#include <libchar_commit.hpp>

namespace libchar {
std::string_view version() { return LIBCHAR_VERSION; }

std::string build() { return LIBCHAR_BUILD ", " LIBCHAR_COMMIT; }
}  // namespace libchar
