// Intervals of a curve's points from their equivalent degrees of freedom.

#include "libchar/allan/confidence.hpp"

#include <algorithm>
#include <cmath>

#include "libchar/allan/allan_covariance.hpp"
#include "libchar/allan/detail/equivalent_dof.hpp"
#include "libchar/allan/detail/family_dof.hpp"
#include "libchar/core/numeric/chi_square.hpp"
#include "libchar/core/text/readable.hpp"

namespace libchar {
namespace {

constexpr double kOneSigma = 0.6827, kTwoSided = 0.95;
constexpr double kReliableDof = 5;

/// Expected total variance / Allan variance = 1 - a tau/T (SP 1065, 5.11): a = 0.481 flicker, 0.75
/// walk.
void note_total_bias(AllanCurve& curve, const Mixture& theta) {
  if (curve.points.empty()) return;
  const bool flicker = theta[static_cast<std::size_t>(Term::flicker)] > 0;
  const bool walk = theta[static_cast<std::size_t>(Term::walk)] > 0;
  if (!flicker && !walk) return;
  const double share =
      curve.points.back().tau_s / (static_cast<double>(curve.samples) * curve.dt_s);
  curve.notes.push_back(
      "the total variance is low by up to " + percent_text((walk ? 0.75 : 0.481) * share) +
      " at the longest averaging time (not corrected); its degrees of freedom are approximate");
}

void take_bias_out(AllanPoint& point, double bias) {
  point.deviation *= std::sqrt(point.bias / bias);
  point.bias = bias;
}

void note_bias(AllanCurve& curve) {
  double least = 1;
  for (const AllanPoint& point : curve.points) least = std::min(least, point.bias);
  if (least < 1)
    curve.notes.push_back("the variances are divided by their expected bias, down to " +
                          brief_text(least, 3) + " (SP 1065, for the noise that is there)");
}

}  // namespace

void add_intervals(AllanCurve& curve, const Mixture& theta) {
  const DeviationRow& row = deviation_row(curve.type);
  if (row.without_interval()) return;
  const bool differences = row.family == DeviationFamily::differences;
  for (AllanPoint& point : curve.points) {
    take_bias_out(point, family_bias(row, theta, point, curve.dt_s));
    Mixture with_added = theta;
    with_added[static_cast<std::size_t>(Term::white)] += point.added * point.tau_s;
    point.edf =
        differences
            ? equivalent_dof(
                  curve.type, with_added, point.m, point.terms, stride_of(curve, point), curve.dt_s)
            : family_dof(row, theta, point, curve.used, curve.dt_s);
    point.edf = std::max(1.0, point.edf / (point.inflation * point.inflation));
    point.ci68 = chi_square_interval(point.deviation, point.edf, kOneSigma);
    point.ci95 = chi_square_interval(point.deviation, point.edf, kTwoSided);
    point.reliable = point.edf >= kReliableDof;
  }
  if (differences && row.reflected) note_total_bias(curve, theta);
  note_bias(curve);
}

}  // namespace libchar
