// The four zone rules: each on values that hold it and on values that just do not, and how often chance brings them.

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "libchar/lot/control_chart.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;

namespace {

std::size_t signals(const std::vector<double>& z, ZoneRule rule) {
  return zone_findings(z, 0, 1).rule[static_cast<std::size_t>(rule)].signals;
}

std::vector<double> steady(std::size_t count, test::Gaussian& gauss) {
  std::vector<double> out(count);
  for (double& x : out) x = gauss();
  return out;
}

}  // namespace

TEST_CASE("zone rules: what each holds and what it does not") {
  CHECK(signals({0, 3.1, 0, -3.1, 2.9}, ZoneRule::beyond_3_sigma) == 2);
  CHECK(signals({2.1, 0, 2.1, 0}, ZoneRule::two_of_three) == 1);
  CHECK(signals({2.1, 0, 0, 2.1}, ZoneRule::two_of_three) == 0);
  CHECK(signals({2.1, 0, -2.1, 0}, ZoneRule::two_of_three) == 0);
  CHECK(signals({1.1, 1.1, 0, 1.1, 1.1}, ZoneRule::four_of_five) == 1);
  CHECK(signals({-1.1, -1.1, 1.1, -1.1, -1.1}, ZoneRule::four_of_five) == 1);
  CHECK(signals({1.1, 1.1, 0, 0, 1.1, 1.1}, ZoneRule::four_of_five) == 0);
  CHECK(signals({.1, .1, .1, .1, .1, .1, .1, .1, .1}, ZoneRule::eight_in_a_row) == 1);
  CHECK(signals({.1, .1, .1, .1, .1, .1, .1, -.1, .1}, ZoneRule::eight_in_a_row) == 0);
}

TEST_CASE("zone rules: as many signals as is said to be expected by chance") {
  test::Gaussian gauss(41);
  constexpr std::size_t kValues = 400000;
  const ZoneFindings found = zone_findings(steady(kValues, gauss), 0, 1);
  for (const ZoneFinding& rule : found.rule) {
    CAPTURE(rule.by_chance);
    CHECK(rule.by_chance > 700);
    CHECK(std::abs(static_cast<double>(rule.signals) - rule.by_chance) < 4.5 * std::sqrt(rule.by_chance));
  }
  // The combination, of charts whose limits are known: Champ and Woodall's 91.75 values to the first signal.
  int any = 0;
  constexpr int kCharts = 4000;
  for (int i = 0; i < kCharts; ++i)
    for (const ZoneFindings one = zone_findings(steady(100, gauss), 0, 1); const ZoneFinding& rule : one.rule)
      if (rule.signals > 0) {
        ++any;
        break;
      }
  CHECK(static_cast<double>(any) / kCharts ==
        Approx(zone_findings(std::vector<double>(100), 0, 1).any_by_chance).margin(0.03));
}

TEST_CASE("zone rules: steady charts do not alarm, shifts, trends and wild values do") {
  test::Gaussian gauss(42);
  int clean = 0, shift = 0, trend = 0, wild = 0;
  constexpr int kCharts = 400;
  for (int i = 0; i < kCharts; ++i) {
    std::vector<double> x = steady(200, gauss);
    clean += control_chart(x).zones.alarm;
    auto changed = x;
    for (std::size_t k = 100; k < 200; ++k) changed[k] += 1.5;
    shift += control_chart(changed).zones.alarm;
    changed = x;
    for (std::size_t k = 0; k < 200; ++k) changed[k] += 3 * static_cast<double>(k) / 200;
    trend += control_chart(changed).zones.alarm;
    changed = x;
    changed[77] = -7;
    wild += control_chart(changed).zones.rule[static_cast<std::size_t>(ZoneRule::beyond_3_sigma)].alarm;
  }
  CHECK(clean <= 12);  // 4 are expected at most
  CHECK(shift >= 0.9 * kCharts);
  CHECK(trend >= 0.97 * kCharts);
  CHECK(wild >= 0.97 * kCharts);
}

TEST_CASE("zone rules: values that are all alike have none") {
  const ControlChart chart = control_chart(std::vector<double>(20, 3.0));
  CHECK_FALSE(chart.zones.alarm);
  CHECK(chart.zones.rule[0].signals == 0);
}
