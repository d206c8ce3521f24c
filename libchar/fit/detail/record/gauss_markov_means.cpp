// The covariance phi^j summed against the cosines of the DCT-II, with a = pi k/n, e = 1 - phi, s = sin(a/2), w = 1 - phi exp(i a),
// D = |w|² = e² + 4 phi s²:
//   E[c_k²] = (1 - phi²)/D + (2/n) (1 - (-1)^k phi^n) [Re 1/w - Re 1/w² - phi/D]
// The first part is the process's spectrum, the second what its two ends add. Means of m samples are such a process with phi^m, whose
// neighbours have the covariance of neighbouring means, and white noise that makes up their variance.
#include "libchar/fit/detail/record/gauss_markov_means.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include "libchar/allan/gauss_markov_curves.hpp"

namespace libchar {
namespace {

constexpr std::uint64_t kFew = 6;  ///< coefficients of a bin that are summed one by one
constexpr double kForgotten =
    10;  ///< correlation times between means: only neighbours have to do with each other

/// Mean of unit(k) over the bin's coefficients: its ends are an eighth of an octave apart, three nodes do.
template <typename UnitAt>
double mean_over(const PowerBin& bin, UnitAt&& unit_at) {
  const auto first = static_cast<double>(bin.first), end = static_cast<double>(bin.end);
  if (bin.end - bin.first <= kFew) {
    double sum = 0;
    for (double k = first; k < end; ++k) sum += unit_at(k);
    return sum / (end - first);
  }
  const double middle = 0.5 * (first + end - 1), half = 0.5 * (end - first);
  const double node = 0.7745966692414834 * half;
  return (5 * unit_at(middle - node + 1e-7) + 8 * unit_at(middle + 1e-7) +
          5 * unit_at(middle + node + 1e-7)) /
         18;
}

}  // namespace

double gauss_markov_dct_mean(double k, std::uint64_t n, double dt_over_tau) {
  const auto count = static_cast<double>(n);
  const double phi = std::exp(-dt_over_tau), e = -std::expm1(-dt_over_tau);
  const double sine = std::sin(0.5 * std::numbers::pi * k / count), square = sine * sine;
  const double d = e * e + 4 * phi * square;
  double open = 1;  // 1 - (-1)^k phi^n
  if (k == std::round(k)) {
    const double across = -dt_over_tau * count;
    open = std::fmod(k, 2.0) == 0 ? -std::expm1(across) : 1 + std::exp(across);
  }
  const double real = e + 2 * phi * square;
  const double imaginary_square = 4 * phi * phi * square * (1 - square);
  const double ends = real / d - (real * real - imaginary_square) / (d * d) - phi / d;
  return e * (1 + phi) / d + 2 / count * open * ends;
}

double gauss_markov_unit(const PowerBin& bin, double tau_s, double rate_hz) {
  const double step = 1 / (rate_hz * tau_s);
  if (bin.spacing == 1)
    return mean_over(bin, [&](double k) { return gauss_markov_dct_mean(k, bin.length, step); });
  const auto m = static_cast<double>(bin.spacing);
  const MeanCovariance means = gauss_markov_means(tau_s, m, 1 / rate_hz);
  if (step * m > kForgotten) {
    const auto n = static_cast<double>(bin.length);
    return m * (means.variance + 2 * means.neighbours / n * mean_over(bin, [n](double k) {
                                   return (n - 1) * std::cos(std::numbers::pi * k / n) - 1;
                                 }));
  }
  const double like = means.neighbours * std::exp(step * m);
  return m * (like * mean_over(
                         bin,
                         [&](double k) { return gauss_markov_dct_mean(k, bin.length, step * m); }) +
              means.variance - like);
}

}  // namespace libchar
