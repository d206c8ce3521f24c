#include "libchar/fusion/algorithms/median.hpp"

#include <algorithm>
#include <cmath>

#include "libchar/fusion/detail/variances/weighted_mean.hpp"

namespace libchar::fusion {
namespace {

/// Below this many samples, sorting by insertion is faster than selection.
constexpr std::ptrdiff_t kFew = 24;

void sort_by_insertion(double* first, double* last) {
  for (double* next = first + 1; next < last; ++next) {
    const double value = *next;
    double* place = next;
    for (; place > first && place[-1] > value; --place) *place = place[-1];
    *place = value;
  }
}

}  // namespace

Estimate Median::step(const Sample& y) {
  double* const first = sorted_.data();
  double* last = first;
  for (Eigen::Index i = 0; i < y.size(); ++i)
    if (usable(y[i])) *last++ = y[i];
  const std::ptrdiff_t n = last - first;
  if (n == 0) return Estimate::none(1);
  double* const middle = first + n / 2;
  if (n <= kFew)
    sort_by_insertion(first, last);
  else
    std::nth_element(first, middle, last);
  if (n % 2 == 1) return Estimate::scalar(*middle, std::nan(""));
  const double below = *std::max_element(first, middle);
  return Estimate::scalar(below + (*middle - below) / 2, std::nan(""));
}

}  // namespace libchar::fusion
