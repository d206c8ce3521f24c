#pragma once
// libchar/core/findings.tsv, embedded at build time (libchar/cmake/embed.cmake).

#include <string_view>

namespace libchar {

std::string_view finding_table();

}  // namespace libchar
