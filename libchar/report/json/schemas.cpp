#include "libchar/report/json/schemas.hpp"

#include <initializer_list>
#include <nlohmann/json.hpp>

#include "libchar/benchmark/bench_document.hpp"
#include "libchar/characterize/curves/curve_document.hpp"
#include "libchar/fit/fit_json.hpp"
#include "libchar/log/recording_json.hpp"
#include "libchar/lot/device_record.hpp"
#include "libchar/model/model_fields.hpp"
#include "libchar/model/noise_limits.hpp"
#include "libchar/replay/fusion_file.hpp"
#include "libchar/replay/report/replay_report.hpp"
#include "libchar/report/detail/report_rows.hpp"
#include "libchar/scene/scene_file.hpp"

namespace libchar {
namespace {

std::string file_of(const std::string& name) { return name + ".schema.json"; }

Json titled(const std::string& name, const char* title) {
  return {{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"$id", file_of(name)}, {"title", title}};
}

void add_file(Json& all, const std::string& name, const char* title, const Json& schema) {
  Json& out = all[file_of(name)] = titled(name, title);
  out.update(schema);
}

// What the program prints: the part may stand in other documents without the head.
void add_document(Json& all, const std::string& name, const char* title, Json part) {
  Json& out = all[file_of(name)] = titled(name, title);
  out["allOf"] = {{{"$ref", file_of("head") + "#/$defs/head"}}, {{"$ref", file_of(name) + "#/$defs/part"}}};
  out["$defs"]["part"] = std::move(part);
}

Json of_format(const char* name, Json properties) {
  Json out = {{"type", "object"}, {"required", {"format", "version"}}, {"properties", Json::object()}};
  out["properties"]["format"] = {{"const", name}};
  out["properties"]["version"] = {{"const", 1}};
  for (const auto& [key, schema] : properties.items()) {
    out["required"].push_back(key);
    out["properties"][key] = schema;
  }
  return out;
}

// Format and version, and what the rows of the document say.
Json of_format(const char* name, std::span<const Field> rows) {
  Json out = of_format(name, Json::object());
  const Json part = schema_of(rows);
  for (const Json& key : part.value("required", Json::array())) out["required"].push_back(key);
  out["properties"].update(part["properties"]);
  return out;
}

Json list_of_schema(Json items) { return {{"type", "array"}, {"items", std::move(items)}}; }

Json head_schema() {
  Json out = schema_of(document_head_fields().rows);
  out["properties"]["measured"] = {
      {"type", "object"}, {"description", "what differs between two runs of one command, and counts of what was done"}};
  return out;
}

Json fit_channel_schema() {
  Json out = schema_of(noise_fit_fields().rows);
  for (const char* key : {"unit", "name"}) {
    out["required"].insert(out["required"].begin(), key);
    out["properties"][key] = {{"type", "string"}};
  }
  out["properties"].update(schema_of(fit_residual_fields().rows)["properties"]);
  out["properties"]["derived"] = schema_of(derived_fields().rows);
  return out;
}

// Of each channel an object, behind one key.
Json channels_schema(std::span<const Field> rows, Json keys = Json::object()) {
  Json out = {{"type", "object"}, {"required", {"channels"}}, {"properties", std::move(keys)}};
  out["properties"]["channels"] = list_of_schema(schema_of(rows));
  return out;
}

// Names and digests of the files that stand beside a report.
void add_files(Json& properties) {
  const Json text = {{"type", "string"}};
  properties["files"] = list_of_schema(text);
  properties["files_sha256"] = {{"type", "object"}, {"additionalProperties", text}};
}

Json characterization_schema() {
  const Json text = {{"type", "string"}};
  Json out =
      of_format("characterization",
                {{"config", {{"type", "object"}, {"description", "options of the program and the library"}}},
                 {"verdict", text},
                 {"summary", channels_schema(summary_fields().rows, {{"rating", text}})},
                 {"recording", schema_of(recording_rows())},
                 {"allan", {{"$ref", file_of("allan") + "#/$defs/part"}}},
                 {"spectrum", {{"$ref", file_of("spectrum") + "#/$defs/part"}}},
                 {"fit", {{"$ref", file_of("noise-fit") + "#/$defs/part"}}},
                 {"quality", channels_schema(quality_fields().rows)},
                 {"trace", channels_schema(trace_fields().rows, {{"rate_hz", {{"type", {"number", "null"}}}}})}});
  Json& more = out["properties"];
  more["still"] = schema_of(still_fields().rows);
  more["verification"] = channels_schema(verification_fields().rows);
  more["verification"]["properties"]["channels"]["items"]["type"] = {"object", "null"};
  more["limits"] = schema_of(limit_report_fields().rows);
  add_files(more);
  return out;
}

Json replay_schema() {
  Json out = of_format("replay-report", ReplayReport::fields().rows);
  out["properties"]["config"] = {{"type", "object"}, {"description", "options of the program and the library"}};
  add_files(out["properties"]);
  for (const char* key : {"config", "files", "files_sha256"}) out["required"].push_back(key);
  return out;
}

Json comparison_schema() {
  Json out = of_format("replay-comparison", comparison_fields().rows);
  out["properties"]["failed"] = list_of_schema({{"type", "string"}});
  out["required"].push_back("failed");
  return out;
}

Json fuse_schema() {
  Json out = of_format("fuse", fuse_fields().rows);
  out["properties"]["output"] = list_of_schema({{"type", "string"}});
  out["required"].push_back("output");
  return out;
}

Json texts_schema(std::initializer_list<const char*> keys) {
  Json out = {{"type", "object"}, {"required", keys}, {"properties", Json::object()}};
  for (const char* key : keys) out["properties"][key] = {{"type", "string"}};
  return out;
}

Json explanation_schema() {
  Json kind = texts_schema({"code", "severity", "title", "meaning", "remedy"});
  kind["properties"]["effects"] = list_of_schema(texts_schema({"quantity", "direction"}));
  Json out = of_format("explanation", {{"kinds", list_of_schema(std::move(kind))}});
  out["properties"]["errors"] = list_of_schema(texts_schema({"code", "exit_code", "meaning"}));
  return out;
}

Json bench_schema() {
  Json out = schema_of(bench_fields().rows);
  add_files(out["properties"]);
  return out;
}

// Also of a model without its head, in a scene.
Json model_schema() {
  Json keys = schema_of(model_fields().rows, true), head;
  for (const char* key : {"format", "version"}) {
    head["properties"][key] = keys["properties"][key];
    keys["properties"].erase(key);
  }
  head["required"] = keys["required"];
  keys.erase("required");
  head["type"] = "object";
  head["allOf"] = {{{"$ref", file_of("sensor-model") + "#/$defs/keys"}}};
  head["$defs"]["keys"] = std::move(keys);
  return head;
}

Json limits_schema() {
  Json out = schema_of(limits_fields().rows, true);
  out["properties"]["limits"]["items"] = schema_of(limit_block_fields().rows, true);
  return out;
}

Json sidecar_schema() {
  Json out = schema_of(sidecar_rows(), true);
  out["required"] = {"dtype", "channels"};
  return out;
}

}  // namespace

Json schemas() {
  Json all = Json::object();
  add_file(all, "head", "The head of every document of the program", {{"$defs", {{"head", head_schema()}}}});
  add_document(all, "inspect", "What is in logs",
               of_format("inspect", {{"recordings", list_of_schema(schema_of(recording_rows()))}}));
  add_document(all, "allan", "Deviations of the Allan family", schema_of(allan_fields().rows));
  add_document(all, "spectrum", "Spectra", schema_of(spectrum_fields().rows));
  add_document(all, "noise-fit", "Noise coefficients",
               of_format("noise-fit",
                         {{"density_sides", {{"const", "two"}}}, {"channels", list_of_schema(fit_channel_schema())}}));
  add_document(all, "characterization", "report.json of a characterization", characterization_schema());
  add_document(all, "replay-report", "report.json of a replay", replay_schema());
  add_document(all, "replay-comparison", "Two replays side by side", comparison_schema());
  add_document(all, "fuse", "A log fused", fuse_schema());
  add_document(
      all, "fusion-algorithms", "Fusion algorithms with what they need",
      of_format("fusion-algorithms", {{"algorithms", list_of_schema(schema_of(algorithm_entry_fields().rows))}}));
  add_document(all, "explanation", "What findings and errors mean", explanation_schema());
  add_file(all, "bench", "bench.json of benchmarks", bench_schema());
  add_file(all, "sensor-model", "A sensor model: CHANNEL.sensor.yaml (docs/models.md)", model_schema());
  add_document(all, "models", "Sensor models",
               of_format("models", {{"models", list_of_schema({{"$ref", file_of("sensor-model")}})}}));
  add_file(all, "noise-limits", "What a data sheet allows (docs/recordings.md)", limits_schema());
  add_file(all, "sidecar", "The sidecar of a raw binary log: LOG.json or LOG.yaml (docs/formats.md)", sidecar_schema());
  add_file(all, "device-record", "A line of a fleet's results: what a lot needs to know of one characterized device",
           schema_of(device_record_fields().rows));
  add_file(all, "scene", "A scene: a recording, or a simulation, and what is known of it (docs/scenes.md)",
           scene_schema());
  add_file(all, "fusion", "What a replay learnt: fusion.yaml (docs/fuse.md)", schema_of(fusion_fields().rows, true));
  return all;
}

}  // namespace libchar
