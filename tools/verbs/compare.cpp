// compare A B C…: recordings, reports and models side by side: which is the lowest in each term and at each averaging
// time; or two replays of one scene; and checks for build servers.

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "analysis_options.hpp"
#include "libchar/characterize/compare/characterization_comparison.hpp"
#include "libchar/core/file/whole_file.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/core/text/text_table.hpp"
#include "libchar/log/recording_json.hpp"
#include "libchar/model/model_file.hpp"
#include "libchar/replay/comparison.hpp"
#include "libchar/report/compare/comparison_text.hpp"
#include "verb.hpp"

namespace sensorchar {
namespace {

using namespace libchar;

struct CompareVerb {
  std::vector<std::string> inputs, checks, labels, channels;
  std::string output, limits;
  bool unlike = false, json = false, markdown = false, latex = false, csv = false, force = false;
  AnalysisOptions analysis;
};

Json texts(const std::vector<std::string>& sentences) {
  Json out = Json::array();
  for (const std::string& sentence : sentences) out.push_back(printable(sentence));
  return out;
}

Json comparison_head(const Session& session, const std::string& format, const std::vector<LogInfo>& files) {
  std::vector<const LogInfo*> each;
  for (const LogInfo& one : files) each.push_back(&one);
  return document_head(session, format, each);
}

Json document(const Session& session, const Comparison& c, const std::vector<std::string>& failed) {
  Json out = comparison_head(session, "replay-comparison", {document_info(c.a.file), document_info(c.b.file)});
  out.update(comparison_json(c));
  out["failed"] = texts(failed);
  return out;
}

[[noreturn]] void refuse_failed(const std::vector<std::string>& failed) {
  std::string what = failed[0];
  for (std::size_t i = 1; i < failed.size(); ++i) what += "; " + failed[i];
  throw Refusal(ErrorKind::check, "E0924", "--fail-if").says(what);
}

void compare_two_replays(Session& session, const CompareVerb& verb) {
  if (verb.inputs.size() != 2)
    throw usage_error("E0205", "compare")
        .says("replays are compared two by two")
        .got(fmt::format("{}", verb.inputs.size()));
  if (verb.latex || verb.csv || !verb.output.empty() || !verb.limits.empty())
    throw usage_error("E0205", "compare")
        .says("--latex, --csv, --limits and -o go with characterizations, and these are replays")
        .hint("--markdown and --json serve both");
  std::vector<ComparisonCheck> checks;
  for (const std::string& text : verb.checks) checks.push_back(parse_comparison_check(text));
  const Comparison comparison = compare_replays(read_replay_report(verb.inputs[0]), read_replay_report(verb.inputs[1]));
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

ReportedCharacterization candidate_of(Session& session, const CompareVerb& verb, const std::string& path,
                                      std::vector<LogInfo>& files) {
  if (!detail::is_recording(path)) {
    ReportedCharacterization out = read_characterization_report(path);
    files.push_back(document_info(out.file));
    return out;
  }
  RecordedReport made = report_of_recording(session, path, finish(verb.analysis));
  files.push_back(std::move(made.log));
  ReportedCharacterization out = parse_characterization_report(made.text, path);
  out.name = detail::document_name(path);
  return out;
}

std::string text_of(const CompareVerb& verb, const CharacterizationComparison& comparison, const Json& document) {
  if (verb.json) return dump_json(document);
  if (verb.markdown) return comparison_markdown(comparison);
  if (verb.latex) return table_text(detail::comparison_table(comparison), TableFormat::latex);
  if (verb.csv) return table_text(detail::comparison_table(comparison, detail::TableGroups::all), TableFormat::csv);
  return comparison_text(comparison, table_width());
}

void compare_sensors(Session& session, const CompareVerb& verb) {
  if (verb.unlike)
    throw usage_error("E0205", "--unlike").says("applies to reports of replay, and these are characterizations");
  if (!verb.output.empty()) foresee_output(verb.output, verb.inputs, verb.force);
  std::vector<GrowthCheck> checks;
  for (const std::string& text : verb.checks) checks.push_back(parse_characterization_check(text));
  CharacterizationCompareOptions options;
  options.names = verb.labels;
  options.channels = verb.channels;
  if (!verb.limits.empty()) options.limits = read_limits_file(verb.limits);
  std::vector<ReportedCharacterization> sides;
  std::vector<LogInfo> files;
  for (const std::string& path : verb.inputs) sides.push_back(candidate_of(session, verb, path, files));
  const CharacterizationComparison comparison = compare_characterizations(std::move(sides), options);
  std::vector<std::string> failed;
  for (const GrowthCheck& check : checks)
    for (const std::string& sentence : failures(comparison, check)) failed.push_back(sentence);
  Json document = comparison_head(session, "characterization-comparison", files);
  document.update(comparison_json(comparison));
  document["failed"] = texts(failed);
  const bool plain = !verb.json && !verb.markdown && !verb.latex && !verb.csv;
  const std::string text = text_of(verb, comparison, document);
  plain ? print_text(text) : print(text);
  if (!verb.output.empty())
    write_whole_file(verb.output, detail::comparison_html(comparison, document, session.command), verb.force);
  if (!failed.empty()) refuse_failed(failed);
}

/// The kind of document decides what is compared.
void run_compare(Session& session, const CompareVerb& verb) {
  for (const std::string& report : verb.inputs)
    refuse_lot_report(report,
                      "lots are compared as fleets (sensorchar fleet plan LOG… -o A): sensorchar fleet compare A B, or "
                      "sensorchar fleet merge A B -o REPORT for one report of both");
  const auto is_replay = [](const std::string& path) { return detail::document_format(path) == "replay-report"; };
  if (std::all_of(verb.inputs.begin(), verb.inputs.end(), is_replay))
    compare_two_replays(session, verb);
  else
    compare_sensors(session, verb);
}

std::function<void()> compare_options(VerbOptions& options, Session& session) {
  const auto verb = std::make_shared<CompareVerb>();
  options
      .add_texts("INPUT", verb->inputs,
                 "recordings, reports of characterize (or their folders; runs.json, fit --json, allan --json), curves "
                 "and sensor models in any mixture; or two reports of replay")
      .required();
  options
      .add_texts("--fail-if", verb->checks,
                 "exit code 6 when a later input is worse than the first by more: rmse+5%, ns_per_sample+20%, "
                 "peak_bytes+10%, regret+0.5% (points), white_noise+10% (beyond its interval); minque:rmse+5% for one "
                 "algorithm, gyro_x:white_noise+5% for one channel; may be repeated")
      .value_name("[LABEL:]METRIC+N%")
      .one_value_each();
  options.add_flag("--unlike", verb->unlike, "compare reports even if their scenes differ");
  options
      .add_texts("-c,--channel", verb->channels,
                 "channels by name or pattern; gyro_x and accel_x fit any channel that measures them (default: all)")
      .separated_by_commas()
      .once_each();
  options.add_texts("--label", verb->labels, "name of each input (default: its file's)").separated_by_commas();
  options
      .add_text("--limits", verb->limits,
                "data-sheet limits (docs/recordings.md) as a row of the table and a line in the figures")
      .value_name("FILE");
  const Option json = options.add_flag("--json", verb->json, "one JSON document instead of the table");
  const Option markdown =
      options.add_flag("--markdown", verb->markdown, "a Markdown page instead of the table").excludes(json);
  const Option latex =
      options.add_flag("--latex", verb->latex, "the table alone as a LaTeX tabular").excludes(json).excludes(markdown);
  options.add_flag("--csv", verb->csv, "the table alone, one number per column")
      .excludes(json)
      .excludes(markdown)
      .excludes(latex);
  options
      .add_text("-o,--output", verb->output, "a page with verdict, table and overlaid Allan curves, such as which.html")
      .value_name("FILE");
  options.add_flag("--force", verb->force, "overwrite the output file");
  add_recording_options(options, session, verb->analysis, verb->inputs);
  return [&session, verb] { run_compare(session, *verb); };
}

}  // namespace

VerbEntry verb_compare() {
  return {9,
          "compare",
          "Compare sensors: which has the lowest noise, and where; or two replays",
          compare_options,
          {{"which of three sensors, from their recordings", "sensorchar compare A.csv B.csv C.csv -o which.html"},
           {"two recordings of one sensor", "sensorchar compare monday friday"},
           {"for a build server: exit code 6 when an error grew by more than 5 %",
            "sensorchar compare array-replay new-replay --fail-if rmse+5%"}}};
}

}  // namespace sensorchar
