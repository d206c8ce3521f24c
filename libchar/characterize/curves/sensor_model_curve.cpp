// The curves that a sensor model implies: those of a fit with its coefficients.
#include "libchar/characterize/curves/sensor_model_curve.hpp"

#include <algorithm>
#include <cmath>

#include "libchar/characterize/curves/model_curve.hpp"
#include "libchar/core/not_known.hpp"

namespace libchar::detail {

NoiseFit sensor_model_fit(const SensorModel& model) {
  NoiseFit fit;
  for (std::size_t t = 0; t < kTerms; ++t) {
    fit.term[t] = model.noise[t];
    fit.theta[t] = std::pow(simulated_value(model.noise[t]), 2);
    // What is stated without an interval is taken as it is.
    Coefficient& c = fit.term[t];
    if (c.value && !(c.ci95.high > 0)) c.ci95 = {*c.value, *c.value};
  }
  fit.shape = model.noise_shape;
  if (model.gauss_markov.sigma > 0) {
    GaussMarkovFit process;
    process.in_model = true;
    process.sigma.value = model.gauss_markov.sigma;
    const std::vector<double>& ends = model.gauss_markov.sigma_ci95;
    process.sigma.ci95 = ends.size() == 2
                             ? Interval{ends[0], ends[1]}
                             : Interval{model.gauss_markov.sigma, model.gauss_markov.sigma};
    process.tau_s.value = model.gauss_markov.tau_s;
    fit.gauss_markov = process;
  }
  if (model.flicker_phase > 0) {
    fit.flicker_phase = Coefficient{};
    fit.flicker_phase->value = model.flicker_phase;
    fit.flicker_phase->ci95 = {model.flicker_phase, model.flicker_phase};
  }
  if (model.bandwidth_hz) fit.bandwidth_hz = model.bandwidth_hz;
  fit.rate_hz = model.rate_hz;
  return fit;
}

Interval sensor_model_times(const SensorModel& model) {
  // What a data sheet says has no rate: a thousandth of a second is shorter than what one looks at.
  const double dt_s = model.rate_hz > 0 ? 1 / model.rate_hz : 1e-3;
  const double record_s = model.duration_s > 0 ? model.duration_s / 3 : 1e4;
  return {dt_s, std::max(1e3 * dt_s, std::max(model.tau_max_s, record_s))};
}

std::vector<double> even_on_log(double low, double high) {
  constexpr int kPointsADecade = 20;
  std::vector<double> out;
  const double decades = std::log10(high / low);
  const int steps = std::max(2, static_cast<int>(std::ceil(decades * kPointsADecade)));
  for (int i = 0; i <= steps; ++i) out.push_back(low * std::pow(10.0, decades * i / steps));
  return out;
}

AllanCurve sensor_model_curve(const SensorModel& model, const NoiseFit& fit) {
  const Interval times = sensor_model_times(model);
  AllanCurve out;
  out.dt_s = times.low;
  for (const double tau : even_on_log(times.low, times.high)) {
    AllanPoint& point = out.points.emplace_back();
    const double m = tau / out.dt_s;
    point.tau_s = tau;
    point.deviation = model_deviation(fit, out.type, m, out.dt_s).value_or(kNone);
    point.ci95 = model_interval(fit, out.type, m, out.dt_s)
                     .value_or(Interval{point.deviation, point.deviation});
  }
  return out;
}

}  // namespace libchar::detail
