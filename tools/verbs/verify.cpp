// verify DIR|DOCUMENT: are results and inputs still those that the document was written with?

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "libchar/core/document/result_check.hpp"
#include "libchar/core/process/version.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/text.hpp"
#include "rerun.hpp"
#include "verb.hpp"

namespace sensorchar {
namespace {

using namespace libchar;

struct VerifyVerb {
  std::string results, inputs_in, again;
  bool json = false, allow_read = false;
};

std::string check_text(const ResultCheck& check) {
  std::string out = fmt::format("{}: written by sensorchar {}{}\n", printable(check.document), printable(check.version),
                                check.build.empty() ? "" : " (" + printable(check.build) + ")");
  for (const CheckedFile& file : check.files)
    out += fmt::format("  {:9} {}{}\n", state_word(file.state), printable(file.path), file.input ? " (input)" : "");
  return out;
}

Json check_json(const ResultCheck& check) {
  Json out = {{"document", json_text(check.document)},
              {"version", json_text(check.version)},
              {"build", json_text(check.build)},
              {"same_program", check.version == version() && check.build == build()},
              {"holds", check.holds()},
              {"files", Json::array()}};
  for (const CheckedFile& file : check.files)
    out["files"].push_back(
        {{"path", json_text(file.path)}, {"input", file.input}, {"state", std::string(state_word(file.state))}});
  return out;
}

std::string digits_text(double relative) {
  return std::isfinite(relative) ? ", " + brief_text(relative, 2) + " relative" : "";
}

std::string rerun_text(const Rerun& run) {
  std::string out = fmt::format("{}: run again into {}\n", printable(run.document),
                                printable(std::filesystem::path(run.again).parent_path().string()));
  for (const auto& [file, same] : run.files)
    out += fmt::format("  {:9} {}\n", same ? "same" : "other", printable(file));
  constexpr std::size_t kShown = 20;
  for (std::size_t i = 0; i < std::min(kShown, run.differences.size()); ++i) {
    const JsonDifference& d = run.differences[i];
    out += fmt::format("  other     {}: {}, was {}{}\n", printable(d.at), printable(d.now), printable(d.was),
                       digits_text(d.relative));
  }
  if (run.differences.size() > kShown) out += fmt::format("  and {} more\n", run.differences.size() - kShown);
  if (run.differences.empty())
    out += "  same      every number of the document\n";
  else if (run.holds())
    out += "  within 8 digits: another processor or build\n";
  return out;
}

Json rerun_json(const Rerun& run) {
  Json out = {{"document", json_text(run.document)},
              {"again", json_text(run.again)},
              {"same_program", run.same_program},
              {"holds", run.holds()},
              {"files", Json::array()},
              {"differences", Json::array()}};
  for (const auto& [file, same] : run.files) out["files"].push_back({{"path", json_text(file)}, {"same", same}});
  for (const JsonDifference& d : run.differences)
    out["differences"].push_back({{"at", json_text(d.at)},
                                  {"was", json_text(d.was)},
                                  {"now", json_text(d.now)},
                                  {"relative", json_number(d.relative)}});
  return out;
}

// What was found, or an error: the numbers of the second run are not those of the first.
void run_again(Session& session, const VerifyVerb& verb, const std::string& document) {
  const Rerun run = rerun(session, {document, verb.again, verb.inputs_in, verb.allow_read});
  if (verb.json) {
    Json out = document_head(session, "rerun", {});
    out["rerun"] = rerun_json(run);
    print(dump_json(out));
  } else {
    print_text(rerun_text(run));
  }
  if (run.holds()) return;
  throw Refusal(ErrorKind::check, "E0520", document)
      .says("a second run gives other results")
      .hint(run.same_program ? "the same program wrote it: check its inputs and --in"
                             : "another build wrote it, and its numbers differ beyond 8 digits");
}

void run_verify(Session& session, const VerifyVerb& verb) {
  if (!verb.again.empty()) {
    const std::vector<std::string> documents = detail::result_documents(verb.results);
    if (documents.size() != 1)
      throw usage_error("E0205", "--rerun")
          .says("repeats one document, and several were given")
          .got(std::to_string(documents.size()))
          .hint("name the document itself");
    return run_again(session, verb, documents[0]);
  }
  const std::vector<ResultCheck> checks = check_results(verb.results, verb.inputs_in);
  if (verb.json) {
    Json document = document_head(session, "result-check", {});
    document["documents"] = Json::array();
    for (const ResultCheck& check : checks) document["documents"].push_back(check_json(check));
    print(dump_json(document));
  } else {
    for (const ResultCheck& check : checks) print_text(check_text(check));
  }
  const auto broken =
      std::find_if(checks.begin(), checks.end(), [](const ResultCheck& check) { return !check.holds(); });
  if (broken != checks.end())
    throw Refusal(ErrorKind::check, "E0520", broken->document)
        .says("an input or a result has changed or is missing")
        .hint("run it again; --in finds inputs in another folder");
}

std::function<void()> verify_options(VerbOptions& options, Session& session) {
  const auto verb = std::make_shared<VerifyVerb>();
  options.add_text("RESULTS", verb->results, "folder that characterize or replay wrote, or its report")
      .required()
      .value_name("DIR|REPORT");
  options.add_text("--in", verb->inputs_in, "folder that input paths are relative to (default: the current one)")
      .value_name("FOLDER");
  options.add_text("--rerun", verb->again, "repeat the report's command into this new folder and compare every number")
      .value_name("FOLDER");
  options.add_flag("--allow-read", verb->allow_read,
                   "allow the report's command to read files outside this folder (or --in) and the report's");
  options.only("with --rerun", [verb = verb.get()] { return !verb->again.empty(); }, {"--allow-read"});
  options.add_flag("--json", verb->json, "one JSON document on stdout instead of text");
  return [&session, verb] { run_verify(session, *verb); };
}

}  // namespace

VerbEntry verb_verify() {
  return {12,
          "verify",
          "Check that results and input files have not changed since the report was written",
          verify_options,
          {{"check the files of a folder", "sensorchar verify report"},
           {"repeat the analysis and compare the numbers", "sensorchar verify report --rerun again"}}};
}

}  // namespace sensorchar
