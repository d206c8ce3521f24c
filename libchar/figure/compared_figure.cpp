#include "libchar/figure/compared_figure.hpp"

#include <fmt/format.h>

#include "libchar/core/not_known.hpp"
#include "libchar/figure/detail/figure_parts.hpp"

namespace libchar {
namespace {

// More bands than these hide each other.
constexpr std::size_t kMostCandidateBands = 5;

FigureSeries candidate_series(const ComparedGroup::Candidate& candidate,
                              std::size_t k,
                              bool with_band) {
  FigureSeries out;
  out.name = out.tip = candidate.name + (candidate.takes_part ? "" : " (left out)");
  out.look = series_look(k);
  out.look.size = 1.3;
  if (!candidate.measured) out.look.marker = FigureMarker::none;
  for (const AllanPoint& point : candidate.curve) {
    out.x.push_back(point.tau_s);
    out.y.push_back(point.deviation);
    if (!with_band) continue;
    const bool known = point.ci95.high > 0;
    out.low.push_back(known ? point.ci95.low : kNone);
    out.high.push_back(known ? point.ci95.high : kNone);
  }
  return out;
}

}  // namespace

Chart detail::compared_chart(const ComparedGroup& group) {
  Chart out;
  Extent x(true), y(true), ends(true);
  for (std::size_t k = 0; k < group.candidates.size(); ++k) {
    if (group.candidates[k].curve.empty()) continue;
    FigureSeries series =
        candidate_series(group.candidates[k], k, group.candidates.size() <= kMostCandidateBands);
    x.take(series.x);
    y.take(series.y);
    out.series.push_back(std::move(series));
  }
  if (out.series.empty()) return out;
  for (const FigureSeries& series : out.series)
    for (const auto* band : {&series.low, &series.high})
      for (const double v : *band) ends.take_near(v, y, 2);
  for (const double v : {ends.low(), ends.high()}) y.take(v);
  if (!out.series.back().low.empty()) out.series.back().band = "95 % interval";
  if (!group.limit_tau_s.empty()) {
    out.series.push_back(line_series("data sheet",
                                     group.limit_tau_s,
                                     group.limit_curve,
                                     {.ink = Ink::black, .dash = 3, .width = 1.2}));
    for (const double v : group.limit_curve) y.take_near(v, y, 10);
  }
  x.pad(1.3);
  y.pad(1.4);
  out.kind = "allan";
  out.about = "Allan deviation of " + group.name;
  out.x = {.title = "Averaging time τ [s]", .log = true, .rows = {}};
  out.y = {.title = axis_title("Allan deviation, " + group.name, usual_figure_unit(group.unit)),
           .log = true,
           .rows = {}};
  set_ends(out.x, x, {});
  set_ends(out.y, y, {});
  return out;
}

}  // namespace libchar
