#pragma once
// A first-order Gauss-Markov process in white noise.

#include <cmath>
#include <vector>

#include "tests/support/noise.hpp"

namespace test {

// White noise and y_t = phi y_{t-1} + e_t by their own recursion, apart from the library's generator.
inline std::vector<double> white_and_process(std::uint64_t seed, std::size_t n, double rate, double q, double sigma,
                                             double tau) {
  Gaussian normal(seed);
  const double phi = std::exp(-1 / (rate * tau));
  std::vector<double> y(n);
  double state = sigma * normal();
  for (double& sample : y) {
    sample = state + q * std::sqrt(rate) * normal();
    state = phi * state + sigma * std::sqrt(1 - phi * phi) * normal();
  }
  return y;
}

}  // namespace test
