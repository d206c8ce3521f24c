// The JSON Schema of what rows describe.

#include <nlohmann/json.hpp>

#include "libchar/core/document/fields.hpp"

namespace libchar {
namespace {

constexpr const char* kNumber = "number";

Json type_of(std::string_view word, bool nullable) {
  return nullable ? Json{{"type", {word, "null"}}} : Json{{"type", word}};
}

Json list_schema(Json items) { return {{"type", "array"}, {"items", std::move(items)}}; }

// An end that is not known or infinite is null.
Json interval_schema(bool nullable) {
  Json out = type_of("array", nullable);
  out["items"] = type_of(kNumber, true);
  out["minItems"] = out["maxItems"] = 2;
  return out;
}

// One bare value is a list of one in files that people write.
Json plain_list(std::string_view word, bool file) {
  Json list = list_schema(type_of(word, word == kNumber && !file));
  return file ? Json{{"anyOf", {list, type_of(word, false)}}} : list;
}

bool may_be_null(const Field& row) { return row.text.written == Written::always && row.text.known != nullptr; }

Json value_schema(const Field& row, bool file) {
  const bool nullable = may_be_null(row);
  if (!row.text.words.empty()) {
    Json words = Json::array();
    for (const Word& word : row.text.words) words.push_back(word.word);
    if (nullable) words.push_back(nullptr);
    return {{"enum", std::move(words)}};
  }
  if (row.kind == kNumber) return type_of(kNumber, !row.text.required);
  if (row.kind == "whole number") return type_of("integer", nullable || row.optional);
  if (row.kind == "text") return type_of("string", nullable);
  if (row.kind == "true, false") return type_of("boolean", nullable);
  if (row.kind == "list of numbers") return plain_list(kNumber, file);
  if (row.kind == "list of texts") return plain_list("string", file);
  if (row.kind == "[low, high]") return interval_schema(!row.text.required);
  if (row.kind == "list of [low, high]") return list_schema(interval_schema(true));
  if (row.kind == "lists of numbers") return list_schema(plain_list(kNumber, false));
  if (row.kind == "number or map") return {{"type", {kNumber, "object", "null"}}};
  if (row.kind.starts_with("list")) return list_schema(Json::object());
  if (row.kind.starts_with("map")) return type_of("object", false);
  if (row.kind == "pairs") return list_schema(plain_list("integer", false));
  if (row.kind == "counts") return {{"type", "object"}, {"additionalProperties", {{"type", "integer"}}}};
  return Json::object();
}

Json column_schema(const Field& row) {
  Json items = value_schema(row, false);
  if (row.kind == "whole number") items = type_of("integer", false);
  return list_schema(std::move(items));
}

Json columns_schema(const Field& columns) {
  Json out = {{"type", "object"}, {"required", Json::array()}, {"properties", Json::object()}};
  for (const Field& row : columns.below) {
    if (row.text.written == Written::always) out["required"].push_back(row.key);
    out["properties"][std::string(row.key)] = column_schema(row);
  }
  return out;
}

// What is substituted is any text.
Json constant_schema(const Value& value) {
  const auto* text = std::get_if<std::string>(&value);
  if (text != nullptr && text->find('{') != std::string::npos) return type_of("string", false);
  return {{"const", json_of({{"value", value}})["value"]}};
}

Json known_schema(const Field& row, bool file) {
  if (row.constant) return constant_schema(*row.constant);
  if (row.below.empty()) return value_schema(row, file);
  if (row.layout == Layout::columns) return columns_schema(row);
  Json part = schema_of(row.below, file);
  if (row.kind.starts_with("list")) return list_schema(std::move(part));
  if (row.kind == "map") return {{"type", "object"}, {"additionalProperties", std::move(part)}};
  if (row.kind == "number or map") return {{"anyOf", {type_of(kNumber, true), std::move(part)}}};
  if (row.optional) part["type"] = {"object", "null"};
  return part;
}

Json row_schema(const Field& row, bool file) {
  Json out = known_schema(row, file);
  if (may_be_null(row) && out.contains("type") && out["type"].is_string()) out["type"] = {out["type"], "null"};
  return out;
}

std::string description_of(const Field& row) {
  std::string out(row.text.meaning.empty() ? row.text.comment : row.text.meaning);
  if (!row.text.unit.empty()) out += (out.empty() ? "in " : ", in ") + std::string(row.text.unit);
  return out;
}

void add_row(Json& out, const Field& row, bool file) {
  if (row.key.empty() && row.slot != nullptr) {
    const Json beside = row_schema(row, file);
    for (const Json& key : beside.value("required", Json::array())) out["required"].push_back(key);
    out["properties"].update(beside["properties"]);
  }
  if (row.key.empty()) return;
  const bool written = !file && row.text.written == Written::always;
  const bool there = written || row.text.required || row.constant;
  if (there) out["required"].push_back(row.key);
  Json one = row_schema(row, file);
  if (const std::string text = description_of(row); !text.empty()) one["description"] = text;
  out["properties"][std::string(row.key)] = std::move(one);
}

}  // namespace

Json schema_of(std::span<const Field> rows, bool file) {
  Json out = {{"type", "object"}, {"required", Json::array()}, {"properties", Json::object()}};
  for (const Field& row : rows) add_row(out, row, file);
  if (out["required"].empty()) out.erase("required");
  return out;
}

}  // namespace libchar
