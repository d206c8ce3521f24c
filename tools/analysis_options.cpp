#include "analysis_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "libchar/characterize/compare/reported_characterization.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/quantity_text.hpp"
#include "libchar/report/html/html_report.hpp"
#include "reading_options.hpp"

namespace sensorchar {
namespace {

using namespace libchar;

std::vector<std::string> words(const std::string& list) {
  std::vector<std::string> out;
  std::size_t from = 0;
  while (from <= list.size()) {
    const std::size_t comma = std::min(list.find(',', from), list.size());
    out.push_back(list.substr(from, comma - from));
    from = comma + 1;
  }
  return out;
}

void read_taus(const std::string& text, AllanOptions& allan) {
  const auto grid = find_enum<TauGrid>(text);
  allan.grid = grid.value_or(TauGrid::list);
  if (grid && *grid != TauGrid::list) return;
  allan.taus_s.clear();
  try {
    for (const std::string& word : words(text)) allan.taus_s.push_back(parse_duration_s(word, true));
  } catch (const Error&) {
    throw usage_error("E0201", "--taus")
        .says("octave, decade, dense, all, ten or a list of times was expected")
        .got(text)
        .hint("for example --taus 0.1s,1s,10s");
  }
}

std::array<bool, kTerms> read_terms(const std::string& text) {
  std::array<bool, kTerms> wanted{};
  for (const std::string& word : words(text)) {
    if (word == "Q")
      throw usage_error("E0201", "--terms")
          .says("Q is quantization in IEEE 952 and stood for white noise in earlier versions")
          .got(word)
          .hint("write N for white noise, or quantization in full");
    bool known = false;
    for (std::size_t t = 0; t < kTerms; ++t)
      if (word == kTermNames[t].letter || word == kTermNames[t].key) known = wanted[t] = true;
    if (!known)
      throw usage_error("E0201", "--terms")
          .says("a list of N, B, K, R (or names such as white_noise, quantization) was expected")
          .got(word)
          .hint("for example --terms N,B,K,R");
  }
  return wanted;
}

// "auto", or "10..600", "10s..10min", "10s..".
void read_still(const std::string& text, StillOptions& still) {
  still = {};
  still.search = text == "auto";
  if (!still.search) still.stretch_s = parse_range(text);
}

}  // namespace

// "4096" counts samples; "20s" is a time, which becomes samples when the rate is known; "N/4" is a
// quarter of the record.
bool read_segment(const std::string& text, WelchOptions& spectrum, double& segment_s) {
  spectrum.segment = 0;
  segment_s = 0;
  if (text.empty() || text == "N/4") return text == "N/4";
  if (text.find_first_not_of("0123456789") == std::string::npos)
    spectrum.segment = parse_count(text, 8);
  else
    segment_s = parse_duration_s(text, true);
  return false;
}

void add_still_option(VerbOptions& verb, AnalysisOptions& a) {
  verb.add_parsed(
      "--still", "auto|FROM..TO", [&a](const std::string& text) { read_still(text, a.options.still); },
      "analyse only the longest stretch in which no channel moves, or the one from FROM to TO after the first sample "
      "(s, min, h)");
}

void add_data_options(VerbOptions& verb, AnalysisOptions& a) {
  verb.add_enum("--data", a.options.data,
                "meaning of the samples: the quantity itself, its integral, or a frequency in Hz (default: rate)");
  verb.add_number(
      "--nominal-frequency", a.nominal_frequency,
      "with --data frequency: the frequency that counts as zero deviation, Hz (default: values are fractional)", 0);
  verb.add_number("--unwrap", a.options.unwrap,
                  "period at which the values wrap, in their unit, as for a phase or an angle (default: no wrapping)",
                  0);
  verb.add_parsed(
      "--frozen", "N", [&a](const std::string& text) { a.options.frozen = parse_count(text, 2); },
      "treat runs of N or more equal values as missing (default: they count)");
  verb.add_parsed(
      "--interpolated", "N", [&a](const std::string& text) { a.options.interpolated = parse_count(text, 3); },
      "treat samples on straight lines of N or more samples as missing, as in gaps that were filled; lines of fewer "
      "than 8 must be straight to 0.1 % (default: they count)");
  verb.add_bytes("--memory", a.options.memory_bytes,
                 "limit of the memory for samples: with less, a log of many channels is read several times, and an "
                 "option that needs all samples of a long log is refused; no result changes (default: 1GiB)");
}

bool has_bias(const AnalysisOptions& analysis) {
  return std::any_of(analysis.types.begin(), analysis.types.end(), [](const std::string& type) {
    const auto known = deviation_type(type);
    return known && deviation_row(*known).family == DeviationFamily::extended;
  });
}

void add_allan_options(VerbOptions& verb, AnalysisOptions& a) {
  verb.add_choices("--type", a.types, deviation_words(),
                   a.several_types ? "statistic, or several: oadev,mdev (default: oadev, overlapping Allan)"
                                   : "deviation (default: oadev, overlapping Allan)");
  verb.add_parsed(
      "--taus", "TEXT",
      [&a](const std::string& text) {
        a.options.ten_a_decade = a.ten_asked = text == "ten";
        read_taus(text == "ten" ? "octave" : text, a.options.allan);
      },
      "averaging times: octave, decade, dense, all (every multiple of the interval), ten (ten per decade and the "
      "octaves; octaves alone for logs that are streamed), or a list such as 0.1s,1s,1min (default: " +
          std::string(a.options.ten_a_decade ? "ten" : "octave") + ")");
  verb.add_duration("--tau-min", a.tau_min_s, "shortest averaging time (default: one sample)");
  verb.add_duration("--tau-max", a.tau_max_s,
                    "longest averaging time (default: half of the recording; three quarters for Theo, all of it for "
                    "mtie and tierms)");
  verb.add_enum("--bias", a.options.allan.bias,
                "bias of mtotdev, ttotdev and htotdev: sp1065 removes it as in SP 1065, none keeps it as allantools "
                "does (default: sp1065)")
      .only("with --type mtotdev, ttotdev or htotdev", [&a] { return has_bias(a); });
  verb.add_flag(
      "--full-overlap", a.options.full_overlap,
      "use every term of the deviation (default: of long recordings every (m/4)th, beyond 1048576 samples for "
      "octaves and dense times, 131072 for all times; of Theo1 and the total deviations every (m/16)th or "
      "less where one time would take seconds)");
}

void add_spectrum_options(VerbOptions& verb, WelchOptions& spectrum, double& segment_s, bool& quarter) {
  verb.add_enum("--sides", spectrum.sides, "one- or two-sided spectrum (default: one)");
  verb.add_enum("--scaling", spectrum.scaling, "density U²/Hz, power U², and their roots (default: psd)");
  verb.add_parsed(
      "--segment", "N|TIME",
      [&spectrum, &segment_s, &quarter](const std::string& text) { quarter = read_segment(text, spectrum, segment_s); },
      "samples per segment, a time such as 20s, or N/4, a quarter of the record (default: N/4 up to 1048576 samples, "
      "65536 samples of a longer record)");
  verb.add_number("--overlap", spectrum.overlap, "overlap of segments, a fraction (default: 0.5)", 0, 0.99);
  verb.add_enum("--window", spectrum.window, "window (default: hann)");
  verb.add_enum("--detrend", spectrum.detrend, "trend to remove from each segment (default: constant)");
}

void add_fit_options(VerbOptions& verb, AnalysisOptions& a) {
  verb.add_parsed(
      "--terms", "TEXT", [&a](const std::string& text) { a.options.fit.terms = read_terms(text); },
      "terms of the first fit, of N,B,K,R,quantization (default: N,B,K; others are added when a test requires them)");
  verb.add_number("--threshold", a.options.fit.threshold,
                  "likelihood ratio above which a term counts as present (default: 5.41, 1 % false alarms)", 0);
  verb.add_flag("--no-remedies", a.no_remedies,
                "do not clean spikes, clip lines, or add ramp, bandwidth or quantization terms");
  verb.add_parsed(
      "--assume", "white-top",
      [&a](const std::string& text) {
        if (text != "white-top") throw usage_error("E0201", "--assume").says("white-top was expected").got(text);
        a.options.fit.white_top = true;
      },
      "assume that nothing shapes the top of the spectrum (no filter, no quantization noise): the uncertainty of N "
      "falls by a third");
  verb.add_text("--temperature", a.options.temperature,
                "temperature channel: a polynomial of it, with a lag, is removed from the other channels before their "
                "noise is fitted");
  verb.add_flag("--no-second-opinion", a.no_second_opinion, "do not fit the Allan curve as well");
}

void add_characterize_options(VerbOptions& verb, Session& session, AnalysisOptions& a) {
  add_reading_options(verb, session, a.options.reading);
  add_still_option(verb, a);
  add_data_options(verb, a);
  add_allan_options(verb, a);
  add_spectrum_options(verb, a.options.spectrum, a.options.segment_s, a.options.quarter_segments);
  add_fit_options(verb, a);
}

CharacterizeOptions finish(const AnalysisOptions& a) {
  CharacterizeOptions o = a.options;
  if (a.nominal_frequency && o.data != SampleKind::frequency)
    throw usage_error("E0201", "--nominal-frequency").says("goes with --data frequency only");
  o.nominal_frequency = a.nominal_frequency.value_or(0);
  if (a.types.size() > 1 && !a.several_types)
    throw usage_error("E0201", "--type")
        .says("one statistic was expected here")
        .got(a.types[1])
        .hint("sensorchar allan takes several");
  o.allan.type = deviation_type(a.types[0]).value_or(DeviationType::oadev);
  o.more_types.clear();
  for (std::size_t i = 1; i < a.types.size(); ++i) o.more_types.push_back(*deviation_type(a.types[i]));
  for (const std::string& type : a.types)
    if (a.ten_asked && type != "oadev")
      throw usage_error("E0201", "--taus")
          .says("ten a decade goes with the overlapping Allan deviation only")
          .got("ten with --type " + type)
          .hint("--taus decade or dense serve every type");
  o.allan.tau_min_s = a.tau_min_s.value_or(0);
  o.allan.tau_max_s = a.tau_max_s.value_or(0);
  o.fit.remedies = !a.no_remedies;
  o.fit.second_opinion = !a.no_second_opinion;
  return o;
}

RecordedReport report_of_recording(Session& session, const std::string& log, const CharacterizeOptions& options) {
  CharacterizeOptions how = options;
  how.ten_a_decade = how.allan.grid == TauGrid::octave;
  Characterization result = characterize(log, how, session.terminal);
  result.command = session.command;
  report_warnings(session, result.log);
  std::string text = dump_json(json_report(result));
  return {std::move(result.log), std::move(text)};
}

std::vector<std::string> recording_flags(std::vector<std::string> more) {
  for (const char* flag : {"--still", "--from", "--to", "--topic", "--time-source", "--time-column", "--time-unit"})
    more.emplace_back(flag);
  return more;
}

void add_recording_options(VerbOptions& verb, Session& session, AnalysisOptions& analysis,
                           const std::vector<std::string>& inputs, bool with_format) {
  add_reading_options_without_channel(verb, session, analysis.options.reading, with_format);
  add_still_option(verb, analysis);
  verb.only("with a recording",
            [&inputs] {
              return std::any_of(inputs.begin(), inputs.end(),
                                 [](const std::string& input) { return libchar::detail::is_recording(input); });
            },
            {"--still", "--rate", "--from", "--to", "--topic", "--time-source", "--time-column", "--time-unit"});
}

}  // namespace sensorchar
