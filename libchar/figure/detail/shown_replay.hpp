#pragma once
// The report of a replay as figures show it.

#include <string>
#include <vector>

#include "libchar/figure/make_figure.hpp"
#include "libchar/replay/report/replay_report.hpp"

namespace libchar {

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
FigureSeries track_series(const std::string& name,
                          const Timeline& track,
                          std::size_t series,
                          const ShownReplay& replay,
                          bool log,
                          FigureLook look);

/// The algorithms that are asked for; of nothing asked, those that the page shows first: the best,
/// the best without a reference, the mean and the bounds.
std::vector<const ReplayReport::Algorithm*> shown_algorithms(const ShownReplay& replay,
                                                             const FigureOptions& options);

/// The algorithm that is asked for; of nothing asked the best that `has` what is drawn. Null: nobody has it.
const ReplayReport::Algorithm* tracked_algorithm(
    const ShownReplay& replay,
    const FigureOptions& options,
    bool (*has)(const ReplayReport::Algorithm& algorithm));

/// Patterns of algorithms have to match one that ran.
void refuse_unmatched_methods(const ShownReplay& replay, const FigureOptions& options);

}  // namespace libchar
