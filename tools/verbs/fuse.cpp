// fuse LOG --with RUN_OR_FILE -o FILE: a log fused with what a replay learnt, streaming.

#include "libchar/replay/fuse.hpp"

#include <memory>
#include <nlohmann/json.hpp>

#include "libchar/core/file/output_files.hpp"
#include "libchar/core/file/whole_file.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/report/replay/replay_text.hpp"
#include "reading_options.hpp"
#include "verb.hpp"
#include "writing_options.hpp"

namespace sensorchar {
namespace {

struct FuseVerb {
  std::string log, with, output;
  std::vector<std::string> map;
  libchar::FuseOptions options;
  WritingOptions writing;
  bool json = false;
};

// "gyro1=wx": a sensor of the file and its channel in the log.
void add_map(const FuseVerb& verb, libchar::FuseOptions& options) {
  for (const std::string& text : verb.map) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
      throw libchar::usage_error("E0935", "--map").says("expected SENSOR=CHANNEL").got(text).hint("--map gyro1=wx");
    options.map.emplace_back(text.substr(0, equals), text.substr(equals + 1));
  }
}

void run_fuse(Session& session, FuseVerb& verb) {
  add_map(verb, verb.options);
  take_standard_output(verb.output, verb.writing, verb.json);
  const libchar::LearntFusion learnt = libchar::read_fusion_file(verb.with);
  for (const std::string& input : {verb.log, verb.with, learnt.file})
    for (const char* suffix : {"", ".json"}) libchar::refuse_same_file(input, verb.output + suffix);
  libchar::check_log_output(verb.output, write_options(verb.writing));
  libchar::ColumnWriter writer(verb.output, write_options(verb.writing));
  const libchar::FuseResult result = libchar::fuse(verb.log, learnt, writer, verb.options, session.terminal);
  session.terminal.clear();
  report_warnings(session, result.log);
  session.terminal.warn(result.warnings, verb.log);
  // With --strict nothing is written from a log that has warnings.
  if (session.strict && !result.log.warnings.empty()) return;
  session.terminal.update(1, "writing " + verb.output);  // the last chance to be stopped
  const std::vector<std::string> files = writer.finish();
  for (const std::string& loss : writer.losses()) session.terminal.note("not kept: " + loss);
  if (!verb.json) return print_summary(session, verb.output, libchar::fuse_text(result, files));
  print(libchar::dump_json(libchar::fuse_json(result, session.command, files)));
}

std::function<void()> fuse_options(VerbOptions& options, Session& session) {
  const auto verb = std::make_shared<FuseVerb>();
  options.add_text("LOG", verb->log, "log to fuse").required();
  options.add_text("--with", verb->with, "folder of a replay, or the fusion.yaml in it (docs/fuse.md)")
      .required()
      .value_name("RUN");
  options
      .add_text("-o,--output", verb->output,
                "file to write; its suffix says the format (" + libchar::written_suffixes() + "; - is standard output)")
      .required()
      .value_name("FILE");
  options
      .add_text("--algorithm", verb->options.algorithm,
                "algorithm, by its name in the replay's report (default: the recommended one)")
      .value_name("NAME");
  options
      .add_texts("--map", verb->map, "channels of sensors whose names differ from those in the replay, SENSOR=CHANNEL")
      .separated_by_commas()
      .one_value_each()
      .value_name("SENSOR=CHANNEL,…")
      .once_each();
  options.add_instant(
      "--fault-free", verb->options.fault_free_s,
      "time at the start of this log in which no sensor fails (default: unknown, unless the replay used this log)");
  add_writing_options(options, verb->writing, "t[s] or t[ns]", verb->output);
  options.add_flag("--force", verb->writing.options.overwrite, "overwrite an existing file");
  options.add_flag("--json", verb->json, "one JSON document on stdout instead of text");
  add_reading_options(options, session, verb->options.reading);
  return [&session, verb] { run_fuse(session, *verb); };
}

}  // namespace

VerbEntry verb_fuse() {
  return {9,
          "fuse",
          "Fuse a log with the result of a replay: estimates, deviations, one flag per sensor",
          fuse_options,
          {{"a log, by the recommended algorithm", "sensorchar fuse array.csv --with array-replay -o fused.csv"},
           {"by another algorithm of that replay, as NumPy file",
            "sensorchar fuse array.csv --with array-replay --algorithm mean -o fused.npy"}}};
}

}  // namespace sensorchar
