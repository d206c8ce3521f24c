#pragma once
// Drawings of a page: no script, the same on paper, of a size that does not grow with what is drawn.
// Each is "<figure>…" with its caption; "" where there is nothing to draw.

#include <optional>
#include <string>
#include <vector>

#include "libchar/allan/allan_deviation.hpp"
#include "libchar/benchmark/bench_document.hpp"
#include "libchar/core/table/table.hpp"
#include "libchar/figure/draw_figure.hpp"
#include "libchar/figure/figure.hpp"
#include "libchar/lot/control_chart.hpp"
#include "libchar/report/html/fleet_report.hpp"

namespace libchar {

/// A chart with its caption, drawn once more for small windows.
std::string drawn_figure(const Chart& chart, const DrawingOptions& options, const std::string& caption);

/// The points of the curve that can be relied on, times a factor; the k-th of many, told apart.
FigureSeries allan_series(const AllanCurve& allan, std::size_t k, const std::string& name, bool strong,
                          double factor = 1);

/// Many curves on one pair of logarithmic axes: the legend has the first of them. `about`: for
/// readers who cannot see it.
std::string curves_figure(std::vector<FigureSeries> curves, const std::string& y_title, const std::string& about);

/// Named points with intervals, and the front of those that nobody beats in both.
std::string points_figure(const BenchChart& chart, const std::string& about);

/// Values on an axis: of ln(value) where `logarithm`, else as they are.
struct LotAxis {
  bool logarithm = true;
  std::string title;            ///< "bias instability, deg/s"
  std::optional<double> mean;   ///< of the lot, as the values stand on the axis
  std::optional<double> limit;  ///< of a data sheet
};

std::string histogram_figure(const Histogram& histogram, const LotAxis& axis, const std::string& about);

/// Where another batch begins.
struct ChartBound {
  std::size_t index = 0;
  std::string name;
};
/// `beyond`: names of the values outside of the limits.
std::string control_figure(const ControlChart& chart, std::size_t values, const LotAxis& axis,
                           const std::vector<std::string>& beyond, const std::vector<ChartBound>& bounds,
                           const std::string& about);

// Cells and figures of a fleet's quantities.

/// "of mems" behind a channel where there are several types.
std::string group_title(const QuantityLot& quantity, const FleetLot& lot);

/// "22.5 °C", to a tenth of a degree.
std::string celsius_text(double t);

/// Group, what, mean, spread, where 95 % lie, counted, not counted, batches, limit: of channels, of
/// kinds of them, of both.
Table quantities_table(const FleetLot& lot, std::optional<bool> of_kind = {});

/// The Allan curves of all channels, a drawing for each quantity that they measure; "" where the
/// recordings are not in memory.
std::string allan_figures(const FleetReport& report);

/// Histogram, control chart, batches, repeats, limit of one quantity; "" where nothing is known of it.
std::string quantity_figures(const FleetReport& report, const QuantityLot& quantity);

}  // namespace libchar
