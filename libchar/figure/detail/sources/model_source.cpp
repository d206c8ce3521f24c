// The curves that a sensor model implies: those of a fit with its coefficients.

#include <algorithm>
#include <cmath>

#include "libchar/characterize/curves/model_curve.hpp"
#include "libchar/core/not_known.hpp"
#include "libchar/figure/detail/figure_parts.hpp"
#include "libchar/figure/detail/sources/curve_sources.hpp"

namespace libchar {
namespace {

NoiseFit fit_of(const SensorModel& model) {
  NoiseFit fit;
  for (std::size_t t = 0; t < kTerms; ++t) {
    fit.term[t] = model.noise[t];
    fit.theta[t] = std::pow(simulated_value(model.noise[t]), 2);
  }
  fit.shape = model.noise_shape;
  if (model.gauss_markov.sigma > 0) {
    GaussMarkovFit process;
    process.in_model = true;
    process.sigma.value = model.gauss_markov.sigma;
    process.tau_s.value = model.gauss_markov.tau_s;
    fit.gauss_markov = process;
  }
  if (model.flicker_phase > 0) {
    fit.flicker_phase = Coefficient{};
    fit.flicker_phase->value = model.flicker_phase;
  }
  if (model.bandwidth_hz) fit.bandwidth_hz = model.bandwidth_hz;
  fit.rate_hz = model.rate_hz;
  return fit;
}

constexpr int kPointsADecade = 20;

std::vector<double> even_on_log(double low, double high) {
  std::vector<double> out;
  const double decades = std::log10(high / low);
  const int steps = std::max(2, static_cast<int>(std::ceil(decades * kPointsADecade)));
  for (int i = 0; i <= steps; ++i) out.push_back(low * std::pow(10.0, decades * i / steps));
  return out;
}

SourceCurve allan_of(const SensorModel& model, const NoiseFit& fit, double dt_s, double end_s) {
  SourceCurve out;
  AllanCurve grid;
  grid.dt_s = dt_s;
  for (const double tau : even_on_log(dt_s, end_s)) {
    AllanPoint& point = grid.points.emplace_back();
    point.tau_s = tau;
    const auto deviation = model_deviation(fit, grid.type, tau / dt_s, dt_s);
    point.deviation = deviation.value_or(kNone);
    out.x.push_back(tau);
    out.y.push_back(point.deviation);
  }
  out.lines = allan_asymptotes(fit, grid);
  for (const ReadOff& point : read_off_points(fit, grid))
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
  grid.frequency_hz = even_on_log(1 / end_s, 0.5 / dt_s);
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
  const NoiseFit fit = fit_of(model);
  // What a data sheet says has no rate: a thousandth of a second is shorter than what one looks at.
  const double dt_s = model.rate_hz > 0 ? 1 / model.rate_hz : 1e-3;
  const double record_s = model.duration_s > 0 ? model.duration_s / 3 : 1e4;
  const double end_s = std::max(1e3 * dt_s, std::max(model.tau_max_s, record_s));
  for (SourceCurve curve : {allan_of(model, fit, dt_s, end_s), spectrum_of(fit, dt_s, end_s)}) {
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
