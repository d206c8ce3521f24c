// N. J. Kasdin, "Discrete simulation of colored noise and stochastic processes and 1/f^alpha power
// law noise generation", Proc. IEEE 83 (1995) 802-827; [RV 1.19-1.28]. Two slips of [RV] are not
// followed: for gamma = 2 every h_k is 1 (RV 1.22 drops all but two), and the product of transforms
// is padded to twice the length (the listing of its appendix A wraps around).

#include "libchar/simulate/detail/kasdin.hpp"

#include <algorithm>
#include <cassert>
#include <string>

#include "libchar/core/decimal.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/lanes.hpp"
#include "libchar/spectrum/fft.hpp"

namespace libchar {
namespace {

std::vector<double> binomial_series(double gamma, double sign, std::size_t count) {
  if (!(gamma >= 0 && gamma <= 2))
    throw Error({ErrorKind::usage,
                 "E0951",
                 "",
                 "the slope gamma of coloured noise lies between 0 and 2",
                 shortest(gamma),
                 "0 is white, 1 flicker, 2 random walk"});
  std::vector<double> series(count);
  if (count > 0) series[0] = 1;
  for (std::size_t k = 1; k < count; ++k) {
    const double order = static_cast<double>(k);
    series[k] = series[k - 1] * (order - 1 + sign * gamma / 2) / order;
  }
  return series;
}

std::size_t good_size(std::size_t least) {
  std::size_t size = 2;
  while (size < least) size *= 2;
  return size;
}

/// Sum of a[i] b[i] in eight lanes, the same with and without AVX.
LIBCHAR_WIDE_LANES double dot(const double* a, const double* b, std::size_t count) {
  Four low = {}, high = {};
  std::size_t i = 0;
  for (; i + 8 <= count; i += 8) {
    low += LIBCHAR_FOUR(a + i) * LIBCHAR_FOUR(b + i);
    high += LIBCHAR_FOUR(a + i + 4) * LIBCHAR_FOUR(b + i + 4);
  }
  double rest = 0;
  for (; i < count; ++i) rest += a[i] * b[i];
  const Four sum = low + high;
  return ((sum[0] + sum[1]) + (sum[2] + sum[3])) + rest;
}

}  // namespace

std::vector<double> kasdin_response(double gamma, std::size_t count) {
  return binomial_series(gamma, 1, count);
}

std::vector<double> kasdin_recursion(double gamma, std::size_t count) {
  return binomial_series(gamma, -1, count);
}

std::vector<double> kasdin_filter(double gamma, std::span<const double> driving) {
  const std::size_t n = driving.size();
  std::vector<double> out(driving.begin(), driving.end());
  const std::vector<double> response = kasdin_response(gamma, n);
  if (gamma == 0 || n == 0) return out;
  if (gamma == 2) {
    for (std::size_t t = 1; t < n; ++t) out[t] += out[t - 1];
    return out;
  }
  if (n > kLongestConvolution)
    throw Error({ErrorKind::usage,
                 "E0952",
                 "",
                 "too many samples for the convolution of a whole record, whose limit is " +
                     std::to_string(kLongestConvolution),
                 std::to_string(n),
                 "the method `recursive` has no limit"});
  RealFft fft(good_size(2 * n));
  const auto load = [&fft](std::span<const double> values) {
    const auto input = fft.input();
    std::fill(std::copy(values.begin(), values.end(), input.begin()), input.end(), 0.0);
    return fft.transform();
  };
  const auto first = load(response);
  const std::vector<std::complex<double>> gain(first.begin(), first.end());
  load(driving);
  const auto product = fft.coefficients();
  for (std::size_t k = 0; k < gain.size(); ++k) product[k] *= gain[k];
  const auto result = fft.inverse();
  const double scale = 1 / static_cast<double>(fft.size());
  for (std::size_t t = 0; t < n; ++t) out[t] = result[t] * scale;
  return out;
}

TruncatedKasdin::TruncatedKasdin(double gamma, std::size_t taps) {
  const std::vector<double> b = kasdin_recursion(gamma, taps + 1);
  reversed_.reserve(taps);
  for (std::size_t k = taps; k > 0; --k) reversed_.push_back(-b[k]);
  past_.assign(std::max<std::size_t>(2 * taps, taps + 1024), 0.0);
}

void TruncatedKasdin::run(std::span<double> values) {
  const std::size_t taps = reversed_.size();
  for (double& value : values) {
    if (at_ + taps == past_.size()) {
      std::copy(past_.end() - static_cast<std::ptrdiff_t>(taps), past_.end(), past_.begin());
      at_ = 0;
    }
    value += dot(reversed_.data(), past_.data() + at_, taps);
    past_[at_ + taps] = value;
    ++at_;
  }
}

}  // namespace libchar
