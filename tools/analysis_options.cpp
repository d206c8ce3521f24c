#include "analysis_options.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "libchar/core/error.hpp"
#include "libchar/core/text.hpp"
#include "numbers.hpp"

namespace sensorchar {
namespace {

using namespace libchar;

[[noreturn]] void refuse(const std::string& option,
                         const std::string& what,
                         const std::string& got,
                         const std::string& hint) {
  throw Error({ErrorKind::usage, "", option, what, got, hint});
}

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
  if (text == "octave") {
    allan.grid = TauGrid::octave;
  } else if (text == "decade") {
    allan.grid = TauGrid::decade;
  } else if (text == "dense") {
    allan.grid = TauGrid::dense;
  } else {
    allan.grid = TauGrid::list;
    try {
      for (const std::string& word : words(text)) allan.taus_s.push_back(parse_duration_s(word));
    } catch (const Error&) {
      refuse("--taus",
             "octave, decade, dense or a list of times was expected",
             text,
             "for example --taus 0.1s,1s,10s");
    }
  }
}

// A number of samples, or a duration that becomes one when the rate is known: only samples are taken here.
std::uint64_t read_segment(const std::string& text) {
  if (text.empty() || text == "N/4") return 0;
  return parse_count(text, 8);
}

std::array<bool, kTerms> read_terms(const std::string& text) {
  std::array<bool, kTerms> wanted{};
  for (const std::string& word : words(text)) {
    bool known = false;
    for (std::size_t t = 0; t < kTerms; ++t)
      if (word == kTermNames[t].letter || word == kTermNames[t].key) known = wanted[t] = true;
    if (!known)
      refuse("--terms",
             "a list of Q, B, K, Qz, R (or the long names) was expected",
             word,
             "for example --terms Q,B,K,R");
  }
  return wanted;
}

}  // namespace

void add_data_options(VerbOptions& verb, AnalysisOptions& a) {
  verb.add_choice("--data",
                  a.data,
                  {"rate", "phase", "frequency"},
                  "what the samples are: the quantity itself, its integral, or a frequency in Hz "
                  "(default: rate)");
  verb.add_number(
      "--nominal-frequency",
      a.nominal_frequency,
      "with --data frequency: the frequency that counts as zero deviation, Hz (default: "
      "values are fractional)",
      0);
  verb.add_bytes("--memory",
                 a.options.memory_bytes,
                 "samples kept in memory at most; a longer log streams through fixed-size stages "
                 "(default: 1GiB)");
}

void add_allan_options(VerbOptions& verb, AnalysisOptions& a) {
  verb.add_choice(
      "--type", a.type, deviation_words(), "deviation (default: oadev, overlapping Allan)");
  verb.add_text(
      "--taus",
      a.taus,
      "averaging times: octave, decade, dense, or a list such as 0.1s,1s,1min (default: octave)");
  verb.add_duration("--tau-min", a.tau_min_s, "shortest averaging time (default: one sample)");
  verb.add_duration("--tau-max", a.tau_max_s, "longest averaging time (default: half the record)");
  verb.add_flag("--full-overlap",
                a.options.full_overlap,
                "use every term however long the record is (default: every (m/4)th term beyond 4 "
                "million samples)");
}

void add_spectrum_options(VerbOptions& verb, AnalysisOptions& a) {
  verb.add_choice("--sides", a.sides, {"one", "two"}, "one- or two-sided spectrum (default: one)");
  verb.add_choice("--scaling",
                  a.scaling,
                  {"psd", "ps", "lsd", "ls"},
                  "density U²/Hz, power U², and their roots (default: psd)");
  verb.add_text(
      "--segment", a.segment, "samples per segment (default: N/4, a quarter of the record)");
  verb.add_number(
      "--overlap", a.overlap, "overlap of segments, a fraction (default: 0.5)", 0, 0.99);
  verb.add_choice("--window",
                  a.window,
                  {"hann", "rectangular", "blackman_harris", "flat_top"},
                  "window (default: hann)");
  verb.add_choice("--detrend",
                  a.detrend,
                  {"none", "constant", "linear"},
                  "what is removed from each segment (default: constant)");
}

void add_fit_options(VerbOptions& verb, AnalysisOptions& a) {
  verb.add_text("--terms",
                a.terms,
                "terms offered to the fit from the start, of Q,B,K,Qz,R (default: Q,B,K; Qz and "
                "R join when an alarm asks)");
  verb.add_number(
      "--threshold",
      a.threshold,
      "likelihood ratio above which a term counts as present (default: 5.41, 1 % false)",
      0);
  verb.add_flag("--no-remedies",
                a.no_remedies,
                "do not clean spikes, clip lines, or add ramp, bandwidth or quantization terms");
  verb.add_flag("--no-second-opinion", a.no_second_opinion, "do not fit the Allan curve as well");
}

CharacterizeOptions finish(const AnalysisOptions& a) {
  CharacterizeOptions o = a.options;
  o.data = a.data == "phase"       ? SampleKind::phase
           : a.data == "frequency" ? SampleKind::frequency
                                   : SampleKind::rate;
  o.nominal_frequency = a.nominal_frequency.value_or(0);
  if (a.nominal_frequency && o.data != SampleKind::frequency)
    refuse("--nominal-frequency", "goes with --data frequency only", "", "");
  o.allan.type = *deviation_type(a.type);
  read_taus(a.taus, o.allan);
  o.allan.tau_min_s = a.tau_min_s.value_or(0);
  o.allan.tau_max_s = a.tau_max_s.value_or(0);
  o.spectrum.sides = a.sides == "two" ? Sides::two : Sides::one;
  o.spectrum.scaling = a.scaling == "ps"    ? Scaling::ps
                       : a.scaling == "lsd" ? Scaling::lsd
                       : a.scaling == "ls"  ? Scaling::ls
                                            : Scaling::psd;
  o.spectrum.segment = read_segment(a.segment);
  if (a.overlap) o.spectrum.overlap = *a.overlap;
  o.spectrum.window = *window_named(a.window);
  o.spectrum.detrend = a.detrend == "none"     ? Detrend::none
                       : a.detrend == "linear" ? Detrend::linear
                                               : Detrend::constant;
  o.fit.terms = read_terms(a.terms);
  if (a.threshold) o.fit.threshold = *a.threshold;
  o.fit.remedies = !a.no_remedies;
  o.fit.second_opinion = !a.no_second_opinion;
  return o;
}

}  // namespace sensorchar
