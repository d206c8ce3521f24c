#pragma once
// Exact simulation of sampled noise with known coefficients, from an own seeded generator (the same bits everywhere).

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include "libchar/spectrum/fft.hpp"

namespace test {

using Record = std::vector<double>;

/// Standard normal deviates by the polar method on std::mt19937_64 (std::normal_distribution
/// differs between libraries).
class Gaussian {
 public:
  explicit Gaussian(std::uint64_t seed) : engine_(seed) {}
  double uniform() { return static_cast<double>(engine_() >> 11U) * 0x1.0p-53; }
  double operator()() {
    if (has_spare_) {
      has_spare_ = false;
      return spare_;
    }
    double x = 0, y = 0, r = 0;
    do {
      x = 2 * uniform() - 1;
      y = 2 * uniform() - 1;
      r = x * x + y * y;
    } while (r >= 1 || r == 0);
    const double factor = std::sqrt(-2 * std::log(r) / r);
    spare_ = y * factor;
    has_spare_ = true;
    return x * factor;
  }
  /// Mean of the squares of so many: chi-square over its degrees of freedom.
  double mean_square(int count) {
    double sum = 0;
    for (int k = 0; k < count; ++k) {
      const double one = (*this)();
      sum += one * one;
    }
    return sum / count;
  }

 private:
  std::mt19937_64 engine_;
  double spare_ = 0;
  bool has_spare_ = false;
};

/// Stationary increments of fractionally differenced flicker by circulant embedding: autocovariance
/// -(4/pi)/(4 n^2 - 1), exact for every lag below n. Two independent records a transform; the plan
/// and the eigenvalues are kept.
class FlickerSource {
 public:
  explicit FlickerSource(std::size_t n) : n_(n), size_(embedding(n)), fft_(size_), amplitude_(size_ / 2 + 1) {
    const auto input = fft_.input();
    for (std::size_t j = 0; j < size_; ++j) {
      const double lag = static_cast<double>(std::min(j, size_ - j));
      input[j] = -4 / std::numbers::pi / (4 * lag * lag - 1);
    }
    const auto eigen = fft_.transform();
    for (std::size_t k = 0; k < amplitude_.size(); ++k)
      amplitude_[k] = std::sqrt(std::max(0.0, eigen[k].real()) / static_cast<double>(size_));
  }

  /// Adds `level` times unit flicker (innovation standard deviation 1) to y, start at zero.
  void add(std::vector<double>& y, double level, Gaussian& gauss) {
    const auto c = fft_.coefficients();
    c[0] = amplitude_[0] * gauss();
    c[size_ / 2] = amplitude_[size_ / 2] * gauss();
    for (std::size_t k = 1; k < size_ / 2; ++k) {
      // One after the other: compilers differ in the order of arguments.
      const double imaginary = gauss(), real = gauss();
      c[k] = std::complex<double>(real, imaginary) * (amplitude_[k] * std::sqrt(0.5));
    }
    const auto increments = fft_.inverse();
    double sum = 0;
    for (std::size_t t = 0; t < n_; ++t) {
      y[t] += level * sum;
      sum += increments[t];
    }
  }

 private:
  static std::size_t embedding(std::size_t n) {
    std::size_t size = 2;
    while (size < 2 * n) size *= 2;
    return size;
  }
  std::size_t n_, size_;
  libchar::RealFft fft_;
  std::vector<double> amplitude_;
};

/// A record of white, flicker and walk with coefficients Q, B, K at rate fs (docs/theory/simulation.md).
class NoiseSource {
 public:
  NoiseSource(std::size_t n, double rate_hz, std::uint64_t seed)
      : n_(n), rate_hz_(rate_hz), flicker_(n), gauss_(seed) {}

  std::vector<double> record(double q, double b, double k) {
    std::vector<double> y(n_, 0.0);
    if (b > 0) flicker_.add(y, b, gauss_);
    const double white = q * std::sqrt(rate_hz_), step = k / std::sqrt(rate_hz_);
    double walk = 0;
    for (double& value : y) {
      if (k > 0) walk += step * gauss_();
      value += walk + (q > 0 ? white * gauss_() : 0.0);
    }
    return y;
  }
  Gaussian& gauss() { return gauss_; }

 private:
  std::size_t n_;
  double rate_hz_;
  FlickerSource flicker_;
  Gaussian gauss_;
};

}  // namespace test
