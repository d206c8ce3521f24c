// report FILE: what a report found as a table for a paper or a page.

#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "analysis_options.hpp"
#include "libchar/core/file/file_text.hpp"
#include "libchar/core/file/whole_file.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/report/compare/comparison_text.hpp"
#include "libchar/report/text/report_table.hpp"
#include "verb.hpp"

namespace sensorchar {
namespace {

using namespace libchar;

constexpr std::size_t kMostReportBytes = std::size_t{1} << 30U;

struct ReportVerb {
  std::vector<std::string> files;
  std::string output;
  std::vector<std::string> channels;
  bool latex = false, markdown = false, csv = false, form = false, force = false;
  AnalysisOptions analysis;
};

/// What stands in a file; a recording is characterized on the way.
struct Reported {
  std::string text;
  ReportedCharacterization report;
};

Reported reported(Session& session, const ReportVerb& verb, const std::string& file) {
  const bool recording = detail::is_recording(file);
  if (!recording && !verb.form) return {"", read_characterization_report(file)};
  Reported out;
  out.text = recording ? report_of_recording(session, file, finish(verb.analysis)).text
                       : file_text(report_file(file), kMostReportBytes);
  out.report = parse_characterization_report(out.text, file);
  if (recording) out.report.name = detail::document_name(file);
  return out;
}

std::string form_of(Session& session, const ReportVerb& verb) {
  if (verb.files.size() > 1)
    throw usage_error("E0205", "report").says("--form takes one recording").got(fmt::format("{}", verb.files.size()));
  const Reported one = reported(session, verb, verb.files[0]);
  if (one.report.format != "characterization")
    throw usage_error("E0205", "--form").says("needs a report of characterize or a recording").got(one.report.format);
  report_findings(session, one.report.file, one.report.findings, verb.channels);
  return detail::test_form_html(one.report, parse_json(one.text, one.report.file),
                                parse_figure_source(one.text, one.report.file), verb.channels);
}

/// Of several, the table of `compare`.
std::string table_of(Session& session, const ReportVerb& verb, TableFormat format) {
  std::vector<ReportedCharacterization> reports;
  for (const std::string& file : verb.files) {
    reports.push_back(reported(session, verb, file).report);
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
  if (verb.form) {
    text = form_of(session, verb);
  } else if (detail::document_format(verb.files[0]) != "replay-report") {
    text = table_of(session, verb, format);
  } else {
    if (verb.files.size() > 1)
      throw usage_error("E0205", "report")
          .says("the table of a replay takes one report")
          .hint("sensorchar compare A B compares two replays");
    const ReplayReport replay = read_replay_report(verb.files[0]);
    if (!verb.channels.empty())
      throw usage_error("E0205", "--channel")
          .says("applies to the report of a characterization, and this is one of a replay");
    text = ranking_table(replay, format);
  }
  if (verb.output.empty() || verb.output == "-") return print(text);
  write_whole_file(verb.output, text, verb.force);
}

std::function<void()> report_options(VerbOptions& options, Session& session) {
  const auto verb = std::make_shared<ReportVerb>();
  options
      .add_texts("FILE", verb->files,
                 "report.json of characterize or replay (runs.json of pooled runs, output of fit --json) or its "
                 "folder, a recording, or sensor models; several make the table of compare")
      .required();
  const Option markdown = options.add_flag("--markdown", verb->markdown, "a table in Markdown (default)");
  const Option latex = options.add_flag("--latex", verb->latex, "a LaTeX tabular; needs no package").excludes(markdown);
  const Option csv =
      options.add_flag("--csv", verb->csv, "one number per column, all digits").excludes(latex).excludes(markdown);
  options
      .add_flag("--form", verb->form, "a test report to print and sign, in HTML: conditions, method, results, limits")
      .excludes(latex)
      .excludes(markdown)
      .excludes(csv);
  options.add_texts("-c,--channel", verb->channels, "channels by name or pattern such as 'gyro*' (default: all)")
      .separated_by_commas()
      .once_each();
  options.add_text("-o,--output", verb->output, "output file (default: standard output)").value_name("FILE");
  options.add_flag("--force", verb->force, "overwrite the output file");
  add_recording_options(options, session, verb->analysis, verb->files);
  return [verb, &session] { run_report(session, *verb); };
}

}  // namespace

VerbEntry verb_report() {
  return {9,
          "report",
          "Print the table of a report (Markdown, LaTeX, CSV), or a test report to sign",
          report_options,
          {{"the coefficients as a table for LaTeX", "sensorchar report report --latex"},
           {"a test report to print and sign", "sensorchar report report --form -o test-report.html"},
           {"the ranking of a replay", "sensorchar report array-replay"}}};
}

}  // namespace sensorchar
