// Charts and histograms of known values.

#include "libchar/lot/control_chart.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "tests/support/noise.hpp"

using namespace libchar;

TEST_CASE("control chart: limits by the mean moving range") {
  // Moving ranges 1, 2, 3: mean 2, sigma 2 / 1.128379.
  const ControlChart chart = control_chart(std::vector<double>{10, 11, 9, 12});
  CHECK(chart.centre == Approx(10.5));
  CHECK(chart.sigma == Approx(2 / 1.1283791670955126));
  CHECK(chart.limits.high == Approx(10.5 + 3 * chart.sigma));
  CHECK(chart.points.size() == 4);
  CHECK(chart.beyond.empty());
}

TEST_CASE("control chart: normal values leave the limits and stay on a side as often as it says") {
  test::Gaussian gauss(1);
  std::vector<double> values(100000);
  for (double& v : values) v = 5 + gauss();
  const ControlChart chart = control_chart(values);
  CHECK(chart.zones.of(ZoneRule::beyond_3_sigma).by_chance == Approx(270).epsilon(0.01));
  CHECK(std::abs(static_cast<double>(chart.beyond.size()) - 270) < 4 * std::sqrt(270));
  const ZoneFinding& runs = chart.zones.of(ZoneRule::eight_in_a_row);
  CHECK(std::abs(static_cast<double>(runs.signals) - runs.by_chance) < 4 * std::sqrt(391));
  REQUIRE(chart.points.size() == kChartPoints);
  std::size_t covered = 0;
  for (const ChartPoint& p : chart.points) {
    CHECK(p.first == covered);
    CHECK(p.low <= p.mean);
    covered += p.count;
  }
  CHECK(covered == values.size());
}

TEST_CASE("control chart: a value far off and a shift are seen") {
  test::Gaussian gauss(2);
  std::vector<double> values(60);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = gauss() + (i < 40 ? 0 : 1.5);
  values[12] = -9;
  const ControlChart chart = control_chart(values);
  CHECK(std::any_of(chart.beyond.begin(), chart.beyond.end(),
                    [](const ChartValue& v) { return v.index == 12 && v.value == -9; }));
  CHECK(chart.beyond.size() <= 3);
  CHECK(chart.zones.of(ZoneRule::eight_in_a_row).signals >= 1);
}

TEST_CASE("histogram: every value once, a wild one in its own place") {
  test::Gaussian gauss(3);
  std::vector<double> values(1000);
  for (double& v : values) v = gauss();
  values[0] = 1e9;
  const Histogram h = histogram_of(values);
  CHECK(h.above == 1);
  CHECK(h.below == 0);
  std::uint64_t sum = 0;
  for (const auto n : h.count) sum += n;
  CHECK(sum == 999);
  CHECK(h.count.size() > 10);
  CHECK(h.count.size() <= 60);
  CHECK(histogram_of({}).count.empty());
  const Histogram one = histogram_of(std::vector<double>{2, 2, 2});
  CHECK(one.count == std::vector<std::uint64_t>{3});
  CHECK(one.step > 0);
}

TEST_CASE("capability: of known mean and spread, and its interval covers") {
  Capability c;
  RandomEffects effects;
  effects.mean = 1;
  effects.mean_ci95 = {0.9, 1.1};
  effects.spread = 0.5;
  effects.spread_ci95 = {0.4, 0.6};
  add_ppk(effects, 4, c);
  CHECK(c.ppk.value() == Approx(2));
  CHECK(c.above == Approx(9.865876e-10).epsilon(1e-5));
  effects.spread_ci95.low = 0;
  add_ppk(effects, 4, c);
  CHECK(c.ppk_ci95.low == Approx((4 - 1.1) / (3 * 0.6)));
  CHECK(std::isinf(c.ppk_ci95.high));

  test::Gaussian gauss(4);
  int covered = 0;
  constexpr int kLots = 400;
  for (int i = 0; i < kLots; ++i) {
    std::vector<double> y, v(50, 0.04);
    for (std::size_t k = 0; k < v.size(); ++k) y.push_back(gauss() + 0.2 * gauss());
    add_ppk(random_effects(y, v), 3, c);
    covered += c.ppk_ci95.low <= 1 && 1 <= c.ppk_ci95.high;
  }
  CHECK(covered >= 0.91 * kLots);
}
