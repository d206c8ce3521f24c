// Sums in long double: their rounding, 2^-64 of the sum, stays below that of a sample even where a
// record of 10^7 samples drifts by 10^6 standard deviations.

#include "libchar/allan/detail/kernels/present_sums.hpp"

#include <cmath>

#include "libchar/allan/detail/anchored_phase.hpp"

namespace libchar {

PresentSums present_sums(std::span<const double> record) {
  PresentSums sums;
  sums.scale = balancing_scale(record);
  sums.sum.reserve(record.size() + 1);
  sums.present.reserve(record.size() + 1);
  long double sum = 0, origin = 0;
  std::uint64_t present = 0;
  sums.sum.push_back(0);
  sums.present.push_back(0);
  for (const double value : record) {
    if (std::isfinite(value)) {
      const long double scaled = static_cast<long double>(value) * sums.scale;
      if (present == 0) origin = scaled;
      sum += scaled - origin;
      ++present;
    }
    sums.sum.push_back(sum);
    sums.present.push_back(present);
  }
  return sums;
}

namespace {

struct Window {
  double mean = 0, present = 0;
};

Window window(const PresentSums& sums, std::uint64_t begin, std::uint64_t m) {
  const auto present = static_cast<double>(sums.present[begin + m] - sums.present[begin]);
  return {static_cast<double>(sums.sum[begin + m] - sums.sum[begin]) / present, present};
}

}  // namespace

PresentTerms present_terms(const PresentSums& sums,
                           int order,
                           std::uint64_t m,
                           std::uint64_t first,
                           std::uint64_t last,
                           std::uint64_t stride) {
  const auto factor = static_cast<double>(m);
  double squares = 0, shortfall = 0, imbalance = 0;
  PresentTerms total;
  for (std::uint64_t i = first; i < last; i += stride) {
    const Window a = window(sums, i, m), b = window(sums, i + m, m);
    const double uneven = (b.present - a.present) / factor;
    imbalance += uneven * uneven;
    ++total.starts;
    if (!has_mean(a.present, factor) || !has_mean(b.present, factor)) continue;
    double d = b.mean - a.mean, less = 1 / a.present + 1 / b.present - 2 / factor;
    if (order == 2) {
      const Window c = window(sums, i + 2 * m, m);
      if (!has_mean(c.present, factor)) continue;
      d = (c.mean - b.mean) - d;
      less = 1 / a.present + 4 / b.present + 1 / c.present - 6 / factor;
    }
    squares += d * d;
    shortfall += less;
    ++total.terms;
  }
  total.squares = static_cast<long double>(squares);
  total.shortfall = static_cast<long double>(shortfall);
  total.imbalance = static_cast<long double>(imbalance);
  return total;
}

PresentTerms modified_terms(const PresentSums& sums, std::uint64_t m) {
  const std::uint64_t samples = sums.present.size() - 1;
  if (3 * m > samples + 1) return {};
  const auto factor = static_cast<double>(m);
  const double of_white = (factor * factor + 1) / (2 * factor * factor);
  // Running sums over the last m starts, from the first where all are there: u, and what it lacks.
  std::vector<double> d(samples - 2 * m + 1), less(d.size());
  std::uint64_t in_a_row = 0;
  long double sum = 0, lacks = 0, squares = 0, shortfall = 0;
  PresentTerms total;
  for (std::uint64_t k = 0; k < d.size(); ++k) {
    const Window a = window(sums, k, m), b = window(sums, k + m, m);
    if (!has_mean(a.present, factor) || !has_mean(b.present, factor)) {
      in_a_row = 0;
      sum = lacks = 0;
      continue;
    }
    d[k] = b.mean - a.mean;
    less[k] = 1 / a.present + 1 / b.present - 2 / factor;
    sum += static_cast<long double>(d[k]);
    lacks += static_cast<long double>(less[k]);
    if (in_a_row == m) {
      sum -= static_cast<long double>(d[k - m]);
      lacks -= static_cast<long double>(less[k - m]);
    } else {
      ++in_a_row;
    }
    if (in_a_row < m) continue;
    squares += sum * sum;
    shortfall += lacks;
    ++total.terms;
  }
  const auto wide = static_cast<long double>(factor);
  total.squares = squares / wide / wide;
  total.shortfall = shortfall / wide * static_cast<long double>(of_white);
  return total;
}

}  // namespace libchar
