#include "libchar/log/binary/wrong_start.hpp"

#include <fmt/format.h>

namespace libchar {

std::string wrong_start(std::string_view found, std::string_view mark, std::string_view what) {
  if (found.empty()) return fmt::format("is empty, {} was expected", what);
  if (found.size() < mark.size() && mark.starts_with(found))
    return fmt::format(
        "ends at byte {}, inside the {} bytes that mark {}: no whole message or array is there",
        found.size(),
        mark.size(),
        what);
  return fmt::format("does not begin like {}", what);
}

}  // namespace libchar
