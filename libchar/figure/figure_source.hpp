#pragma once
// What a figure is drawn from: reports of characterizations and replays, curves, sensor models. A
// report is the document that its page draws from.

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/allan/allan_deviation.hpp"
#include "libchar/characterize/characterization_view.hpp"
#include "libchar/characterize/curves/model_curve.hpp"
#include "libchar/core/finding.hpp"
#include "libchar/core/noise_terms.hpp"
#include "libchar/core/numeric/interval.hpp"
#include "libchar/spectrum/spectrum.hpp"

namespace libchar {

struct ReplayReport;

/// Where a coefficient is read off an Allan curve.
struct SourceMark {
  Term term = Term::white;
  double tau_s = 0, deviation = 0;
  std::string text;  ///< "N = 0.00401 deg/s·√s"
};

/// An Allan curve or a spectrum of one channel, measured or of a model, with what belongs to it.
/// Lists are as long as `x` or empty; NaN: not known.
struct SourceCurve {
  std::string channel;
  std::string unit;  ///< of the channel, in its usual spelling
  /// What the values are.
  struct Statistic {
    std::string title;          ///< "Overlapping Allan deviation", "One-sided PSD"
    bool is_allan = false;      ///< an estimate of the Allan deviation: they share an axis
    bool goes_squared = false;  ///< with the square of the channel's unit
    bool operator==(const Statistic&) const = default;
  } statistic;
  std::string value_unit;
  bool is_allan = true;
  bool of_model = false;  ///< all of it is computed
  std::vector<double> x;  ///< averaging time in s, or frequency in Hz
  std::vector<double> y, low68, high68, low95, high95, model, data_sheet;
  std::vector<bool> unreliable;
  std::vector<Asymptote> lines;
  std::vector<SourceMark> marks;
  std::vector<double> simulated_x,
      simulated_y;                 ///< of the record that was simulated from the model
  std::vector<Interval> left_out;  ///< of the abscissa: no coefficient comes from there
};

/// Residuals of a fit, in standard deviations, over frequency.
struct SourceResiduals {
  std::string channel;
  std::vector<double> x, z;
  std::vector<bool> outside;  ///< of the band of the fit
};

/// A record in blocks: smallest and largest value of each.
struct SourceTrace {
  std::string channel, unit;
  double block_s = 1;
  std::vector<double> low, high;
  std::vector<TraceMark> marks;
};

struct FigureSource {
  std::string file;
  std::string name;  ///< what tells it from other files: folder of a report, stem of a file
  std::vector<SourceCurve> curves;
  std::vector<SourceResiduals> residuals;
  std::vector<SourceTrace> traces;
  std::vector<Finding> findings;               ///< of the channels (subject), the worst first; no notes
  std::shared_ptr<const ReplayReport> replay;  ///< the report of a replay; null: another document
};

/// Reads report.json of characterize or replay (or the folder that holds it), what `allan`, `psd`
/// and `fit` print, curves.csv and tables of curves like it, sensor models. A log is refused with
/// the command that makes a curve of it. Throws Error(input).
FigureSource read_figure_source(const std::string& path);

/// The same of a document's text that stands for a file at `path`.
FigureSource parse_figure_source(std::string_view text, const std::string& path);

/// Curves of a run that is still in memory.
SourceCurve source_curve(const std::string& channel, const std::string& unit, const AllanCurve& curve);
SourceCurve source_curve(const std::string& channel, const std::string& unit, const Spectrum& spectrum);

}  // namespace libchar
