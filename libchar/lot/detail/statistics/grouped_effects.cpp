// Q(s²) = sum_g sum_i (y_i - m_g)² / (v_i + s²), m_g the weighted mean of a group, is chi-square with n - G degrees of
// freedom at the true square of the spread within, so that it is found as in random_effects.cpp: Q(s²) = n - G, and an
// interval by the quantiles of Q. Groups' means differ more than that by Fisher's F of the one-way analysis of variance
// (Fisher 1925), with these weights
//   F = sum_g W_g (m_g - m)² / (G - 1) / max(1, Q(s²) / (n - G)),   W_g = sum_i 1 / (v_i + s²),
// exact for equal variances. Spread between: random effects of the m_g with variances 1 / W_g.
#include "libchar/lot/detail/statistics/grouped_effects.hpp"

#include <algorithm>

#include "libchar/core/numeric/distributions.hpp"

namespace libchar {
namespace {

struct Groups {
  std::span<const double> y, v;
  std::span<const std::size_t> group;
  std::size_t count = 0;
};

struct GroupMeans {
  std::vector<double> mean, weights;  ///< weights 0: no values
  double q = 0;
};

GroupMeans means_at(const Groups& in, double square) {
  GroupMeans out{std::vector<double>(in.count), std::vector<double>(in.count), 0};
  for (std::size_t i = 0; i < in.y.size(); ++i) {
    const double weight = 1 / (in.v[i] + square);
    out.weights[in.group[i]] += weight;
    out.mean[in.group[i]] += weight * in.y[i];
  }
  for (std::size_t g = 0; g < in.count; ++g) out.mean[g] /= out.weights[g];
  for (std::size_t i = 0; i < in.y.size(); ++i) {
    const double off = in.y[i] - out.mean[in.group[i]];
    out.q += off * off / (in.v[i] + square);
  }
  return out;
}

}  // namespace

GroupedEffects grouped_effects(std::span<const double> value, std::span<const double> variance,
                               std::span<const std::size_t> group, std::size_t groups) {
  const Groups in{value, variance, group, groups};
  GroupedEffects out;
  std::vector<bool> filled(groups);
  for (const std::size_t g : group) filled[g] = true;
  const auto full = static_cast<double>(std::count(filled.begin(), filled.end(), true));
  const double dof = static_cast<double>(value.size()) - full;
  const auto q_within = [&](double square) { return means_at(in, square).q; };
  const WithinSpread within = within_spread(q_within, dof, variance);
  out.within = within.sd;
  out.within_ci95 = within.ci95;
  const GroupMeans at = means_at(in, dof < 1 ? 0 : out.within * out.within);
  std::vector<double> means, variances;
  out.mean.assign(groups, kNone);
  out.variance.assign(groups, kNone);
  for (std::size_t g = 0; g < groups; ++g) {
    if (!filled[g]) continue;
    means.push_back(out.mean[g] = at.mean[g]);
    variances.push_back(out.variance[g] = 1 / at.weights[g]);
  }
  out.between = random_effects(means, variances);
  const double q = weighted(means, variances, 0).q;
  out.p = dof < 1 ? out.between.p : fisher_tail(q / (full - 1) / std::max(1.0, at.q / dof), full - 1, dof);
  return out;
}

}  // namespace libchar
