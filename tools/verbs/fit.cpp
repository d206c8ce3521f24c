// fit LOG | CURVE: noise coefficients with intervals, from a recording or from a curve digitised elsewhere.

#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "analysis_options.hpp"
#include "libchar/characterize/curves/curve_table_fit.hpp"
#include "libchar/characterize/judgement.hpp"
#include "libchar/characterize/model_from_fit.hpp"
#include "libchar/core/file/output_files.hpp"
#include "libchar/core/file/whole_file.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/spelling.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/core/text/text_table.hpp"
#include "libchar/fit/fit_json.hpp"
#include "libchar/log/channel_names.hpp"
#include "libchar/log/formats.hpp"
#include "libchar/log/quality.hpp"
#include "libchar/log/read.hpp"
#include "libchar/model/model_file.hpp"
#include "libchar/report/text/characterization_text.hpp"
#include "reading_options.hpp"
#include "verb.hpp"

namespace sensorchar {
namespace {

using namespace libchar;

struct FitVerb {
  std::string input, output, models, curve = "none", quantity = "auto";
  std::optional<double> duration_s;
  bool json = false, force = false;
  AnalysisOptions analysis;
};

/// What is known of a channel without a fit.
struct Unfitted {
  Channel channel;
  std::vector<Finding> findings;
};

// Each list of findings once, with the channels that have it.
void report_unfitted(Session& session, const std::vector<Unfitted>& unfitted) {
  std::map<std::string, std::vector<std::string>> channels;
  std::vector<const Unfitted*> first;
  for (const Unfitted& one : unfitted) {
    std::vector<std::string>& alike = channels[findings_text(one.findings)];
    if (alike.empty()) first.push_back(&one);
    alike.push_back(one.channel.name);
  }
  for (const Unfitted* one : first)
    report_findings(session, first_names(channels[findings_text(one->findings)]), one->findings);
}

std::vector<ChannelFit> fit_log(Session& session, const FitVerb& verb, LogInfo& log, std::vector<Unfitted>& unfitted) {
  CharacterizeOptions options = finish(verb.analysis);
  options.wanted = {.quality = false, .allan = options.fit.second_opinion, .spectrum = false, .fit = true};
  Characterization result = characterize(verb.input, options, session.terminal);
  log = result.log;
  if (result.still) session.terminal.note(printable(result.still->sentence));
  std::vector<ChannelFit> fits;
  for (ChannelResult& c : result.channels) {
    std::vector<Finding> found = findings_of(c);
    if (!c.fit) {
      unfitted.push_back({c.channel, std::move(found)});
      continue;
    }
    fits.push_back({c.channel, std::move(*c.fit)});
    fits.back().fit.findings = std::move(found);
  }
  report_unfitted(session, unfitted);
  return fits;
}

std::vector<ChannelFit> fit_curves(Session& session, const FitVerb& verb, LogInfo& log) {
  const CharacterizeOptions analysis = finish(verb.analysis);
  CurveTableOptions options;
  options.is_allan = verb.curve == "allan";
  options.sides = verb.analysis.options.spectrum.sides;
  if (verb.quantity != "auto") options.root = verb.quantity == "root";
  options.duration_s = verb.duration_s;
  options.reading = analysis.reading;
  options.fit = analysis.fit;
  CurveTableFit fitted = fit_curve_table(verb.input, options, session.terminal);
  log = fitted.table;
  return std::move(fitted.channels);
}

std::string obtained_from(const FitVerb& verb) {
  return verb.curve == "none"    ? "fit of a recording"
         : verb.curve == "allan" ? "fit of an Allan curve"
                                 : "fit of a spectrum";
}

std::string model_path(const FitVerb& verb, const Channel& channel, std::set<std::string>& taken) {
  const std::string name = unused_file_name_for(channel.name, taken) + ".sensor.yaml";
  return (std::filesystem::path(verb.models) / name).string();
}

// One sensor model a channel; all are written before the first gets its name.
void write_models(const FitVerb& verb, const std::vector<ChannelFit>& fits, const LogInfo& log) {
  std::vector<OutputFile> models;
  models.reserve(fits.size());
  std::set<std::string> taken;
  for (const ChannelFit& c : fits) {
    models.push_back({model_path(verb, c.channel, taken),
                      model_yaml(sensor_model_from_curve(c.channel, c.fit, obtained_from(verb), log))});
  }
  write_outputs(models, verb.models, {verb.input}, verb.force);
}

// Models that are in the way are told before the log is analysed, where its channels can be looked up.
void foresee_models(const FitVerb& verb) {
  std::vector<std::string> models;
  if (verb.curve == "none" && !read_once(verb.input)) {
    std::set<std::string> taken;
    for (const Channel& channel : read_log_head(verb.input, verb.analysis.options.reading).channels)
      models.push_back(model_path(verb, channel, taken));
  }
  if (!verb.output.empty()) {
    std::vector<std::string> all = models;
    all.push_back(verb.output);
    all.push_back((std::filesystem::path(verb.models) / "any.sensor.yaml").string());
    refuse_one_name(all);
  }
  foresee_outputs(models, verb.models, {verb.input}, verb.force);
}

void run_fit(Session& session, const FitVerb& verb) {
  refuse_standard_output("--models", verb.models);
  foresee_output(verb.output, {verb.input}, verb.force);
  if (!verb.models.empty()) foresee_models(verb);
  LogInfo log;
  std::vector<Unfitted> unfitted;
  const std::vector<ChannelFit> fits =
      verb.curve == "none" ? fit_log(session, verb, log, unfitted) : fit_curves(session, verb, log);
  session.terminal.clear();
  report_warnings(session, log);
  if (fits.empty())
    throw numeric_error("E0711", verb.input)
        .says("no channel could be fitted")
        .hint(log.time.rate_hz > 0 ? "" : "the sampling rate is not known: " + libchar::detail::rate_remedy(log.time));
  if (!verb.output.empty() || !verb.models.empty()) refuse_strict(session);
  std::string text;
  if (verb.json) {
    Json document = document_head(session, "noise-fit", {&log});
    Json channels = Json::array();
    for (const ChannelFit& c : fits) channels.push_back(noise_fit_json(c.channel.name, c.channel.unit, c.fit));
    for (const Unfitted& c : unfitted) channels.push_back(no_fit_json(c.channel.name, c.channel.unit, c.findings));
    document.update(noise_fit_document(std::move(channels)));
    if (log.stretch_s) document["stretch_s"] = {log.stretch_s->low, log.stretch_s->high};
    text = dump_json(document);
  } else {
    const TextLook look = verb.output.empty() ? text_look() : TextLook{};
    for (const ChannelFit& c : fits)
      text += (text.empty() ? "" : "\n") + fit_text(c.channel, c.fit, look) +
              findings_text(c.fit.findings, 5, look.colours);
  }
  if (verb.output.empty()) {
    if (verb.json)
      print(text);
    else
      print_text(text);
  } else {
    write_whole_file(verb.output, text, verb.force);
  }
  if (!verb.models.empty()) write_models(verb, fits, log);
  for (const ChannelFit& c : fits) {
    if (!c.fit.search.converged)
      throw numeric_error("E0712", verb.input)
          .says("the fit of {} did not converge; its result is marked", c.channel.name);
  }
}

/// A curve has neither samples nor times, and a recording has no quantity.
void add_only(VerbOptions& options, const FitVerb& verb) {
  options.only("with --curve", [&verb] { return verb.curve != "none"; }, {"--quantity"});
  options.only("with --curve psd", [&verb] { return verb.curve == "psd"; }, {"--sides"});
  options.only("with --curve allan", [&verb] { return verb.curve == "allan"; }, {"--duration"});
  options.only(
      "with a recording, not with --curve", [&verb] { return verb.curve == "none"; },
      recording_flags({"--temperature", "--data", "--nominal-frequency", "--unwrap", "--frozen", "--interpolated",
                       "--memory", "--no-second-opinion", "--no-remedies"}));
}

std::function<void()> fit_options(VerbOptions& options, Session& session) {
  auto verb = std::make_shared<FitVerb>();
  options
      .add_text(
          "LOG|CURVE", verb->input,
          "recording (" + readable_files() + "), or with --curve a table: averaging time or frequency, then values")
      .required();
  options.add_choice(
      "--curve", verb->curve, {"none", "allan", "psd"},
      "kind of curve that the input is: Allan deviation over s, or spectral density over Hz (default: none)");
  options.add_enum("--sides", verb->analysis.options.spectrum.sides,
                   "sides of a --curve psd whose table does not state them (default: one)");
  options.add_choice("--quantity", verb->quantity, {"auto", "root", "power"},
                     "values of a --curve: root (deviation, U/√Hz) or power (variance, U²/Hz) (default: auto, root for "
                     "allan, power for psd)");
  options.add_duration("--duration", verb->duration_s,
                       "length of the recording that a --curve allan was computed from: makes the intervals correct");
  options.add_document_output(verb->output);
  options
      .add_text("--models", verb->models,
                "folder for a sensor model per channel (CHANNEL.sensor.yaml), for simulate and model --to")
      .value_name("FOLDER");
  options.add_flag("--force", verb->force, "overwrite the output files");
  options.add_flag("--json", verb->json, "one JSON document instead of a table");
  add_reading_options(options, session, verb->analysis.options.reading);
  add_still_option(options, verb->analysis);
  add_data_options(options, verb->analysis);
  add_fit_options(options, verb->analysis);
  add_only(options, *verb);
  return [&session, verb] {
    verb->analysis.options.reading.hash = verb->json || !verb->models.empty();  // only these state it
    run_fit(session, *verb);
  };
}

}  // namespace

VerbEntry verb_fit() {
  return {5,
          "fit",
          "Fit noise coefficients with 95 % intervals to a log, or to a curve digitized elsewhere",
          fit_options,
          {{"coefficients of every channel", "sensorchar fit imu.csv"},
           {"coefficients of an Allan curve from a data sheet, computed from 10 min of data",
            "sensorchar fit curve.csv --curve allan --duration 600"}}};
}

}  // namespace sensorchar
