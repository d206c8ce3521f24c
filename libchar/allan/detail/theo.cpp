// Theo1 (W. J. Riley, NIST SP 1065, 5.2.14; D. A. Howe, Metrologia 43 (2006) S322), m even, tau =
// 3/4 m dt, N_x = N + 1 phase points:
//
//   Theo1^2 = 1 / (0.75 (N_x - m) (m dt)^2) sum_i sum_{d < m/2}
//             [ (x_{c-m/2} - x_{c-d}) + (x_{c+m/2} - x_{c+d}) ]^2 / (m/2 - d)
//
// c = i + m/2, i = 0 … N_x - m - 1. It reaches averaging times of 3/4 of the record, and is biased
// against the Allan deviation.
//
//   TheoBR^2 = Theo1^2 · 1/(n+1) sum_{i=0}^{n} AVAR(9 + 3i) / Theo1^2(12 + 4i),   n = floor(N_x/6 - 3)
//   TheoH    = overlapping Allan deviation for tau up to a fifth of the record, beyond it TheoBR
//
// (SP 1065, 5.2.15 and 5.2.16). A factor m costs O(N m). Where N m is beyond the work allowed,
// terms start every m/16 samples or less; and the mean ratio of TheoBR is over kFewRatios of the
// N/6, evenly spaced, in a record too long for all.

#include <cmath>
#include <cstring>
#include <vector>

#include "libchar/allan/detail/family.hpp"
#include "libchar/allan/detail/kernels/eight_lanes.hpp"
#include "libchar/core/numeric/lanes.hpp"
#include "libchar/core/parallel/parallel.hpp"

namespace libchar {
namespace {

constexpr std::size_t kSmallest = 10, kBlockOfTheo = 256, kFewRatios = 64;
constexpr double kRatioWork = 1 << 30;

/// sum_d w_d (ends - (left_d + right_d))^2, d = 0 … count - 1, in eight lanes.
LIBCHAR_LANES double weighted_squares_lanes(const double* left, const double* right, const double* w, std::size_t count,
                                            double ends) {
  Four sum[2] = {};
  const std::size_t whole = count / 8 * 8;
  for (std::size_t d = 0; d < whole; d += 8)
    for (std::size_t h = 0; h < 2; ++h) {
      const std::size_t at = d + 4 * h;
      const Four e = ends - (LIBCHAR_FOUR(left + at) + LIBCHAR_FOUR(right + at));
      sum[h] += LIBCHAR_FOUR(w + at) * e * e;
    }
  double lane[kLanes];
  std::memcpy(lane, sum, sizeof lane);
  for (std::size_t d = whole; d < count; ++d) {
    const double e = ends - (left[d] + right[d]);
    lane[d - whole] += w[d] * e * e;
  }
  return sum_of_lanes(lane);
}
constexpr InLanes<weighted_squares_lanes> weighted_squares;

FamilySum theo_sum(const FamilyInput& input, const IndexRange& stretch, std::size_t m, std::size_t stride) {
  const std::size_t half = m / 2;
  std::vector<double> w(half);
  for (std::size_t d = 0; d < half; ++d) w[d] = 1 / static_cast<double>(half - d);
  return over_blocks(
      stretch.begin, input.points(stretch) - m, stride, kBlockOfTheo, [&](std::size_t first, std::size_t count) {
        const std::size_t length = (count - 1) * stride + m + 1;
        std::vector<double> x(length), turned(length);
        local_phase(input, first, x);
        std::reverse_copy(x.begin(), x.end(), turned.begin());
        double sum = 0;
        for (std::size_t k = 0; k < count; ++k) {
          const std::size_t i = k * stride, c = i + half;
          sum += weighted_squares(turned.data() + (length - 1 - c), x.data() + c, w.data(), half, x[i] + x[i + m]);
        }
        return sum;
      });
}

AllanPoint theo1_point(const FamilyInput& input, const IndexRange& stretch, std::size_t m, bool& spaced) {
  const double tau_s = 0.75 * static_cast<double>(m) * input.dt_s;
  if (input.points(stretch) <= m) return family_point(input, m, tau_s, 1, {});
  const std::size_t stride = family_stride(input, m, input.points(stretch) - m, m / 2);
  spaced = stride > 1;
  AllanPoint point = family_point(input, m, tau_s, 0.75, theo_sum(input, stretch, m, stride));
  point.terms *= m / 2;
  return point;
}

/// Overlapping Allan deviation of the stretch.
AllanPoint allan_point(const FamilyInput& input, const IndexRange& stretch, std::size_t m) {
  const double tau_s = static_cast<double>(m) * input.dt_s;
  if (input.points(stretch) <= 2 * m) return family_point(input, m, tau_s, 1, {});
  const FamilySum sum = over_blocks(stretch.begin, input.points(stretch) - 2 * m, 1, std::max<std::size_t>(512, 2 * m),
                                    [&](std::size_t first, std::size_t count) {
                                      std::vector<double> x(count + 2 * m);
                                      local_phase(input, first, x);
                                      double squares = 0;
                                      for (std::size_t i = 0; i < count; ++i) {
                                        const double d = (x[i + 2 * m] - x[i + m]) - (x[i + m] - x[i]);
                                        squares += d * d;
                                      }
                                      return squares;
                                    });
  return family_point(input, m, tau_s, 2, sum);
}

/// sqrt(mean AVAR / Theo1^2), by which Theo1 is multiplied; 1 where both are zero throughout.
double bias_removal(FamilyInput input, const IndexRange& stretch, std::vector<std::string>& notes) {
  const std::size_t last = input.points(stretch) / 6 - 3;
  const double length = static_cast<double>(input.points(stretch));
  const bool all = length * length * length / 64 <= kRatioWork || last < kFewRatios;
  const std::size_t used = all ? last + 1 : kFewRatios;
  input.work_a_point = all ? 0 : static_cast<std::uint64_t>(kRatioWork) / kFewRatios;
  if (!all)
    notes.push_back("the bias of Theo1 is taken from " + std::to_string(kFewRatios) + " of the " +
                    std::to_string(last + 1) + " ratios, evenly spaced");
  std::vector<double> ratio(used);
  parallel::for_each(0, used, [&](std::size_t k) {
    const std::size_t i = all ? k : detail::in_memory(std::uint64_t{k} * last / (used - 1));
    bool spaced = false;
    const double theo = theo1_point(input, stretch, 12 + 4 * i, spaced).deviation;
    const double allan = allan_point(input, stretch, 9 + 3 * i).deviation;
    ratio[k] = theo > 0 ? (allan / theo) * (allan / theo) : 1;
  });
  double sum = 0;
  for (const double r : ratio) sum += r;
  return std::sqrt(sum / static_cast<double>(used));
}

}  // namespace

std::vector<AllanPoint> theo_points(const FamilyInput& input, const DeviationRow& row,
                                    const std::vector<std::uint64_t>& factors, std::vector<std::string>& notes) {
  const IndexRange& stretch = input.stretches.front();
  const std::uint64_t allan_up_to = row.type == DeviationType::theoh ? last_allan_factor(input.rates(stretch)) : 0;
  const bool any_theo = !factors.empty() && factors.back() > allan_up_to;
  const double removal = row.type == DeviationType::theo1 || !any_theo ? 1 : bias_removal(input, stretch, notes);
  return spaced_points(factors, notes, [&](std::size_t m, bool& spaced) {
    if (m <= allan_up_to) return allan_point(input, stretch, m);
    AllanPoint point = theo1_point(input, stretch, m, spaced);
    point.deviation *= removal;
    return point;
  });
}

}  // namespace libchar
