// allan LOG: deviations of every channel as a table or JSON.

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "analysis_options.hpp"
#include "libchar/characterize/judgement.hpp"
#include "libchar/characterize/log_devices.hpp"
#include "libchar/core/file/whole_file.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/quantity_text.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/formats.hpp"
#include "libchar/log/quality.hpp"
#include "libchar/report/text/curves_text.hpp"
#include "reading_options.hpp"
#include "terminal_plot.hpp"
#include "verb.hpp"

namespace sensorchar {
namespace {

using namespace libchar;

struct AllanVerb {
  std::string log, output;
  bool json = false, force = false, plot = false;
  bool hat = false, hat_of_differences = false;
  std::optional<DynamicTimes> dynamic;
  AnalysisOptions analysis;
};

// "1h" or "1h,10min".
DynamicTimes read_dynamic(const std::string& text) {
  const std::size_t comma = text.find(',');
  DynamicTimes times;
  times.window_s = parse_duration_s(text.substr(0, comma), true);
  if (comma != std::string::npos) times.step_s = parse_duration_s(text.substr(comma + 1), true);
  return times;
}

LogAllanOptions devices_options(const AllanVerb& verb) {
  const CharacterizeOptions all = finish(verb.analysis);
  if (!all.more_types.empty())
    throw usage_error("E0205", "--type")
        .says("one statistic at a time goes with --hat, --hat-pairs and --dynamic")
        .got(std::string(name_of(all.more_types[0])));
  LogAllanOptions options{all.reading, all.data, all.nominal_frequency, all.allan};
  if (all.full_overlap) options.allan.work_a_point = 0;
  return options;
}

void run_hat(Session& session, const AllanVerb& verb) {
  const LogHat hat = log_cornered_hat(verb.log, devices_options(verb), verb.hat_of_differences, session.terminal);
  session.terminal.clear();
  for (const std::string& note : hat.hat.notes) session.terminal.note(note);
  write_document(session, hat.log, "cornered-hat", hat_json(hat), hat_csv(hat), {verb.output, verb.json, verb.force});
}

void run_dynamic(Session& session, const AllanVerb& verb) {
  const LogDynamic dynamic = log_dynamic_deviation(verb.log, devices_options(verb), *verb.dynamic, session.terminal);
  session.terminal.clear();
  for (std::size_t c = 0; c < dynamic.channels.size(); ++c)
    for (const std::string& note : dynamic.deviations[c].notes)
      session.terminal.note(printable(dynamic.channels[c].name) + ": " + note);
  write_document(session, dynamic.log, "dynamic-allan", dynamic_json(dynamic), dynamic_csv(dynamic),
                 {verb.output, verb.json, verb.force});
}

void run_allan(Session& session, const AllanVerb& verb) {
  foresee_output(verb.output, {verb.log}, verb.force);
  if (verb.hat || verb.hat_of_differences) return run_hat(session, verb);
  if (verb.dynamic) return run_dynamic(session, verb);
  CharacterizeOptions options = finish(verb.analysis);
  options.wanted = {.quality = false, .allan = true, .spectrum = false, .fit = false};
  options.fit.second_opinion = false;
  const Characterization result = characterize(verb.log, options, session.terminal);
  session.terminal.clear();
  report_warnings(session, result.log);
  if (result.still) session.terminal.note(printable(result.still->sentence));
  std::vector<Channel> channels;
  std::vector<AllanCurve> curves;
  std::vector<std::vector<Finding>> known, findings;  // a channel; a curve
  bool any = false;
  for (const ChannelResult& c : result.channels) {
    const auto note = [&](const std::string& text) {
      session.terminal.note(fmt::format("{}: {}", printable(c.channel.name), printable(text)));
    };
    const auto take = [&](const AllanCurve& curve) {
      any = any || !curve.points.empty();
      findings.push_back(known.back());
      channels.push_back(c.channel);
      curves.push_back(curve);
      const std::string which = c.more_allan.empty() ? "" : std::string(name_of(curve.type)) + ": ";
      for (const std::string& text : curve.notes) note(which + text);
    };
    known.push_back(detail::findings_of_curve(c));
    report_findings(session, c.channel.name, known.back());
    take(c.allan);
    for (const AllanCurve& curve : c.more_allan) take(curve);
  }
  if (!any)
    throw numeric_error("E0710", verb.log)
        .says("no channel gives an Allan deviation")
        .hint(result.log.time.rate_hz > 0
                  ? ""
                  : "the sampling rate is not known: " + libchar::detail::rate_remedy(result.log.time));
  std::string text;
  if (verb.plot) {
    std::vector<SourceCurve> drawn;
    for (std::size_t c = 0; c < channels.size(); ++c)
      drawn.push_back(source_curve(channels[c].name, channels[c].unit, curves[c]));
    text = terminal_plots(drawn);
  } else if (verb.json) {
    Json document = document_head(session, "allan", {&result.log});
    document.update(allan_json(channels, curves, findings));
    text = dump_json(document);
  } else {
    text = allan_csv(channels, curves, findings, result.log.warnings);
  }
  if (verb.output.empty()) return print(text);
  refuse_strict(session);
  write_whole_file(verb.output, text, verb.force);
}

std::function<void()> allan_options(VerbOptions& options, Session& session) {
  auto verb = std::make_shared<AllanVerb>();
  options.add_text("LOG", verb->log, "recording (" + readable_files() + "; - reads CSV from standard input)")
      .required();
  options.add_document_output(verb->output);
  options.add_flag("--force", verb->force, "overwrite the output file");
  const Option json = options.add_flag("--json", verb->json, "one JSON document instead of CSV");
  const Option hat = options.add_flag("--hat", verb->hat,
                                      "deviations of single devices from three or more channels that measure the same "
                                      "quantity (three-cornered hat, or any number of corners)");
  Option pairs = options.add_flag("--hat-pairs", verb->hat_of_differences,
                                  "the same for three channels that are measured differences a - b, b - c, c - a");
  pairs.excludes(hat);
  Option dynamic = options.add_parsed(
      "--dynamic", "WINDOW[,STEP]",
      [verb = verb.get()](const std::string& text) { verb->dynamic = read_dynamic(text); },
      "one curve per window of this length, moved by STEP (default: half of it)");
  options.add_flag("--plot", verb->plot, "a plot for the terminal instead of CSV")
      .excludes(json)
      .excludes(hat)
      .excludes(pairs)
      .excludes(dynamic);
  dynamic.excludes(hat).excludes(pairs);
  add_reading_options(options, session, verb->analysis.options.reading);
  add_still_option(options, verb->analysis);
  add_data_options(options, verb->analysis);
  verb->analysis.several_types = true;
  add_allan_options(options, verb->analysis);
  const auto plain = [verb = verb.get()] { return !verb->hat && !verb->hat_of_differences && !verb->dynamic; };
  options.only("without --hat, --hat-pairs and --dynamic", plain,
               {"--still", "--unwrap", "--frozen", "--interpolated", "--memory"});
  options.only("with --type mtotdev, ttotdev or htotdev, without --hat, --hat-pairs and --dynamic",
               [plain, verb = verb.get()] { return plain() && has_bias(verb->analysis); }, {"--bias"});
  return [&session, verb] {
    verb->analysis.options.reading.hash = verb->json;  // only the document states it
    run_allan(session, *verb);
  };
}

}  // namespace

VerbEntry verb_allan() {
  return {3,
          "allan",
          "Compute Allan deviations and their relatives, with intervals, as CSV or JSON",
          allan_options,
          {{"a few averaging times of one channel", "sensorchar allan imu.csv -c gyro_z --taus 0.1s,1s,10s"},
           {"the modified deviation of all gyroscopes, into a table",
            "sensorchar allan imu.csv -c 'gyro*' --type mdev -o mdev.csv"}}};
}

}  // namespace sensorchar
