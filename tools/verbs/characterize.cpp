// characterize LOG… -o DIR: everything about a recording, in files that can be shown to a
// colleague.

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "analysis_options.hpp"
#include "libchar/characterize/characterization_view.hpp"
#include "libchar/characterize/settings.hpp"
#include "libchar/characterize/verification.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/file_name.hpp"
#include "libchar/core/output_files.hpp"
#include "libchar/core/text.hpp"
#include "libchar/core/whole_file.hpp"
#include "libchar/log/formats.hpp"
#include "libchar/report/characterization_text.hpp"
#include "libchar/report/json_report.hpp"
#include "libchar/report/report_files.hpp"
#include "reading_options.hpp"
#include "verb.hpp"

namespace sensorchar {
namespace {

using namespace libchar;
namespace fs = std::filesystem;

struct CharacterizeVerb {
  std::vector<std::string> logs;
  std::string folder;
  bool json = false, force = false, verify = false;
  std::uint64_t seed = 1;
  AnalysisOptions analysis;
};

fs::path folder_for(const CharacterizeVerb& verb,
                    const std::string& log,
                    std::set<std::string>& taken) {
  if (verb.logs.size() == 1) return verb.folder;
  return fs::path(verb.folder) / unused_file_name_for(fs::path(log).stem().string(), taken);
}

void run_characterize(Session& session, const CharacterizeVerb& verb) {
  const CharacterizeOptions options = finish(verb.analysis);
  std::set<std::string> taken;
  Json documents = Json::array();
  bool any_fit = false, agrees = true;
  for (const std::string& log : verb.logs) {
    Characterization result = characterize(log, options, session.terminal);
    result.command = session.command;
    result.settings = settings_of(options);
    if (verb.verify) {
      VerifyOptions how;
      how.seed = verb.seed;
      result.settings.push_back(part_entry("verify", {{"seed", verb.seed}}));
      agrees = verify(result, options, how, session.terminal) && agrees;
    }
    session.terminal.clear();
    report_warnings(session, result.log);
    const CharacterizationView view = characterization_view(result);
    const fs::path folder = folder_for(verb, log, taken);
    const std::vector<OutputFile> outputs = report_files(view, folder);
    write_outputs(outputs, folder, {log}, verb.force);
    for (const ChannelResult& c : result.channels) any_fit = any_fit || c.fit;
    if (verb.json) {
      documents.push_back(json_report(view));
      continue;
    }
    print_text(characterization_text(result));
    std::string written = "\nwrote";
    for (const OutputFile& output : outputs) written += fmt::format(" {}", printable(output.path));
    print(written + "\n");
  }
  if (verb.json) print(dump_json(verb.logs.size() == 1 ? documents[0] : documents));
  if (!any_fit)
    throw Error({ErrorKind::numeric,
                 "E0711",
                 verb.logs[0],
                 "no channel could be fitted; the report says why",
                 "",
                 ""});
  if (!agrees)
    throw Error(
        {ErrorKind::check,
         "E0713",
         verb.logs[0],
         "a simulation of the model does not agree with the recording; the report says where",
         "",
         ""});
}

std::function<void()> characterize_options(VerbOptions& options, Session& session) {
  auto verb = std::make_shared<CharacterizeVerb>();
  options
      .add_texts("LOG",
                 verb->logs,
                 "recordings (" + readable_files() + "; - reads CSV from standard input)")
      .required();
  options
      .add_text(
          "-o,--output",
          verb->folder,
          "folder for the results (made when absent; with several logs one folder each inside)")
      .required();
  options.add_flag("--force", verb->force, "overwrite results of an earlier run");
  options.add_flag("--json", verb->json, "print report.json to stdout instead of the tables");
  options.add_flag(
      "--verify",
      verb->verify,
      "simulate every channel from its model, characterize that, and compare (exit code "
      "6 when they disagree)");
  options.add_count("--seed", verb->seed, "seed of the simulation of --verify (default: 1)");
  add_reading_options(options, session, verb->analysis.options.reading);
  add_still_option(options, verb->analysis);
  add_data_options(options, verb->analysis);
  add_allan_options(options, verb->analysis);
  add_spectrum_options(options, verb->analysis.options.spectrum, verb->analysis.options.segment_s);
  add_fit_options(options, verb->analysis);
  return [&session, verb] { run_characterize(session, *verb); };
}

}  // namespace

VerbEntry verb_characterize() {
  return {2,
          "characterize",
          "everything about a recording: report.html, report.json, curves.csv, a "
          "sensor model per channel",
          characterize_options};
}

}  // namespace sensorchar
