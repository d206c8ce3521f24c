// With the spread s that both have in common (detail/grouped_effects.hpp) and z = (y - mean of its
// lot) / sqrt(v + s²), the ratio of the mean squares of z in the two lots is Fisher's F, exactly
// where either the uncertainties or the spread are nothing. F believes that the values are normal:
// with the kurtosis g of all z, at least 3, lots of n values have 2 n / (g - (n - 3)/(n - 1))
// degrees of freedom, n - 1 for g = 3 (Shoemaker, Am. Stat. 57 (2003) 105).
#include "libchar/lot/detail/statistics/equal_spread.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "libchar/core/numeric/distributions.hpp"
#include "libchar/lot/detail/statistics/grouped_effects.hpp"

namespace libchar {
namespace {

constexpr std::size_t kLeast = 4;

struct Powers {
  double n = 0, second = 0, fourth = 0;  ///< sums of z² and z⁴
};

Powers powers_of(std::span<const double> y, std::span<const double> v, double mean, double square) {
  Powers out;
  out.n = static_cast<double>(y.size());
  for (std::size_t i = 0; i < y.size(); ++i) {
    const double z2 = (y[i] - mean) * (y[i] - mean) / (v[i] + square);
    out.second += z2;
    out.fourth += z2 * z2;
  }
  return out;
}

double degrees_of_freedom(double n, double kurtosis) {
  return 2 * n / (kurtosis - (n - 3) / (n - 1));
}

}  // namespace

double equal_spread_p(std::span<const double> y_a,
                      std::span<const double> v_a,
                      std::span<const double> y_b,
                      std::span<const double> v_b) {
  if (std::min(y_a.size(), y_b.size()) < kLeast) return 1;
  std::vector<double> y(y_a.begin(), y_a.end()), v(v_a.begin(), v_a.end());
  y.insert(y.end(), y_b.begin(), y_b.end());
  v.insert(v.end(), v_b.begin(), v_b.end());
  std::vector<std::size_t> lot(y.size());
  std::fill(lot.begin() + static_cast<std::ptrdiff_t>(y_a.size()), lot.end(), std::size_t{1});
  const GroupedEffects both = grouped_effects(y, v, lot, 2);
  const double square = both.within * both.within;
  const Powers a = powers_of(y_a, v_a, both.mean[0], square),
               b = powers_of(y_b, v_b, both.mean[1], square);
  const double sum = a.second + b.second;
  if (!(a.second > 0) || !(b.second > 0)) return 1;
  const double kurtosis = std::max(3.0, (a.n + b.n) * (a.fourth + b.fourth) / (sum * sum));
  const double f = b.second / (b.n - 1) / (a.second / (a.n - 1));
  const double dof_a = degrees_of_freedom(a.n, kurtosis), dof_b = degrees_of_freedom(b.n, kurtosis);
  return std::min(1.0, 2 * std::min(fisher_cdf(f, dof_b, dof_a), fisher_tail(f, dof_b, dof_a)));
}

}  // namespace libchar
