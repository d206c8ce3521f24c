#pragma once
// The report of a replay as figures read it.

#include <optional>
#include <string>
#include <vector>

#include "libchar/core/document/schema.hpp"
#include "libchar/figure/detail/sources/report_values.hpp"
#include "libchar/figure/make_figure.hpp"

namespace libchar {

/// An algorithm that ran.
struct ShownAlgorithm {
  MapReader map;
  std::string label;
  double score = 0;  ///< RMSE, or leave-one-out RMS without a reference; NaN: none
  bool bound = false, learns = false;
};

struct ShownReplay {
  MapReader map;
  std::string file;
  std::vector<ShownAlgorithm> ranked = {};  ///< best first
  std::vector<std::string> sensors = {};
  std::string best = "", unit = "", sensor_unit = "", score_name = "";
  std::size_t input = 0;  ///< its number
  std::string input_name = "";
  bool has_reference = false;
  double start_s = 0, end_s = 0;
  double time_unit_s = 1;  ///< in which one says how long it took
  std::string time_unit = "s";
  double optimum = 0;  ///< of the first input; NaN: not known

  const ShownAlgorithm* find(const std::string& label) const;
};

/// With the unit and the optimum of the input that is asked for. Throws Error(usage) where there is none of the name.
ShownReplay shown_replay(const FigureSource& source, const FigureOptions& options);

/// Of what is drawn over the run: the horizontal axis, and the stretches of faults and windows.
void set_time_axis(Chart& figure, const ShownReplay& replay, const FigureOptions& options);
void add_run_marks(Chart& figure, const ShownReplay& replay);

/// A track as a line between its smallest and largest values, with these as a band.
FigureSeries track_series(const std::string& name,
                          const ReportTrack& track,
                          std::size_t series,
                          const ShownReplay& replay,
                          bool log,
                          FigureLook look);

/// The algorithms that are asked for; of nothing asked, those that the page shows first: the best,
/// the best without a reference, the mean and the bounds.
std::vector<const ShownAlgorithm*> shown_algorithms(const ShownReplay& replay,
                                                    const FigureOptions& options);

/// Whose weights or variances (`key`) or findings are drawn. Null: nobody has any.
const ShownAlgorithm* tracked_algorithm(const ShownReplay& replay,
                                        const FigureOptions& options,
                                        const std::string& key);

}  // namespace libchar
