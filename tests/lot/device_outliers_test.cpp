// Devices of several channels, held against each other as devices: how often a sound lot names one, and a noisier
// one is named.
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "libchar/lot/detail/statistics/grouped_effects.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;

namespace {

constexpr std::size_t kDevices = 6, kChannels = 3, kTrials = 2000;
constexpr double kSpread = 0.05;  ///< of a channel, as a logarithm

/// Of 2000 lots, those that name a device. `shared`: standard deviation of what the channels of a device have in
/// common, over their own; the last device is `factor` times as noisy.
std::size_t named(double shared, double factor, std::uint64_t seed) {
  test::Gaussian normal(seed);
  std::size_t lots = 0;
  for (std::size_t lot = 0; lot < kTrials; ++lot) {
    std::vector<double> value;
    for (std::size_t device = 0; device < kDevices; ++device) {
      const double common = shared * kSpread * normal();
      const double noisier = device + 1 == kDevices ? std::log(factor) : 0;
      for (std::size_t channel = 0; channel < kChannels; ++channel)
        value.push_back(common + noisier + kSpread * normal());
    }
    const std::vector<double> variance(value.size(), 1e-6);
    lots += find_device_outliers(value, variance, kChannels, 0.005).empty() ? 0 : 1;
  }
  return lots;
}

}  // namespace

TEST_CASE("devices as a whole: a sound lot names one in half of 1 % at most where channels are independent") {
  CHECK(named(0, 1, 1) <= kTrials / 200);
  // Where devices differ as much as their channels do, six devices tell that apart badly.
  CHECK(named(1, 1, 2) <= kTrials / 50);
  CHECK(named(5, 1, 3) <= kTrials / 50);
}

TEST_CASE("devices as a whole: one that is 1.4 times as noisy in three channels of six devices is named in most lots") {
  CHECK(named(0, 1.4, 4) >= 7 * kTrials / 10);
  CHECK(named(0, 1.25, 5) >= 2 * kTrials / 10);
}
