// The sensor model itself as JSON, for programs without a format of their own.

#include "libchar/export/detail/export_targets.hpp"
#include "libchar/model/model_json.hpp"

namespace libchar {

Export export_json(const SensorGroup& group, const ExportOptions& options) {
  Export out;
  out.text = dump_json(models_json(group.all));
  if (options.inflate != 1 || options.axes != AxisChoice::automatic)
    out.notes.emplace_back(
        "the models are written as they are: --inflate and --axes are for the other targets");
  return out;
}

}  // namespace libchar
