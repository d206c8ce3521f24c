#include "libchar/spectrum/fft.hpp"

#include <algorithm>
#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <thread>

#include "libchar/core/error.hpp"

using namespace libchar;

namespace {

std::vector<double> gaussian(std::size_t n, unsigned seed, double offset = 0) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  std::vector<double> y(n);
  for (double& v : y) v = offset + normal(generator);
  return y;
}

// cos(pi p / q) and sin with the argument reduced in integers first, so that the reference is good to the last digit.
long double cosine(std::size_t p, std::size_t q) {
  return std::cos(std::numbers::pi_v<long double> * static_cast<long double>(p % (2 * q)) /
                  static_cast<long double>(q));
}
long double sine(std::size_t p, std::size_t q) {
  return std::sin(std::numbers::pi_v<long double> * static_cast<long double>(p % (2 * q)) /
                  static_cast<long double>(q));
}

double relative_l2(const std::vector<long double>& wanted, const std::vector<long double>& got) {
  long double error = 0, norm = 0;
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    error += (wanted[k] - got[k]) * (wanted[k] - got[k]);
    norm += wanted[k] * wanted[k];
  }
  return static_cast<double>(std::sqrt(error / norm));
}

const std::vector<std::size_t> kLengths = {1,  2,  3,   4,   5,   6,   7,   8,   9,    16,   17,   30,   31,
                                           64, 97, 100, 127, 128, 243, 500, 511, 1009, 1024, 1025, 2048, 3001};

// Relative error in the mean square. FFTW reaches about 0.3 eps sqrt(log2 n) where n has small factors; large primes
// run through Rader's convolution and pay a few times that.
double limit(std::size_t n) {
  const double eps = std::numeric_limits<double>::epsilon();
  return 0.6 * eps * std::sqrt(1 + std::log2(static_cast<double>(n))) * (std::has_single_bit(n) ? 1 : 3);
}

double dct_error(const std::vector<double>& y) {
  const std::size_t n = y.size();
  std::vector<long double> wanted(n), got(n);
  Dct dct(n);
  const auto c = dct.transform(y);
  REQUIRE(c.size() == n);
  for (std::size_t k = 0; k < n; ++k) {
    long double sum = 0;
    for (std::size_t t = 0; t < n; ++t) sum += static_cast<long double>(y[t]) * cosine(k * (2 * t + 1), 2 * n);
    wanted[k] = sum * std::sqrt((k == 0 ? 1.0L : 2.0L) / static_cast<long double>(n));
    got[k] = c[k];
  }
  return relative_l2(wanted, got);
}

}  // namespace

TEST_CASE("the cosine transform agrees with the sum in long double, at every kind of length") {
  for (const std::size_t n : kLengths) {
    CAPTURE(n);
    const double error = dct_error(gaussian(n, static_cast<unsigned>(n))) / limit(n);
    CAPTURE(error);
    CHECK(error < 1);
  }
}

TEST_CASE("the coarse and fine twiddles hold over many blocks") {
  const std::size_t n = 1U << 17U;
  const auto y = gaussian(n, 3);
  Dct dct(n);
  const auto c = dct.transform(y);
  for (const std::size_t k : {std::size_t{1}, std::size_t{511}, std::size_t{512}, std::size_t{513}, n / 2 - 1, n / 2,
                              n / 2 + 1, n - 513, n - 1}) {
    CAPTURE(k);
    long double sum = 0;
    for (std::size_t t = 0; t < n; ++t) sum += static_cast<long double>(y[t]) * cosine(k * (2 * t + 1), 2 * n);
    // The coefficients are of the order of one; the long double sum itself is good to about 1e-16.
    const double error = std::abs(c[k] - static_cast<double>(sum * std::sqrt(2.0L / n)));
    CHECK(error * 1e15 < 4);
  }
}

TEST_CASE("the cosine transform keeps the energy and survives an offset of 1e9 standard deviations") {
  const std::size_t n = 4099;
  const auto y = gaussian(n, 5);
  auto shifted = y;
  for (double& v : shifted) v += 1e9;
  auto back = shifted;  // what the rounding to the grid of 1e9 left of y
  for (double& v : back) v -= 1e9;
  Dct dct(n);
  double energy = 0, coefficients = 0;
  for (const double v : y) energy += v * v;
  for (const double c : dct.transform(y)) coefficients += c * c;
  CHECK(coefficients == Approx(energy).epsilon(1e-14));

  const auto plain = dct.transform(back);
  const std::vector<double> expected(plain.begin(), plain.end());
  const auto c = dct.transform(shifted);
  for (std::size_t k = 1; k < n; ++k) REQUIRE(std::abs(c[k] - expected[k]) < 1e-12);
  CHECK(c[0] == Approx(expected[0] + 1e9 * std::sqrt(static_cast<double>(n))).epsilon(1e-15));
}

TEST_CASE("a constant has no coefficient but the first, exactly") {
  Dct dct(1000);
  const auto c = dct.transform(std::vector<double>(1000, 0.1));
  CHECK(c[0] == Approx(0.1 * std::sqrt(1000.0)).epsilon(1e-15));
  for (std::size_t k = 1; k < 1000; ++k) REQUIRE(c[k] == 0);
}

TEST_CASE("the real transform agrees with the sum in long double and inverts") {
  for (const std::size_t n : kLengths) {
    CAPTURE(n);
    const auto y = gaussian(n, static_cast<unsigned>(n) + 99);
    RealFft fft(n);
    CHECK(fft.size() == n);
    std::copy(y.begin(), y.end(), fft.input().begin());
    const auto bins = fft.transform();
    REQUIRE(bins.size() == n / 2 + 1);
    std::vector<long double> wanted, got;
    for (std::size_t k = 0; k < bins.size(); ++k) {
      long double re = 0, im = 0;
      for (std::size_t t = 0; t < n; ++t) {
        re += static_cast<long double>(y[t]) * cosine(2 * k * t, n);
        im -= static_cast<long double>(y[t]) * sine(2 * k * t, n);
      }
      wanted.insert(wanted.end(), {re, im});
      got.insert(got.end(), {bins[k].real(), bins[k].imag()});
    }
    const double error = relative_l2(wanted, got) / limit(n);
    CAPTURE(error);
    CHECK(error < 1);
    const auto again = fft.inverse();
    for (std::size_t t = 0; t < n; ++t) REQUIRE(again[t] / static_cast<double>(n) == Approx(y[t]).margin(1e-14));
  }
}

TEST_CASE("an impulse is flat, a sine on a bin has one line, and energy is kept (Parseval)") {
  const std::size_t n = 512;
  RealFft fft(n);
  std::fill(fft.input().begin(), fft.input().end(), 0.0);
  fft.input()[0] = 1;
  for (const auto& bin : fft.transform()) REQUIRE(bin == std::complex<double>(1, 0));

  for (std::size_t t = 0; t < n; ++t) fft.input()[t] = std::sin(2 * std::numbers::pi * 37 * static_cast<double>(t) / n);
  const auto line = fft.transform();
  for (std::size_t k = 0; k <= n / 2; ++k) REQUIRE(std::abs(line[k]) == Approx(k == 37 ? 256.0 : 0.0).margin(1e-11));

  const auto y = gaussian(n, 8);
  std::copy(y.begin(), y.end(), fft.input().begin());
  double time = 0, frequency = 0;
  for (const double v : y) time += v * v;
  const auto bins = fft.transform();
  for (std::size_t k = 0; k <= n / 2; ++k) frequency += std::norm(bins[k]) * (k == 0 || k == n / 2 ? 1 : 2);
  CHECK(frequency / n == Approx(time).epsilon(1e-14));
}

TEST_CASE("two transforms of one length give the same bits, also from several threads at once") {
  const auto y = gaussian(10000, 2);
  Dct first(y.size());
  const auto c = first.transform(y);
  const std::vector<double> expected(c.begin(), c.end());
  std::vector<std::vector<double>> got(4);
  std::vector<std::thread> threads;
  for (auto& mine : got)
    threads.emplace_back([&mine, &y] {
      for (int i = 0; i < 5; ++i) {
        Dct dct(y.size());
        const auto values = dct.transform(y);
        mine.assign(values.begin(), values.end());
      }
    });
  for (auto& thread : threads) thread.join();
  for (const auto& mine : got) CHECK(mine == expected);
}

TEST_CASE("a transform of nothing, or of the wrong length, is refused") {
  CHECK_THROWS_AS(RealFft(0), Error);
  CHECK_THROWS_AS(Dct(0), Error);
  Dct dct(4);
  CHECK_THROWS_AS(dct.transform(std::vector<double>(5)), Error);
}

TEST_CASE("trigonometric sums: cosines undo the cosine transform") {
  for (const std::size_t n : {1U, 2U, 7U, 64U, 1000U, 2187U}) {
    const std::vector<double> y = gaussian(n, 5, 3);
    Dct dct(n);
    const auto c = dct.transform(y);
    CosineSums sums(n);
    for (int again = 0; again < 2; ++again) {
      std::copy(c.begin(), c.end(), sums.input().begin());
      const auto back = sums.transform();
      for (std::size_t t = 0; t < n; ++t) REQUIRE(back[t] == Approx(y[t]).margin(1e-12));
    }
  }
}

TEST_CASE("trigonometric sums: sines are the sums they say") {
  for (const std::size_t n : {2U, 3U, 8U, 31U, 250U}) {
    const std::vector<double> c = gaussian(n, 6);
    SineSums sums(n);
    std::copy(c.begin(), c.end(), sums.input().begin());
    const auto y = sums.transform();
    CHECK(y[0] == 0);
    for (std::size_t t = 1; t < n; ++t) {
      long double wanted = 0;
      for (std::size_t k = 1; k < n; ++k) wanted += c[k] * sine(k * t, n);
      REQUIRE(y[t] == Approx(static_cast<double>(wanted)).margin(1e-12 * static_cast<double>(n)));
    }
  }
  CHECK_THROWS_AS(SineSums(0), Error);
  CHECK_THROWS_AS(CosineSums(0), Error);
}
