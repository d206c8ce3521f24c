// The sensor model itself as JSON, for programs without a format of their own.

#include <nlohmann/json.hpp>

#include "libchar/export/detail/target_list.hpp"
#include "libchar/model/model_file.hpp"

namespace libchar {
namespace {

Export write_json(const SensorGroup& group, const ExportOptions& options) {
  Export out;
  out.text = dump_json(models_json(group.all));
  if (options.inflate != 1 || options.axes != AxisChoice::automatic)
    out.notes.emplace_back("the models are written as they are: `inflate` and `axes` are for the other targets");
  return out;
}

}  // namespace

ExportTarget json_target() {
  return {"json",
          "generic JSON",
          "the sensor model itself, every key of its file; reads back",
          "model.json",
          ExportNeeds::any_sensor,
          "NBKQR",
          {.inflate = false, .low_pass = true, .status = true},
          write_json};
}

}  // namespace libchar
