// fit LOG | CURVE: noise coefficients with intervals, from a recording or from a curve digitised elsewhere.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis_options.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/text.hpp"
#include "libchar/core/units.hpp"
#include "libchar/core/whole_file.hpp"
#include "libchar/fit/fit_json.hpp"
#include "reading_options.hpp"
#include "verbs.hpp"

namespace sensorchar {
namespace {

using namespace libchar;

struct FitVerb {
  std::string input, output, curve = "none", quantity = "auto";
  std::optional<double> duration_s;
  bool json = false, force = false;
  AnalysisOptions analysis;
};

struct ChannelFit {
  Channel channel;
  NoiseFit fit;
};

std::string length_for_people(double seconds) {
  if (seconds < 120) return fmt::format("{} s", significant(seconds, 2));
  if (seconds < 7200) return fmt::format("{} min", significant(seconds / 60, 2));
  if (seconds < 172800) return fmt::format("{} h", significant(seconds / 3600, 2));
  if (seconds < 3.2e8) return fmt::format("{} d", significant(seconds / 86400, 2));
  return "> 10 years";
}

std::string habits(const Coefficient& term, std::size_t i, const std::string& unit) {
  std::string text;
  for (const HabitualValue& habit : habitual_units(kTermNames[i].key, unit)) {
    const double value = term.value ? *term.value : term.upper95.value_or(0);
    text += fmt::format("{}{}{} {}", text.empty() ? "" : ", ", term.value ? "" : "≤ ", significant(habit.factor * value, 4), habit.symbol);
  }
  return text;
}

std::vector<std::string> row_of(const Coefficient& term, std::size_t i, const std::string& unit) {
  const std::string value = term.value ? significant(*term.value, 5) : term.upper95 ? "≤ " + significant(*term.upper95, 3) : "–";
  const std::string interval = term.value ? fmt::format("{} … {}", significant(term.ci95.low, 4), significant(term.ci95.high, 4)) : "";
  std::string status(name_of(term.status));
  std::replace(status.begin(), status.end(), '_', ' ');
  return {fmt::format("{} {}", kTermNames[i].key, kTermNames[i].letter), value, interval, term_unit(kTermNames[i].key, printable(unit)), status,
          term.bound ? fmt::format("{} %", significant(100 * *term.bound, 2)) : "", term.seconds_for_10_percent ? length_for_people(*term.seconds_for_10_percent) : "",
          habits(term, i, unit)};
}

std::string for_people(const ChannelFit& result) {
  const NoiseFit& fit = result.fit;
  std::string text = fmt::format("{}{}\n", printable(result.channel.name), result.channel.unit.empty() ? "" : fmt::format(" [{}]", printable(result.channel.unit)));
  std::vector<std::vector<std::string>> rows = {{"term", "value", "95 % interval", "unit", "status", "at best", "10 % needs", "in other words"}};
  for (std::size_t i = 0; i < kTerms; ++i) {
    if (fit.term[i].status != Status::not_fitted) rows.push_back(row_of(fit.term[i], i, result.channel.unit));
  }
  text += table(rows);
  if (fit.bandwidth_hz) text += fmt::format("  low-pass corner {} Hz ({} … {})\n", significant(*fit.bandwidth_hz, 4), significant(fit.bandwidth_ci95->low, 4), significant(fit.bandwidth_ci95->high, 4));
  text += fmt::format("  {}; goodness of fit: chi-square {} for {} degrees of freedom, p = {}\n", fit.method, significant(fit.goodness.chi2, 4), significant(fit.goodness.dof, 4), significant(fit.goodness.p, 2));
  if (fit.second_opinion) text += fmt::format("  second opinion (covariance-weighted Allan fit): {}\n", fit.second_opinion->sentence);
  for (const Remedy& remedy : fit.remedies) text += fmt::format("  remedy {}: {} – because {}\n", remedy.kind, remedy.action, remedy.alarm);
  for (const std::string& sentence : fit.sentences) text += fmt::format("  {}\n", sentence);
  return text;
}

std::vector<ChannelFit> fit_log(Session& session, const FitVerb& verb, LogInfo& log) {
  CharacterizeOptions options = finish(verb.analysis);
  options.wanted = {.quality = false, .allan = options.fit.second_opinion, .spectrum = false, .fit = true};
  Characterization result = characterize(verb.input, options, session.terminal);
  log = result.log;
  std::vector<ChannelFit> fits;
  for (ChannelResult& c : result.channels) {
    for (const std::string& problem : c.problems) session.terminal.note(fmt::format("{}: {}", printable(c.channel.name), printable(problem)));
    if (c.fit) fits.push_back({c.channel, std::move(*c.fit)});
  }
  return fits;
}

/// The first column is the averaging time or the frequency, every other one a curve.
std::vector<ChannelFit> fit_curves(Session& session, const FitVerb& verb, LogInfo& log) {
  CharacterizeOptions options = finish(verb.analysis);
  const std::optional<double> rate_hz = options.reading.rate_hz;
  options.reading.time_column = "none";
  options.reading.rate_hz = 1;  // rows of a curve have no time
  const Recording table = read_recording(verb.input, options.reading, session.terminal);
  log = table.info;
  if (table.samples.size() < 2) throw Error({ErrorKind::input, "", verb.input, "a curve needs two columns: averaging time or frequency, and values", "", ""});
  std::vector<ChannelFit> fits;
  for (std::size_t c = 1; c < table.samples.size(); ++c) {
    DigitisedCurve curve;
    curve.is_allan = verb.curve == "allan";
    curve.sides = verb.analysis.sides == "two" ? Sides::two : Sides::one;
    curve.root = verb.quantity == "auto" ? curve.is_allan : verb.quantity == "root";
    curve.duration_s = verb.duration_s;
    curve.rate_hz = rate_hz;
    for (std::size_t i = 0; i < table.samples[0].size(); ++i) {
      if (std::isnan(table.samples[0][i]) || std::isnan(table.samples[c][i])) continue;
      curve.x.push_back(table.samples[0][i]);
      curve.y.push_back(table.samples[c][i]);
    }
    fits.push_back({table.info.channels[c], fit_curve(curve, options.fit)});
  }
  return fits;
}

void run_fit(Session& session, const FitVerb& verb) {
  LogInfo log;
  const std::vector<ChannelFit> fits = verb.curve == "none" ? fit_log(session, verb, log) : fit_curves(session, verb, log);
  session.terminal.clear();
  report_warnings(session, log);
  if (fits.empty()) throw Error({ErrorKind::numeric, "E0711", verb.input, "no channel could be fitted", "", log.time.rate_hz > 0 ? "" : "the log has no time axis: give --rate"});
  std::string text;
  if (verb.json) {
    Json document = document_head(session, "noise-fit", {&log});
    document["channels"] = Json::array();
    for (const ChannelFit& c : fits) document["channels"].push_back(noise_fit_json(c.channel.name, c.channel.unit, c.fit));
    text = dump_json(document);
  } else {
    for (const ChannelFit& c : fits) text += (text.empty() ? "" : "\n") + for_people(c);
  }
  if (verb.output.empty()) {
    print(text);
  } else {
    refuse_same_file(verb.input, verb.output);
    write_whole_file(verb.output, text, verb.force);
  }
  for (const ChannelFit& c : fits) {
    if (!c.fit.converged) throw Error({ErrorKind::numeric, "E0712", verb.input, fmt::format("the fit of {} did not converge; its result is marked", c.channel.name), "", ""});
  }
}

}  // namespace

void add_fit(CLI::App& app, Session& session) {
  auto verb = std::make_shared<FitVerb>();
  CLI::App* sub = add_verb(app, session, "fit", "noise coefficients with 95 % intervals, from a log or from a curve digitised elsewhere", [&session, verb] { run_fit(session, *verb); });
  sub->add_option("LOG|CURVE", verb->input, "recording (.csv, .npy, raw with sidecar), or with --curve a table: averaging time or frequency, then values")->required();
  add_choice(*sub, "--curve", verb->curve, {"none", "allan", "psd"}, "the input is a curve: Allan deviation over s, or spectral density over Hz (none)");
  add_choice(*sub, "--sides", verb->analysis.sides, {"one", "two"}, "of a --curve psd (one)");
  add_choice(*sub, "--quantity", verb->quantity, {"auto", "root", "power"}, "values of a --curve: root (deviation, U/√Hz) or power (variance, U²/Hz) (auto: allan root, psd power)");
  add_duration(*sub, "--duration", verb->duration_s, "length of the record behind a --curve allan: gives honest intervals");
  sub->add_option("-o,--output", verb->output, "write there instead of to stdout");
  sub->add_flag("--force", verb->force, "overwrite the output file");
  sub->add_flag("--json", verb->json, "one JSON document instead of a table");
  add_reading_options(*sub, session, verb->analysis.options.reading);
  add_data_options(*sub, verb->analysis);
  add_fit_options(*sub, verb->analysis);
}

}  // namespace sensorchar
