#include "tests/support/kasdin.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <vector>

#include "libchar/simulate/detail/flicker.hpp"
#include "libchar/simulate/random.hpp"
#include "tests/support/shared.hpp"
#include "tests/support/table.hpp"

using namespace libchar;

namespace {

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
  const std::vector<double> b = test::kasdin_series(-1, taps + 1);
  std::complex<double> sum = 0;
  for (std::size_t k = 0; k <= taps; ++k)
    sum += b[k] * std::polar(1.0, -2 * std::numbers::pi * nu * static_cast<double>(k));
  return 2 * std::sin(std::numbers::pi * nu) / std::norm(sum);
}

}  // namespace

// Slopes 0.5, 1, 1.5 and 2 stand in the tables: two columns each of the coefficients, one each of
// the records. double_precision.txt: a double implementation reaches 1.11e-15 (h) and 9.12e-16 (b)
// relative; ten times that is asked for.
TEST_CASE("coefficients agree with the 50-digit known answers") {
  const std::vector<double> h = column("fusion/kasdin.csv", 3), b = column("fusion/kasdin.csv", 4);
  REQUIRE(h.size() == 200);
  const std::vector<double> got_h = test::kasdin_series(1, 200), got_b = test::kasdin_series(-1, 200);
  for (std::size_t k = 0; k < 200; ++k) {
    CHECK(got_h[k] == Approx(h[k]).epsilon(1.1e-14).margin(0));
    CHECK(got_b[k] == Approx(b[k]).epsilon(9.1e-15).margin(0));
  }
}

TEST_CASE("filtered records agree with the 50-digit known answers") {
  const std::vector<double> w = column("fusion/kasdin_filter.csv", 1), x = column("fusion/kasdin_filter.csv", 3),
                            exact = test::kasdin_filter(w);
  REQUIRE(w.size() >= 100);
  std::vector<double> recursive = w;
  TruncatedKasdin(w.size()).run(recursive);  // long enough: nothing is truncated
  for (std::size_t t = 0; t < x.size(); ++t) {
    CHECK(std::fabs(exact[t] - x[t]) < 1e-14);  // values up to some 10
    CHECK(std::fabs(recursive[t] - x[t]) < 3e-14);
  }
}

TEST_CASE("the truncated filter: samples by definition, whatever the blocks") {
  constexpr std::size_t taps = 37, n = 5000;
  const std::vector<double> w = normals(n), b = test::kasdin_series(-1, taps + 1);
  std::vector<double> whole = w, parts = w, plain = w;
  TruncatedKasdin one(taps), two(taps);
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
