// The table of export targets and nothing else: who links a table of their own replaces this object.

#include <vector>

#include "libchar/export/detail/target_list.hpp"

namespace libchar {

std::span<const ExportTarget> export_targets() {
#define LIBCHAR_LIST_TARGET(NAME) NAME##_target(),
  static const std::vector<ExportTarget> targets = {LIBCHAR_EXPORT_TARGETS(LIBCHAR_LIST_TARGET)};
#undef LIBCHAR_LIST_TARGET
  return targets;
}

}  // namespace libchar
