#pragma once
// What the makers of figures share: ranges of axes, looks of series, which channels are meant.

#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "libchar/core/document/schema.hpp"
#include "libchar/core/noise_terms.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/figure/figure.hpp"
#include "libchar/figure/figure_source.hpp"
#include "libchar/figure/make_figure.hpp"
#include "libchar/model/sensor_model.hpp"
#include "libchar/replay/report/replay_report.hpp"

namespace libchar {

/// Smallest and largest of what was taken; on a logarithmic axis of what is above zero.
class Extent {
 public:
  explicit Extent(bool log) : log_(log) {}
  void take(double value);
  void take(std::span<const double> values);
  bool empty() const { return !(low_ <= high_); }
  double low() const { return low_; }
  double high() const { return high_; }
  /// Both ends moved outward: by the factor on a logarithmic axis, by that share of the length on a linear one.
  void pad(double factor_or_share);
  /// Takes the value moved to at most `factor` beyond the ends of `inner` (both logarithmic).
  void take_near(double value, const Extent& inner, double factor);

 private:
  bool log_;
  double low_ = std::numeric_limits<double>::infinity(), high_ = -std::numeric_limits<double>::infinity();
};

/// Sets the ends: the user's range, else the extent, else 0.1 to 10.
void set_ends(FigureAxis& axis, const Extent& extent, const std::optional<Interval>& range);

/// In which one says when something was in a record that ends there.
std::pair<double, std::string> time_unit_for(double end_s);

/// Colour, dash and marker of the k-th of many: no two of the first 35 alike.
FigureLook series_look(std::size_t k);
Ink term_ink(Term term);
std::size_t term_dash(Term term);
FigureMarker term_marker(Term term);
std::string term_words(Term term);

/// The smallest and the largest value of a stretch, one above the other: a record drawn so looks as
/// all its samples would.
void add_extremes(FigureSeries& series, double x, double low, double high);

FigureSeries line_series(const std::string& name, const std::vector<double>& x, const std::vector<double>& y,
                         const FigureLook& look);

/// "Error [rad/s]"; the words alone for a ratio.
std::string axis_title(const std::string& words, const std::string& unit);

/// No patterns: every name.
bool is_wanted(const std::vector<std::string>& patterns, std::string_view name);
/// Every pattern has to match one of the names, or Error(usage) says which there are.
void refuse_unmatched(const std::vector<std::string>& patterns, const std::vector<std::string>& names,
                      const std::string& file);

/// Throws Error(usage): there is no such figure of this source.
Refusal kind_refusal(const FigureSource& source, std::string_view kind);

bool above_zero(double value);

/// "deg/s" for what means the same; "U" where there is none; "" for a ratio.
std::string usual_figure_unit(const std::string& unit);

// Figures of characterizations, curves and models.

Chart allan_figure(std::span<const FigureSource> sources, const FigureOptions& options);
Chart psd_figure(std::span<const FigureSource> sources, const FigureOptions& options);
Chart residuals_figure(std::span<const FigureSource> sources, const FigureOptions& options);
Chart trace_figure(std::span<const FigureSource> sources, const FigureOptions& options);

// Figures of a replay, from its report.

Chart front_figure(std::span<const FigureSource> sources, const FigureOptions& options);
Chart memory_figure(std::span<const FigureSource> sources, const FigureOptions& options);
Chart ranking_figure(std::span<const FigureSource> sources, const FigureOptions& options);
Chart timeline_figure(std::span<const FigureSource> sources, const FigureOptions& options);
Chart error_figure(std::span<const FigureSource> sources, const FigureOptions& options);
Chart window_figure(std::span<const FigureSource> sources, const FigureOptions& options);
Chart weights_figure(std::span<const FigureSource> sources, const FigureOptions& options);
Chart variances_figure(std::span<const FigureSource> sources, const FigureOptions& options);
Chart faults_figure(std::span<const FigureSource> sources, const FigureOptions& options);
Chart error_allan_figure(std::span<const FigureSource> sources, const FigureOptions& options);

// The report of a replay as figures show it.

struct ShownReplay {
  const ReplayReport* report = nullptr;
  std::vector<const ReplayReport::Algorithm*> ranked;  ///< that ran, best first
  std::vector<std::string> sensors;                    ///< their names
  std::size_t input = 0;                               ///< its number
  std::string unit, sensor_unit;                       ///< of that input; of the first sensor
  double optimum = 0;                                  ///< of that input; NaN: not known
  double end_s = 0;
  double time_unit_s = 1;  ///< in which one says how long it took
  std::string time_unit = "s";

  const ReplayReport::Algorithm* find(const std::string& label) const;
};

/// With the unit and the optimum of the input that is asked for. Throws Error(usage) where there is none of the name.
ShownReplay shown_replay(const FigureSource& source, const FigureOptions& options);

/// Of what is drawn over the run: the horizontal axis, and the stretches of faults and windows.
void set_time_axis(Chart& figure, const ShownReplay& replay, const FigureOptions& options);
void add_run_marks(Chart& figure, const ShownReplay& replay);

/// A track as a line between its smallest and largest values, with these as a band.
FigureSeries track_series(const std::string& name, const Timeline& track, std::size_t series, const ShownReplay& replay,
                          bool log, FigureLook look);

/// The algorithms that are asked for; of nothing asked, those that the page shows first: the best,
/// the best without a reference, the mean and the bounds.
std::vector<const ReplayReport::Algorithm*> shown_algorithms(const ShownReplay& replay, const FigureOptions& options);

/// The algorithm that is asked for; of nothing asked the best that `has` what is drawn. Null: nobody has it.
const ReplayReport::Algorithm* tracked_algorithm(const ShownReplay& replay, const FigureOptions& options,
                                                 bool (*has)(const ReplayReport::Algorithm& algorithm));

/// Patterns of algorithms have to match one that ran.
void refuse_unmatched_methods(const ShownReplay& replay, const FigureOptions& options);

// Curves of each kind of file that a figure is drawn from.

/// `channels` of what allan and psd print, and of the parts of a characterization with these names.
void add_allan_curves(FigureSource& out, const MapReader& document);
void add_spectra(FigureSource& out, const MapReader& document);
/// Of a fit: its residuals, and what belongs to the curves that were added before: coefficients, what was left out.
void add_residuals(FigureSource& out, const MapReader& fit);
void add_fit_to_curves(FigureSource& out, const MapReader& fit);
void add_traces(FigureSource& out, const MapReader& trace);
void add_simulated(FigureSource& out, const MapReader& verification);

/// A table of curves (fit/curve_table.hpp).
void add_table(FigureSource& out, const std::string& file, bool is_allan);

/// Allan curve and spectrum that a model implies, with its terms; of a document of fits those of each that has one.
void add_model(FigureSource& out, const SensorModel& model);
void add_fits(FigureSource& out, const MapReader& fits);

/// "N = 0.00401 deg/s·√s": a coefficient as a mark says it.
std::string mark_text(Term term, double value, const std::string& unit);

/// "overlapping Allan deviation", "One-sided PSD".
SourceCurve::Statistic spectrum_statistic(Sides sides, Scaling scaling);

}  // namespace libchar
