// psd LOG: power spectra of every channel as a table or JSON, or the lines in them.

#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "analysis_options.hpp"
#include "libchar/characterize/curves/log_spectra.hpp"
#include "libchar/characterize/judgement.hpp"
#include "libchar/core/file/whole_file.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/log/formats.hpp"
#include "libchar/report/text/curves_text.hpp"
#include "reading_options.hpp"
#include "terminal_plot.hpp"
#include "verb.hpp"

namespace sensorchar {
namespace {

using namespace libchar;

struct PsdVerb {
  std::string log, output;
  AnalysisOptions analysis;
  bool json = false, force = false, plot = false;
  std::vector<std::string> cross, coherence;
  std::string spectrogram;
};

void run_cross(Session& session, const PsdVerb& verb, const CharacterizeOptions& options) {
  const bool density = !verb.cross.empty();
  const std::vector<std::string>& pair = density ? verb.cross : verb.coherence;
  if (pair.size() != 2)
    throw usage_error("E0873", density ? "--cross" : "--coherence")
        .says("two channels were expected")
        .got(std::to_string(pair.size()))
        .hint("for example --coherence gyro_x,gyro_y");
  const LogCrossSpectrum cross = log_cross_spectrum(verb.log, pair[0], pair[1], options, session.terminal);
  session.terminal.clear();
  for (const std::string& note : cross.cross.notes) session.terminal.note(note);
  session.terminal.note(
      fmt::format("coherence of independent channels stays below {} with 95 % ({} segments, as {} independent)",
                  brief_text(cross.cross.significant_coherence, 3), cross.cross.segments,
                  brief_text(cross.cross.effective_segments, 3)));
  write_document(session, cross.log, "cross-spectrum", cross_json(cross),
                 density ? cross_csv(cross) : coherence_csv(cross), {verb.output, verb.json, verb.force});
}

void run_spectrogram(Session& session, const PsdVerb& verb, const CharacterizeOptions& options) {
  const LogSpectrograms spectrograms = log_spectrograms(verb.log, options, session.terminal);
  session.terminal.clear();
  write_document(session, spectrograms.log, "spectrogram", spectrograms_json(spectrograms),
                 spectrograms_csv(spectrograms), {verb.output, verb.json, verb.force});
}

void run_psd(Session& session, const PsdVerb& verb) {
  foresee_output(verb.output, {verb.log}, verb.force);
  const CharacterizeOptions options = finish(verb.analysis);
  if (!verb.cross.empty() || !verb.coherence.empty()) return run_cross(session, verb, options);
  if (!verb.spectrogram.empty()) return run_spectrogram(session, verb, options);
  const LogSpectra spectra = log_spectra(verb.log, options, session.terminal);
  session.terminal.clear();
  for (const std::string& note : spectra.notes) session.terminal.note(note);
  report_warnings(session, spectra.log);
  for (const ChannelResult& c : spectra.channels) report_findings(session, c.channel.name, findings_of(c));
  std::string text;
  if (verb.plot) {
    std::vector<SourceCurve> drawn;
    for (const ChannelResult& c : spectra.channels)
      drawn.push_back(source_curve(c.channel.name, c.channel.unit, c.spectrum));
    text = terminal_plots(drawn);
  } else if (verb.json) {
    Json document = document_head(session, "spectrum", {&spectra.log});
    document.update(spectra_json(spectra, options));
    text = dump_json(document);
  } else {
    text = options.wanted.lines ? lines_csv(spectra) : spectra_csv(spectra);
  }
  if (verb.output.empty()) return print(text);
  refuse_strict(session);
  write_whole_file(verb.output, text, verb.force);
}

/// What each option is for: spectra, lines, a pair, a spectrogram.
void add_only(VerbOptions& options, const PsdVerb& verb) {
  const auto single = [&verb] { return verb.cross.empty() && verb.coherence.empty() && verb.spectrogram.empty(); };
  const auto of_table = [&verb] { return !verb.analysis.options.wanted.lines || verb.json; };
  options.only(
      "for spectra of single channels", single,
      {"--average", "--data", "--nominal-frequency", "--still", "--unwrap", "--frozen", "--interpolated", "--memory"});
  options.only("for spectra of single channels, and not with --plot",
               [&verb, single] { return single() && !verb.plot; }, {"--lines"});
  options.only("for spectra of single channels, and not for a table of --lines",
               [single, of_table] { return single() && of_table(); }, {"--log-bins"});
  options.only("for spectra of single channels and spectrograms, and not for a table of --lines",
               [&verb, of_table] { return verb.cross.empty() && verb.coherence.empty() && of_table(); }, {"--scaling"});
  options.only("without --coherence, and not for a table of --lines",
               [&verb, of_table] { return verb.coherence.empty() && of_table(); }, {"--sides"});
  options.only("without --spectrogram, which sets it", [&verb] { return verb.spectrogram.empty(); }, {"--segment"});
}

std::function<void()> psd_options(VerbOptions& options, Session& session) {
  auto verb = std::make_shared<PsdVerb>();
  CharacterizeOptions& analysis = verb->analysis.options;
  analysis.spectrum_bins = 0;
  analysis.wanted.lines = false;
  options.add_text("LOG", verb->log, "recording (" + readable_files() + "; - reads CSV from standard input)")
      .required();
  options.add_document_output(verb->output);
  options.add_flag("--force", verb->force, "overwrite the output file");
  const Option json =
      options.add_flag("--json", verb->json, "one JSON document, with degrees of freedom and intervals");
  Option plot = options.add_flag("--plot", verb->plot, "a plot for the terminal instead of CSV");
  plot.excludes(json);
  options.add_flag("--lines", analysis.wanted.lines,
                   "list the spectral lines (with --json: in addition to the spectra)");
  add_spectrum_options(options, analysis.spectrum, analysis.segment_s, analysis.quarter_segments);
  options.add_enum("--average", analysis.average,
                   "mean of the segments, or their median without its bias, which ignores bursts (default: mean)");
  const Option cross =
      options
          .add_texts("--cross", verb->cross,
                     "cross spectrum of two channels A,B: density, phase of B minus phase of A, coherence")
          .value_name("A,B")
          .separated_by_commas()
          .one_value_each();
  Option coherence =
      options.add_texts("--coherence", verb->coherence, "coherence of two channels A,B, and where it is significant")
          .value_name("A,B")
          .separated_by_commas()
          .one_value_each();
  coherence.excludes(cross);
  plot.excludes(cross).excludes(coherence);
  options
      .add_parsed(
          "--spectrogram", "N|TIME",
          [verb = verb.get()](const std::string& text) {
            verb->spectrogram = text;
            CharacterizeOptions& of_verb = verb->analysis.options;
            read_segment(text, of_verb.spectrum, of_verb.segment_s);
          },
          "one spectrum per segment of this length, instead of their average")
      .excludes(cross)
      .excludes(coherence)
      .excludes(plot);
  options.add_count("--log-bins", analysis.spectrum_bins,
                    "average into at most N bins of a logarithmic frequency axis (default: 0, no averaging)", 0,
                    1000000);
  add_reading_options(options, session, analysis.reading);
  add_still_option(options, verb->analysis);
  add_data_options(options, verb->analysis);
  add_only(options, *verb);
  return [&session, verb] {
    verb->analysis.options.reading.hash = verb->json;  // only the document states it
    run_psd(session, *verb);
  };
}

}  // namespace

VerbEntry verb_psd() {
  return {
      4,
      "psd",
      "Compute power spectra (Welch), cross spectra, coherence, spectrograms, as CSV or JSON",
      psd_options,
      {{"a spectrum of segments of 20 s, into a table", "sensorchar psd imu.csv -c gyro_z --segment 20s -o psd.csv"},
       {"the spectral lines", "sensorchar psd imu.csv --lines"}}};
}

}  // namespace sensorchar
