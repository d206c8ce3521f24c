// report FILE: what a report found as a table for a paper or a page.

#include <memory>

#include "analysis_options.hpp"
#include "libchar/core/file/whole_file.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/report/compare/comparison_text.hpp"
#include "libchar/report/text/report_table.hpp"
#include "verb.hpp"

namespace sensorchar {
namespace {

using namespace libchar;

struct ReportVerb {
  std::vector<std::string> files;
  std::string output;
  std::vector<std::string> channels;
  bool latex = false, markdown = false, csv = false, force = false;
  AnalysisOptions analysis;
};

/// A recording is characterized on the way.
ReportedCharacterization reported(Session& session, const ReportVerb& verb, const std::string& file) {
  if (!detail::is_recording(file)) return read_characterization_report(file);
  ReportedCharacterization out =
      parse_characterization_report(report_of_recording(session, file, finish(verb.analysis)).text, file);
  out.name = detail::document_name(file);
  return out;
}

/// Of several, the table of `compare`.
std::string table_of(Session& session, const ReportVerb& verb, TableFormat format) {
  std::vector<ReportedCharacterization> reports;
  for (const std::string& file : verb.files) {
    reports.push_back(reported(session, verb, file));
    report_findings(session, reports.back().file, reports.back().findings, verb.channels);
  }
  if (reports.size() == 1) return coefficient_table(reports[0], verb.channels, format);
  CharacterizationCompareOptions options;
  options.channels = verb.channels;
  return table_text(
      detail::comparison_table(compare_characterizations(std::move(reports), options),
                               format == TableFormat::csv ? detail::TableGroups::all : detail::TableGroups::summary),
      format);
}

void run_report(Session& session, const ReportVerb& verb) {
  if (!verb.output.empty() && verb.output != "-")
    for (const std::string& file : verb.files) foresee_output(verb.output, {file, report_file(file)}, verb.force);
  const TableFormat format = verb.latex ? TableFormat::latex : verb.csv ? TableFormat::csv : TableFormat::markdown;
  for (const std::string& file : verb.files)
    refuse_lot_report(file,
                      "its tables are coefficients.csv and index.html next to it; index.html links to the folder with "
                      "the report of each device");
  std::string text;
  if (detail::document_format(verb.files[0]) != "replay-report") {
    text = table_of(session, verb, format);
  } else {
    if (verb.files.size() > 1)
      throw usage_error("E0205", "report")
          .says("a table of a replay is of one report")
          .hint("sensorchar compare A B holds two replays against each other");
    const ReplayReport replay = read_replay_report(verb.files[0]);
    if (!verb.channels.empty())
      throw usage_error("E0205", "--channel")
          .says("goes with the report of a characterization, and this is one of a replay");
    text = ranking_table(replay, format);
  }
  if (verb.output.empty() || verb.output == "-") return print(text);
  write_whole_file(verb.output, text, verb.force);
}

std::function<void()> report_options(VerbOptions& options, Session& session) {
  const auto verb = std::make_shared<ReportVerb>();
  options
      .add_texts("FILE", verb->files,
                 "report.json of characterize or replay (runs.json of pooled runs, what fit --json prints) or its "
                 "folder, a recording, or sensor models; several make the table of compare")
      .required();
  const Option markdown = options.add_flag("--markdown", verb->markdown, "a table of Markdown (the default)");
  const Option latex =
      options.add_flag("--latex", verb->latex, "a tabular of LaTeX, which needs no package").excludes(markdown);
  options.add_flag("--csv", verb->csv, "one number per column, all digits").excludes(latex).excludes(markdown);
  options.add_texts("-c,--channel", verb->channels, "channels by name or pattern such as 'gyro*' (all)")
      .separated_by_commas()
      .once_each();
  options.add_text("-o,--output", verb->output, "write there instead of to stdout").value_name("FILE");
  options.add_flag("--force", verb->force, "overwrite the output file");
  add_recording_options(options, session, verb->analysis, verb->files);
  return [verb, &session] { run_report(session, *verb); };
}

}  // namespace

VerbEntry verb_report() {
  return {9,
          "report",
          "Print the table of a report: Markdown, LaTeX or CSV",
          report_options,
          {{"the coefficients as a table for LaTeX", "sensorchar report report --latex"},
           {"the ranking of a replay", "sensorchar report array-replay"}}};
}

}  // namespace sensorchar
