#pragma once
// report.json of a characterization, read back: what a comparison needs of it.

#include <string>
#include <string_view>
#include <vector>

#include "libchar/allan/allan_deviation.hpp"
#include "libchar/core/coefficient.hpp"
#include "libchar/core/document/schema.hpp"
#include "libchar/core/finding.hpp"
#include "libchar/fit/fit_result.hpp"
#include "libchar/model/sensor_model.hpp"

namespace libchar {

struct ReportedChannel {
  std::string name, unit;
  bool fitted = false;
  Coefficients term;
  FitBand band;
  std::string shape;  ///< its kind, with the number of taps
  double p = 1;       ///< goodness of fit; NaN: not known
  double rate_hz = 0, duration_s = 0;
  std::size_t events = 0;  ///< taken out before the fit
  /// Allan deviation by averaging time, measured or of a model; empty: none, or another statistic.
  std::vector<AllanPoint> curve;
};

struct ReportedCharacterization {
  std::string file;       ///< of the report
  std::string name;       ///< folder of a report, stem of a file
  std::string format;     ///< "characterization", "pooled-runs", "noise-fit", "allan", "sensor-model", "curve"
  std::string program;    ///< version of the program that wrote it
  std::string recording;  ///< what was characterized, in words
  std::vector<ReportedChannel> channels;
  std::vector<Finding> findings;  ///< of the channels (subject), the worst first; no notes

  const ReportedChannel* find(std::string_view channel) const;
};

/// The file that a path means: the report.json or runs.json in a folder, or the path itself.
std::string report_file(const std::string& path);

/// Throws Error(input) for the report of a fleet's lot (lot.json, or its folder): `instead` is what to do with one.
void refuse_lot_report(const std::string& path, const std::string& instead);

/// Reads report.json of characterize, runs.json of pooled runs, or what `fit` prints as JSON; of a folder, the
/// one in it. Throws Error(input) with file and key.
ReportedCharacterization read_characterization_report(const std::string& path);
ReportedCharacterization parse_characterization_report(std::string_view text, const std::string& path);

namespace detail {

/// Folder of a report, stem of another file.
std::string document_name(const std::string& path);
/// Files of one name in several folders are distinguished by these.
void set_names_apart(std::vector<std::string>& names, const std::vector<std::string>& files);

/// A report or a model, by its suffix.
bool ends_like_a_document(const std::string& path);
/// Whether `path` is neither a document, nor a curve, nor a model: a recording, if it can be read.
bool is_recording(const std::string& path);

/// What the JSON document at a path, or in its folder, says of itself ("characterization", "replay-report"); ""
/// where it cannot be read.
std::string document_format(const std::string& path);

}  // namespace detail
}  // namespace libchar

// What a document says is known of its channels.

namespace libchar::detail {

/// Subject of what the reader found and a quantity depends on.
inline constexpr const char* kOfRecording = "the recording";

/// Of the report of a characterization, or of what is printed of curves, spectra and fits: all but
/// notes, the worst first; the subject is the channel. None where the document has none.
std::vector<Finding> reported_findings(const MapReader& document);

}  // namespace libchar::detail
