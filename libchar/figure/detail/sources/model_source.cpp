// The curves that a sensor model implies: those of a fit with its coefficients.

#include "libchar/characterize/curves/model_curve.hpp"
#include "libchar/characterize/curves/sensor_model_curve.hpp"
#include "libchar/core/not_known.hpp"
#include "libchar/figure/detail/figure_parts.hpp"
#include "libchar/figure/detail/sources/curve_sources.hpp"

namespace libchar {
namespace {

SourceCurve allan_of(const SensorModel& model, const NoiseFit& fit) {
  const AllanCurve curve = detail::sensor_model_curve(model, fit);
  SourceCurve out;
  for (const AllanPoint& point : curve.points) {
    out.x.push_back(point.tau_s);
    out.y.push_back(point.deviation);
    out.low95.push_back(point.ci95.low);
    out.high95.push_back(point.ci95.high);
  }
  out.lines = allan_asymptotes(fit, curve);
  for (const ReadOff& point : read_off_points(fit, curve))
    out.marks.push_back({point.term,
                         point.tau_s,
                         point.deviation,
                         mark_text(point.term, simulated_value(model[point.term]), out.unit)});
  out.statistic = "Allan deviation";
  return out;
}

SourceCurve spectrum_of(const NoiseFit& fit, double dt_s, double end_s) {
  SourceCurve out;
  Spectrum grid;
  grid.rate_hz = 1 / dt_s;
  grid.frequency_hz = detail::even_on_log(1 / end_s, 0.5 / dt_s);
  for (const double f : grid.frequency_hz) {
    out.x.push_back(f);
    out.y.push_back(model_spectrum(fit, grid, f).value_or(kNone));
  }
  out.lines = spectrum_asymptotes(fit, grid);
  out.is_allan = false;
  out.statistic = spectrum_statistic(grid.sides, grid.scaling);
  return out;
}

}  // namespace

void add_model(FigureSource& out, const SensorModel& model) {
  const NoiseFit fit = detail::sensor_model_fit(model);
  const Interval times = detail::sensor_model_times(model);
  for (SourceCurve curve : {allan_of(model, fit), spectrum_of(fit, times.low, times.high)}) {
    curve.channel = model.channel;
    curve.unit = usual_figure_unit(model.unit);
    curve.value_unit = curve.is_allan ? curve.unit : spectrum_unit(Scaling::psd, model.unit);
    curve.of_model = true;
    for (SourceMark& mark : curve.marks)
      mark.text = mark_text(mark.term, simulated_value(model[mark.term]), curve.unit);
    out.curves.push_back(std::move(curve));
  }
  for (Finding one : model.findings) {
    if (one.severity == Severity::note) continue;
    one.subject = model.channel;
    out.findings.push_back(std::move(one));
  }
}

}  // namespace libchar
