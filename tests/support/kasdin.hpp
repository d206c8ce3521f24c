#pragma once
// Flicker as published (N. J. Kasdin, Proc. IEEE 83 (1995) 802): coefficients, and the exact
// filtering of a whole record.

#include <algorithm>
#include <complex>
#include <span>
#include <vector>

#include "libchar/spectrum/fft.hpp"

namespace test {

/// Coefficients of (1 - z^-1)^(-sign/2): the impulse response of flicker (+1), its recursion (-1).
inline std::vector<double> kasdin_series(double sign, std::size_t count) {
  std::vector<double> series(count, 1);
  for (std::size_t k = 1; k < count; ++k) {
    const double order = static_cast<double>(k);
    series[k] = series[k - 1] * (order - 1 + sign / 2) / order;
  }
  return series;
}

/// The response convolved with `driving`, from rest: linear, no wrap-around.
inline std::vector<double> kasdin_filter(std::span<const double> driving) {
  const std::size_t n = driving.size();
  std::size_t size = 2;
  while (size < 2 * n) size *= 2;
  libchar::RealFft fft(size);
  const auto load = [&fft](std::span<const double> values) {
    const auto input = fft.input();
    std::fill(std::copy(values.begin(), values.end(), input.begin()), input.end(), 0.0);
    return fft.transform();
  };
  const auto first = load(kasdin_series(1, n));
  const std::vector<std::complex<double>> gain(first.begin(), first.end());
  load(driving);
  const auto product = fft.coefficients();
  for (std::size_t k = 0; k < gain.size(); ++k) product[k] *= gain[k];
  const auto result = fft.inverse();
  std::vector<double> out(n);
  for (std::size_t t = 0; t < n; ++t) out[t] = result[t] / static_cast<double>(size);
  return out;
}

}  // namespace test
