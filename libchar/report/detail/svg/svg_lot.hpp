#pragma once
// A lot's histograms and control charts, as drawings inside a page: no script, the same on paper, of a size that does not grow with the
// number of devices.

#include <optional>
#include <string>
#include <vector>

#include "libchar/lot/control_chart.hpp"
#include "libchar/lot/histogram.hpp"

namespace libchar {

/// Values on an axis: of ln(value) where `logarithm`, else as they are.
struct LotAxis {
  bool logarithm = true;
  std::string title;            ///< "bias instability, deg/s"
  std::optional<double> mean;   ///< of the lot, as the values stand on the axis
  std::optional<double> limit;  ///< of a data sheet
};

/// "<figure>…": `title` is for readers who cannot see it.
std::string svg_histogram(const Histogram& histogram,
                          const LotAxis& axis,
                          const std::string& title);

/// Where another batch begins.
struct ChartBound {
  std::size_t index = 0;
  std::string name;
};
/// `beyond`: names of the values outside of the limits.
std::string svg_control_chart(const ControlChart& chart,
                              std::size_t values,
                              const LotAxis& axis,
                              const std::vector<std::string>& beyond,
                              const std::vector<ChartBound>& bounds,
                              const std::string& title);

}  // namespace libchar
