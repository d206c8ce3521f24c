// The smallest export target, for the test that it costs a file and a line; and the table with it, in place of
// libchar/export/targets.cpp.

#include <vector>

#include "libchar/export/detail/target_list.hpp"
#include "libchar/export/exports.hpp"

namespace libchar {
namespace {

Export write_names(const SensorGroup& group, const ExportOptions&) {
  Export out;
  for (const SensorModel* model : group.all) out.text += model->channel + "\n";
  return out;
}

}  // namespace

ExportTarget names_target() {
  return {"names", "a test", "names of channels", "names.txt", ExportNeeds::any_sensor, "QBKQzR", {}, write_names};
}

std::span<const ExportTarget> export_targets() {
#define LIBCHAR_LIST_TARGET(NAME) NAME##_target(),
  static const std::vector<ExportTarget> targets = {LIBCHAR_EXPORT_TARGETS(LIBCHAR_LIST_TARGET) names_target()};
#undef LIBCHAR_LIST_TARGET
  return targets;
}

}  // namespace libchar
