#include "libchar/core/version.hpp"

namespace libchar {
std::string_view version() {
  return LIBCHAR_VERSION;
}
}  // namespace libchar
