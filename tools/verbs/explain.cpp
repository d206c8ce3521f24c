// explain [CODE…]: what a finding means, what it does to the numbers, and what to do; what an error means.

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "help/error_page.hpp"
#include "libchar/core/finding.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/spelling.hpp"
#include "verb.hpp"

namespace sensorchar {
namespace {

using namespace libchar;

struct ExplainVerb {
  std::vector<std::string> codes;
  bool json = false;
};

struct KindOfError {
  std::string_view code, exit_code, meaning;
};

struct Explained {
  std::vector<FindingKind> findings;
  std::vector<KindOfError> errors;
};

/// The rows "| E0312 | 3 | a number … | where it is raised |" of the page.
std::vector<KindOfError> kinds_of_errors() {
  std::vector<KindOfError> out;
  for (std::string_view rest = error_page(); !rest.empty();) {
    const std::string_view line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(line.size() + 1, rest.size()));
    if (!line.starts_with("| E")) continue;
    std::vector<std::string_view> cells;
    for (std::size_t at = 2; cells.size() < 3;) {
      const std::size_t end = line.find(" | ", at);
      cells.push_back(line.substr(at, end - at));
      at = end + 3;
    }
    out.push_back({cells[0], cells[1], cells[2]});
  }
  return out;
}

[[noreturn]] void refuse_code(const std::string& code) {
  std::vector<std::string> known;
  for (const FindingKind& one : finding_kinds()) known.emplace_back(one.code);
  for (const KindOfError& one : kinds_of_errors()) known.emplace_back(one.code);
  throw usage_error("E0202", "explain")
      .says("no such finding or error")
      .got(code)
      .hint(did_you_mean(nearest(code, known), "sensorchar explain lists all findings"));
}

Explained chosen(const std::vector<std::string>& codes) {
  const auto all = finding_kinds();
  if (codes.empty()) return {{all.begin(), all.end()}, {}};
  const std::vector<KindOfError> errors = kinds_of_errors();
  Explained out;
  for (const std::string& code : codes) {
    const auto error =
        std::find_if(errors.begin(), errors.end(), [&](const KindOfError& one) { return one.code == code; });
    if (const FindingKind* kind = find_finding_kind(code))
      out.findings.push_back(*kind);
    else if (error != errors.end())
      out.errors.push_back(*error);
    else
      refuse_code(code);
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
  std::string out = fmt::format("{} ({}): {}\n  {}\n", kind.code, name_of(kind.severity), kind.title, kind.meaning);
  if (!kind.effects.empty()) out += "  it changes: " + effects_text(kind) + "\n";
  if (!kind.remedy.empty()) out += fmt::format("  what to do: {}\n", kind.remedy);
  return out;
}

Json as_json(const FindingKind& kind) {
  Json out = {{"code", kind.code},     {"severity", name_of(kind.severity)},
              {"title", kind.title},   {"meaning", kind.meaning},
              {"remedy", kind.remedy}, {"effects", Json::array()}};
  for (const Finding::Effect& effect : kind.effects)
    out["effects"].push_back({{"quantity", name_of(effect.quantity)}, {"direction", name_of(effect.direction)}});
  return out;
}

std::string as_text(const KindOfError& kind) {
  return fmt::format("{} (error, exit code {}): {}\n", kind.code, kind.exit_code, kind.meaning);
}

void run_explain(const Session& session, const ExplainVerb& verb) {
  const Explained kinds = chosen(verb.codes);
  if (verb.json) {
    Json document = document_head(session, "explanation", {});
    document["kinds"] = Json::array();
    for (const FindingKind& kind : kinds.findings) document["kinds"].push_back(as_json(kind));
    for (const KindOfError& kind : kinds.errors)
      document["errors"].push_back({{"code", kind.code}, {"exit_code", kind.exit_code}, {"meaning", kind.meaning}});
    return print(dump_json(document));
  }
  std::string text;
  for (const FindingKind& kind : kinds.findings) text += as_text(kind);
  for (const KindOfError& kind : kinds.errors) text += as_text(kind);
  print_text(text);
}

std::function<void()> explain_options(VerbOptions& options, Session& session) {
  const auto verb = std::make_shared<ExplainVerb>();
  options.add_texts("CODE", verb->codes,
                    "codes of findings, as in JSON and pages, or of errors (default: all findings)");
  options.add_flag("--json", verb->json, "as JSON");
  return [&session, verb] { run_explain(session, *verb); };
}

}  // namespace

VerbEntry verb_explain() {
  return {11,
          "explain",
          "Explain a finding or an error: meaning, effect, remedy",
          explain_options,
          {{"one of them", "sensorchar explain held_values"},
           {"an error", "sensorchar explain E0304"},
           {"all findings, for a script", "sensorchar explain --json"}}};
}

}  // namespace sensorchar
