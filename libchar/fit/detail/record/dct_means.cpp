// Expected squared DCT-II coefficients (what they are for: docs/theory/fit.md).
// With a = pi k / n:
//   white         Q^2 fs                                          exact, uncorrelated
//   flicker       B^2 r_k / (2 sin(a/2)),
//                 r_k = (2/pi) Si(pi k) - (2/pi^2)(1 - (-1)^k)/k  error 6e-5 at n = 4096
//   walk          K^2 dt / (4 sin^2(a/2))                         exact, uncorrelated
//   quantization  Qz^2 fs^2 [4 sin^2(a/2) + (4/n) cos^2(a/2)]     exact
//   ramp          (R dt t_k)^2, t_k = sqrt(2/n) cos(a/2) / (2 sin^2(a/2)) for odd k, 0 for even k
// The low coefficients are what ordinary periodograms get wrong: r_1 = 0.774, not 1.

#include "libchar/fit/detail/record/dct_means.hpp"

#include <cmath>
#include <numbers>

#include "libchar/allan/noise_curves.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/spectrum/fft.hpp"

namespace libchar {

// The covariance phi^j summed against the cosines of the DCT-II, with a = pi k/n, e = 1 - phi, s = sin(a/2), w = 1 -
// phi exp(i a),
// D = |w|² = e² + 4 phi s²:
//   E[c_k²] = (1 - phi²)/D + (2/n) (1 - (-1)^k phi^n) [Re 1/w - Re 1/w² - phi/D]
// The first part is the process's spectrum, the second what its two ends add. Means of m samples are such a process
// with phi^m, whose neighbours have the covariance of neighbouring means, and white noise that makes up their variance.

namespace {

constexpr std::uint64_t kFew = 6;  ///< coefficients of a bin that are summed one by one
constexpr double kForgotten = 10;  ///< correlation times between means: only neighbours have to do with each other

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
  return (5 * unit_at(middle - node + 1e-7) + 8 * unit_at(middle + 1e-7) + 5 * unit_at(middle + node + 1e-7)) / 18;
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
  if (bin.spacing == 1) return mean_over(bin, [&](double k) { return gauss_markov_dct_mean(k, bin.length, step); });
  const auto m = static_cast<double>(bin.spacing);
  const MeanCovariance means = gauss_markov_means(tau_s, m, 1 / rate_hz);
  if (step * m > kForgotten) {
    const auto n = static_cast<double>(bin.length);
    return m * (means.variance + 2 * means.neighbours / n * mean_over(bin, [n](double k) {
                                   return (n - 1) * std::cos(std::numbers::pi * k / n) - 1;
                                 }));
  }
  const double like = means.neighbours * std::exp(step * m);
  return m * (like * mean_over(bin, [&](double k) { return gauss_markov_dct_mean(k, bin.length, step * m); }) +
              means.variance - like);
}

// Differences of flicker have the covariance gamma(j) = -(4/pi)/(4 j² - 1) dt^-2, the spectrum 2 sin(b) dt^-2 with b =
// pi k/(2n). Summed against the cosines of the DCT-II, L = ln(cot(b/2))/2:
//   dt² E[c_k²] = 2 sin b + (2/(pi n)) (-1)^k (1 - z f(z))                           the spectrum, less lags beyond n
//               + (8/(pi n)) [L cos b/2 - 1/4 + Ci(z)/4] + (4/(pi n)) L/cos b, what the two ends add; z = pi k
//   1 - z f(z) = 1 - z (pi/2 - Si(z)) (-1)^k,   Ci(z) = -(-1)^k g(z), g(z) ~ 1/(z² + 4.3)
// The ends count: L is 6 where n is 10⁶ and k = 1. Short series, and means of m samples, whose covariance is the second
// difference of
// -(2/pi) H_(jm), H_n = 1 + 1/3 + … + 1/(2n - 1), are summed exactly.

namespace {

using std::numbers::pi;

constexpr std::uint64_t kExactUpTo = 4096;

/// E[c_k²] dt² at [k-1] of the series sqrt(m) times means of m samples.
std::vector<double> exact_means(std::size_t n, std::uint64_t m) {
  std::vector<double> covariance(n);
  const auto width = static_cast<double>(m);
  for (std::size_t j = 0; j < n; ++j) {
    const auto lag = static_cast<double>(j);
    if (m == 1) {
      covariance[j] = -4 / pi / (4 * lag * lag - 1);
      continue;
    }
    covariance[j] = 2 / pi / width *
                    (libchar::odd_harmonic((lag + 1) * width) + libchar::odd_harmonic(std::abs(lag - 1) * width) -
                     2 * libchar::odd_harmonic(lag * width));
  }
  return dct_means_of_covariance(covariance);
}

double mean_of(const PowerBin& bin, const std::vector<double>& exact) {
  double sum = 0;
  for (std::uint64_t k = bin.first; k < bin.end; ++k) sum += exact[detail::in_memory(k) - 1];
  return sum / static_cast<double>(bin.end - bin.first);
}

double mean_of(const PowerBin& bin, double dt_s) {
  return mean_over(bin, [&](double k) { return flicker_phase_dct_mean(k, bin.length, dt_s); });
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
  const double ends =
      8 * (0.5 * log_cot * std::cos(b) - 0.25 + 0.25 * integral) + 4 * log_cot / std::cos(b) + 2 * beyond;
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
      exact = exact_means(detail::in_memory(length), spacing);
    }
    out.push_back(mean_of(bin, exact) * rate_hz * rate_hz);
  }
  return out;
}

void lend_flicker_phase(double rate_hz, std::vector<PowerBin>& bins) {
  const std::vector<double> units = flicker_phase_units(bins, rate_hz);
  for (std::size_t j = 0; j < bins.size(); ++j) bins[j].unit[static_cast<std::size_t>(Term::ramp)] = units[j];
}

namespace {

using std::numbers::egamma;
using std::numbers::ln2;
using std::numbers::pi;

constexpr std::uint64_t kSiTable = 64;

// Integral of sin(t)/t over [pi (j-1), pi j] by ten-point Gauss-Legendre (1e-15 on these smooth half waves).
double sine_integral_half_wave(std::uint64_t j) {
  static constexpr std::array<double, 5> node = {0.1488743389816312, 0.4333953941292472, 0.6794095682990244,
                                                 0.8650633666889845, 0.9739065285171717};
  static constexpr std::array<double, 5> weight = {0.2955242247147529, 0.2692667193099963, 0.2190863625159820,
                                                   0.1494513491505806, 0.0666713443086881};
  const double middle = pi * (static_cast<double>(j) - 0.5);
  double sum = 0;
  for (std::size_t i = 0; i < node.size(); ++i) {
    for (const double sign : {-1.0, 1.0}) {
      const double t = middle + sign * 0.5 * pi * node[i];
      sum += weight[i] * std::sin(t) / t;
    }
  }
  return 0.5 * pi * sum;
}

std::array<double, kSiTable + 1> sine_integral_table() {
  std::array<double, kSiTable + 1> table{};
  for (std::size_t j = 1; j <= kSiTable; ++j) table[j] = table[j - 1] + sine_integral_half_wave(j);
  return table;
}

double flicker_ratio(double k) {
  const double whole = std::round(k);
  if (whole != k) return 1 - 2 / (pi * pi * k);  // between the integers: the mean of odd and even, k large
  const auto index = static_cast<std::uint64_t>(whole);
  const double odd = index % 2 == 1 ? 2.0 : 0.0;
  return 2 / pi * sine_integral_at_pi(index) - 2 / (pi * pi) * odd / k;
}

// H_n = sum_{i=1..n} 1/(2i-1).
long double long_odd_harmonic(std::uint64_t n) {
  if (n < 64) {
    long double sum = 0;
    for (std::uint64_t i = n; i >= 1; --i) sum += 1.0L / static_cast<long double>(2 * i - 1);
    return sum;
  }
  const auto x = static_cast<long double>(n);
  const long double y = 1 / (x * x);
  return (std::log(x) + std::numbers::egamma_v<long double>) / 2 + std::numbers::ln2_v<long double> +
         y * (1.0L / 48 - y * (7.0L / 1920 - y * (31.0L / 16128)));
}

// Generalised covariance of the phase of unit flicker, s_F(n) = [(4n^2-1) H_n - 3n^2] / (4 pi).
long double flicker_phase_covariance(std::uint64_t n) {
  const auto x = static_cast<long double>(n);
  return ((4 * x * x - 1) * long_odd_harmonic(n) - 3 * x * x) / (4 * std::numbers::pi_v<long double>);
}

// Covariance at lag j of means of m samples, times m: minus the second difference of s_F at step m, over m. Far lags by
// its Taylor series, where the difference of huge numbers would lose the digits.
double flicker_block_covariance(std::uint64_t j, std::uint64_t m) {
  const auto width = static_cast<double>(m);
  if (j <= 32) {
    const std::uint64_t before = j == 0 ? 1 : j - 1;
    const long double second = flicker_phase_covariance((j + 1) * m) - 2 * flicker_phase_covariance(j * m) +
                               flicker_phase_covariance(before * m);
    return static_cast<double>(-second) / width;
  }
  const double n = static_cast<double>(j), x = n * width, y = 1 / (n * n), z = 1 / (x * x);
  const double level = std::log(x) + egamma + 2 * ln2;
  const double discrete = z * (0.125 * (1 + y * (0.5 + y / 3)) - z * (17.0 / 320 * (1 + 5 * y / 3) - z * 0.0567));
  return -width / pi * (level + discrete - y * (1.0 / 12 + y * (1.0 / 60 + y * (1.0 / 168 + y / 360))));
}

}  // namespace

double sine_integral_at_pi(std::uint64_t k) {
  static const std::array<double, kSiTable + 1> table = sine_integral_table();
  if (k <= kSiTable) return table[detail::in_memory(k)];
  // Si(x) = pi/2 - cos(x) f(x) - sin(x) g(x); at x = pi k only f remains, by its asymptotic series.
  const double x = pi * static_cast<double>(k), y = 1 / (x * x);
  const double f = (1 - 2 * y * (1 - 12 * y * (1 - 30 * y))) / x;
  return pi / 2 - (k % 2 == 0 ? f : -f);
}

std::array<double, kTerms> dct_mean(double k, std::uint64_t n, double dt_s) {
  const double count = static_cast<double>(n), fs = 1 / dt_s;
  const double half = 0.5 * pi * k / count, sine = std::sin(half), cosine = std::cos(half);
  const double parity = k == std::round(k) ? std::fmod(k, 2.0) : 0.5;  // a bin centre stands for odd and even alike
  const double ramp = dt_s * cosine / (2 * sine * sine);
  return {fs, flicker_ratio(k) / (2 * sine), dt_s / (4 * sine * sine),
          fs * fs * (4 * sine * sine + 4 / count * cosine * cosine), parity * 2 / count * ramp * ramp};
}

std::vector<double> dct_means_of_covariance(const std::vector<double>& g) {
  const std::size_t n = g.size();
  const double count = static_cast<double>(n);
  RealFft fft(2 * n);
  std::vector<double> means(n - 1);
  const auto fill = [&](auto&& value) {
    const std::span<double> input = fft.input();
    for (std::size_t j = 0; j < n; ++j) input[j] = value(j) * (j == 0 ? 0.5 : 1.0);
    for (std::size_t j = n; j < 2 * n; ++j) input[j] = 0;
    return fft.transform();
  };
  const auto cosines = fill([&](std::size_t j) { return g[j] * (count - static_cast<double>(j)); });
  for (std::size_t k = 1; k < n; ++k) means[k - 1] = 2 / count * cosines[k].real();
  const auto sines = fill([&](std::size_t j) { return g[j]; });
  for (std::size_t k = 1; k < n; ++k) {
    const double sine_sum = -sines[k].imag();
    means[k - 1] -= 2 / count * sine_sum / std::sin(pi * static_cast<double>(k) / count);
  }
  return means;
}

BlockMeanDct::BlockMeanDct(std::uint64_t n, std::uint64_t m, double dt_s) : n_(n), m_(m), dt_s_(dt_s) {
  std::vector<double> covariance(detail::in_memory(n));
  const double origin =
      flicker_block_covariance(1, m);  // constants drop out of contrasts; small numbers keep the digits
  for (std::size_t j = 0; j < covariance.size(); ++j) covariance[j] = flicker_block_covariance(j, m) - origin;
  flicker_ = dct_means_of_covariance(covariance);
}

std::array<double, kTerms> BlockMeanDct::mean(std::uint64_t k) const {
  const auto width = static_cast<double>(m_);
  std::array<double, kTerms> unit = dct_mean(static_cast<double>(k), n_, dt_s_ * width);
  unit[0] = 1 / dt_s_;
  unit[1] = flicker_[detail::in_memory(k) - 1];
  // Increments of averaged walk are MA(1): the point-sampled walk of step m dt, less a white part.
  unit[2] = width * (unit[2] - dt_s_ * width * (1 - 1 / (width * width)) / 6);
  unit[3] *= width;
  unit[4] *= width;
  return unit;
}

}  // namespace libchar
