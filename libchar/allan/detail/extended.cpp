// Modified total and Hadamard total deviation (W. J. Riley, NIST SP 1065, 5.2.11, 5.2.12 and
// 5.2.13). Of a series s (MTOT: phase, HTOT: rate) each window w of 3m samples loses its trend, by
// the means of its two halves (the middle sample of an odd number in neither), and is continued by
// its own reflection on both sides to e of 9m. With A_j the mean of e_j … e_{j+m-1},
//
//   v = mean over the windows of  1/(6m) sum_{j<6m} (A_{j+2m} - 2 A_{j+m} + A_j)^2
//   MTOT^2 = v / (2 tau^2),   TTOT = tau MTOT / sqrt(3),   HTOT^2 = v / 6
//   (HTOT at m = 1: the overlapping Hadamard deviation)
//
// Let P_k be the sum of the first k samples of the window without mean and trend (P_{3m} = 0). e is
// even about both ends of w, so that j and 3m - j give the same square:
//
//   m (A_{j+2m} - 2 A_{j+m} + A_j) = P_j + P_{3m-j} - 3 P_{2m-j} + 3 P_{m-j}
//
// with - 3 P_{j-m} for the last where j > m. The other half of the 6m positions is the same of the
// window turned round. P comes from running sums, so that a window costs about 3m squares: O(N m)
// an averaging time; beyond the work allowed windows start every m/16 samples or less.

#include <cmath>
#include <cstring>
#include <vector>

#include "libchar/allan/detail/family.hpp"
#include "libchar/allan/detail/kernels/eight_lanes.hpp"
#include "libchar/core/numeric/lanes.hpp"
#include "libchar/core/parallel/parallel.hpp"

namespace libchar {
namespace {

/// P forwards and backwards, back[t] = P_{3m-t}.
struct WindowSums {
  std::vector<double> to, back;
};

/// sum_{j<count} (a_j + b_j - 3 c_j + weight d_j)^2, in eight lanes.
LIBCHAR_LANES double reflected_squares_lanes(const double* a, const double* b, const double* c, const double* d,
                                             double weight, std::size_t count) {
  Four sum[2] = {};
  const std::size_t whole = count / 8 * 8;
  for (std::size_t j = 0; j < whole; j += 8)
    for (std::size_t h = 0; h < 2; ++h) {
      const std::size_t at = j + 4 * h;
      const Four z =
          (LIBCHAR_FOUR(a + at) + LIBCHAR_FOUR(b + at)) - (3.0 * LIBCHAR_FOUR(c + at) - weight * LIBCHAR_FOUR(d + at));
      sum[h] += z * z;
    }
  double lane[kLanes];
  std::memcpy(lane, sum, sizeof lane);
  for (std::size_t j = whole; j < count; ++j) {
    const double z = (a[j] + b[j]) - (3 * c[j] - weight * d[j]);
    lane[j - whole] += z * z;
  }
  return sum_of_lanes(lane);
}
constexpr InLanes<reflected_squares_lanes> reflected_squares;

/// `sum`: running sums of the series; the window begins at i.
void window_sums(const std::vector<double>& sum, std::size_t i, std::size_t m, WindowSums& out) {
  const std::size_t points = 3 * m, half = points / 2;
  const auto n = static_cast<double>(points), h = static_cast<double>(half);
  const double* const s = sum.data() + i;
  const double mean = (s[points] - s[0]) / n;
  const double slope = ((s[points] - s[points - half]) - (s[half] - s[0])) / h / static_cast<double>(points - half);
  for (std::size_t k = 0; k <= points; ++k) {
    const auto at = static_cast<double>(k);
    out.to[k] = (s[k] - s[0]) - at * mean - slope * at * (at - n) / 2;
  }
  std::reverse_copy(out.to.begin(), out.to.end(), out.back.begin());
}

/// Squares of half of the 6m positions, those of windows that begin in e before w (forwards) or in w.
double squares_of_half(const std::vector<double>& forwards, const std::vector<double>& backwards, std::size_t m) {
  const double* const to = forwards.data();
  const double* const back = backwards.data();
  const auto over = [&](std::size_t first, std::size_t last) {  // j = first … last - 1
    if (last <= first) return 0.0;
    return reflected_squares(to + first, back + first, back + m + first,
                             first > m ? to + first - m : back + 2 * m + first, first > m ? -3 : 3, last - first);
  };
  const std::size_t last = (3 * m - 1) / 2;  // the last j that stands for two
  const double inner = over(1, std::min(m, last) + 1) + over(m + 1, last + 1);
  return over(0, 1) + 2 * inner + (m % 2 == 0 ? over(3 * m / 2, 3 * m / 2 + 1) : 0);
}

/// Mean over j of the m^2-fold squares of one window.
double mean_square(const WindowSums& p, std::size_t m) {
  return (squares_of_half(p.to, p.back, m) + squares_of_half(p.back, p.to, m)) / (6 * static_cast<double>(m));
}

FamilySum window_squares(const FamilyInput& input, const IndexRange& stretch, bool of_phase, std::size_t m,
                         std::size_t starts, std::size_t stride) {
  const std::size_t block = std::clamp<std::size_t>(3 * m, 16, 48);
  return over_blocks(stretch.begin, starts, stride, block, [&](std::size_t first, std::size_t count) {
    std::vector<double> series((count - 1) * stride + 3 * m), sum(series.size() + 1);
    of_phase ? local_phase(input, first, series) : local_rate(input, first, series);
    for (std::size_t j = 0; j < series.size(); ++j) sum[j + 1] = sum[j] + series[j];
    WindowSums window{std::vector<double>(3 * m + 1), std::vector<double>(3 * m + 1)};
    double squares = 0;
    for (std::size_t k = 0; k < count; ++k) {
      window_sums(sum, k * stride, m, window);
      squares += mean_square(window, m);
    }
    return squares;
  });
}

/// Third differences at m = 1, where reflection would add nothing but a factor.
double hadamard_squares(const FamilyInput& input, std::size_t first, std::size_t count) {
  std::vector<double> y(count + 2);
  local_rate(input, first, y);
  double squares = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double d = (y[i + 2] - y[i + 1]) - (y[i + 1] - y[i]);
    squares += d * d;
  }
  return squares;
}

AllanPoint extended_point(const FamilyInput& input, const DeviationRow& row, std::size_t m, bool& spaced) {
  const IndexRange& stretch = input.stretches.front();
  const double tau_s = static_cast<double>(m) * input.dt_s;
  const std::size_t length = row.of_sum ? input.points(stretch) : input.rates(stretch);
  if (length < 3 * m) return family_point(input, m, tau_s, 1, {});
  const std::size_t starts = length - 3 * m + 1;
  const std::size_t stride = family_stride(input, m, starts, 6 * m);
  spaced = stride > 1;
  FamilySum sum = !row.of_sum && m == 1
                      ? over_blocks(stretch.begin, starts, 1, 512,
                                    [&](std::size_t first, std::size_t n) { return hadamard_squares(input, first, n); })
                      : window_squares(input, stretch, row.of_sum, m, starts, stride);
  const auto factor = static_cast<double>(m);
  sum.sum /= row.of_sum ? factor * factor : 1;  // HTOT is of rates: no division by tau
  AllanPoint point = family_point(input, m, tau_s, row.divisor, sum);
  if (row.as_time) point.deviation *= tau_s / std::sqrt(3.0);
  return point;
}

}  // namespace

std::vector<AllanPoint> extended_points(const FamilyInput& input, const DeviationRow& row,
                                        const std::vector<std::uint64_t>& factors, std::vector<std::string>& notes) {
  return spaced_points(factors, notes,
                       [&](std::size_t m, bool& spaced) { return extended_point(input, row, m, spaced); });
}

}  // namespace libchar
