#pragma once
// docs/errors.md, as `explain` reads its table of codes.

#include <string_view>

namespace libchar {

std::string_view error_page();

}  // namespace libchar
