// Fisher information of theta from the DCT-II coefficients k = 1..N-1 of a record,
//   I_ab = 1/2 sum_k S_a(k) S_b(k) / S(k)^2,   S = sum theta_a S_a,
//   sd(c)/c = 1/2 sqrt((I^-1)_aa) / theta_a
// (Whittle), summed over log bins with three nodes each, so that N = 1e12 costs as much as N = 1e3.
#include "libchar/fit/curve/bounds.hpp"

#include <algorithm>
#include <cmath>

#include "libchar/fit/detail/band/bin_likelihood.hpp"
#include "libchar/fit/detail/record/dct_means.hpp"

namespace libchar {
namespace {

constexpr double kSingles = 24;
constexpr double kPerOctave = 4;

TermMatrix information_of(const Mixture& theta, double rate_hz, double samples, const TermSet& fitted) {
  const double dt_s = 1 / rate_hz;
  const auto n = static_cast<std::uint64_t>(samples);
  TermMatrix information = TermMatrix::Zero();
  const auto add = [&](double k, double weight) {
    const std::array<double, kTerms> unit = dct_mean(k, n, dt_s);
    double model = 0;
    for (std::size_t i = 0; i < kTerms; ++i) model += theta[i] * unit[i];
    for (std::size_t a = 0; a < kTerms; ++a) {
      for (std::size_t b = 0; b <= a && fitted[a]; ++b) {
        if (!fitted[b]) continue;
        const double term = weight / 2 * (unit[a] / model) * (unit[b] / model);
        information(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)) += term;
      }
    }
  };
  for (double k = 1; k < std::min(kSingles, samples); ++k) add(k, 1);
  const double ratio = std::exp2(1 / kPerOctave);
  for (double lo = kSingles; lo < samples; lo *= ratio) {
    const double hi = std::min(lo * ratio, samples);
    const double middle = 0.5 * (lo + hi) - 0.5,
                 half = 0.5 * (hi - lo);  // k = lo .. hi-1, each standing for k -+ 1/2
    const double node = 0.7745966692414834 * half;
    add(middle - node + 1e-7, half * 5 / 9);
    add(middle + 1e-7, half * 8 / 9);
    add(middle + node + 1e-7, half * 5 / 9);
  }
  return information.selfadjointView<Eigen::Lower>();
}

std::array<std::optional<double>, kTerms> bound_of(const Mixture& theta, double rate_hz, double samples,
                                                   const TermSet& fitted) {
  std::array<std::optional<double>, kTerms> bound;
  bool any = false;
  for (std::size_t i = 0; i < kTerms; ++i) any = any || theta[i] > 0;
  if (!any || samples < 4) return bound;
  const TermMatrix covariance = inverse_of(information_of(theta, rate_hz, samples, fitted), fitted);
  for (std::size_t i = 0; i < kTerms; ++i) {
    const double variance = covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i));
    if (fitted[i] && theta[i] > 0 && variance >= 0) bound[i] = std::sqrt(variance) / (2 * theta[i]);
  }
  return bound;
}

}  // namespace

std::array<std::optional<double>, kTerms> cramer_rao(const Mixture& theta, double rate_hz, double samples,
                                                     const TermSet& fitted) {
  return bound_of(theta, rate_hz, samples, fitted);
}

std::optional<double> seconds_for(Term term, double relative_sd, const Mixture& theta, double rate_hz,
                                  const TermSet& fitted) {
  const auto excess = [&](double log_seconds) {
    const auto bound =
        bound_of(theta, rate_hz, std::exp(log_seconds) * rate_hz, fitted)[static_cast<std::size_t>(term)];
    return bound && std::isfinite(*bound) ? std::log(*bound / relative_sd) : 1e3;
  };
  double low = std::log(16 / rate_hz), high = std::log(1e15 / rate_hz);  // 16 .. 1e15 samples
  double at_high = excess(high);
  if (excess(low) <= 0) return std::exp(low);
  if (at_high > 0) return std::nullopt;
  // Bisection to get near, then the secant: the bound falls nearly as a power of the length.
  double at_low = 0;
  for (int i = 0; i < 60 && high - low > 1e-4; ++i) {
    double x = 0.5 * (low + high);
    if (i >= 4 && at_low > 0 && at_low < 5) {
      x = low + (high - low) * at_low / (at_low - at_high);
      x = std::clamp(x + (i % 2 == 0 ? 1e-5 : -1e-5), low, high);
    }
    const double value = excess(x);
    (value > 0 ? low : high) = x;
    (value > 0 ? at_low : at_high) = value;
    if (std::abs(value) < 1e-5) return std::exp(x);
  }
  return std::exp(high);
}

}  // namespace libchar
