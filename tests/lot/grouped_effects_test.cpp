// Values in groups: what differs within and between them.

#include "libchar/lot/detail/statistics/grouped_effects.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "libchar/core/numeric/distributions.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;

namespace {

struct Grouped {
  std::vector<double> value, variance;
  std::vector<std::size_t> group;
};

Grouped made(std::size_t groups, std::size_t each, double between, double within, test::Gaussian& gauss) {
  Grouped out;
  for (std::size_t g = 0; g < groups; ++g) {
    const double b = between * gauss();
    for (std::size_t i = 0; i < each + g % 3; ++i) {
      const double sd = 0.5 + gauss.uniform();
      out.group.push_back(g);
      out.variance.push_back(sd * sd);
      out.value.push_back(3 + b + within * gauss() + sd * gauss());
    }
  }
  return out;
}

GroupedEffects effects(const Grouped& in, std::size_t groups) {
  return grouped_effects(in.value, in.variance, in.group, groups);
}

}  // namespace

TEST_CASE("grouped effects: equal uncertainties have the analysis of variance in closed form") {
  // Means 2, 3, 7; sum of squares within 2 + 2 + 8 = 12 over 6, between 3 (4 + 1 + 9) = 42 over 2.
  const std::vector<double> y = {1, 2, 3, 2, 3, 4, 5, 7, 9}, v(9, 1e-9);
  const std::vector<std::size_t> group = {0, 0, 0, 1, 1, 1, 2, 2, 2};
  const GroupedEffects r = grouped_effects(y, v, group, 3);
  CHECK(r.within == Approx(std::sqrt(2)));
  CHECK(r.p == Approx(fisher_tail(21 / 2.0, 2, 6)));
  CHECK(r.mean[2] == Approx(7));
  CHECK(r.variance[0] == Approx(2.0 / 3));
  // Variance of the means 7 = between² + within² / 3.
  CHECK(r.between.spread == Approx(std::sqrt(7 - 2.0 / 3)));
  // A group more without values changes nothing.
  const GroupedEffects more = grouped_effects(y, v, group, 4);
  CHECK(more.p == r.p);
  CHECK(std::isnan(more.mean[3]));
}

TEST_CASE("grouped effects: one value a group says nothing of the spread within") {
  const std::vector<double> y = {1, 2, 4}, v(3, 0.01);
  const std::vector<std::size_t> group = {0, 1, 2};
  const GroupedEffects r = grouped_effects(y, v, group, 3);
  CHECK(std::isnan(r.within));
  CHECK(r.between.spread == Approx(random_effects(y, v).spread));
  CHECK(r.p == Approx(r.between.p));
}

TEST_CASE("grouped effects: intervals cover, and equal groups are told apart in 5 %") {
  test::Gaussian gauss(3);
  for (const double within : {0.0, 1.0}) {
    int inside = 0, between = 0, alarms = 0, found = 0;
    constexpr int kLots = 400;
    for (int i = 0; i < kLots; ++i) {
      const GroupedEffects r = effects(made(8, 5, 2, within, gauss), 8);
      inside += r.within_ci95.low <= within && within <= r.within_ci95.high;
      between += r.between.spread_ci95.low <= 2 && 2 <= r.between.spread_ci95.high;
      found += r.p < 0.05;
      alarms += effects(made(8, 5, 0, within, gauss), 8).p < 0.05;
    }
    CAPTURE(within);
    CHECK(inside >= 0.905 * kLots);
    CHECK(between >= 0.905 * kLots);
    CHECK(found >= 0.95 * kLots);
    CHECK(alarms <= 0.095 * kLots);
  }
}
