// Values with known uncertainties and a spread of their own.

#include "libchar/core/numeric/random_effects.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "tests/support/noise.hpp"

using namespace libchar;

namespace {

struct Lot {
  std::vector<double> value, variance;
};

// Uncertainties between .5 and 1.5, spread about a mean of 3.
Lot made(std::size_t count, double spread, test::Gaussian& gauss) {
  Lot lot;
  for (std::size_t i = 0; i < count; ++i) {
    const double sd = 0.5 + gauss.uniform();
    lot.variance.push_back(sd * sd);
    lot.value.push_back(3 + spread * gauss() + sd * gauss());
  }
  return lot;
}

}  // namespace

TEST_CASE("random effects: equal uncertainties have the moments in closed form") {
  const std::vector<double> y = {1, 2, 3, 4, 10}, v(5, 0.25);
  const RandomEffects r = random_effects(y, v);
  CHECK(r.mean == Approx(4));
  // Sample variance 12.5 = spread² + v.
  CHECK(r.spread == Approx(std::sqrt(12.25)).epsilon(1e-9));
  // (k - 1) 12.5 / chi-square quantile = spread² + v.
  CHECK(r.spread_ci95.low == Approx(std::sqrt(50 / 11.143287 - 0.25)).epsilon(1e-6));
  CHECK(r.spread_ci95.high == Approx(std::sqrt(50 / 0.48441856 - 0.25)).epsilon(1e-6));
  // Student's t of 4 degrees of freedom.
  CHECK(r.mean_ci95.high == Approx(4 + 2.7764451 * std::sqrt(12.5 / 5)).epsilon(1e-6));
}

TEST_CASE("random effects: intervals cover, with a spread and without") {
  test::Gaussian gauss(7);
  for (const double spread : {0.0, 0.3, 1.0, 5.0})
    for (const std::size_t count : {3, 8, 30}) {
      CAPTURE(spread, count);
      int mean = 0, inside = 0, found = 0;
      constexpr int kLots = 400;
      for (int i = 0; i < kLots; ++i) {
        const Lot lot = made(count, spread, gauss);
        const RandomEffects r = random_effects(lot.value, lot.variance);
        mean += r.mean_ci95.low <= 3 && 3 <= r.mean_ci95.high;
        inside += r.spread_ci95.low <= spread && spread <= r.spread_ci95.high;
        found += r.spread_ci95.low > 0;
      }
      // 95 % of 400 lots, less four standard deviations.
      CHECK(mean >= 0.905 * kLots);
      CHECK(inside >= 0.905 * kLots);
      // A spread that is not there is claimed in 2.5 %.
      if (spread == 0) CHECK(found <= 0.06 * kLots);
      if (spread == 5 && count >= 8) CHECK(found >= 0.97 * kLots);
    }
}

TEST_CASE("random effects: values closer than their uncertainties do not bound the spread by nothing") {
  const std::vector<double> y = {1, 1, 1, 1}, v(4, 1.0);
  const RandomEffects r = random_effects(y, v);
  CHECK(r.spread == 0);
  CHECK(r.spread_ci95.low == 0);
  CHECK(r.spread_ci95.high > 1);
  CHECK(r.p > 0.99);
}

TEST_CASE("random effects: one value has no spread, two have a wide mean") {
  const std::vector<double> y = {1, 3}, v = {0.01, 0.01};
  CHECK(std::isnan(random_effects(std::span(y).first(1), std::span(v).first(1)).spread));
  const RandomEffects two = random_effects(y, v);
  CHECK(two.mean_ci95.high == Approx(2 + 12.706205).epsilon(1e-5));
}

TEST_CASE("outliers: at most 1 % of lots without one have one, and one that is there is named") {
  test::Gaussian gauss(11);
  for (const double spread : {0.0, 1.0})
    for (const std::size_t count : {4, 6, 12, 40}) {
      CAPTURE(spread, count);
      int false_alarms = 0, found = 0;
      const int lots = count > 20 ? 60 : 300;  // the work grows with the cube of the count
      for (int i = 0; i < lots; ++i) {
        Lot lot = made(count, spread, gauss);
        false_alarms += !find_outliers(lot.value, lot.variance).empty();
        lot.value[2] += 30;
        const auto outliers = find_outliers(lot.value, lot.variance);
        found += !outliers.empty() && outliers[0].index == 2;
      }
      CHECK(false_alarms <= (count > 20 ? 4 : 9));  // 1 %, and four standard deviations of a Poisson count
      // Of four, three are left to say what is usual: Student's t of two degrees of freedom.
      if (count > 4) CHECK(found >= 0.98 * lots);
    }
}

TEST_CASE("random effects: what is the same far from zero has the same spread") {
  const std::vector<double> near = {1, 2.5, 3, 4.25, 10}, v = {0.25, 1, 0.5, 2, 0.25};
  std::vector<double> far = near;
  for (double& y : far) y += 1073741824;
  const RandomEffects here = random_effects(near, v), there = random_effects(far, v);
  CHECK(there.spread == Approx(here.spread).epsilon(1e-6));
  CHECK(there.spread_ci95.high == Approx(here.spread_ci95.high).epsilon(1e-6));
  CHECK(there.mean - 1073741824 == Approx(here.mean).epsilon(1e-6));
  CHECK(there.p == Approx(here.p).epsilon(1e-6));
}

TEST_CASE("outliers: the probability is that of Student's t, of any of the values") {
  // Of four equal values with variance 1 the mean has 1/4: the fifth is off by t sqrt(5/4). With 3
  // degrees of freedom 12.924 is passed on either side with probability 0.001.
  const std::vector<double> y = {2, 2, 2, 2, 2 + 12.924 * std::sqrt(1.25)}, v(5, 1.0);
  const auto outliers = find_outliers(y, v, 0.02);
  REQUIRE(outliers.size() == 1);
  CHECK(outliers[0].index == 4);
  CHECK(outliers[0].deviation == Approx(12.924).epsilon(1e-9));
  CHECK(outliers[0].p == Approx(5 * 0.001).epsilon(1e-3));
}

TEST_CASE("outliers: two of them do not hide each other in a lot of twelve") {
  test::Gaussian gauss(13);
  Lot lot = made(12, 0.2, gauss);
  lot.value[1] += 40;
  lot.value[5] += 35;
  const auto outliers = find_outliers(lot.value, lot.variance);
  REQUIRE(outliers.size() == 2);
  CHECK(outliers[0].index + outliers[1].index == 6);
}

TEST_CASE("outliers of many: at most 1 % of lots without one have one, and those that are there are named") {
  test::Gaussian gauss(17);
  for (const double spread : {0.0, 1.0})
    for (const std::size_t count : {61, 300}) {
      CAPTURE(spread, count);
      int false_alarms = 0, found = 0;
      const int lots = 400;
      for (int i = 0; i < lots; ++i) {
        Lot lot = made(count, spread, gauss);
        false_alarms += !find_outliers(lot.value, lot.variance).empty();
        for (const std::size_t k : {2, 30, 45}) lot.value[k] += k == 45 ? -30 : 30;
        const auto outliers = find_outliers(lot.value, lot.variance);
        found += outliers.size() == 3 && outliers[0].index + outliers[1].index + outliers[2].index == 77;
      }
      CHECK(false_alarms <= 12);  // 1 % and four standard deviations of a Poisson count
      CHECK(found >= 0.97 * lots);
    }
}

TEST_CASE("outliers of many: the deviation of one value is that from all others") {
  test::Gaussian gauss(19);
  Lot lot = made(200, 2, gauss);
  std::fill(lot.variance.begin(), lot.variance.end(), 1.0);
  lot.value[7] += 18;
  const auto outliers = find_outliers(lot.value, lot.variance, 0.05);
  REQUIRE(outliers.size() == 1);
  std::vector<double> y = lot.value, v = lot.variance;
  y.erase(y.begin() + 7);
  v.erase(v.begin() + 7);
  const RandomEffects others = random_effects(y, v);
  const double square = others.spread * others.spread + 1;
  CHECK(outliers[0].deviation ==
        Approx((lot.value[7] - others.mean) / std::sqrt(square * (1 + 1 / 199.0))).epsilon(1e-6));
}

TEST_CASE("outliers of many: a second kind is no outlier") {
  test::Gaussian gauss(23);
  Lot lot = made(200, 0.1, gauss);
  for (std::size_t i = 0; i < 100; ++i) lot.value[i] += 100;
  CHECK(find_outliers(lot.value, lot.variance).empty());
}

TEST_CASE("outliers of many: a hundred thousand values take about a second, not hours") {
  test::Gaussian gauss(29);
  Lot lot = made(100000, 1, gauss);
  lot.value[99] += 60;
  const auto outliers = find_outliers(lot.value, lot.variance);
  REQUIRE(outliers.size() == 1);
  CHECK(outliers[0].index == 99);
}
