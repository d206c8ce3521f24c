#include "libchar/model/model_json.hpp"

#include <nlohmann/json.hpp>

#include "libchar/core/document/document.hpp"
#include "libchar/core/document/document_file.hpp"
#include "libchar/core/document/schema.hpp"
#include "libchar/model/model_fields.hpp"
#include "libchar/model/model_reader.hpp"

namespace libchar {
namespace {

constexpr const char* kListFormat = "sensor-models";

}  // namespace

Json model_json(const SensorModel& model) {
  return json_of(model_entries(model));
}

Json models_json(const std::vector<const SensorModel*>& models) {
  if (models.size() == 1) return model_json(*models.front());
  Json out =
      json_of({{"format", std::string(kListFormat)}, {"version", std::uint64_t{1}}, tool_entry()});
  out["models"] = Json::array();
  for (const SensorModel* m : models) out["models"].push_back(model_json(*m));
  return out;
}

std::vector<SensorModel> read_model_list(const std::string& path) {
  const Document document = parse_document(read_document_text(path), path);
  const DocumentEntry* format =
      document.kind == Document::Kind::map ? document.find("format") : nullptr;
  if (format == nullptr || format->value.text != kListFormat) {
    check_format(document, path, "sensor-model", 1);
    return {sensor_model_of(document, path, "")};
  }
  check_format(document, path, kListFormat, 1);
  const MapReader top(document, path, "", {"format", "version", "tool", "models"});
  std::vector<SensorModel> models;
  std::size_t index = 0;
  for (const Document& node : top.list("models"))
    models.push_back(sensor_model_of(node, path, "models[" + std::to_string(index++) + "]"));
  if (models.empty()) top.refuse("models", "an empty list");
  return models;
}

}  // namespace libchar
