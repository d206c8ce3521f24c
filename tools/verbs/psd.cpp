// psd LOG: power spectra of every channel as a table or JSON, or the lines in them.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "analysis_options.hpp"
#include "libchar/characterize/model_curve.hpp"
#include "libchar/core/csv_cell.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/text.hpp"
#include "libchar/core/whole_file.hpp"
#include "libchar/log/formats.hpp"
#include "libchar/log/read.hpp"
#include "libchar/report/detail/json_pieces.hpp"
#include "libchar/spectrum/lines.hpp"
#include "libchar/spectrum/log_spectrum.hpp"
#include "libchar/spectrum/spectrum.hpp"
#include "libchar/spectrum/spectrum_interval.hpp"
#include "libchar/spectrum/welch.hpp"
#include "libchar/spectrum/welch_stream.hpp"
#include "libchar/spectrum/window.hpp"
#include "reading_options.hpp"
#include "verb.hpp"

namespace sensorchar {
namespace {

using namespace libchar;

struct PsdVerb {
  std::string log, output;
  WelchOptions spectrum;
  double segment_s = 0;  ///< when a time was given for a segment
  std::uint64_t log_bins = 0;
  bool json = false, force = false, lines = false;
  ReadOptions reading;
};

struct ChannelSpectrum {
  Channel channel;
  Spectrum spectrum;
  std::vector<SpectralLine> lines;
};

struct Result {
  LogInfo info;
  std::vector<ChannelSpectrum> channels;
};

WelchOptions welch_options(const PsdVerb& verb) {
  WelchOptions options = verb.spectrum;
  options.threads = verb.reading.threads;
  return options;
}

bool segment_given(const PsdVerb& verb) {
  return verb.spectrum.segment != 0 || verb.segment_s > 0;
}

void check_rate(const LogInfo& info) {
  if (info.time.rate_hz > 0) return;
  throw Error({ErrorKind::numeric,
               "E0402",
               info.file,
               "the sampling rate is not known",
               "",
               "a log without time stamps needs --rate"});
}

// A channel that gives no spectrum is named and left out; the others are still of use.
template <typename Make>
void try_channel(Session& session, Result& result, const Channel& channel, const Make& make) {
  try {
    result.channels.push_back({channel, make(), {}});
    for (const std::string& note : result.channels.back().spectrum.notes)
      session.terminal.note(fmt::format("{}: {}", printable(channel.name), note));
  } catch (const Error& error) {
    if (error.problem().kind != ErrorKind::numeric) throw;
    session.terminal.note(fmt::format("{}: {}", printable(channel.name), error.what()));
  }
}

// One segment a channel in memory, however long the log is.
class StreamSink : public BlockSink {
 public:
  StreamSink(const PsdVerb& verb, WelchOptions options) : verb_(verb), options_(options) {}
  void begin(const LogInfo& so_far) override {
    if (options_.segment == 0)
      options_.segment = segment_samples(verb_.segment_s, so_far.time.rate_hz);
    for (std::size_t c = 0; c < so_far.channels.size(); ++c)
      streams_.emplace_back(options_, &workspace_);
  }
  void block(const SampleBlock& samples) override {
    for (std::size_t c = 0; c < streams_.size(); ++c)
      streams_[c].push({samples.channels[c], samples.rows});
  }
  const std::vector<WelchStream>& streams() const { return streams_; }

 private:
  const PsdVerb& verb_;
  WelchOptions options_;
  WelchWorkspace workspace_;
  std::vector<WelchStream> streams_;
};

Result streamed(Session& session, const PsdVerb& verb) {
  StreamSink sink(verb, welch_options(verb));
  Result result;
  result.info = read_log(verb.log, verb.reading, sink, session.terminal);
  check_rate(result.info);
  for (std::size_t c = 0; c < sink.streams().size(); ++c)
    try_channel(session, result, result.info.channels[c], [&] {
      return sink.streams()[c].finish(result.info.time.rate_hz);
    });
  return result;
}

// Segments of a quarter of the record: the record has to be there first. Where one channel needs
// shorter segments than another, all get the shortest, so that they share one frequency axis.
Result whole(Session& session, const PsdVerb& verb) {
  const Recording recording = read_recording(verb.log, verb.reading, session.terminal);
  check_rate(recording.info);
  WelchOptions options = welch_options(verb);
  const auto spectra = [&] {
    Result result;
    result.info = recording.info;
    for (std::size_t c = 0; c < recording.samples.size(); ++c)
      try_channel(session, result, recording.info.channels[c], [&] {
        return welch(recording.channel(c), recording.info.time.rate_hz, options);
      });
    return result;
  };
  Result result = spectra();
  std::uint64_t shortest_segment = 0;
  bool alike = true;
  for (const ChannelSpectrum& c : result.channels) {
    alike = alike && c.spectrum.segment == result.channels.front().spectrum.segment;
    if (shortest_segment == 0 || c.spectrum.segment < shortest_segment)
      shortest_segment = c.spectrum.segment;
  }
  if (alike) return result;
  session.terminal.note(
      fmt::format("all channels: segments of {} samples, the shortest that one of them needs",
                  shortest_segment));
  options.segment = shortest_segment;
  return spectra();
}

std::string spectra_csv(const Result& result) {
  std::string text = "frequency_hz";
  for (const ChannelSpectrum& c : result.channels)
    text += "," + csv_cell(fmt::format(
                      "{}[{}]", c.channel.name, spectrum_unit(c.spectrum.scaling, c.channel.unit)));
  text += "\n";
  const std::vector<double>& frequency = result.channels.front().spectrum.frequency_hz;
  for (std::size_t k = 0; k < frequency.size(); ++k) {
    text += shortest(frequency[k]);
    for (const ChannelSpectrum& c : result.channels) text += "," + shortest(c.spectrum.value[k]);
    text += "\n";
  }
  return text;
}

std::string lines_csv(const Result& result) {
  std::string text = "channel,unit,frequency_hz,amplitude,excess,width_hz\n";
  for (const ChannelSpectrum& c : result.channels)
    for (const SpectralLine& line : c.lines)
      text += fmt::format("{},{},{},{},{},{}\n",
                          csv_cell(c.channel.name),
                          csv_cell(c.channel.unit),
                          shortest(line.frequency_hz),
                          shortest(line.amplitude),
                          shortest(line.excess),
                          shortest(line.width_hz));
  return text;
}

Json channel_json(const PsdVerb& verb, const ChannelSpectrum& c) {
  Json out =
      spectrum_channel_json(c.channel, c.spectrum, nullptr, spectrum_intervals(c.spectrum, 0.95));
  if (verb.lines) {
    out["lines"] = Json::array();
    for (const SpectralLine& line : c.lines)
      out["lines"].push_back({{"frequency_hz", line.frequency_hz},
                              {"amplitude", line.amplitude},
                              {"excess", line.excess},
                              {"width_hz", line.width_hz}});
  }
  return out;
}

Json as_json(const Session& session, const PsdVerb& verb, const Result& result) {
  Json document = document_head(session, "spectrum", {&result.info});
  document["sides"] = name_of(verb.spectrum.sides);
  document["scaling"] = name_of(verb.spectrum.scaling);
  document["window"] = name_of(verb.spectrum.window);
  document["overlap"] = verb.spectrum.overlap;
  document["detrend"] = name_of(verb.spectrum.detrend);
  document["rate_hz"] = result.info.time.rate_hz;
  document["channels"] = Json::array();
  for (const ChannelSpectrum& c : result.channels)
    document["channels"].push_back(channel_json(verb, c));
  return document;
}

void write_result(const PsdVerb& verb, const std::string& text) {
  if (verb.output.empty()) return print(text);
  write_whole_file(verb.output, text, verb.force);
}

void run_psd(Session& session, const PsdVerb& verb) {
  foresee_output(verb.output, {verb.log}, verb.force);
  Result result = segment_given(verb) ? streamed(session, verb) : whole(session, verb);
  session.terminal.clear();
  report_warnings(session, result.info);
  if (result.channels.empty())
    throw Error({ErrorKind::numeric,
                 "E0715",
                 verb.log,
                 "no channel gives a spectrum",
                 "",
                 segment_given(verb) ? "try a shorter --segment" : ""});
  for (ChannelSpectrum& c : result.channels) {
    if (verb.lines) c.lines = find_lines(c.spectrum);
    if (verb.log_bins > 0) c.spectrum = log_binned(c.spectrum, verb.log_bins);
  }
  write_result(verb,
               verb.json    ? dump_json(as_json(session, verb, result))
               : verb.lines ? lines_csv(result)
                            : spectra_csv(result));
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
      "--lines", verb->lines, "list the spectral lines (with --json: beside the spectra)");
  add_spectrum_options(options, verb->spectrum, verb->segment_s);
  options.add_count(
      "--log-bins",
      verb->log_bins,
      "average into at most N bins of a logarithmic frequency axis (default: 0, do not)",
      0,
      1000000);
  add_reading_options(options, session, verb->reading);
  return [&session, verb] { run_psd(session, *verb); };
}

}  // namespace

VerbEntry verb_psd() {
  return {4, "psd", "power spectrum of every channel (Welch), as CSV or JSON", psd_options};
}

}  // namespace sensorchar
