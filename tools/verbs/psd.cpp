// psd LOG: power spectra of every channel as a table or JSON, or the lines in them.

#include <memory>
#include <nlohmann/json.hpp>

#include "analysis_options.hpp"
#include "libchar/characterize/log_spectra.hpp"
#include "libchar/core/whole_file.hpp"
#include "libchar/log/formats.hpp"
#include "libchar/report/spectra_text.hpp"
#include "reading_options.hpp"
#include "verb.hpp"

namespace sensorchar {
namespace {

using namespace libchar;

struct PsdVerb {
  std::string log, output;
  LogSpectraOptions options;
  bool json = false, force = false;
};

void run_psd(Session& session, const PsdVerb& verb) {
  foresee_output(verb.output, {verb.log}, verb.force);
  const LogSpectra spectra = log_spectra(verb.log, verb.options, session.terminal);
  session.terminal.clear();
  for (const std::string& note : spectra.notes) session.terminal.note(note);
  report_warnings(session, spectra.log);
  std::string text;
  if (verb.json) {
    Json document = document_head(session, "spectrum", {&spectra.log});
    document.update(spectra_json(spectra, verb.options));
    text = dump_json(document);
  } else {
    text = verb.options.lines ? lines_csv(spectra) : spectra_csv(spectra);
  }
  if (verb.output.empty()) return print(text);
  write_whole_file(verb.output, text, verb.force);
}

std::function<void()> psd_options(VerbOptions& options, Session& session) {
  auto verb = std::make_shared<PsdVerb>();
  options
      .add_text(
          "LOG", verb->log, "recording (" + readable_files() + "; - reads CSV from standard input)")
      .required();
  options.add_text("-o,--output", verb->output, "write there instead of to stdout")
      .value_name("FILE");
  options.add_flag("--force", verb->force, "overwrite the output file");
  options.add_flag(
      "--json", verb->json, "one JSON document, with degrees of freedom and intervals");
  options.add_flag(
      "--lines", verb->options.lines, "list the spectral lines (with --json: beside the spectra)");
  add_spectrum_options(options, verb->options.spectrum, verb->options.segment_s);
  options.add_count(
      "--log-bins",
      verb->options.bins,
      "average into at most N bins of a logarithmic frequency axis (default: 0, do not)",
      0,
      1000000);
  add_reading_options(options, session, verb->options.reading);
  return [&session, verb] { run_psd(session, *verb); };
}

}  // namespace

VerbEntry verb_psd() {
  return {4,
          "psd",
          "power spectrum of every channel (Welch), as CSV or JSON",
          psd_options,
          {{"a spectrum of segments of 20 s, into a table",
            "sensorchar psd imu.csv -c gyro_z --segment 20s -o psd.csv"},
           {"the spectral lines", "sensorchar psd imu.csv --lines"}}};
}

}  // namespace sensorchar
