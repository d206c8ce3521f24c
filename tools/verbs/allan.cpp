// allan LOG: deviations of every channel as a table or JSON.

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "analysis_options.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/text.hpp"
#include "libchar/core/whole_file.hpp"
#include "libchar/log/formats.hpp"
#include "libchar/report/allan_text.hpp"
#include "reading_options.hpp"
#include "verb.hpp"

namespace sensorchar {
namespace {

using namespace libchar;

struct AllanVerb {
  std::string log, output;
  bool json = false, force = false;
  AnalysisOptions analysis;
};

void run_allan(Session& session, const AllanVerb& verb) {
  foresee_output(verb.output, {verb.log}, verb.force);
  CharacterizeOptions options = finish(verb.analysis);
  options.wanted = {.quality = false, .allan = true, .spectrum = false, .fit = false};
  options.fit.second_opinion = false;
  const Characterization result = characterize(verb.log, options, session.terminal);
  session.terminal.clear();
  report_warnings(session, result.log);
  std::vector<Channel> channels;
  std::vector<AllanCurve> curves;
  bool any = false;
  for (const ChannelResult& c : result.channels) {
    any = any || !c.allan.points.empty();
    channels.push_back(c.channel);
    curves.push_back(c.allan);
    for (const std::string& problem : c.problems)
      session.terminal.note(fmt::format("{}: {}", printable(c.channel.name), printable(problem)));
    for (const std::string& note : c.allan.notes)
      session.terminal.note(fmt::format("{}: {}", printable(c.channel.name), printable(note)));
  }
  if (!any)
    throw Error({ErrorKind::numeric,
                 "E0710",
                 verb.log,
                 "no channel gives an Allan deviation",
                 "",
                 result.log.time.rate_hz > 0
                     ? ""
                     : "the sampling rate is not known: a log without time stamps needs --rate"});
  std::string text;
  if (verb.json) {
    Json document = document_head(session, "allan", {&result.log});
    document.update(allan_json(channels, curves));
    text = dump_json(document);
  } else {
    text = allan_csv(channels, curves);
  }
  if (verb.output.empty()) return print(text);
  write_whole_file(verb.output, text, verb.force);
}

std::function<void()> allan_options(VerbOptions& options, Session& session) {
  auto verb = std::make_shared<AllanVerb>();
  options
      .add_text(
          "LOG", verb->log, "recording (" + readable_files() + "; - reads CSV from standard input)")
      .required();
  options.add_text("-o,--output", verb->output, "write there instead of to stdout")
      .value_name("FILE");
  options.add_flag("--force", verb->force, "overwrite the output file");
  options.add_flag("--json", verb->json, "one JSON document instead of CSV");
  add_reading_options(options, session, verb->analysis.options.reading);
  add_data_options(options, verb->analysis);
  add_allan_options(options, verb->analysis);
  return [&session, verb] { run_allan(session, *verb); };
}

}  // namespace

VerbEntry verb_allan() {
  return {3,
          "allan",
          "Allan deviation of every channel, with chi-square intervals, as CSV or JSON",
          allan_options,
          {{"a few averaging times of one channel",
            "sensorchar allan imu.csv -c gyro_z --taus 0.1s,1s,10s"},
           {"the modified deviation of all gyroscopes, into a table",
            "sensorchar allan imu.csv -c 'gyro*' --type mdev -o mdev.csv"}}};
}

}  // namespace sensorchar
