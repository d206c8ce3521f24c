#include <catch2/catch.hpp>
#include <cmath>
#include <map>

#include "libchar/core/numeric/distributions.hpp"
#include "tests/support/shared.hpp"
#include "tests/support/table.hpp"

using namespace libchar;

namespace {

// 1 - p of the table, as the nearest double (1 - 0.999999 in double has only ten digits).
const std::map<std::string, double> kUpperTail = {{"0.999999", 1e-6}, {"0.999", 1e-3},    {"0.995", 5e-3},
                                                  {"0.99", 1e-2},     {"0.975", 2.5e-2},  {"0.95", 5e-2},
                                                  {"0.9", 0.1},       {"0.8415", 0.1585}, {"0.75", 0.25}};

}  // namespace

TEST_CASE("chi-square quantiles agree with 361 values of 25 digits") {
  double worst = 0;
  int count = 0;
  for (const auto& row : test::table(test::known("chi_square/chi2_quantiles.csv"))) {
    if (row[0] == "nu") continue;
    const double nu = std::stod(row[0]);
    const double truth = std::stod(row[2]);
    const auto upper = kUpperTail.find(row[1]);
    const double got = upper == kUpperTail.end() ? chi_square_quantile(std::stod(row[1]), nu)
                                                 : chi_square_upper_quantile(upper->second, nu);
    INFO("nu " << row[0] << " p " << row[1] << " got " << got);
    CHECK(std::fabs(got / truth - 1) <= 1e-12);
    // Through the plain call, what the rounding of p itself leaves: |dx| = |dp| / density.
    CHECK(std::fabs(chi_square_quantile(std::stod(row[1]), nu) / truth - 1) <= 2e-11);
    worst = std::max(worst, std::fabs(got / truth - 1));
    ++count;
  }
  CHECK(count == 361);
}

TEST_CASE("chi-square distribution and quantile invert each other, fractional and huge") {
  for (const double nu : {0.1, 0.5, 1.0, 2.7, 33.3, 1e4, 9e5, 1.1e6, 1e8, 1e12})
    for (const double p : {1e-3, 0.1586, 0.5, 0.84, 0.975}) {
      INFO("nu " << nu << " p " << p);
      const double x = chi_square_quantile(p, nu);
      // At huge nu one rounding of x moves p by sqrt(nu) eps.
      CHECK(chi_square_cdf(x, nu) == Approx(p).epsilon(1e-11 + 1e-15 * std::sqrt(nu)));
      CHECK(chi_square_tail(x, nu) == Approx(1 - p).epsilon(1e-11 + 1e-15 * std::sqrt(nu)));
    }
  CHECK(chi_square_cdf(-1, 3) == 0);
  CHECK(chi_square_cdf(2 * std::log(2.0), 2) == Approx(0.5).epsilon(1e-14));
}

TEST_CASE("chi-square at 1e6 degrees of freedom: expansion and Boost join") {
  for (const double p : {1e-6, 0.025, 0.3, 0.7, 0.975}) {
    const double below = chi_square_quantile(p, 1e6), above = chi_square_quantile(p, 1e6 + 1);
    const double next = chi_square_quantile(p, 1e6 + 2);
    CHECK(above - below == Approx(next - above).epsilon(1e-5));
    CHECK(chi_square_cdf(above, 1e6 + 1) == Approx(p).epsilon(1e-9));
  }
}

TEST_CASE("intervals hold the deviation, shrink with edf and stay finite") {
  double width = 1e300;
  for (const double edf : {1.0, 1.5, 3.0, 10.0, 1e3, 1e6, 1e12, 1e15}) {
    const Interval i = chi_square_interval(2.0, edf, 0.95);
    INFO("edf " << edf);
    CHECK(i.low < 2.0 + 1e-6);
    CHECK(i.high > 2.0 - 1e-6);
    CHECK(i.high - i.low < width);
    width = i.high - i.low;
  }
  for (const double edf : {0.0, 1e-300, 1e-6, -1.0, std::nan(""), HUGE_VAL}) {
    const Interval i = chi_square_interval(1.0, edf, 0.95);
    CHECK(std::isfinite(i.low));
    CHECK(std::isfinite(i.high));
    CHECK(i.low <= i.high);
  }
  // nu = 1: chi2_{0.975} is the square of the normal quantile of 0.9875.
  CHECK(chi_square_interval(1, 1, 0.95).low == Approx(1 / 2.241402727604947).epsilon(1e-12));
  CHECK(chi_square_interval(0, 10, 0.95).high == 0);
}

TEST_CASE("chi-square density, on both sides of where the expansion begins") {
  CHECK(chi_square_density(0, 3) == 0);
  CHECK(chi_square_density(2, 2) == Approx(std::exp(-1.0) / 2).epsilon(1e-14));
  // x^(a-1) exp(-x/2) / (2^a Gamma(a)) in 60 digits
  CHECK(chi_square_density(1099999.34, 1.1e6) == Approx(2.6896692457730428e-4).epsilon(1e-13));
  CHECK(chi_square_density(1e11 - 0.66, 1e11) == Approx(8.9206205807981496e-7).epsilon(1e-13));
  CHECK(chi_square_density(1e6, 1e6) == Approx(chi_square_density(1e6 + 1, 1e6 + 1)).epsilon(1e-6));
}

TEST_CASE("without degrees of freedom nothing is improbable") {
  CHECK(chi_square_tail(5, 0) == 1);
  CHECK(chi_square_tail(5, std::nan("")) == 1);
  CHECK(chi_square_tail(0, 3) == 1);
  CHECK(chi_square_tail(-1, 3) == 1);
}

TEST_CASE("chi-square: mean and variance of the logarithm") {
  // psi and psi' at 1/2, 1, 2 and 15/2 in closed form.
  constexpr double kEuler = 0.57721566490153286, kPi2 = 9.8696044010893586;
  const auto check = [](double dof, double mean, double variance) {
    CAPTURE(dof);
    CHECK(chi_square_log_moments(dof).mean == Approx(mean).epsilon(1e-12));
    CHECK(chi_square_log_moments(dof).variance == Approx(variance).epsilon(1e-12));
  };
  check(1, -kEuler - std::log(2.0), kPi2 / 2);
  check(2, -kEuler, kPi2 / 6);
  check(4, 1 - kEuler - std::log(2.0), kPi2 / 6 - 1);
  double psi = -kEuler - 2 * std::log(2.0), derivative = kPi2 / 2;
  for (double x = 0.5; x < 7.5; ++x) {
    psi += 1 / x;
    derivative -= 1 / (x * x);
  }
  check(15, psi - std::log(7.5), derivative);
  CHECK(chi_square_log_moments(1e8).mean == Approx(-1e-8).epsilon(1e-6));
  CHECK(chi_square_log_moments(1e8).variance == Approx(2e-8).epsilon(1e-6));
}
