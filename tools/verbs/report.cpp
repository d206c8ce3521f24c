// report FILE: what a report found as a table for a paper or a page.

#include <memory>

#include "libchar/core/file/whole_file.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/report/text/report_table.hpp"
#include "verb.hpp"

namespace sensorchar {
namespace {

using namespace libchar;

struct ReportVerb {
  std::string file, output;
  std::vector<std::string> channels;
  bool latex = false, markdown = false, csv = false, force = false;
};

void run_report(Session& session, const ReportVerb& verb) {
  if (!verb.output.empty() && verb.output != "-")
    foresee_output(verb.output, {verb.file, report_file(verb.file)}, verb.force);
  const TableFormat format = verb.latex ? TableFormat::latex
                             : verb.csv ? TableFormat::csv
                                        : TableFormat::markdown;
  refuse_lot_report(
      verb.file,
      "its tables are coefficients.csv and index.html next to it; index.html links to "
      "the folder with the report of each device");
  std::string text;
  if (is_characterization_report(verb.file)) {
    const ReportedCharacterization report = read_characterization_report(verb.file);
    text = coefficient_table(report, verb.channels, format);
    report_findings(session, report.file, report.findings, verb.channels);
  } else {
    const ReplayReport replay = read_replay_report(verb.file);
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
      .add_text("FILE",
                verb->file,
                "report.json of characterize or replay (runs.json of pooled runs, what fit --json "
                "prints), or the folder that holds it")
      .required();
  const Option markdown =
      options.add_flag("--markdown", verb->markdown, "a table of Markdown (the default)");
  const Option latex =
      options.add_flag("--latex", verb->latex, "a tabular of LaTeX, which needs no package")
          .excludes(markdown);
  options.add_flag("--csv", verb->csv, "one number per column, all digits")
      .excludes(latex)
      .excludes(markdown);
  options
      .add_texts(
          "-c,--channel", verb->channels, "channels by name or pattern such as 'gyro*' (all)")
      .separated_by_commas()
      .once_each();
  options.add_text("-o,--output", verb->output, "write there instead of to stdout")
      .value_name("FILE");
  options.add_flag("--force", verb->force, "overwrite the output file");
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
