#include "tests/support/schemas.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

#include "tests/support/places.hpp"
#include "tests/support/run.hpp"

namespace test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::string text_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// docs/schema/NAME or what the program prints of it, read once; null when there is none.
const json& schema_file(const std::string& name) {
  static std::map<std::string, json> files = json::parse(run_words({program(), "--generate", "schema"}).out);
  const auto found = files.find(name);
  if (found != files.end()) return found->second;
  const fs::path path = fs::path(source_folder()) / "docs/schema" / name;
  return files[name] = fs::exists(path) ? json::parse(text_of(path)) : json();
}

bool is_of_type(const json& value, const std::string& type) {
  if (type == "null") return value.is_null();
  if (type == "boolean") return value.is_boolean();
  if (type == "integer") return value.is_number_integer();
  if (type == "number") return value.is_number();
  if (type == "string") return value.is_string();
  if (type == "array") return value.is_array();
  if (type == "object") return value.is_object();
  throw std::runtime_error("docs/schema: no such type: " + type);
}

struct Validator {
  std::string file;  ///< that "#/…" is meant in

  std::string check(const json& value, const json& schema, const std::string& at) const {
    for (const auto& [keyword, rule] : schema.items()) {
      if (const std::string fault = keyword_fault(keyword, rule, value, schema, at); !fault.empty()) return fault;
    }
    return "";
  }

  std::string keyword_fault(const std::string& keyword, const json& rule, const json& value, const json& schema,
                            const std::string& at) const {
    if (keyword == "$ref") return referred(rule.get<std::string>(), value, at);
    if (keyword == "type") return type_fault(rule, value, at);
    if (keyword == "const") return value == rule ? "" : at + ": is not " + rule.dump();
    if (keyword == "enum") return enum_fault(rule, value, at);
    if (keyword == "required") return required_fault(rule, value, at);
    if (keyword == "properties") return properties_fault(rule, value, at);
    if (keyword == "additionalProperties") return other_properties_fault(rule, value, schema, at);
    if (keyword == "items") return items_fault(rule, value, at);
    if (keyword == "minItems" || keyword == "maxItems")
      return !value.is_array() || (keyword == "minItems" ? value.size() >= rule : value.size() <= rule)
                 ? ""
                 : at + ": has " + std::to_string(value.size()) + " items";
    if (keyword == "minimum") return !value.is_number() || value >= rule ? "" : at + ": is below " + rule.dump();
    if (keyword == "allOf") return all_fault(rule, value, at);
    if (keyword == "anyOf") return any_fault(rule, value, at);
    static const std::vector<std::string> kWords = {"$schema", "$id", "$defs", "title", "description", "$comment"};
    if (std::find(kWords.begin(), kWords.end(), keyword) != kWords.end()) return "";
    // One that is not understood would be passed over.
    throw std::runtime_error("tests/support/schemas.cpp does not know the keyword " + keyword);
  }

  static std::string enum_fault(const json& rule, const json& value, const std::string& at) {
    return std::find(rule.begin(), rule.end(), value) != rule.end()
               ? ""
               : at + ": " + value.dump() + " is none of " + rule.dump();
  }

  static std::string required_fault(const json& rule, const json& value, const std::string& at) {
    if (!value.is_object()) return "";
    for (const json& key : rule)
      if (!value.contains(key.get<std::string>())) return at + ": " + key.dump() + " is missing";
    return "";
  }

  std::string properties_fault(const json& rule, const json& value, const std::string& at) const {
    if (!value.is_object()) return "";
    for (const auto& [key, part] : rule.items())
      if (value.contains(key))
        if (const auto fault = check(value[key], part, at + "/" + key); !fault.empty()) return fault;
    return "";
  }

  std::string other_properties_fault(const json& rule, const json& value, const json& schema,
                                     const std::string& at) const {
    if (!value.is_object()) return "";
    for (const auto& [key, item] : value.items())
      if (!schema.contains("properties") || !schema["properties"].contains(key))
        if (const auto fault = check(item, rule, at + "/" + key); !fault.empty()) return fault;
    return "";
  }

  std::string items_fault(const json& rule, const json& value, const std::string& at) const {
    if (!value.is_array()) return "";
    for (std::size_t k = 0; k < value.size(); ++k)
      if (const auto fault = check(value[k], rule, at + "/" + std::to_string(k)); !fault.empty()) return fault;
    return "";
  }

  std::string all_fault(const json& rule, const json& value, const std::string& at) const {
    for (const json& part : rule)
      if (const auto fault = check(value, part, at); !fault.empty()) return fault;
    return "";
  }

  std::string any_fault(const json& rule, const json& value, const std::string& at) const {
    std::string first;
    for (const json& part : rule) {
      const auto fault = check(value, part, at);
      if (fault.empty()) return "";
      if (first.empty()) first = fault;
    }
    return first;
  }

  static std::string type_fault(const json& rule, const json& value, const std::string& at) {
    const bool right = rule.is_string() ? is_of_type(value, rule)
                                        : std::any_of(rule.begin(), rule.end(),
                                                      [&](const json& type) { return is_of_type(value, type); });
    return right ? "" : at + ": " + value.dump().substr(0, 40) + " is not of type " + rule.dump();
  }

  std::string referred(const std::string& reference, const json& value, const std::string& at) const {
    const std::size_t sign = std::min(reference.find('#'), reference.size());
    const std::string name = sign == 0 ? file : reference.substr(0, sign);
    const json& whole = schema_file(name);
    if (whole.is_null()) throw std::runtime_error("docs/schema: no file " + name);
    const std::string pointer = sign < reference.size() ? reference.substr(sign + 1) : "";
    return Validator{name}.check(value, pointer.empty() ? whole : whole.at(json::json_pointer(pointer)), at);
  }
};

std::string fault_of(const json& document) {
  if (document.is_array()) {
    for (const json& one : document)
      if (const auto fault = fault_of(one); !fault.empty()) return fault;
    return "";
  }
  const bool sidecar = document.is_object() && document.contains("dtype");  // of a raw log: names no format
  if (!sidecar && (!document.is_object() || !document.contains("format") || !document["format"].is_string()))
    return "a document without a format";
  const std::string name = (sidecar ? "sidecar" : document["format"].get<std::string>()) + ".schema.json";
  const json& schema = schema_file(name);
  if (schema.is_null()) return "docs/schema has no " + name;
  const std::string fault = Validator{name}.check(document, schema, "");
  return fault.empty() ? "" : name + ": " + fault;
}

}  // namespace

std::string schema_fault(const std::string& document) { return fault_of(json::parse(document)); }

std::string faults_of_run(const std::vector<std::string>& arguments, const std::string& out,
                          const std::string& folder) {
  const bool asked = std::find(arguments.begin(), arguments.end(), "--json") != arguments.end();
  if (asked && !out.empty()) {
    if (!json::accept(out)) return "what --json printed is not one document";
    if (const auto fault = schema_fault(out); !fault.empty()) return "--json: " + fault;
  }
  auto at = std::find_if(arguments.begin(), arguments.end(),
                         [](const std::string& word) { return word == "-o" || word == "--output"; });
  if (at == arguments.end() || ++at == arguments.end()) return "";
  const fs::path results = fs::path(folder) / *at;
  std::error_code ignored;
  if (!fs::is_directory(results, ignored)) return "";
  for (const auto& entry : fs::directory_iterator(results, ignored)) {
    const std::string text = entry.path().extension() == ".json" ? text_of(entry.path()) : "";
    if (text.empty() || !json::accept(text)) continue;
    if (const auto fault = schema_fault(text); !fault.empty()) return entry.path().filename().string() + ": " + fault;
  }
  return "";
}

}  // namespace test
