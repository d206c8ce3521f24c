// Not detected are the small ones, doubtful those beside the threshold. Taking them as censored at their upper limits
// was given up: a limit is not the threshold that the device was below, the errors of fits beside it are far from
// normal, and constants that were right for random walks were wrong for bias instabilities. What can be said is how far
// it goes at most. Of a normal distribution of which the lowest share f is missing (Cohen, Truncated and Censored
// Samples, 1991), with z the quantile of f and l = phi(z) / (1 - f),
//   mean of the others = mean + l sd,   their variance = (1 - l (l - z)) sd²
// and no other share f that is missing moves the mean further. sd is that of the values, spread and uncertainty
// together, since what is too small is so as it was measured: from the scatter of those counted, at its 97.5 % limit.
// Temperature coefficients that are not detected are about zero: with m the mean of the detected ones and f the share
// of the others, the mean of all lies in [(1 - f) m, m].

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libchar/core/not_known.hpp"
#include "libchar/core/numeric/distributions.hpp"
#include "libchar/lot/fleet_lot.hpp"

namespace libchar {
namespace {

/// Standard deviation of the values, not less with 97.5 %.
double largest_scatter(std::span<const double> value) {
  const double dof = static_cast<double>(value.size()) - 1;
  double sum = 0, square = 0;
  for (const double y : value) sum += y - value[0];
  const double mean = value[0] + sum / (dof + 1);
  for (const double y : value) square += (y - mean) * (y - mean);
  return std::sqrt(square / chi_square_quantile(0.025, dof));
}

LeftOut of_logarithms(double share, std::span<const double> value, std::span<const double> variance,
                      const RandomEffects& effects) {
  const double z = -std::sqrt(chi_square_upper_quantile(2 * share, 1));
  const double l = std::exp(-z * z / 2) / std::sqrt(2 * std::numbers::pi) / (1 - share);
  const double narrower = std::sqrt(1 - l * (l - z));
  double v = 0;
  for (const double one : variance) v += one / static_cast<double>(variance.size());
  const double scatter = (effects.spread_ci95.high * effects.spread_ci95.high + v) / (narrower * narrower);
  const double off = l * largest_scatter(value) / narrower;
  return {share,
          {std::exp(effects.mean_ci95.low - off), std::exp(effects.mean_ci95.high)},
          std::exp(off),
          std::sqrt(scatter - v)};
}

LeftOut about_zero(double share, const RandomEffects& effects) {
  const Interval& of = effects.mean_ci95;
  return {share,
          {std::min(of.low, (1 - share) * of.low), std::max(of.high, (1 - share) * of.high)},
          1 / (1 - share),
          kNone};
}

}  // namespace

std::optional<LeftOut> left_out(DeviceQuantity quantity, const LotCounts& counts, std::span<const double> value,
                                std::span<const double> variance, const RandomEffects& effects) {
  const std::size_t missing = counts.not_detected + counts.doubtful;
  // A bias is never too small to be found, and a time is not found for its process being small.
  if (missing == 0 || 2 * missing >= counts.counted + missing || value.size() < 2 ||
      quantity == DeviceQuantity::turn_on_bias || quantity == DeviceQuantity::gauss_markov_time)
    return std::nullopt;
  const double share = static_cast<double>(missing) / static_cast<double>(counts.counted + missing);
  return in_logarithm(quantity) ? of_logarithms(share, value, variance, effects) : about_zero(share, effects);
}

}  // namespace libchar
