// Means of lots in which some devices are not detected.

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "libchar/lot/fleet_lot.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;

namespace {

LotCounts counts_of(std::size_t counted, std::size_t not_detected) {
  LotCounts out;
  out.members = counted + not_detected;
  out.counted = counted;
  out.not_detected = not_detected;
  return out;
}

}  // namespace

TEST_CASE("left out: of a lot whose smallest are missing the mean and the spread of all are held") {
  test::Gaussian gauss(51);
  constexpr int kLots = 300;
  int plain = 0, mean = 0, spread = 0;
  double factor = 0;
  for (int lot = 0; lot < kLots; ++lot) {
    std::vector<double> y, v;
    std::size_t missing = 0;
    for (int i = 0; i < 100; ++i) {
      const double x = 0.3 * gauss() + 0.1 * gauss();
      if (x < -0.2) {
        ++missing;
      } else {
        y.push_back(x);
        v.push_back(0.01);
      }
    }
    const RandomEffects effects = random_effects(y, v);
    const auto left = left_out(DeviceQuantity::random_walk, counts_of(y.size(), missing), y, v, effects);
    REQUIRE(left);
    plain += effects.mean_ci95.low <= 0 && 0 <= effects.mean_ci95.high;
    mean += left->mean_ci95.low <= 1 && 1 <= left->mean_ci95.high;
    spread += effects.spread_ci95.low <= 0.3 && 0.3 <= left->spread_high;
    factor += std::log(left->factor) / kLots;
  }
  CHECK(plain < 0.1 * kLots);  // what it is for
  CHECK(mean >= 0.94 * kLots);
  CHECK(spread >= 0.94 * kLots);
  // A quarter is missing: .42 standard deviations of .32, and what the scatter's limit adds.
  CHECK(factor == Approx(0.155).epsilon(0.15));
}

TEST_CASE("left out: nothing where all count, and of what is not left out for being small") {
  const std::vector<double> y = {1, 2, 3, 4}, v(4, 0.01);
  const RandomEffects effects = random_effects(y, v);
  CHECK_FALSE(left_out(DeviceQuantity::random_walk, counts_of(4, 0), y, v, effects));
  CHECK_FALSE(left_out(DeviceQuantity::turn_on_bias, counts_of(4, 1), y, v, effects));
  CHECK_FALSE(left_out(DeviceQuantity::gauss_markov_time, counts_of(4, 1), y, v, effects));
  const auto zero = left_out(DeviceQuantity::temperature_coefficient, counts_of(4, 1), y, v, effects);
  REQUIRE(zero);
  CHECK(zero->factor == Approx(1.25));
  CHECK(zero->mean_ci95.low == Approx(0.8 * effects.mean_ci95.low));
  CHECK(zero->mean_ci95.high == effects.mean_ci95.high);
}
