// Intervals of a curve's points from their equivalent degrees of freedom.

#include "libchar/allan/confidence.hpp"

#include <algorithm>

#include "libchar/allan/allan_covariance.hpp"
#include "libchar/allan/detail/equivalent_dof.hpp"
#include "libchar/core/chi_square.hpp"
#include "libchar/core/decimal.hpp"

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
      "the total variance is low by up to " + significant(100 * (walk ? 0.75 : 0.481) * share, 2) +
      " % at the longest averaging time (not corrected); its degrees of freedom are approximate");
}

}  // namespace

void add_intervals(AllanCurve& curve, const Mixture& theta) {
  for (AllanPoint& point : curve.points) {
    Mixture with_added = theta;
    with_added[static_cast<std::size_t>(Term::white)] += point.added * point.tau_s;
    point.edf = equivalent_dof(
        curve.type, with_added, point.m, point.terms, stride_of(curve, point), curve.dt_s);
    point.edf = std::max(1.0, point.edf / (point.inflation * point.inflation));
    point.ci68 = chi_square_interval(point.deviation, point.edf, kOneSigma);
    point.ci95 = chi_square_interval(point.deviation, point.edf, kTwoSided);
    point.reliable = point.edf >= kReliableDof;
  }
  if (deviation_row(curve.type).reflected) note_total_bias(curve, theta);
}

}  // namespace libchar
