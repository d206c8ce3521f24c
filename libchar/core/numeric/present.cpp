#include "libchar/core/numeric/present.hpp"

#include <cmath>

#include "libchar/core/not_known.hpp"
#include "libchar/core/numeric/lanes.hpp"

namespace libchar {
namespace {

constexpr std::size_t kPiece = 64;  // looked at together

// x != x for a missing sample only; x - x is no number for an infinity either.
LIBCHAR_LANES std::size_t whole_present_pieces_lanes(const double* x, std::size_t n) {
  std::size_t i = 0;
  for (; i + kPiece <= n; i += kPiece) {
    Four sum = {};
    auto missing = sum != sum;
    for (std::size_t k = 0; k < kPiece; k += 4) {
      const Four v = LIBCHAR_FOUR(x + i + k);
      missing |= v != v;
    }
    if ((missing[0] | missing[1] | missing[2] | missing[3]) != 0) break;
  }
  return i;
}
constexpr InLanes<whole_present_pieces_lanes> whole_present_pieces;

LIBCHAR_LANES std::size_t whole_finite_pieces_lanes(const double* x, std::size_t n) {
  std::size_t i = 0;
  for (; i + kPiece <= n; i += kPiece) {
    Four sum = {};
    for (std::size_t k = 0; k < kPiece; k += 4) {
      const Four v = LIBCHAR_FOUR(x + i + k);
      sum += v - v;
    }
    if (!((sum[0] + sum[1]) + (sum[2] + sum[3]) == 0)) break;
  }
  return i;
}
constexpr InLanes<whole_finite_pieces_lanes> whole_finite_pieces;

LIBCHAR_LANES std::size_t missing_in_lanes(const double* x, std::size_t n) {
  Four none = {};
  auto count = none != none;  // minus one for every missing sample of the lane
  std::size_t i = 0;
  for (; i + 4 <= n; i += 4) {
    const Four v = LIBCHAR_FOUR(x + i);
    count += v != v;
  }
  auto missing = static_cast<std::size_t>(-(count[0] + count[1] + count[2] + count[3]));
  for (; i < n; ++i) missing += x[i] != x[i];
  return missing;
}
constexpr InLanes<missing_in_lanes> missing_in;

LIBCHAR_LANES std::size_t beyond_in_lanes(const double* x, std::size_t n) {
  Four none = {};
  auto count = none != none;
  std::size_t i = 0;
  for (; i + 4 <= n; i += 4) {
    const Four v = LIBCHAR_FOUR(x + i);
    count += (v > kLargestSample) | (v < -kLargestSample);
  }
  auto beyond = static_cast<std::size_t>(-(count[0] + count[1] + count[2] + count[3]));
  for (; i < n; ++i) beyond += std::abs(x[i]) > kLargestSample;
  return beyond;
}
constexpr InLanes<beyond_in_lanes> beyond_in;

LIBCHAR_LANES double sum_of_fours_lanes(const double* x, std::size_t fours, double origin) {
  Four sum = {}, other = {};
  std::size_t i = 0;
  for (; i + 2 <= fours; i += 2) {
    sum += LIBCHAR_FOUR(x + 4 * i) - origin;
    other += LIBCHAR_FOUR(x + 4 * i + 4) - origin;
  }
  if (i < fours) sum += LIBCHAR_FOUR(x + 4 * i) - origin;
  sum += other;
  return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}
constexpr InLanes<sum_of_fours_lanes> sum_of_fours;

double sum_about(std::span<const double> samples, double origin) {
  const std::size_t fours = samples.size() / 4;
  double sum = sum_of_fours(samples.data(), fours, origin);
  for (const double x : samples.subspan(4 * fours)) sum += x - origin;
  return sum;
}

}  // namespace

std::size_t present_run(std::span<const double> samples) {
  std::size_t n = whole_present_pieces(samples.data(), samples.size());
  while (n < samples.size() && !std::isnan(samples[n])) ++n;
  return n;
}

std::size_t finite_run(std::span<const double> samples) {
  std::size_t n = whole_finite_pieces(samples.data(), samples.size());
  while (n < samples.size() && std::isfinite(samples[n])) ++n;
  return n;
}

std::size_t count_missing(std::span<const double> samples) { return missing_in(samples.data(), samples.size()); }

std::size_t count_beyond(std::span<const double> samples) { return beyond_in(samples.data(), samples.size()); }

PresentMean present_mean(std::span<const double> samples) {
  if (std::isfinite(samples[0])) {
    const double sum = sum_about(samples, samples[0]);
    if (std::isfinite(sum)) return {samples[0] + sum / static_cast<double>(samples.size()), samples.size()};
  }
  double first = kNone, sum = 0;
  std::size_t present = 0;
  for (const double x : samples) {
    if (!std::isfinite(x)) continue;
    if (present == 0) first = x;
    sum += x - first;
    ++present;
  }
  return {present == 0 ? kNone : first + sum / static_cast<double>(present), present};
}

double mean_present(std::span<const double> samples) { return present_mean(samples).mean; }

}  // namespace libchar
