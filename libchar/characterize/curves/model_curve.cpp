#include "libchar/characterize/curves/model_curve.hpp"

#include <algorithm>
#include <cmath>

#include "libchar/allan/deviation_types.hpp"
#include "libchar/allan/noise_curves.hpp"
#include "libchar/core/not_known.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/fit/curve/shaped_curves.hpp"

namespace libchar {
namespace {

double theta_of(const NoiseFit& fit, Term term) { return fit.theta[static_cast<std::size_t>(term)]; }

/// What the interval of a sum is made of.
struct SquaredReach {
  double variance = 0, down = 0, up = 0;

  /// A squared coefficient times its unit; a limit where the coefficient was not seen.
  void add(const Coefficient& c, double theta, double unit) {
    const double low = c.value ? c.ci95.low : 0;
    const double high = c.value ? c.ci95.high : c.upper95.value_or(0);
    variance += theta * unit;
    down += std::pow(std::max(0.0, theta - low * low) * unit, 2);
    up += std::pow(std::max(0.0, high * high - theta) * unit, 2);
  }
};

}  // namespace

std::optional<double> model_deviation(const NoiseFit& fit, DeviationType type, double m, double dt_s) {
  if (!deviation_row(type).is_allan()) return std::nullopt;
  const double variance = shaped_allan_variance(fit, m, dt_s);
  if (!(variance > 0)) return std::nullopt;
  return std::sqrt(variance);
}

// A variance that is a sum of estimates V_i with intervals l_i..u_i has the interval (MOVER: Zou and Donner, Statistics
// in Medicine 27,
// 2008)
//   V - sqrt(sum (V_i - l_i)²) .. V + sqrt(sum (u_i - V_i)²),
// wide enough where estimates are negatively correlated, as those of flicker and walk are. A shape multiplies it as a
// whole; what differs between stretches is added on the logarithm.
std::optional<Interval> model_interval(const NoiseFit& fit, DeviationType type, double m, double dt_s) {
  const auto deviation = model_deviation(fit, type, m, dt_s);
  if (!deviation) return std::nullopt;
  SquaredReach reach;
  for (std::size_t t = 0; t < kTerms; ++t) {
    Mixture one{};
    one[t] = 1;
    if (fit.term[t].status != Status::not_fitted) reach.add(fit.term[t], fit.theta[t], allan_variance(one, m, dt_s));
  }
  if (fit.gauss_markov && fit.gauss_markov->in_model && fit.gauss_markov->sigma.value) {
    const double sigma = *fit.gauss_markov->sigma.value;
    reach.add(fit.gauss_markov->sigma, sigma * sigma, process_allan_variance(fit, m, dt_s) / (sigma * sigma));
  }
  if (fit.flicker_phase) {
    const double f = fit.flicker_phase->value.value_or(0);
    reach.add(*fit.flicker_phase, f * f, flicker_phase_allan_variance(m, dt_s));
  }
  Mixture white{};
  white[static_cast<std::size_t>(Term::white)] = 1;
  reach.variance += fit.rounding * allan_variance(white, m, dt_s);
  if (!(reach.variance > 0)) return std::nullopt;
  const double low = 1 - std::sqrt(reach.down) / reach.variance, high = 1 + std::sqrt(reach.up) / reach.variance;
  const double spread = spread_reach(fit.stationarity, m * dt_s);
  return Interval{low > 0 ? *deviation * std::exp(-std::hypot(0.5 * std::log(low), spread)) : 0,
                  *deviation * std::exp(std::hypot(0.5 * std::log(high), spread))};
}

double scaled_density(const Spectrum& spectrum, double two_sided_density) {
  double value = two_sided_density;
  if (spectrum.sides == Sides::one) value *= 2;
  if (spectrum.scaling == Scaling::ps || spectrum.scaling == Scaling::ls) value *= spectrum.enbw_hz;
  if (spectrum.scaling == Scaling::lsd || spectrum.scaling == Scaling::ls) value = std::sqrt(value);
  return value;
}

std::optional<double> model_spectrum(const NoiseFit& fit, const Spectrum& shown, double frequency_hz) {
  const double f = std::fabs(frequency_hz), dt_s = 1 / shown.rate_hz;
  if (!(f > 0)) return std::nullopt;
  const double density = shaped_density(fit, f, dt_s);
  if (!(density > 0)) return std::nullopt;
  return scaled_density(shown, density);
}

std::vector<Asymptote> allan_asymptotes(const NoiseFit& fit, const AllanCurve& curve) {
  std::vector<Asymptote> lines;
  if (curve.points.empty() || !deviation_row(curve.type).is_allan()) return lines;
  for (std::size_t t = 0; t < kTerms; ++t) {
    if (!(fit.theta[t] > 0)) continue;
    Asymptote line{static_cast<Term>(t), {curve.points.front().tau_s / 10, curve.points.back().tau_s * 10}, {}};
    for (std::size_t i = 0; i < 2; ++i) line.y[i] = std::sqrt(fit.theta[t] * allan_asymptote(line.term, line.x[i]));
    lines.push_back(line);
  }
  return lines;
}

std::vector<Asymptote> spectrum_asymptotes(const NoiseFit& fit, const Spectrum& shown) {
  std::vector<Asymptote> lines;
  const auto first = std::find_if(shown.frequency_hz.begin(), shown.frequency_hz.end(), [](double f) { return f > 0; });
  if (first == shown.frequency_hz.end()) return lines;
  for (std::size_t t = 0; t < kTerms; ++t) {
    Asymptote line{static_cast<Term>(t), {*first / 10, shown.frequency_hz.back() * 10}, {}};
    for (std::size_t i = 0; i < 2; ++i) {
      line.y[i] = scaled_density(shown, fit.theta[t] * spectrum_asymptote(line.term, line.x[i], 1 / shown.rate_hz));
    }
    if (line.y[0] > 0 && line.y[1] > 0) lines.push_back(line);
  }
  return lines;
}

const AllanPoint* allan_minimum(const AllanCurve& curve) {
  const AllanPoint* best = nullptr;
  for (const AllanPoint& point : curve.points) {
    if (point.reliable && point.deviation > 0 && (best == nullptr || point.deviation < best->deviation)) best = &point;
  }
  return best;
}

std::vector<ReadOff> read_off_points(const NoiseFit& fit, const AllanCurve& curve) {
  std::vector<ReadOff> points;
  const double q2 = theta_of(fit, Term::white), b2 = theta_of(fit, Term::flicker), k2 = theta_of(fit, Term::walk);
  if (q2 > 0) points.push_back({Term::white, 1, std::sqrt(q2), "N at τ = 1 s"});
  if (b2 > 0) {
    // On the floor line, where the other two asymptotes cross (or at the curve's minimum): there the floor shows best.
    const AllanPoint* lowest = allan_minimum(curve);
    double tau_s = lowest != nullptr ? lowest->tau_s : 1;
    if (q2 > 0 && k2 > 0) tau_s = std::sqrt(3 * q2 / k2);
    points.push_back({Term::flicker, tau_s, std::sqrt(allan_asymptote(Term::flicker, tau_s) * b2), "0.664·B"});
  }
  if (k2 > 0) points.push_back({Term::walk, 3, std::sqrt(k2), "K at τ = 3 s"});
  return points;
}

}  // namespace libchar

// The curves that a sensor model implies: those of a fit with its coefficients.

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
  if (model.resolution && model.rate_hz > 0) fit.rounding = *model.resolution * *model.resolution / 12 / model.rate_hz;
  if (model.gauss_markov.sigma > 0) {
    GaussMarkovFit process;
    process.in_model = true;
    process.sigma.value = model.gauss_markov.sigma;
    const std::vector<double>& ends = model.gauss_markov.sigma_ci95;
    process.sigma.ci95 =
        ends.size() == 2 ? Interval{ends[0], ends[1]} : Interval{model.gauss_markov.sigma, model.gauss_markov.sigma};
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
  const int steps = std::max(2, clamped_whole<int>(std::ceil(decades * kPointsADecade)));
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
    point.ci95 = model_interval(fit, out.type, m, out.dt_s).value_or(Interval{point.deviation, point.deviation});
  }
  return out;
}

}  // namespace libchar::detail
