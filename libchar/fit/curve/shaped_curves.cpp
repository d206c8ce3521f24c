// AVAR(m) = AVAR of the terms + integral over 0..fs/2 of (|H|² - 1) S(f) 4 sin⁴(pi f m dt) / (m sin(pi f dt))² df
// with two-sided S (SP 1065, 5.2, for samples instead of a continuous rate). The terms' part is exact; the integral
// goes over stretches of a sixteenth of an octave from the top down to where the shape is one, with nodes enough for
// the sine, or its mean of
// 3/8 where a stretch holds many periods.
#include "libchar/fit/curve/shaped_curves.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libchar/allan/allan_deviation.hpp"
#include "libchar/allan/noise_curves.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/fit/detail/band/low_pass.hpp"

namespace libchar {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kStretch = 0.0625;  ///< octaves
constexpr double kManyPeriods = 6;
constexpr double kVisibleRatio = 1e-4;  ///< of a shape's distance from one
constexpr double kSameWithin = 0.01;

double ratio_at(const NoiseFit& fit, double frequency_hz, double dt_s) {
  double ratio = shape_ratio(fit.shape, frequency_hz, 1 / dt_s);
  if (fit.bandwidth_hz) ratio *= low_pass_gain(frequency_hz, *fit.bandwidth_hz, 1 / dt_s).gain;
  return ratio;
}

bool has_process(const NoiseFit& fit) {
  return fit.gauss_markov && fit.gauss_markov->in_model && fit.gauss_markov->sigma.value;
}

double flicker_phase_theta(const NoiseFit& fit) {
  const double f = fit.flicker_phase ? fit.flicker_phase->value.value_or(0) : 0;
  return f * f;
}

double unshaped_variance(const NoiseFit& fit, double m, double dt_s) {
  return allan_variance(fit.theta, m, dt_s) + process_allan_variance(fit, m, dt_s) +
         flicker_phase_theta(fit) * flicker_phase_allan_variance(m, dt_s);
}

bool has_shape(const NoiseFit& fit) { return fit.bandwidth_hz || fit.shape.kind != NoiseShape::Kind::none; }

/// Lowest frequency that the shape touches.
double shape_from_hz(const NoiseFit& fit, double dt_s) {
  if (!fit.bandwidth_hz && fit.shape.kind == NoiseShape::Kind::measured) return fit.shape.frequency_hz.front() / 2;
  double f = 0.5 / dt_s;
  while (f > 1e-9 / dt_s && std::abs(ratio_at(fit, f / 2, dt_s) - 1) > kVisibleRatio) f /= 2;
  return f / 2;
}

double rounding_variance(const NoiseFit& fit, double m, double dt_s) {
  return fit.rounding * unit_allan_variance(Term::white, m, dt_s);
}

/// sin⁴(pi f m dt) / (m sin(pi f dt))² times the excess of the density, over one stretch.
double stretch_integral(const NoiseFit& fit, double m, double dt_s, double low_hz, double high_hz) {
  const double width = high_hz - low_hz, periods = width * m * dt_s;
  const bool many = periods > kManyPeriods;
  const int nodes = many ? 2 : 4 + clamped_whole<int>(std::ceil(8 * periods));
  double sum = 0;
  for (int i = 0; i < nodes; ++i) {
    const double f = low_hz + width * (i + 0.5) / nodes;
    const double sine = std::sin(kPi * f * m * dt_s), step = m * std::sin(kPi * f * dt_s);
    const double transfer = (many ? 0.375 : sine * sine * sine * sine) / (step * step);
    sum += (ratio_at(fit, f, dt_s) - 1) * detail::unshaped_density(fit, f, dt_s) * transfer;
  }
  return 4 * sum * width / nodes;
}

}  // namespace

double detail::unshaped_density(const NoiseFit& fit, double frequency_hz, double dt_s) {
  const double terms =
      spectrum(fit.theta, frequency_hz, dt_s) + flicker_phase_theta(fit) * flicker_phase_spectrum(frequency_hz, dt_s);
  if (!has_process(fit)) return terms;
  const double sigma = *fit.gauss_markov->sigma.value;
  return terms + sigma * sigma * gauss_markov_spectrum(*fit.gauss_markov->tau_s.value, frequency_hz, dt_s);
}

double shaped_density(const NoiseFit& fit, double frequency_hz, double dt_s) {
  return detail::unshaped_density(fit, frequency_hz, dt_s) * ratio_at(fit, frequency_hz, dt_s) + fit.rounding;
}

double shaped_allan_variance(const NoiseFit& fit, double m, double dt_s) {
  double variance = unshaped_variance(fit, m, dt_s) + rounding_variance(fit, m, dt_s);
  if (!has_shape(fit)) return variance;
  const double lowest_hz = shape_from_hz(fit, dt_s), step = std::exp2(-kStretch);
  for (double high = 0.5 / dt_s; high > lowest_hz; high *= step)
    variance += stretch_integral(fit, m, dt_s, high * step, high);
  return std::max(variance, 0.0);
}

double process_allan_variance(const NoiseFit& fit, double m, double dt_s) {
  if (!has_process(fit)) return 0;
  const double sigma = *fit.gauss_markov->sigma.value;
  return sigma * sigma * gauss_markov_allan_variance(*fit.gauss_markov->tau_s.value, m, dt_s);
}

double mean_noise_variance(const NoiseFit& fit) {
  const double m = static_cast<double>(fit.samples), dt_s = 1 / fit.rate_hz;
  return allan_variance(fit.theta, m, dt_s) + process_allan_variance(fit, m, dt_s) + rounding_variance(fit, m, dt_s);
}

namespace {

/// What stretches of the record differ by, the mean of all differs by from the long run's.
void widen_by_stretches(AllanCurve& curve, const Stationarity& stationarity) {
  if (stationarity.steady || deviation_row(curve.type).without_interval()) return;
  for (AllanPoint& point : curve.points) {
    const StretchSpread spread = detail::spread_at(stationarity, point.tau_s);
    const double variance = 2 * spread.relative_sd * spread.relative_sd / spread.independent;
    detail::set_dof(point, 1 / (1 / point.edf + variance));
  }
  curve.notes.emplace_back("the intervals hold what stretches of the record differ by");
}

Mixture theta_with_rounding(const NoiseFit& fit) {
  Mixture theta = fit.theta;
  theta[static_cast<std::size_t>(Term::white)] += fit.rounding;
  return theta;
}

void add_steady_intervals(AllanCurve& curve, const NoiseFit& fit) {
  if (!has_process(fit)) {
    Mixture theta = theta_with_rounding(fit);  // flicker phase has the degrees of freedom of white phase, nearly
    theta[static_cast<std::size_t>(Term::quantization)] += flicker_phase_theta(fit);
    return add_intervals(curve, theta);
  }
  constexpr double kRises = 1, kFalls = 4;  // averaging times in correlation times
  AllanCurve one = curve;
  for (AllanPoint& point : curve.points) {
    const auto m = static_cast<double>(point.m);
    const double across = m * curve.dt_s / *fit.gauss_markov->tau_s.value;
    const Term like = across < kRises ? Term::walk : across < kFalls ? Term::flicker : Term::white;
    Mixture theta = theta_with_rounding(fit);
    theta[static_cast<std::size_t>(like)] +=
        process_allan_variance(fit, m, curve.dt_s) / unit_allan_variance(like, m, curve.dt_s);
    one.points = {point};
    add_intervals(one, theta);
    point = one.points.front();
  }
}

}  // namespace

void add_fit_intervals(AllanCurve& curve, const NoiseFit& fit) {
  add_steady_intervals(curve, fit);
  widen_by_stretches(curve, fit.stationarity);
}

double plain_from_s(const NoiseFit& fit, const AllanCurve& curve) {
  if (!has_shape(fit)) return 0;
  double from_s = 0;
  for (const AllanPoint& point : curve.points) {
    const auto m = static_cast<double>(point.m);
    const double unshaped = unshaped_variance(fit, m, curve.dt_s) + rounding_variance(fit, m, curve.dt_s);
    if (std::abs(shaped_allan_variance(fit, m, curve.dt_s) - unshaped) > kSameWithin * unshaped)
      from_s = point.tau_s * (1 + 1e-9);
  }
  return from_s;
}

}  // namespace libchar
