#include "help/generate.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "help/completion.hpp"
#include "help/flag_names.hpp"
#include "help/help_page.hpp"
#include "help/man_page.hpp"
#include "libchar/core/document/json.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/spelling.hpp"
#include "libchar/report/json/schemas.hpp"

namespace sensorchar {
namespace {

using libchar::Error;
using libchar::ErrorKind;
using libchar::Json;

const VerbUsage& named_verb(const ProgramUsage& program, const std::string& name) {
  std::vector<std::string> names;
  for (const VerbUsage& verb : program.verbs) {
    if (verb.name == name) return verb;
    names.push_back(verb.name);
  }
  throw libchar::usage_error("E0203", program.name)
      .says("unknown verb")
      .got(name)
      .hint(libchar::did_you_mean(libchar::nearest(name, names),
                                  fmt::format("the verbs are {}", fmt::join(names, ", "))));
}

std::string_view kind_word(ValueKind kind) {
  switch (kind) {
    case ValueKind::none:
      return "flag";
    case ValueKind::text:
      return "text";
    case ValueKind::words:
      return "words";
    case ValueKind::file:
      return "file";
    case ValueKind::folder:
      return "folder";
  }
  return "";
}

Json option_json(const OptionUsage& option) {
  return {{"flags", option.flags},
          {"value", option.name},
          {"kind", kind_word(option.kind)},
          {"words", option.words},
          {"comma_list", option.comma_list},
          {"required", option.required},
          {"repeatable", option.repeatable},
          {"group", option.group},
          {"help", option.help},
          {"only", option.only},
          {"excludes", option.excludes}};
}

Json list_json(const std::vector<OptionUsage>& options) {
  Json list = Json::array();
  for (const OptionUsage& option : options) list.push_back(option_json(option));
  return list;
}

std::string usage_json(const ProgramUsage& program) {
  Json document = {{"format", "usage"},
                   {"version", 1},
                   {"program", program.name},
                   {"program_version", program.version},
                   {"options", list_json(program.options)},
                   {"settings", Json::object()},
                   {"verbs", Json::array()}};
  for (const auto& [option, flag] : flags_of_options()) document["settings"][option] = flag;
  for (const VerbUsage& verb : program.verbs) {
    Json examples = Json::array();
    for (const Example& example : verb.examples)
      examples.push_back({{"command", example.command}, {"what", example.what}});
    document["verbs"].push_back({{"name", verb.name},
                                 {"what", verb.what},
                                 {"arguments", list_json(verb.arguments)},
                                 {"options", list_json(verb.options)},
                                 {"examples", examples}});
  }
  return libchar::dump_json(document);
}

// Of one document, or of all by file name.
std::string schema_json(const std::vector<std::string>& words) {
  const Json all = libchar::schemas();
  if (words.size() == 1) return libchar::dump_json(all);
  std::vector<std::string> names;
  for (const auto& [file, schema] : all.items()) names.push_back(file.substr(0, file.find('.')));
  if (std::find(names.begin(), names.end(), words[1]) != names.end())
    return libchar::dump_json(all[words[1] + ".schema.json"]);
  throw libchar::usage_error("E0202", "--generate schema")
      .says("expected one of {}", fmt::join(names, ", "))
      .got(words[1])
      .hint(libchar::did_you_mean(libchar::nearest(words[1], names)));
}

std::string artefact(const ProgramUsage& program, const std::vector<std::string>& words) {
  static const std::vector<std::string> kKinds = {"man", "bash", "zsh", "fish", "json", "schema"};
  const std::string kind = words.empty() ? "" : words[0];
  if (words.size() > 2 || (words.size() == 2 && kind != "man" && kind != "schema"))
    throw libchar::usage_error("E0204", "--generate")
        .says("one argument too many")
        .got(words.back())
        .hint("--generate man VERB or schema NAME, or --generate bash, zsh, fish or json alone");
  if (kind == "man")
    return words.size() == 1 ? program_man_page(program) : verb_man_page(program, named_verb(program, words[1]));
  if (kind == "bash") return bash_completion(program);
  if (kind == "zsh") return zsh_completion(program);
  if (kind == "fish") return fish_completion(program);
  if (kind == "json") return usage_json(program);
  if (kind == "schema") return schema_json(words);
  throw libchar::usage_error("E0202", "--generate")
      .says("expected one of {}", fmt::join(kKinds, ", "))
      .got(kind)
      .hint(libchar::did_you_mean(libchar::nearest(kind, kKinds)));
}

}  // namespace

std::optional<std::string> generated(const ProgramUsage& program, const std::vector<std::string>& command,
                                     std::size_t width) {
  if (command.size() < 2) return std::nullopt;
  const std::string& first = command[1];
  if (first == "--generate") return artefact(program, {command.begin() + 2, command.end()});
  const bool asked = std::any_of(command.begin() + 1, command.end(),
                                 [](const std::string& word) { return word == "--help" || word == "-h"; });
  if (first == "help") {
    if (command.size() == 2 || asked) return program_help(program, width);
    if (command.size() > 3) throw libchar::usage_error("E0204", "help").says("one argument too many").got(command[3]);
    std::string group = group_help(program, command[2], width);
    return group.empty() ? verb_help(program, named_verb(program, command[2]), width) : group;
  }
  if (first == "--help" || first == "-h") return program_help(program, width);
  if (!asked) return std::nullopt;
  const auto verb =
      std::find_if(program.verbs.begin(), program.verbs.end(), [&](const VerbUsage& v) { return v.name == first; });
  if (verb == program.verbs.end()) return std::nullopt;
  return verb_help(program, *verb, width);
}

}  // namespace sensorchar
