#pragma once
// The flags of the analysis verbs: the same words mean the same thing in allan, psd, fit and characterize.

#include "command_line.hpp"
#include "libchar/characterize/characterization.hpp"
#include "session.hpp"

namespace sensorchar {

/// Flags become CharacterizeOptions only when all of them are known: text is kept until `finish`.
struct AnalysisOptions {
  libchar::CharacterizeOptions options;
  std::string data = "rate", type = "oadev", taus = "octave", sides = "one", scaling = "psd",
              window = "hann", detrend = "constant", terms = "Q,B,K";
  std::optional<double> nominal_frequency, tau_min_s, tau_max_s, overlap, threshold;
  std::string segment;
  bool no_remedies = false, no_second_opinion = false;
};

void add_data_options(VerbOptions& verb,
                      AnalysisOptions& analysis);  ///< --data, --nominal-frequency, --memory
void add_allan_options(
    VerbOptions& verb,
    AnalysisOptions& analysis);  ///< --type, --taus, --tau-min, --tau-max, --full-overlap
void add_spectrum_options(
    VerbOptions& verb,
    AnalysisOptions& analysis);  ///< --sides, --scaling, --segment, --overlap, --window, --detrend
void add_fit_options(
    VerbOptions& verb,
    AnalysisOptions& analysis);  ///< --terms, --threshold, --no-remedies, --no-second-opinion

/// The options with every text read. Throws Error(usage).
libchar::CharacterizeOptions finish(const AnalysisOptions& analysis);

}  // namespace sensorchar
