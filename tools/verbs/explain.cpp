// explain [CODE…]: what a finding means, what it does to the numbers, and what to do.

#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "libchar/core/error.hpp"
#include "libchar/core/finding.hpp"
#include "libchar/core/text/spelling.hpp"
#include "verb.hpp"

namespace sensorchar {
namespace {

using namespace libchar;

struct ExplainVerb {
  std::vector<std::string> codes;
  bool json = false;
};

std::vector<FindingKind> chosen(const std::vector<std::string>& codes) {
  const auto all = finding_kinds();
  if (codes.empty()) return {all.begin(), all.end()};
  std::vector<FindingKind> out;
  for (const std::string& code : codes) {
    const FindingKind* kind = find_finding_kind(code);
    if (kind != nullptr) {
      out.push_back(*kind);
      continue;
    }
    std::vector<std::string> known;
    for (const FindingKind& one : all) known.emplace_back(one.code);
    throw Error({ErrorKind::usage,
                 "E0202",
                 "explain",
                 "no such finding",
                 code,
                 did_you_mean(nearest(code, known), "sensorchar explain lists them all")});
  }
  return out;
}

std::string effects_text(const FindingKind& kind) {
  std::string out;
  for (const Finding::Effect& effect : kind.effects) {
    out += (out.empty() ? "" : ", ") + std::string(name_of(effect.quantity));
    if (effect.direction != Direction::unknown)
      out += effect.direction == Direction::too_large ? " too large" : " too small";
  }
  return out;
}

std::string as_text(const FindingKind& kind) {
  std::string out = fmt::format(
      "{} ({}): {}\n  {}\n", kind.code, name_of(kind.severity), kind.title, kind.meaning);
  if (!kind.effects.empty()) out += "  it changes: " + effects_text(kind) + "\n";
  if (!kind.remedy.empty()) out += fmt::format("  what to do: {}\n", kind.remedy);
  return out;
}

Json as_json(const FindingKind& kind) {
  Json out = {{"code", kind.code},
              {"severity", name_of(kind.severity)},
              {"title", kind.title},
              {"meaning", kind.meaning},
              {"remedy", kind.remedy},
              {"effects", Json::array()}};
  for (const Finding::Effect& effect : kind.effects)
    out["effects"].push_back(
        {{"quantity", name_of(effect.quantity)}, {"direction", name_of(effect.direction)}});
  return out;
}

void run_explain(const ExplainVerb& verb) {
  const std::vector<FindingKind> kinds = chosen(verb.codes);
  if (verb.json) {
    Json document = {{"format", "finding-kinds"}, {"version", 1}, {"findings", Json::array()}};
    for (const FindingKind& kind : kinds) document["findings"].push_back(as_json(kind));
    return print(dump_json(document));
  }
  std::string text;
  for (const FindingKind& kind : kinds) text += as_text(kind);
  print_text(text);
}

std::function<void()> explain_options(VerbOptions& options, Session& /*session*/) {
  const auto verb = std::make_shared<ExplainVerb>();
  options.add_texts("CODE", verb->codes, "codes of findings, as JSON and pages give them (all)");
  options.add_flag("--json", verb->json, "as JSON");
  return [verb] { run_explain(*verb); };
}

}  // namespace

VerbEntry verb_explain() {
  return {11,
          "explain",
          "What a finding means, and what to do about it",
          explain_options,
          {{"one of them", "sensorchar explain held_values"},
           {"all of them, for a script", "sensorchar explain --json"}}};
}

}  // namespace sensorchar
