#pragma once
// The flags of the analysis verbs: the same words mean the same thing in allan, psd, fit and characterize.

#include "command_line.hpp"
#include "libchar/characterize/characterization.hpp"
#include "session.hpp"

namespace sensorchar {

/// What the flags say; `finish` checks what only all of them together show.
struct AnalysisOptions {
  libchar::CharacterizeOptions options;
  std::vector<std::string> types = {"oadev"};
  std::optional<double> nominal_frequency, tau_min_s, tau_max_s;
  bool ten_asked = false;      ///< --taus ten
  bool several_types = false;  ///< the verb takes them
  bool no_remedies = false, no_second_opinion = false;
};

/// --still auto|FROM..TO
void add_still_option(VerbOptions& verb, AnalysisOptions& analysis);
/// --data, --nominal-frequency, --memory
void add_data_options(VerbOptions& verb, AnalysisOptions& analysis);
/// A statistic whose bias `--bias` is about is among the types.
bool has_bias(const AnalysisOptions& analysis);
/// --type, --taus, --tau-min, --tau-max, --full-overlap
void add_allan_options(VerbOptions& verb, AnalysisOptions& analysis);
/// --sides, --scaling, --segment, --overlap, --window, --detrend. `segment_s` is the length of a
/// segment when a time was given for it, 0 otherwise.
/// `quarter`: to distinguish N/4 of a log of any length from the default.
void add_spectrum_options(VerbOptions& verb, libchar::WelchOptions& spectrum, double& segment_s, bool& quarter);
/// Samples ("4096"), a time ("20s": `segment_s`, which becomes samples when the rate is known), or "N/4" (true).
bool read_segment(const std::string& text, libchar::WelchOptions& spectrum, double& segment_s);
/// --terms, --threshold, --no-remedies, --assume, --temperature, --no-second-opinion
void add_fit_options(VerbOptions& verb, AnalysisOptions& analysis);

/// All of the above, and reading options: all options of a characterization. `session` and
/// `analysis` must live until the verb has run.
void add_characterize_options(VerbOptions& verb, Session& session, AnalysisOptions& analysis);

/// The options of the job. Throws Error(usage) for flags that do not go together.
libchar::CharacterizeOptions finish(const AnalysisOptions& analysis);

// Recordings where a verb takes reports: they are characterized on the way.

struct RecordedReport {
  libchar::LogInfo log;
  std::string text;  ///< report.json, as `characterize` would write it
};

/// Characterizes a recording in memory; its warnings are said.
RecordedReport report_of_recording(Session& session, const std::string& log,
                                   const libchar::CharacterizeOptions& options);

/// Flags that have an effect on a recording only, and `more`.
std::vector<std::string> recording_flags(std::vector<std::string> more);

/// Options of verbs that take recordings next to reports: how they are read, --still, --temperature.
/// `inputs`, which must live until the verb has run: they are refused where none of these is a recording.
void add_recording_options(VerbOptions& verb, Session& session, AnalysisOptions& analysis,
                           const std::vector<std::string>& inputs, bool with_format = true);

}  // namespace sensorchar
