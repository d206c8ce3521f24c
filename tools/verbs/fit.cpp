// fit LOG | CURVE: noise coefficients with intervals, from a recording or from a curve digitised elsewhere.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "analysis_options.hpp"
#include "libchar/characterize/model_from_fit.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/file_name.hpp"
#include "libchar/core/output_files.hpp"
#include "libchar/core/text.hpp"
#include "libchar/core/whole_file.hpp"
#include "libchar/fit/curve_table.hpp"
#include "libchar/fit/fit_json.hpp"
#include "libchar/log/channel_names.hpp"
#include "libchar/log/formats.hpp"
#include "libchar/log/read.hpp"
#include "libchar/model/model_file.hpp"
#include "libchar/report/fit_text.hpp"
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

struct ChannelFit {
  Channel channel;
  NoiseFit fit;
};

std::vector<ChannelFit> fit_log(Session& session, const FitVerb& verb, LogInfo& log) {
  CharacterizeOptions options = finish(verb.analysis);
  options.wanted = {
      .quality = false, .allan = options.fit.second_opinion, .spectrum = false, .fit = true};
  Characterization result = characterize(verb.input, options, session.terminal);
  log = result.log;
  if (result.still) session.terminal.note(printable(result.still->sentence));
  std::vector<ChannelFit> fits;
  for (ChannelResult& c : result.channels) {
    for (const std::string& problem : c.problems)
      session.terminal.note(fmt::format("{}: {}", printable(c.channel.name), printable(problem)));
    if (c.fit) fits.push_back({c.channel, std::move(*c.fit)});
  }
  return fits;
}

struct Table {
  std::vector<Channel> channels;
  std::vector<DigitisedCurve> curves;
  LogInfo info;
};

/// A table whose header does not name what its columns are: the first is the averaging time or the frequency, every other one a curve.
Table unnamed_table(Session& session, const FitVerb& verb, ReadOptions reading) {
  reading.time_column = "none";
  reading.rate_hz = 1;  // rows of a curve have no time
  const Recording read = read_recording(verb.input, reading, session.terminal);
  if (read.samples.size() < 2)
    throw Error({ErrorKind::input,
                 "E0803",
                 verb.input,
                 "a curve needs two columns: averaging time or frequency, and values",
                 "",
                 ""});
  Table table{{}, {}, read.info};
  for (std::size_t c = 1; c < read.samples.size(); ++c) {
    DigitisedCurve curve;
    curve.root = verb.curve == "allan";
    for (std::size_t i = 0; i < read.samples[0].size(); ++i) {
      if (std::isnan(read.samples[0][i]) || std::isnan(read.samples[c][i])) continue;
      curve.x.push_back(read.samples[0][i]);
      curve.y.push_back(read.samples[c][i]);
    }
    table.channels.push_back(read.info.channels[c]);
    table.curves.push_back(curve);
  }
  return table;
}

Table named_table(const FitVerb& verb,
                  const CurveTable& named,
                  const std::vector<std::string>& wanted) {
  Table table;
  table.info.file = verb.input;
  table.info.bytes = named.bytes;
  table.info.sha256 = named.sha256;
  for (const NamedCurve& n : named.curves) {
    if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), n.name) == wanted.end())
      continue;
    table.channels.push_back({n.name, n.unit, false});
    table.curves.push_back(n.curve);
  }
  if (table.curves.empty())
    throw Error({ErrorKind::usage,
                 "E0320",
                 verb.input,
                 "no curve of this name",
                 wanted.front(),
                 "the first one is " + named.curves.front().name});
  return table;
}

std::vector<ChannelFit> fit_curves(Session& session, const FitVerb& verb, LogInfo& log) {
  const CharacterizeOptions options = finish(verb.analysis);
  const auto named = read_curve_table(verb.input, verb.curve == "allan");
  Table table = named ? named_table(verb, *named, options.reading.channels)
                      : unnamed_table(session, verb, options.reading);
  log = table.info;
  std::vector<ChannelFit> fits;
  for (std::size_t c = 0; c < table.curves.size(); ++c) {
    DigitisedCurve& curve = table.curves[c];
    curve.is_allan = verb.curve == "allan";
    curve.sides = verb.analysis.options.spectrum.sides;
    if (verb.quantity != "auto") curve.root = verb.quantity == "root";
    const std::vector<std::string>& units = options.reading.units;
    if (named && !units.empty()) table.channels[c].unit = units[std::min(c, units.size() - 1)];
    curve.duration_s = verb.duration_s;
    curve.rate_hz = options.reading.rate_hz;
    fits.push_back({table.channels[c], fit_curve(curve, options.fit)});
  }
  return fits;
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
  std::set<std::string> taken;
  for (const ChannelFit& c : fits) {
    models.push_back(
        {model_path(verb, c.channel, taken),
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
  foresee_outputs(models, verb.models, {verb.input}, verb.force);
}

// A curve has neither samples nor times.
void refuse_with_curve(const FitVerb& verb) {
  const CharacterizeOptions& o = verb.analysis.options;
  if (verb.curve == "none") return;
  const bool still = o.still.search || o.still.stretch_s;
  if (still || !o.temperature.empty())
    throw Error({ErrorKind::usage,
                 "E0205",
                 still ? "--still" : "--temperature",
                 "goes with a recording, not with --curve",
                 "",
                 ""});
}

void run_fit(Session& session, const FitVerb& verb) {
  refuse_with_curve(verb);
  foresee_output(verb.output, {verb.input}, verb.force);
  if (!verb.models.empty()) foresee_models(verb);
  LogInfo log;
  const std::vector<ChannelFit> fits =
      verb.curve == "none" ? fit_log(session, verb, log) : fit_curves(session, verb, log);
  session.terminal.clear();
  report_warnings(session, log);
  if (fits.empty())
    throw Error({ErrorKind::numeric,
                 "E0711",
                 verb.input,
                 "no channel could be fitted",
                 "",
                 log.time.rate_hz > 0
                     ? ""
                     : "the sampling rate is not known: a log without time stamps needs --rate"});
  std::string text;
  if (verb.json) {
    Json document = document_head(session, "noise-fit", {&log});
    Json channels = Json::array();
    for (const ChannelFit& c : fits)
      channels.push_back(noise_fit_json(c.channel.name, c.channel.unit, c.fit));
    document.update(noise_fit_document(std::move(channels)));
    if (log.stretch_s) document["stretch_s"] = {log.stretch_s->low, log.stretch_s->high};
    text = dump_json(document);
  } else {
    for (const ChannelFit& c : fits)
      text += (text.empty() ? "" : "\n") + fit_text(c.channel, c.fit);
  }
  if (verb.output.empty()) {
    print(text);
  } else {
    write_whole_file(verb.output, text, verb.force);
  }
  if (!verb.models.empty()) write_models(verb, fits, log);
  for (const ChannelFit& c : fits) {
    if (!c.fit.converged)
      throw Error(
          {ErrorKind::numeric,
           "E0712",
           verb.input,
           fmt::format("the fit of {} did not converge; its result is marked", c.channel.name),
           "",
           ""});
  }
}

std::function<void()> fit_options(VerbOptions& options, Session& session) {
  auto verb = std::make_shared<FitVerb>();
  options
      .add_text("LOG|CURVE",
                verb->input,
                "recording (" + readable_files() +
                    "), or with --curve a table: averaging "
                    "time or frequency, then values")
      .required();
  options.add_choice(
      "--curve",
      verb->curve,
      {"none", "allan", "psd"},
      "the input is a curve: Allan deviation over s, or spectral density over Hz (none)");
  options.add_enum("--sides", verb->analysis.options.spectrum.sides, "of a --curve psd (one)");
  options.add_choice(
      "--quantity",
      verb->quantity,
      {"auto", "root", "power"},
      "values of a --curve: root (deviation, U/√Hz) or power (variance, U²/Hz) (auto: allan "
      "root, psd power)");
  options.add_duration("--duration",
                       verb->duration_s,
                       "length of the record behind a --curve allan: gives honest intervals");
  options.add_text("-o,--output", verb->output, "write there instead of to stdout");
  options
      .add_text("--models",
                verb->models,
                "folder for a sensor model per channel (CHANNEL.sensor.yaml), for simulate and "
                "model --to")
      .value_name("FOLDER");
  options.add_flag("--force", verb->force, "overwrite the output files");
  options.add_flag("--json", verb->json, "one JSON document instead of a table");
  add_reading_options(options, session, verb->analysis.options.reading);
  add_still_option(options, verb->analysis);
  add_data_options(options, verb->analysis);
  add_fit_options(options, verb->analysis);
  return [&session, verb] { run_fit(session, *verb); };
}

}  // namespace

VerbEntry verb_fit() {
  return {5,
          "fit",
          "noise coefficients with 95 % intervals, from a log or from a curve digitised elsewhere",
          fit_options};
}

}  // namespace sensorchar
