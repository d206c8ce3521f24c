// Differences of flicker have the covariance gamma(j) = -(4/pi)/(4 j² - 1) dt^-2, the spectrum 2 sin(b) dt^-2 with b = pi k/(2n). Summed
// against the cosines of the DCT-II, L = ln(cot(b/2))/2:
//   dt² E[c_k²] = 2 sin b + (2/(pi n)) (-1)^k (1 - z f(z))                           the spectrum, less lags beyond n
//               + (8/(pi n)) [L cos b/2 - 1/4 + Ci(z)/4] + (4/(pi n)) L/cos b,       what the two ends add;     z = pi k
//   1 - z f(z) = 1 - z (pi/2 - Si(z)) (-1)^k,   Ci(z) = -(-1)^k g(z), g(z) ~ 1/(z² + 4.3)
// The ends count: L is 6 where n is 10⁶ and k = 1. Short series, and means of m samples, whose covariance is the second difference of
// -(2/pi) H_(jm), H_n = 1 + 1/3 + … + 1/(2n - 1), are summed exactly.
#include "libchar/fit/detail/record/flicker_phase_means.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libchar/allan/noise_curves.hpp"
#include "libchar/fit/detail/record/dct_means.hpp"

namespace libchar {
namespace {

using std::numbers::pi;

constexpr std::uint64_t kExactUpTo = 4096;
constexpr std::uint64_t kOneByOne = 6;

/// E[c_k²] dt² at [k-1] of the series sqrt(m) times means of m samples.
std::vector<double> exact_means(std::uint64_t n, std::uint64_t m) {
  std::vector<double> covariance(n);
  const auto width = static_cast<double>(m);
  for (std::uint64_t j = 0; j < n; ++j) {
    const auto lag = static_cast<double>(j);
    if (m == 1) {
      covariance[j] = -4 / pi / (4 * lag * lag - 1);
      continue;
    }
    covariance[j] =
        2 / pi / width *
        (libchar::odd_harmonic((lag + 1) * width) +
         libchar::odd_harmonic(std::abs(lag - 1) * width) - 2 * libchar::odd_harmonic(lag * width));
  }
  return dct_means_of_covariance(covariance);
}

double mean_of(const PowerBin& bin, const std::vector<double>& exact) {
  double sum = 0;
  for (std::uint64_t k = bin.first; k < bin.end; ++k) sum += exact[k - 1];
  return sum / static_cast<double>(bin.end - bin.first);
}

double mean_of(const PowerBin& bin, double dt_s) {
  const auto first = static_cast<double>(bin.first), end = static_cast<double>(bin.end);
  if (bin.end - bin.first <= kOneByOne) {
    double sum = 0;
    for (double k = first; k < end; ++k) sum += flicker_phase_dct_mean(k, bin.length, dt_s);
    return sum / (end - first);
  }
  const double middle = 0.5 * (first + end - 1), half = 0.5 * (end - first);
  const double node = 0.7745966692414834 * half;
  return (5 * flicker_phase_dct_mean(middle - node + 1e-7, bin.length, dt_s) +
          8 * flicker_phase_dct_mean(middle + 1e-7, bin.length, dt_s) +
          5 * flicker_phase_dct_mean(middle + node + 1e-7, bin.length, dt_s)) /
         18;
}

}  // namespace

double flicker_phase_dct_mean(double k, std::uint64_t n, double dt_s) {
  const auto count = static_cast<double>(n);
  const double b = 0.5 * pi * k / count, z = pi * k;
  const double log_cot = -0.5 * std::log(std::tan(b / 2));
  double beyond = 0, integral = 0;
  if (k == std::round(k)) {
    const double sign = std::fmod(k, 2.0) == 0 ? 1 : -1;
    beyond = sign - z * (pi / 2 - sine_integral_at_pi(static_cast<std::uint64_t>(k)));
    integral = -sign / (z * z + 4.3);
  }
  const double ends = 8 * (0.5 * log_cot * std::cos(b) - 0.25 + 0.25 * integral) +
                      4 * log_cot / std::cos(b) + 2 * beyond;
  return (2 * std::sin(b) + ends / (pi * count)) / (dt_s * dt_s);
}

std::vector<double> flicker_phase_units(const std::vector<PowerBin>& bins, double rate_hz) {
  std::vector<double> out;
  std::vector<double> exact;
  std::uint64_t length = 0, spacing = 0;
  for (const PowerBin& bin : bins) {
    if (bin.spacing == 1 && bin.length > kExactUpTo) {
      out.push_back(mean_of(bin, 1 / rate_hz));
      continue;
    }
    if (bin.length != length || bin.spacing != spacing) {
      length = bin.length;
      spacing = bin.spacing;
      exact = exact_means(length, spacing);
    }
    out.push_back(mean_of(bin, exact) * rate_hz * rate_hz);
  }
  return out;
}

}  // namespace libchar
