// characterize LOG… -o DIR: everything about a recording, in files that can be shown to a
// colleague.

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "analysis_options.hpp"
#include "fit_table.hpp"
#include "libchar/characterize/model_from_fit.hpp"
#include "libchar/characterize/settings.hpp"
#include "libchar/characterize/verification.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/file_name.hpp"
#include "libchar/core/text.hpp"
#include "libchar/core/whole_file.hpp"
#include "libchar/log/formats.hpp"
#include "libchar/model/model_file.hpp"
#include "libchar/report/outputs.hpp"
#include "output_files.hpp"
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

std::vector<OutputFile> outputs_of(const Characterization& result, const fs::path& folder) {
  Json document = json_without_times(result);
  std::vector<OutputFile> outputs = {
      {(folder / "report.html").string(), html_report(result, document)}};
  add_times(document, result);
  outputs.push_back({(folder / "report.json").string(), dump_json(document)});
  outputs.push_back({(folder / "curves.csv").string(), csv_curves(result)});
  std::set<std::string> taken;
  for (const ChannelResult& c : result.channels) {
    if (!c.fit) continue;
    const std::string name = unused_file_name_for(c.channel.name, taken);
    outputs.push_back(
        {(folder / (name + ".sensor.yaml")).string(),
         model_yaml(sensor_model_from(c.channel, result.log, c.quality, *c.fit, c.allan))});
  }
  return outputs;
}

std::string text_for_people(const Characterization& result) {
  const LogInfo& log = result.log;
  const double rate = log.time.rate_hz;
  const std::string length =
      rate > 0 ? fmt::format("{} Hz, {} s",
                             significant(rate, 6),
                             significant(static_cast<double>(log.samples) / rate, 6))
               : fmt::format("{} sample{}, rate unknown", log.samples, log.samples == 1 ? "" : "s");
  std::string text = fmt::format("{}: {} channel{}, {}, {} gap{}\n",
                                 printable(log.file),
                                 log.channels.size(),
                                 log.channels.size() == 1 ? "" : "s",
                                 length,
                                 log.time.gaps,
                                 log.time.gaps == 1 ? "" : "s");
  for (const ChannelResult& c : result.channels) {
    text += "\n" + (c.fit ? fit_for_people(c.channel, *c.fit) : printable(c.channel.name) + "\n");
    if (c.verification)
      for (const std::string& sentence : c.verification->sentences)
        text += fmt::format("  {}\n", printable(sentence));
    for (const std::string& problem : c.problems) text += fmt::format("  {}\n", printable(problem));
  }
  return text;
}

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
    const fs::path folder = folder_for(verb, log, taken);
    const std::vector<OutputFile> outputs = outputs_of(result, folder);
    write_outputs(outputs, folder, {log}, verb.force);
    for (const ChannelResult& c : result.channels) any_fit = any_fit || c.fit;
    if (verb.json) {
      documents.push_back(json_report(result));
      continue;
    }
    print(text_for_people(result));
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

std::function<void()> add_options(VerbOptions& options, Session& session) {
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
  add_data_options(options, verb->analysis);
  add_allan_options(options, verb->analysis);
  add_spectrum_options(options, verb->analysis);
  add_fit_options(options, verb->analysis);
  return [&session, verb] { run_characterize(session, *verb); };
}

}  // namespace

VerbEntry verb_characterize() {
  return {2,
          "characterize",
          "everything about a recording: report.html, report.json, curves.csv, a "
          "sensor model per channel",
          add_options};
}

}  // namespace sensorchar
