// P_pk = (U - mean) / (3 s) of an upper limit U. Its variance, to first order, from the standard errors of mean and ln s (Bissell, Appl.
// Stat. 39 (1990) 331, has those of a sample without uncertainties: 1/(3 sqrt n) and 1/sqrt(2 (n - 1))):
//   var P = (se mean / (3 s))² + P² (se ln s)²
// Where a spread of zero is not excluded the interval is what its upper end and both ends of the mean give, and has no upper end.
#include "libchar/lot/capability.hpp"

#include <cmath>
#include <limits>

namespace libchar {

void add_ppk(const RandomEffects& effects, double limit, Capability& out) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const Interval& mean = effects.mean_ci95;
  const Interval& spread = effects.spread_ci95;
  const double room = limit - effects.mean;
  const double ppk = effects.spread > 0 ? room / (3 * effects.spread)
                     : room >= 0        ? kInfinity
                                        : -kInfinity;
  out.ppk = ppk;
  out.above = std::erfc(3 * ppk / std::sqrt(2.0)) / 2;
  if (spread.low > 0) {
    const double of_mean = (mean.high - mean.low) / 2 / (3 * effects.spread);
    const double of_spread = ppk * std::log(spread.high / spread.low) / 2;
    const double half = std::hypot(of_mean, of_spread);
    out.ppk_ci95 = {ppk - half, ppk + half};
    return;
  }
  const auto at_widest = [&](double from) { return (limit - from) / (3 * spread.high); };
  out.ppk_ci95 = {mean.high <= limit ? at_widest(mean.high) : -kInfinity,
                  mean.low <= limit ? kInfinity : at_widest(mean.low)};
}

}  // namespace libchar
