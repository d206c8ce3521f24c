// compare A B: two reports of one scene side by side, and checks for build servers; or two
// characterizations, term by term.

#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "libchar/characterize/compare/characterization_check.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/core/text/text_table.hpp"
#include "libchar/log/recording_json.hpp"
#include "libchar/model/model_file.hpp"
#include "libchar/replay/comparison.hpp"
#include "libchar/replay/comparison_check.hpp"
#include "libchar/report/compare/comparison_text.hpp"
#include "verb.hpp"

namespace sensorchar {
namespace {

using namespace libchar;

struct CompareVerb {
  std::string a, b;
  std::vector<std::string> checks;
  bool unlike = false, json = false, markdown = false;
};

Json comparison_head(const Session& session,
                     const std::string& format,
                     const std::string& a,
                     const std::string& b) {
  const LogInfo files[] = {document_info(a), document_info(b)};
  return document_head(session, format, {&files[0], &files[1]});
}

Json document(const Session& session, const Comparison& c, const std::vector<std::string>& failed) {
  Json out = comparison_head(session, "replay-comparison", c.a.file, c.b.file);
  out.update(comparison_json(c));
  out["failed"] = Json::array();
  for (const std::string& sentence : failed) out["failed"].push_back(printable(sentence));
  return out;
}

[[noreturn]] void refuse_failed(const std::vector<std::string>& failed) {
  std::string what = failed[0];
  for (std::size_t i = 1; i < failed.size(); ++i) what += "; " + failed[i];
  throw Refusal(ErrorKind::check, "E0924", "--fail-if").says(what);
}

void compare_two_replays(Session& session, const CompareVerb& verb) {
  std::vector<ComparisonCheck> checks;
  for (const std::string& text : verb.checks) checks.push_back(parse_comparison_check(text));
  const Comparison comparison =
      compare_replays(read_replay_report(verb.a), read_replay_report(verb.b));
  if (!verb.unlike) refuse_unlike(comparison);
  std::vector<std::string> failed;
  for (const ComparisonCheck& check : checks)
    for (const std::string& sentence : failures(comparison, check)) failed.push_back(sentence);
  if (verb.json)
    print(dump_json(document(session, comparison, failed)));
  else if (verb.markdown)
    print(comparison_markdown(comparison));
  else
    print_text(comparison_text(comparison, table_width()));
  if (!failed.empty()) refuse_failed(failed);
}

void compare_two_characterizations(Session& session, const CompareVerb& verb) {
  if (verb.unlike)
    throw usage_error("E0205", "--unlike")
        .says("goes with reports of replay, and these are characterizations");
  std::vector<GrowthCheck> checks;
  for (const std::string& text : verb.checks) checks.push_back(parse_characterization_check(text));
  const ReportedCharacterization a = read_characterization_report(verb.a);  // A is refused before B
  const CharacterizationComparison comparison =
      compare_characterizations(a, read_characterization_report(verb.b));
  std::vector<std::string> failed;
  for (const GrowthCheck& check : checks)
    for (const std::string& sentence : failures(comparison, check)) failed.push_back(sentence);
  if (verb.json) {
    Json out = comparison_head(
        session, "characterization-comparison", comparison.a.file, comparison.b.file);
    out.update(comparison_json(comparison));
    out["failed"] = Json::array();
    for (const std::string& sentence : failed) out["failed"].push_back(printable(sentence));
    print(dump_json(out));
  } else if (verb.markdown) {
    print(comparison_markdown(comparison));
  } else {
    print_text(comparison_text(comparison, table_width()));
  }
  if (!failed.empty()) refuse_failed(failed);
}

/// The kind of document decides what is compared.
void run_compare(Session& session, const CompareVerb& verb) {
  for (const std::string& report : {verb.a, verb.b})
    refuse_lot_report(
        report,
        "lots are compared as fleets (sensorchar fleet plan LOG… -o A): sensorchar fleet "
        "compare A B, or sensorchar fleet merge A B -o REPORT for one report of both");
  if (is_characterization_report(verb.a) || is_characterization_report(verb.b))
    compare_two_characterizations(session, verb);
  else
    compare_two_replays(session, verb);
}

std::function<void()> compare_options(VerbOptions& options, Session& session) {
  const auto verb = std::make_shared<CompareVerb>();
  options
      .add_text("A",
                verb->a,
                "report.json of a replay or of characterize (runs.json of pooled runs, what fit "
                "--json prints), or the folder that holds it")
      .required();
  options.add_text("B", verb->b, "the same of what is held against it").required();
  options
      .add_texts("--fail-if",
                 verb->checks,
                 "exit code 6 when B is worse than A by more: rmse+5%, ns_per_sample+20%, "
                 "peak_bytes+10%, regret+0.5% (points), white_noise+10% (beyond its interval); "
                 "minque:rmse+5% "
                 "for one algorithm, gyro_x:white_noise+5% for one channel; "
                 "several times")
      .value_name("[LABEL:]METRIC+N%")
      .one_value_each();
  options.add_flag("--unlike", verb->unlike, "compare reports of unlike scenes all the same");
  const Option json =
      options.add_flag("--json", verb->json, "one JSON document instead of the table");
  options.add_flag("--markdown", verb->markdown, "a page of Markdown instead of the table")
      .excludes(json);
  return [&session, verb] { run_compare(session, *verb); };
}

}  // namespace

VerbEntry verb_compare() {
  return {9,
          "compare",
          "Compare two replays, or two characterizations",
          compare_options,
          {{"two recordings of one sensor", "sensorchar compare monday friday"},
           {"for a build server: exit code 6 when an error grew by more than 5 %",
            "sensorchar compare array-replay new-replay --fail-if rmse+5%"}}};
}

}  // namespace sensorchar
