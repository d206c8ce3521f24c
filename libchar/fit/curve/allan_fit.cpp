// Generalised least squares on the Allan variances a = A theta + e with Cov(e) = C(theta), the
// model's exact covariance:
//   theta <- argmin_{theta >= 0} (a - A theta)' C(theta_old)^-1 (a - A theta),  repeated until the
//   fitted curve stands still
// (generalised least squares; docs/theory/fit.md). There is no objective behind the reweighting, so that it may swing:
// each round that moves no less than the one before halves the step.
#include "libchar/fit/curve/allan_fit.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "libchar/allan/allan_covariance.hpp"
#include "libchar/allan/noise_curves.hpp"
#include "libchar/core/numeric/dense.hpp"
#include "libchar/core/numeric/distributions.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/fit/curve/shaped_curves.hpp"
#include "libchar/fit/detail/curve/coefficients.hpp"
#include "libchar/fit/detail/curve/nonnegative.hpp"

namespace libchar {
namespace {

/// The points that the terms alone can explain: where the shape counts the curve is another one.
AllanCurve usable(const AllanCurve& curve, const NoiseFit& first) {
  AllanCurve kept = curve;
  const double from_s = plain_from_s(first, curve);
  std::erase_if(kept.points, [&](const AllanPoint& point) {
    return !(point.deviation > 0) || point.terms == 0 || point.tau_s < from_s;
  });
  return kept;
}

constexpr int kMostRounds = 100;

struct Solution {
  Mixture theta{};
  TermMatrix covariance = TermMatrix::Zero();
  double chi2 = 0;
  std::size_t judged = 0;  ///< points that it is of
  bool converged = false;
};

/// The points up to the first with fewer degrees of freedom: the squares of those have far heavier tails than a
/// normal variable's, and one of them is enough to reject a curve that is as it should be.
Eigen::Index judged_points(const Eigen::VectorXd& variance, const Eigen::MatrixXd& covariance) {
  constexpr double kFewestFreedoms = 8;
  Eigen::Index n = 0;
  while (n < variance.size() && 2 * variance[n] * variance[n] >= kFewestFreedoms * covariance(n, n)) ++n;
  return n;
}

std::optional<Solution> solve(const AllanCurve& curve, const AllanCovariance& covariance, const Mixture& start) {
  const TermSet terms = only_positive(start);
  const auto n = static_cast<Eigen::Index>(curve.points.size());
  Eigen::MatrixXd design = Eigen::MatrixXd::Zero(n, static_cast<int>(kTerms));
  Eigen::VectorXd variance(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    const AllanPoint& point = curve.points[static_cast<std::size_t>(j)];
    variance[j] = point.deviation * point.deviation;
    for (std::size_t i = 0; i < kTerms; ++i) {
      if (terms[i])
        design(j, static_cast<Eigen::Index>(i)) =
            unit_allan_variance(static_cast<Term>(i), static_cast<double>(point.m), curve.dt_s);
    }
  }
  Solution solution{start, TermMatrix::Zero(), 0, false};
  double step = 1, before = std::numeric_limits<double>::infinity();
  for (int round = 0; round < kMostRounds && !solution.converged; ++round) {
    const Eigen::MatrixXd now = covariance.at(solution.theta);
    const std::optional<Eigen::MatrixXd> factor = cholesky_factor(now);
    if (!factor) return std::nullopt;
    const Eigen::MatrixXd whitened = solve_lower(*factor, design);
    const Eigen::VectorXd target = solve_lower(*factor, variance);
    const TermMatrix gram = whitened.transpose() * whitened;
    const Eigen::VectorXd product = whitened.transpose() * target;
    Mixture right{};
    for (std::size_t i = 0; i < kTerms; ++i) right[i] = product[static_cast<Eigen::Index>(i)];
    Mixture next = nonnegative_minimum(gram, right, terms);
    for (std::size_t i = 0; i < kTerms; ++i) next[i] = step * next[i] + (1 - step) * solution.theta[i];
    const auto vector = [](const Mixture& theta) {
      return Eigen::Map<const Eigen::Matrix<double, kTerms, 1>>(theta.data());
    };
    const Eigen::VectorXd curve_now = design * vector(next), curve_before = design * vector(solution.theta);
    if (!(curve_now.minCoeff() > 0)) return std::nullopt;
    const double moved = ((curve_now - curve_before).array() / curve_now.array()).abs().maxCoeff();
    solution.theta = next;
    solution.covariance = inverse_of(gram, terms);
    // The factor is triangular: the first entries are those of the first points alone.
    const Eigen::Index judged = judged_points(curve_now, now);
    solution.chi2 = (target - whitened * vector(next)).head(judged).squaredNorm();
    solution.judged = static_cast<std::size_t>(judged);
    solution.converged = moved < 1e-7 * step;
    if (moved > 0.95 * before) step /= 2;
    before = moved;
  }
  return solution;
}

void compare(const NoiseFit& first, const Solution& solution, SecondOpinion& second) {
  for (std::size_t i = 0; i < kTerms; ++i) {
    const Coefficient& term = first.term[i];
    if (!term.value) continue;
    const double theta = solution.theta[i],
                 sd_theta = std::sqrt(solution.covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i)));
    const double scale = 2 * std::max(*term.value, std::sqrt(theta));
    second.value[i] = std::sqrt(theta);
    second.sd[i] = sd_theta / scale;
    const double first_sd_theta = 2 * term.relative_sd * first.theta[i];
    const double apart = std::abs(theta - first.theta[i]) / std::hypot(sd_theta, first_sd_theta);
    if (term.status != Status::detected || apart <= 3) continue;
    second.agrees = false;
    second.sentence += fmt::format("{}the Allan curve gives {} for {}, {:.1f} combined standard deviations from {}",
                                   second.sentence.empty() ? "" : "; ", brief_text(*second.value[i], 4),
                                   long_name(static_cast<Term>(i)), apart, brief_text(*term.value, 4));
  }
  if (second.goodness.p < 1e-4) {
    // An opinion that does not describe the curve it was made from supports nothing.
    second.agrees = false;
    second.sentence += fmt::format("{}does not describe the Allan curve itself (p = {})",
                                   second.sentence.empty() ? "" : "; ", brief_text(second.goodness.p, 2));
  } else if (second.agrees) {
    second.sentence = "agrees";
  }
  if (!solution.converged)
    second.sentence += fmt::format(" (the reweighting did not converge in {} rounds)", kMostRounds);
}

}  // namespace

std::optional<SecondOpinion> second_opinion(const AllanCurve& curve, const NoiseFit& first,
                                            AllanCovarianceCache* cache) {
  const AllanCurve kept = usable(curve, first);
  const std::size_t terms = count_of(only_positive(first.theta));
  if (!deviation_row(kept.type).is_allan() || terms == 0 || kept.points.size() < terms + 1) return std::nullopt;
  AllanCovarianceCache own;
  const auto covariance = (cache != nullptr ? *cache : own).of(kept);
  const std::optional<Solution> solution = solve(kept, *covariance, first.theta);
  if (!solution) return std::nullopt;
  SecondOpinion second;
  second.goodness.chi2 = solution->chi2;
  second.goodness.dof =
      static_cast<double>(solution->judged) - static_cast<double>(count_of(only_positive(solution->theta)));
  second.goodness.p = second.goodness.dof > 0 ? chi_square_tail(second.goodness.chi2, second.goodness.dof) : 1;
  compare(first, *solution, second);
  return second;
}

}  // namespace libchar
