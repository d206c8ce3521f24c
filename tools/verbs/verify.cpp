// verify DIR|DOCUMENT: are results and inputs still those that the document was written with?

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "libchar/core/error.hpp"
#include "libchar/core/result_check.hpp"
#include "libchar/core/text.hpp"
#include "libchar/core/version.hpp"
#include "verb.hpp"

namespace sensorchar {
namespace {

using namespace libchar;

struct VerifyVerb {
  std::string results, inputs_in;
  bool json = false;
};

std::string check_text(const ResultCheck& check) {
  std::string out = fmt::format("{}: written by sensorchar {}{}\n",
                                printable(check.document),
                                printable(check.version),
                                check.build.empty() ? "" : " (" + printable(check.build) + ")");
  for (const CheckedFile& file : check.files)
    out += fmt::format("  {:9} {}{}\n",
                       state_word(file.state),
                       printable(file.path),
                       file.input ? " (input)" : "");
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
    out["files"].push_back({{"path", json_text(file.path)},
                            {"input", file.input},
                            {"state", std::string(state_word(file.state))}});
  return out;
}

void run_verify(Session& session, const VerifyVerb& verb) {
  const std::vector<ResultCheck> checks = check_results(verb.results, verb.inputs_in);
  if (verb.json) {
    Json document = document_head(session, "result-check", {});
    document["documents"] = Json::array();
    for (const ResultCheck& check : checks) document["documents"].push_back(check_json(check));
    print(dump_json(document));
  } else {
    for (const ResultCheck& check : checks) print(check_text(check));
  }
  const auto broken = std::find_if(
      checks.begin(), checks.end(), [](const ResultCheck& check) { return !check.holds(); });
  if (broken != checks.end())
    throw Error({ErrorKind::check,
                 "E0520",
                 broken->document,
                 "what it was written with is changed or missing",
                 "",
                 "run it again; inputs that lie elsewhere are found with --in"});
}

std::function<void()> verify_options(VerbOptions& options, Session& session) {
  const auto verb = std::make_shared<VerifyVerb>();
  options
      .add_text("RESULTS", verb->results, "folder that characterize or replay wrote, or its report")
      .required()
      .value_name("DIR|REPORT");
  options
      .add_text("--in",
                verb->inputs_in,
                "folder that the paths of inputs are meant from (default: the one you are in)")
      .value_name("FOLDER");
  options.add_flag("--json", verb->json, "one JSON document on stdout instead of text");
  return [&session, verb] { run_verify(session, *verb); };
}

}  // namespace

VerbEntry verb_verify() {
  return {12,
          "verify",
          "Are results and their inputs still what the report was written with?",
          verify_options};
}

}  // namespace sensorchar
