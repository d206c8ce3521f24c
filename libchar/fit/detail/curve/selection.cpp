// A term is reported when z = sqrt(likelihood ratio) > c = sqrt(threshold). With r(theta) the signed root of the rise of -2 ln L,
// standard normal under theta, z = r + (z - r), so that given the selection
//   P(more than what was found | theta) = P(N > r) / P(N > r + c - z),
// and the lower limit is where that is 2.5 %: always at r > 1.96, at infinity for z -> c, at 1.96 for z >> c.
// Source: Zhong and Prentice (2008), Bias-reduced estimators and confidence intervals for odds ratios in genome-wide association
// studies, Biostatistics 9:621; Weinstein, Fithian and Benjamini (2013), Selection adjusted confidence intervals, JASA 108:165.
// The upper limit stays that of the plain interval, which is the larger one.
#include "libchar/fit/detail/curve/selection.hpp"

#include <cmath>
#include <numbers>

#include "libchar/fit/detail/curve/profile.hpp"

namespace libchar {
namespace {

constexpr double kTail = 0.025;
constexpr double kFarRoot = 20;  ///< beyond it a limit is zero whatever the term

double above(double r) {
  return 0.5 * std::erfc(r / std::numbers::sqrt2);
}

}  // namespace

double selected_rise(double likelihood_ratio, double threshold) {
  const double z = std::sqrt(likelihood_ratio), c = std::sqrt(threshold);
  if (!(z - c < kFarRoot)) return kTwoSided95;
  double low = std::sqrt(kTwoSided95), high = kFarRoot;
  for (int i = 0; i < 60; ++i) {
    const double r = 0.5 * (low + high);
    (above(r) > kTail * above(r + c - z) ? low : high) = r;
  }
  return high * high;
}

}  // namespace libchar
