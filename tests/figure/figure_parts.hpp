#pragma once
// Sources and figures that several tests draw.

#include <string>

#include "libchar/figure/figure_source.hpp"
#include "libchar/figure/make_figure.hpp"

namespace test {

using namespace libchar;

/// White noise with N = 0.01 and a random walk with K = 0.001 at averaging times of 0.01 to 1000 s.
inline SourceCurve figure_curve(const std::string& channel, const std::string& unit) {
  SourceCurve c;
  c.channel = channel;
  c.unit = c.value_unit = unit;
  c.statistic = {"Overlapping Allan deviation", true};
  for (int i = 0; i <= 25; ++i) {
    const double tau = 0.01 * std::pow(10.0, i / 5.0);
    const double y = std::sqrt(1e-4 / tau + 1e-6 * tau / 3);
    c.x.push_back(tau);
    c.y.push_back(y);
    c.low95.push_back(0.9 * y);
    c.high95.push_back(1.2 * y);
    c.unreliable.push_back(i > 22);
  }
  return c;
}

inline FigureSource figure_source_of(std::vector<SourceCurve> curves, const std::string& name = "a") {
  FigureSource out;
  out.file = name + "/report.json";
  out.name = name;
  out.curves = std::move(curves);
  return out;
}

}  // namespace test
