#include "libchar/scene/text/scene_schema.hpp"

#include <nlohmann/json.hpp>

#include "libchar/scene/detail/scene_fields.hpp"

namespace libchar {
namespace {

Json any_of(Json one, Json other) {
  return {{"anyOf", {std::move(one), std::move(other)}}};
}

}  // namespace

Json scene_schema() {
  Json out = schema_of(scene_fields().rows, true),
       reading = schema_of(scene_reading_fields().rows, true);
  Json& keys = out["properties"];
  const Json text = {{"type", "string"}};
  reading["properties"]["path"] = text;
  keys["recording"] = any_of(text, std::move(reading));
  Json simulate = schema_of(simulation_fields().rows, true);
  simulate["properties"]["truth"]["type"] = {"array", "object", "number", "string"};
  keys["simulate"] = std::move(simulate);
  keys["sensors"]["items"] = any_of(text, schema_of(sensor_fields().rows, true));
  keys["reference"] =
      any_of({{"type", {"string", "array", "null"}}}, schema_of(reference_fields().rows, true));
  keys["tilt"] = schema_of(tilt_fields().rows, true);
  keys["faults"]["items"] = schema_of(fault_fields().rows, true);
  keys["simulated"] = schema_of(simulated_fields().rows, true);
  return out;
}

}  // namespace libchar
