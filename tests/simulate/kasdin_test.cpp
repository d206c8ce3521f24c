#include "libchar/simulate/detail/kasdin.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <vector>

#include "libchar/core/error.hpp"
#include "libchar/simulate/random.hpp"
#include "tests/support/shared.hpp"
#include "tests/support/table.hpp"

using namespace libchar;

namespace {

const std::vector<double> kGammas = {0.5, 1, 1.5, 2};

/// Known answers of column `column` below the header.
std::vector<double> column(const std::string& name, std::size_t column) {
  const auto rows = test::table(test::known(name));
  std::vector<double> values;
  for (std::size_t i = 1; i < rows.size(); ++i) values.push_back(std::stod(rows[i].at(column)));
  return values;
}

std::vector<double> normals(std::size_t n) {
  std::vector<double> out(n);
  DeviateStream({1, 0, Purpose::flicker}).fill_normal(out);
  return out;
}

/// Two-sided spectrum of the truncated filter relative to 1/(2 sin pi nu).
double truncated_power(std::size_t taps, double nu) {
  const std::vector<double> b = kasdin_recursion(1, taps + 1);
  std::complex<double> sum = 0;
  for (std::size_t k = 0; k <= taps; ++k)
    sum += b[k] * std::polar(1.0, -2 * std::numbers::pi * nu * static_cast<double>(k));
  return 2 * std::sin(std::numbers::pi * nu) / std::norm(sum);
}

}  // namespace

// double_precision.txt: a double implementation reaches 1.11e-15 (h) and 9.12e-16 (b) relative; ten
// times that is asked for.
TEST_CASE("coefficients agree with the 50-digit known answers") {
  for (std::size_t g = 0; g < kGammas.size(); ++g) {
    const std::vector<double> h = column("fusion/kasdin.csv", 1 + 2 * g);
    const std::vector<double> b = column("fusion/kasdin.csv", 2 + 2 * g);
    REQUIRE(h.size() == 200);
    const std::vector<double> got_h = kasdin_response(kGammas[g], 200);
    const std::vector<double> got_b = kasdin_recursion(kGammas[g], 200);
    for (std::size_t k = 0; k < 200; ++k) {
      CHECK(got_h[k] == Approx(h[k]).epsilon(1.1e-14).margin(0));
      CHECK(got_b[k] == Approx(b[k]).epsilon(9.1e-15).margin(0));
    }
  }
}

TEST_CASE("filtered records agree with the 50-digit known answers") {
  const std::vector<double> w = column("fusion/kasdin_filter.csv", 1);
  REQUIRE(w.size() >= 100);
  for (std::size_t g = 0; g < kGammas.size(); ++g) {
    const std::vector<double> x = column("fusion/kasdin_filter.csv", 2 + g);
    const std::vector<double> exact = kasdin_filter(kGammas[g], w);
    std::vector<double> recursive = w;
    TruncatedKasdin(kGammas[g], w.size()).run(recursive);  // long enough: nothing is truncated
    double worst = 0, worst_recursive = 0;
    for (std::size_t t = 0; t < x.size(); ++t) {
      worst = std::max(worst, std::fabs(exact[t] - x[t]));
      worst_recursive = std::max(worst_recursive, std::fabs(recursive[t] - x[t]));
    }
    INFO("gamma " << kGammas[g]);
    CHECK(worst < 1e-14);  // values up to some 10
    CHECK(worst_recursive < 3e-14);
  }
}

TEST_CASE("the convolution is linear: no wrap-around at any length") {
  for (const std::size_t n : {1U, 2U, 3U, 7U, 64U, 1000U}) {
    const std::vector<double> w = normals(n);
    for (const double gamma : {0.0, 0.3, 1.0, 1.7, 2.0}) {
      const std::vector<double> h = kasdin_response(gamma, n), x = kasdin_filter(gamma, w);
      REQUIRE(x.size() == n);
      for (std::size_t t = 0; t < n; ++t) {
        double sum = 0;
        for (std::size_t k = 0; k <= t; ++k) sum += h[k] * w[t - k];
        CHECK(x[t] == Approx(sum).margin(1e-12));
      }
    }
  }
  CHECK(kasdin_filter(1, {}).empty());
}

TEST_CASE("gamma 2 has all coefficients 1, gamma 0 none but the first") {
  for (const double h : kasdin_response(2, 50)) CHECK(h == 1);
  const std::vector<double> h = kasdin_response(0, 50), b = kasdin_recursion(2, 50);
  CHECK(h[0] == 1);
  CHECK(b[1] == -1);
  for (std::size_t k = 1; k < 50; ++k) {
    CHECK(h[k] == 0);
    if (k > 1) CHECK(b[k] == 0);
  }
}

TEST_CASE("the truncated filter: samples by definition, whatever the blocks") {
  constexpr std::size_t taps = 37, n = 5000;
  const std::vector<double> w = normals(n), b = kasdin_recursion(1, taps + 1);
  std::vector<double> whole = w, parts = w, plain = w;
  TruncatedKasdin one(1, taps), two(1, taps);
  one.run(whole);
  std::size_t at = 0;
  for (std::size_t size = 1; at < n; size = size * 7 % 500 + 1) {
    const std::size_t count = std::min(size, n - at);
    two.run(std::span(parts).subspan(at, count));
    at += count;
  }
  CHECK(whole == parts);
  for (std::size_t t = 0; t < n; ++t) {
    for (std::size_t k = 1; k <= std::min(t, taps); ++k) plain[t] -= b[k] * plain[t - k];
    CHECK(whole[t] == Approx(plain[t]).margin(1e-12));
  }
}

// Shared notes on [RV], appendix A: spectrum over ideal at 1e-3, 1e-4, 1e-5 of the sample rate.
TEST_CASE("the truncated filter loses its slope where it is known to") {
  CHECK(truncated_power(63, 1e-3) == Approx(1.03).margin(0.005));
  CHECK(truncated_power(63, 1e-4) == Approx(0.12).margin(0.005));
  CHECK(truncated_power(1000, 1e-3) == Approx(1.02).margin(0.005));
  CHECK(truncated_power(1000, 1e-4) == Approx(1.30).margin(0.005));
  CHECK(truncated_power(1000, 1e-5) == Approx(0.20).margin(0.005));
  CHECK(truncated_power(4000, 1e-5) == Approx(0.73).margin(0.005));
}

TEST_CASE("a slope outside 0 to 2 and a record beyond the limit are refused") {
  CHECK_THROWS_AS(kasdin_response(-0.1, 3), Error);
  CHECK_THROWS_AS(kasdin_recursion(2.1, 3), Error);
  CHECK_THROWS_AS(kasdin_filter(std::nan(""), std::vector<double>(3)), Error);
  CHECK_THROWS_AS(TruncatedKasdin(3, 10), Error);
}
