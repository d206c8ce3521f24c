// Weighted least squares in every group with the weights w_i = 1 / (v_i + s²) and one s² for all
// (Draper & Smith, Applied Regression Analysis, Wiley), about the group's own weighted mean of x,
// in which the two columns are orthogonal:
//   c = sum w (x - xm)(y - ym) / S,   S = sum w (x - xm)²,   var c = 1/S,   var(a at x) = 1/W + (x - xm)²/S
// s² is pooled over the groups: Q(s²), the weighted sum of squares about all lines, is chi-square with (values - 2 a
// line - 1 a mean) degrees of freedom at the true s² (grouped_effects.hpp). So the error of a slope is what the values
// scatter by from one to the next, which two values of a group do not show and those of all groups together do.

#include "libchar/core/not_known.hpp"
#include "libchar/lot/detail/statistics/grouped_effects.hpp"

namespace libchar {
namespace {

struct LineValues {
  std::span<const double> y, v, x;
  std::span<const std::size_t> group;
  const std::vector<bool>& sloped;
};

/// Of each group: its weighted means, and the line through them.
struct Lines {
  std::vector<double> weights, x, y, s, slope;
  double q = 0;
};

Lines lines_at(const LineValues& in, double square) {
  const std::size_t groups = in.sloped.size();
  Lines out{std::vector<double>(groups), std::vector<double>(groups), std::vector<double>(groups),
            std::vector<double>(groups), std::vector<double>(groups), 0};
  for (std::size_t i = 0; i < in.y.size(); ++i) {
    const std::size_t g = in.group[i];
    const double weight = 1 / (in.v[i] + square);
    out.weights[g] += weight;
    out.x[g] += weight * in.x[i];
    out.y[g] += weight * in.y[i];
  }
  for (std::size_t g = 0; g < groups; ++g) {
    out.x[g] /= out.weights[g];
    out.y[g] /= out.weights[g];
  }
  for (std::size_t i = 0; i < in.y.size(); ++i) {
    const std::size_t g = in.group[i];
    if (!in.sloped[g]) continue;
    const double off = in.x[i] - out.x[g], weight = 1 / (in.v[i] + square);
    out.s[g] += weight * off * off;
    out.slope[g] += weight * off * (in.y[i] - out.y[g]);
  }
  for (std::size_t g = 0; g < groups; ++g)
    if (in.sloped[g]) out.slope[g] /= out.s[g];
  for (std::size_t i = 0; i < in.y.size(); ++i) {
    const std::size_t g = in.group[i];
    // A group without a line has values at no known x.
    const double line = in.sloped[g] ? out.slope[g] * (in.x[i] - out.x[g]) : 0;
    const double off = in.y[i] - out.y[g] - line;
    out.q += off * off / (in.v[i] + square);
  }
  return out;
}

/// Variances of the slopes by a spread within; NaN for a group without one.
std::vector<double> slope_variances(const LineValues& in, double within) {
  const Lines at = lines_at(in, within * within);
  std::vector<double> out(in.sloped.size(), kNone);
  for (std::size_t g = 0; g < out.size(); ++g)
    if (in.sloped[g]) out[g] = 1 / at.s[g];
  return out;
}

}  // namespace

GroupedLines grouped_lines(std::span<const double> value, std::span<const double> variance, std::span<const double> x,
                           std::span<const std::size_t> group, const std::vector<bool>& sloped) {
  const LineValues in{value, variance, x, group, sloped};
  const std::size_t groups = sloped.size();
  GroupedLines out;
  out.residual_dof.assign(groups, 0);
  for (const std::size_t g : group) ++out.residual_dof[g];
  for (std::size_t g = 0; g < groups; ++g) {
    if (out.residual_dof[g] > 0) out.residual_dof[g] -= sloped[g] ? 2 : 1;
    out.dof += out.residual_dof[g];
  }
  const auto q = [&](double square) { return lines_at(in, square).q; };
  const WithinSpread within = within_spread(q, out.dof, variance);
  out.within = within.sd;
  out.within_ci95 = within.ci95;
  const bool known = out.dof >= 1;
  const Lines at = lines_at(in, known ? out.within * out.within : 0);
  out.at_zero.assign(groups, kNone);
  out.at_zero_variance.assign(groups, kNone);
  out.slope.assign(groups, kNone);
  out.slope_variance = slope_variances(in, known ? out.within : 0);
  out.slope_variance_low = known ? slope_variances(in, out.within_ci95.low) : out.slope_variance;
  out.slope_variance_high = known ? slope_variances(in, out.within_ci95.high) : out.slope_variance;
  for (std::size_t g = 0; g < groups; ++g) {
    if (!(at.weights[g] > 0)) continue;
    out.at_zero[g] = at.y[g];
    out.at_zero_variance[g] = 1 / at.weights[g];
    if (!sloped[g]) continue;
    out.slope[g] = at.slope[g];
    out.at_zero[g] -= at.slope[g] * at.x[g];
    out.at_zero_variance[g] += at.x[g] * at.x[g] / at.s[g];
  }
  return out;
}

}  // namespace libchar
