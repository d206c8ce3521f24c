// Medians, means and shares with their intervals, by hand and by simulation.

#include <catch2/catch.hpp>
#include <cmath>

#include "libchar/benchmark/turns.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;

TEST_CASE("median: order statistics of the binomial, by hand") {
  const Figure six = median_figure({6, 1, 5, 2, 4, 3});
  CHECK(six.value == 3.5);
  // P(all six on one side) = 2/64 = 3.1 %: the extremes; five values cannot say 95 %.
  CHECK(six.ci95.low == 1);
  CHECK(six.ci95.high == 6);
  const Figure five = median_figure({1, 2, 3, 4, 5});
  CHECK(five.value == 3);
  CHECK(std::isinf(five.ci95.low));
  CHECK(std::isinf(five.ci95.high));
  // Nine values: the second and the eighth (Conover, Practical Nonparametric Statistics, table A3).
  const Figure nine = median_figure({9, 8, 7, 6, 5, 4, 3, 2, 1});
  CHECK(nine.ci95.low == 2);
  CHECK(nine.ci95.high == 8);
  CHECK(std::isnan(median_figure({}).value));
}

TEST_CASE("times: wider than a median's interval, and never narrower than what code placement costs") {
  std::vector<double> values(20, 100);
  const Figure still = time_figure(values);
  CHECK(still.ci95.low == Approx(98.5));
  CHECK(still.ci95.high == Approx(101.5));
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<double>(i + 1);
  // 20 values: the 4th and 17th at 99 % (P(K <= 3) = 0.13 %, P(K <= 4) = 0.59 %), the 6th and 15th at 95 %.
  CHECK(time_figure(values).ci95.low == 4);
  CHECK(time_figure(values).ci95.high == 17);
  CHECK(median_figure(values).ci95.low == 6);
  CHECK(std::isinf(time_figure({1, 2, 3, 4, 5, 6, 7}).ci95.high));
}

TEST_CASE("mean and rms: Student and chi-square, by hand") {
  const Figure mean = mean_figure({1e9 + 1, 1e9 + 2, 1e9 + 3});
  CHECK(mean.value == 1e9 + 2);
  CHECK(mean.ci95.high - mean.value == Approx(4.302653 / std::sqrt(3.0)).epsilon(1e-6));
  CHECK(std::isinf(mean_figure({3}).ci95.high));
  const Figure rms = rms_figure(std::vector<double>(10, 2.0));
  CHECK(rms.value == 2);
  CHECK(rms.ci95.low == Approx(2 * std::sqrt(10 / 20.4832)).epsilon(1e-5));
}

TEST_CASE("share: Wilson's interval, none and all included") {
  const Figure none = share_figure(0, 10);
  CHECK(none.value == 0);
  CHECK(none.ci95.low == 0);
  CHECK(none.ci95.high == Approx(0.27753).epsilon(1e-4));
  CHECK(share_figure(10, 10).ci95.low == Approx(1 - 0.27753).epsilon(1e-4));
}

TEST_CASE("intervals hold the truth as often as they say") {
  test::Gaussian gauss(5);
  int median_hits = 0, mean_hits = 0, rms_hits = 0;
  constexpr int kTrials = 4000;
  for (int i = 0; i < kTrials; ++i) {
    std::vector<double> values(11);
    for (double& v : values) v = gauss();
    const auto holds = [](const Figure& f, double truth) {
      return f.ci95.low <= truth && truth <= f.ci95.high ? 1 : 0;
    };
    rms_hits += holds(rms_figure(values), 1);
    mean_hits += holds(mean_figure(values), 0);
    median_hits += holds(median_figure(values), 0);
  }
  // Four standard errors of a share at 95 %: 1.4 %. The median's is at least so much (98.8 % with eleven values).
  CHECK(std::abs(mean_hits / double{kTrials} - 0.95) < 0.014);
  CHECK(std::abs(rms_hits / double{kTrials} - 0.95) < 0.014);
  CHECK(std::abs(median_hits / double{kTrials} - 0.988) < 0.007);
}
