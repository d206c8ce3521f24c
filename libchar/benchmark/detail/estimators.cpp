// A row each: what is named in a report is computed here and nowhere else.
#include "libchar/benchmark/detail/estimators.hpp"

#include <algorithm>

#include "libchar/allan/allan_deviation.hpp"
#include "libchar/allan/allan_pyramid.hpp"
#include "libchar/fit/curve/allan_fit.hpp"
#include "libchar/fit/curve/curve_fit.hpp"
#include "libchar/fit/noise_fit.hpp"

namespace libchar {
namespace {

NoiseEstimate estimate_of(const NoiseFit& fit) {
  NoiseEstimate out;
  for (std::size_t i = 0; i < kTerms; ++i) {
    const Coefficient& c = fit.term[i];
    if (c.status == Status::not_fitted) continue;
    out[i].value = c.value;
    if (c.value)
      out[i].ci95 = c.ci95;
    else if (c.upper95)
      out[i].ci95 = Interval{0, *c.upper95};
  }
  return out;
}

FitOptions plain(const TermSet& terms) {
  FitOptions options;
  options.white_top = true;  // nothing shapes these records, as the bound and the recipes take for granted
  options.terms = terms;
  options.threshold = 0;
  options.remedies = options.second_opinion = options.events = options.stationarity = false;
  return options;
}

/// What `characterize --assume white-top` does with a record.
NoiseEstimate whole_fit(std::span<const double> y, double rate_hz, const TermSet&) {
  const AllanCurve curve = pyramid_deviation(y, 1 / rate_hz);
  FitOptions options;
  options.white_top = true;  // nothing shapes these records, as bound and recipes take for granted
  return estimate_of(fit_record(y, rate_hz, &curve, options));
}

NoiseEstimate whittle_of(std::span<const PooledPower> powers, std::size_t samples, double rate_hz,
                         const TermSet& terms) {
  return estimate_of(fit_power_bins(power_bins(powers, rate_hz), rate_hz, samples, nullptr, plain(terms)));
}

NoiseEstimate whittle(std::span<const double> y, double rate_hz, const TermSet& terms) {
  return whittle_of(whole_powers(y), y.size(), rate_hz, terms);
}

NoiseEstimate whittle_blocks(std::span<const double> y, double rate_hz, const TermSet& terms) {
  return whittle_of(powers_of(record_sums(y, false).plain.bins), y.size(), rate_hz, terms);
}

NoiseFit edf_fit(const AllanCurve& curve, double rate_hz, const TermSet& terms) {
  DigitisedCurve points;
  for (const AllanPoint& point : curve.points) {
    if (!(point.deviation > 0)) continue;
    points.x.push_back(point.tau_s);
    points.y.push_back(point.deviation);
  }
  points.duration_s = static_cast<double>(curve.samples) / rate_hz;
  points.rate_hz = rate_hz;
  return fit_curve(points, plain(terms));
}

/// Starts from the fit with the points' own weights.
NoiseEstimate covariance_fit(const AllanCurve& curve, double rate_hz, const TermSet& terms) {
  const NoiseFit first = edf_fit(curve, rate_hz, terms);
  NoiseEstimate out;
  const auto second = second_opinion(curve, first, nullptr);
  if (!second) return out;
  for (std::size_t i = 0; i < kTerms; ++i) {
    if (!second->value[i]) continue;
    const double value = *second->value[i], half = kNormal95 * second->sd[i];
    out[i] = {value, Interval{std::max(0.0, value - half), value + half}};
  }
  return out;
}

NoiseEstimate allan_edf(std::span<const double> y, double rate_hz, const TermSet& terms) {
  return estimate_of(edf_fit(pyramid_deviation(y, 1 / rate_hz), rate_hz, terms));
}

NoiseEstimate allan_covariance_stride(std::span<const double> y, double rate_hz, const TermSet& terms) {
  return covariance_fit(pyramid_deviation(y, 1 / rate_hz), rate_hz, terms);
}

NoiseEstimate allan_covariance_overlap(std::span<const double> y, double rate_hz, const TermSet& terms) {
  AllanOptions options;
  options.threads = 1;
  return covariance_fit(allan_deviation(y, 1 / rate_hz, options), rate_hz, terms);
}

NoiseEstimate allan_edf_plain(std::span<const double> y, double rate_hz, const TermSet& terms) {
  AllanOptions options;
  options.type = DeviationType::adev;
  options.threads = 1;
  return estimate_of(edf_fit(allan_deviation(y, 1 / rate_hz, options), rate_hz, terms));
}

}  // namespace

const std::vector<Estimator>& estimators() {
  static const std::vector<Estimator> rows = {
      {"sensorchar",
       "what a characterization does: Whittle likelihood, terms decided by likelihood ratio, remedies on alarm, a "
       "second opinion from the Allan curve",
       whole_fit},
      {"whittle", "Whittle likelihood of the whole record's cosine transform, terms given", whittle, true, true},
      {"whittle-blocks", "the same of blocks of 16384 samples and their means: constant memory", whittle_blocks, true,
       true},
      {"allan-covariance",
       "least squares on the overlapping Allan variances at octaves (stride m/4) with their whole covariance",
       allan_covariance_stride, true, true},
      {"allan-covariance-overlap", "the same with full overlap", allan_covariance_overlap, true, true},
      {"allan-edf", "least squares on the logarithms of the Allan variances, each weighted by its degrees of freedom",
       allan_edf, true, true},
      {"allan-edf-plain", "the same on non-overlapping Allan variances", allan_edf_plain, true, true},
      {"read-off",
       "as in textbooks (IEEE 952 annex C): N at 1 s on the line of slope -1/2, B at the lowest point over 0.664, K at "
       "3 s on the line of slope +1/2",
       read_off, false},
      {"log-log", "unweighted least squares on the logarithms of the variances", log_log, false},
      {"relative-nnls", "least squares of model over measured variance, coefficients not negative",
       relative_least_squares, false},
      {"imu_utils",
       "recipe of imu_utils: 100 logarithmic strides, unweighted log10 least squares of five squared coefficients",
       imu_utils, false},
      {"allan_variance_ros", "recipe of allan_variance_ros: averages side by side, means of logarithms",
       allan_variance_ros, false},
  };
  return rows;
}

}  // namespace libchar
