// Intervals of a curve's points from their equivalent degrees of freedom.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "libchar/allan/allan_covariance.hpp"
#include "libchar/allan/allan_deviation.hpp"
#include "libchar/allan/detail/equivalent_dof.hpp"
#include "libchar/allan/detail/family.hpp"
#include "libchar/allan/noise_curves.hpp"
#include "libchar/core/numeric/distributions.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/text/readable.hpp"

namespace libchar {
namespace {

// Bias and degrees of freedom of the statistics beside plain differences.
// Degrees of freedom, 2 E[v]^2 / Var[v], of the variance v that a point is the root of. Terms of a
// mixture count by their shares in the Allan variance.
//
//   PDEV          exact, by the covariance of terms as in equivalent_dof.cpp: a term is sum_k h_k
//                 x_{i+k} over 2m points, so that R(l) = sum_d a_d s(l + d), a the autocorrelation
//                 of h and s the covariance of the phase. For m > kExact by the same with m =
//                 kExact and as many windows in the record: the statistic of the continuous record,
//                 sampled kExact times in tau.
//   MTOT, TTOT    exact degrees of freedom of the modified deviation times what reflection adds,
//                 from 4000 simulated records for m = 2 … N/16 (docs/theory/allan.md); none at
//                 m = 1. The formula of SP 1065, b T/tau - c, promises up to 60 % more at the
//                 longest times and twice as many at m = 2.
//   HTOT          likewise from the overlapping Hadamard deviation.
//   Theo1         SP 1065, 5.4.5, r = 3/4 m of N phase points, met by simulation to 15 % for r up to N/3
//   TheoBR        Theo1's times the mean ratio that takes its bias out, which goes over averaging times up
//                 to half of the record and so has f_R degrees of freedom, however long the record is:
//                 1/f = 1/f_1 + 1/f_R + 2 c / sqrt(f_1 f_R), c their correlation at r/N (4000 records of
//                 512 samples and 8000 of 128; docs/theory/allan.md)
//   TheoH         that of its parts

constexpr std::size_t kExactPoints = 32;
constexpr std::size_t kFarLags = 24;  // in m; covariances beyond do not count

using Table = PerTerm;  // white, flicker, walk of the rate, white of the phase
constexpr Table kModifiedBias = {0.73, 0.70, 0.69, 0.94}, kHadamardBias = {0.995, 0.851, 0.771, 1};
constexpr Table kOverRatioDof = {1 / 20.0, 1 / 23.0, 1 / 28.0, 0};  // white phase: thousands
constexpr Table kModifiedGain = {1.15, 1.09, 1.06, 1.42}, kHadamardGain = {1.43, 1.24, 1.15, 1};

double weighted(const Table& value, const PerTerm& share, double without) {
  double sum = 0, all = 0;
  for (std::size_t t = 0; t < kRandomTerms; ++t) {
    sum += share[t] * value[t];
    all += share[t];
  }
  return all > 0 ? sum / all : without;
}

std::vector<double> weights_of_slopes(std::size_t m) {
  std::vector<double> h(2 * m);
  for (std::size_t k = 0; k < m; ++k) {
    h[k] = static_cast<double>(m - 1) / 2 - static_cast<double>(k);
    h[m + k] = -h[k];
  }
  return h;
}

std::vector<double> autocorrelation(const std::vector<double>& h) {
  std::vector<double> a(h.size());
  for (std::size_t d = 0; d < h.size(); ++d)
    for (std::size_t k = d; k < h.size(); ++k) a[d] += h[k] * h[k - d];
  return a;
}

double phase_covariance_of(const Mixture& theta, double n, double dt_s) {
  double sum = 0;
  for (std::size_t t = 0; t < kRandomTerms; ++t)
    if (theta[t] > 0) sum += theta[t] * phase_covariance(static_cast<Term>(t), n, dt_s);
  return sum;
}

double parabolic_dof(Mixture theta, double m, double terms, double dt_s) {
  if (m == 1) return equivalent_dof(DeviationType::oadev, theta, 1, static_cast<std::uint64_t>(terms), 1, dt_s);
  if (m > kExactPoints) {
    const double coarser = m / kExactPoints;
    terms = std::max(1.0, terms / coarser);
    dt_s *= coarser;
    // White phase averages over m points whatever their distance.
    theta[static_cast<std::size_t>(Term::quantization)] /= coarser;
    m = kExactPoints;
  }
  const auto points = static_cast<std::size_t>(m);
  const std::vector<double> a = autocorrelation(weights_of_slopes(points));
  const std::size_t lags = std::min(clamped_whole<std::size_t>(std::ceil(terms)), kFarLags * points);
  std::vector<double> s(lags + 2 * points);
  for (std::size_t n = 0; n < s.size(); ++n) s[n] = phase_covariance_of(theta, static_cast<double>(n), dt_s);
  const auto covariance = [&](std::size_t lag) {
    double sum = a[0] * s[lag];
    for (std::size_t d = 1; d < a.size(); ++d) sum += a[d] * (s[lag + d] + s[lag > d ? lag - d : d - lag]);
    return sum;
  };
  const double variance = covariance(0);
  if (!(variance > 0)) return terms;
  double total = terms;
  for (std::size_t lag = 1; lag < lags; ++lag) {
    const double r = covariance(lag) / variance;
    total += 2 * (terms - static_cast<double>(lag)) * r * r;
  }
  return terms * terms / total;
}

double extended_dof(const DeviationRow& row, const Mixture& theta, const AllanPoint& point, std::uint64_t samples,
                    double dt_s) {
  const std::uint64_t starts = samples + (row.of_sum ? 2 : 1) - 3 * point.m;
  const double plain = equivalent_dof(row.of_sum ? DeviationType::mdev : DeviationType::ohdev, theta, point.m,
                                      std::max<std::uint64_t>(1, starts), 1, dt_s);
  if (point.m == 1) return plain;
  const PerTerm share = allan_shares(theta, static_cast<double>(point.m), dt_s);
  return plain * weighted(row.of_sum ? kModifiedGain : kHadamardGain, share, 1);
}

double theo_dof(const Mixture& theta, double r, double n, double dt_s) {
  const double white = ((4.1 * n + 0.8) / r - (3.1 * n + 6.5) / n) * (std::pow(r, 1.5) / (std::pow(r, 1.5) + 5.2));
  const double flicker = (2 * n * n - 1.3 * n * r - 3.5 * r) / (n * r) * (r * r * r / (r * r * r + 2.3));
  const double walk = (4.4 * n - 2) / (2.9 * r) *
                      ((4.4 * n - 1) * (4.4 * n - 1) - 8.6 * r * (4.4 * n - 1) + 11.4 * r * r) /
                      ((4.4 * n - 3) * (4.4 * n - 3));
  const double white_phase = 0.86 * (n + 1) * (n - 4 * r / 3) / (n - r) * (r / (r + 1.14));
  Table dof = {white, flicker, walk, white_phase};
  for (double& d : dof) d = std::max(1.0, d);
  return weighted(dof, allan_shares(theta, r, dt_s), 1);
}

double bias_removed_dof(const Mixture& theta, double r, double n, double dt_s) {
  const double theo = theo_dof(theta, r, n, dt_s);
  const double ratio = weighted(kOverRatioDof, allan_shares(theta, n / 4, dt_s), kOverRatioDof[0]);
  const double together = std::clamp(2.2 * r / n - 0.25, -0.1, 1.0);
  return 1 / (1 / theo + ratio + 2 * together * std::sqrt(ratio / theo));
}

// Expected modified or Hadamard total variance over the modified or Hadamard one, for the mixture
// at the point: as SP 1065, 5.4, states it. 1 of all others.
double family_bias(const DeviationRow& row, const Mixture& theta, const AllanPoint& point, double dt_s) {
  if (row.family != DeviationFamily::extended || (point.m == 1 && !row.of_sum)) return 1;
  const PerTerm share = allan_shares(theta, static_cast<double>(point.m), dt_s);
  return weighted(row.of_sum ? kModifiedBias : kHadamardBias, share, 1);
}

// Equivalent degrees of freedom at a point from `samples` rate samples (confidence.cpp), at least 1.
double family_dof(const DeviationRow& row, const Mixture& theta, const AllanPoint& point, std::uint64_t samples,
                  double dt_s) {
  const auto m = static_cast<double>(point.m);
  if (row.family == DeviationFamily::extended) return std::max(1.0, extended_dof(row, theta, point, samples, dt_s));
  if (row.family == DeviationFamily::parabola)
    return std::max(1.0, parabolic_dof(theta, m, static_cast<double>(point.terms), dt_s));
  if (row.type == DeviationType::theoh && point.m <= last_allan_factor(samples))
    return equivalent_dof(DeviationType::oadev, theta, point.m, point.terms, 1, dt_s);
  const auto dof = row.type == DeviationType::theo1 ? theo_dof : bias_removed_dof;
  return std::max(1.0, dof(theta, point.tau_s / dt_s, static_cast<double>(samples + 1), dt_s));
}

constexpr double kOneSigma = 0.6827, kTwoSided = 0.95;
constexpr double kReliableDof = 5;

/// Expected total variance / Allan variance = 1 - a tau/T (SP 1065, 5.11): a = 0.481 flicker, 0.75 walk.
void note_total_bias(AllanCurve& curve, const Mixture& theta) {
  if (curve.points.empty()) return;
  const bool flicker = theta[static_cast<std::size_t>(Term::flicker)] > 0;
  const bool walk = theta[static_cast<std::size_t>(Term::walk)] > 0;
  if (!flicker && !walk) return;
  const double share = curve.points.back().tau_s / (static_cast<double>(curve.samples) * curve.dt_s);
  curve.notes.push_back("the total variance is low by up to " + percent_text((walk ? 0.75 : 0.481) * share) +
                        " at the longest averaging time (not corrected); its degrees of freedom are approximate");
}

/// The least of a curve; nothing to say of 1.
void note_bias(AllanCurve& curve, double least) {
  if (least < 1)
    curve.notes.push_back((curve.without == AllanCurve::Bias::sp1065
                               ? "the variances are divided by their expected bias, down to "
                               : "the variances keep their expected bias, down to ") +
                          brief_text(least, 3) + " (SP 1065, for the noise that is there)");
}

}  // namespace

void detail::set_dof(AllanPoint& point, double edf) {
  point.edf = std::max(1.0, edf);
  point.ci68 = chi_square_interval(point.deviation, point.edf, kOneSigma);
  point.ci95 = chi_square_interval(point.deviation, point.edf, kTwoSided);
  point.reliable = point.edf >= kReliableDof;
}

void add_intervals(AllanCurve& curve, const Mixture& theta) {
  const DeviationRow& row = deviation_row(curve.type);
  if (row.without_interval()) return;
  const bool differences = row.family == DeviationFamily::differences;
  double least_bias = 1;
  for (AllanPoint& point : curve.points) {
    const double bias = family_bias(row, theta, point, curve.dt_s);
    least_bias = std::min(least_bias, bias);
    if (curve.without == AllanCurve::Bias::sp1065) {
      point.deviation *= std::sqrt(point.bias / bias);
      point.bias = bias;
    }
    Mixture with_added = theta;
    with_added[static_cast<std::size_t>(Term::white)] += point.added * point.tau_s;
    point.edf = differences
                    ? equivalent_dof(curve.type, with_added, point.m, point.terms, stride_of(curve, point), curve.dt_s)
                    : family_dof(row, theta, point, curve.used, curve.dt_s);
    detail::set_dof(point, point.edf / (point.inflation * point.inflation));
  }
  if (differences && row.reflected) note_total_bias(curve, theta);
  note_bias(curve, least_bias);
}

}  // namespace libchar
