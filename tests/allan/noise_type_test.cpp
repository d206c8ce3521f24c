// The power law of a clock's noise by its lag-1 autocorrelation: five kinds of known noise, and
// what Stable32 says of two clocks.
#include "libchar/allan/noise_type.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <sstream>

#include "tests/support/noise.hpp"
#include "tests/support/npy.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;

namespace {

// (1 - z^-1)^(-d) w by its binomial series: S_x ~ f^(-2d), S_y ~ f^(2 - 2d).
std::vector<double> power_law_phase(std::uint64_t seed, double d, std::size_t n) {
  test::Gaussian normal(seed);
  std::vector<double> h(n, 1.0), w(n), x(n, 0.0);
  for (std::size_t k = 1; k < n; ++k) h[k] = h[k - 1] * (static_cast<double>(k) - 1 + d) / static_cast<double>(k);
  for (double& v : w) v = normal();
  for (std::size_t t = 0; t < n; ++t)
    for (std::size_t k = 0; k <= t; ++k) x[t] += h[k] * w[t - k];
  return x;
}

// "af -> alpha" of one statistic in a table of Stable32.
std::map<std::uint64_t, int> stable32(const std::string& name, const std::string& statistic) {
  std::ifstream in(test::shared("data/" + name));
  std::map<std::uint64_t, int> out;
  std::string line;
  while (std::getline(in, line)) {
    std::istringstream row(line);
    std::string cell[5];
    for (std::string& c : cell) std::getline(row, c, ',');
    if (cell[0] == statistic) out[std::stoull(cell[1])] = static_cast<int>(std::stod(cell[4]));
  }
  return out;
}

}  // namespace

TEST_CASE("each of the five power laws is named at every averaging time") {
  int right = 0, total = 0;
  for (int alpha = -2; alpha <= 2; ++alpha)
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      const std::vector<double> x = power_law_phase(seed, 1 - alpha / 2.0, 4096);
      for (const std::uint64_t m : {1U, 4U, 16U}) {
        const auto type = lag1_noise_type(x, m, 0.5);
        REQUIRE(type);
        CAPTURE(alpha, m, type->estimate);
        CHECK(type->tau_s == Approx(0.5 * static_cast<double>(m)));
        // Decimated white and flicker phase alias into white phase (SP 1065, 5.5.6).
        const int expected = alpha == 1 && m > 1 ? 2 : alpha;
        right += type->alpha == alpha || type->alpha == expected;
        ++total;
      }
    }
  CHECK(right >= 0.9 * total);
}

TEST_CASE("noise types: missing readings, short and constant records") {
  std::vector<double> x = power_law_phase(9, 1, 2048);
  const int whole = lag1_noise_type(x, 1, 1)->alpha;
  x[0] = x[700] = x[701] = std::numeric_limits<double>::quiet_NaN();
  REQUIRE(!lag1_noise_types(x, 1).empty());
  CHECK(lag1_noise_types(x, 1)[0].alpha == whole);
  for (std::size_t i = 0; i < x.size(); i += 50) x[i] = std::numeric_limits<double>::quiet_NaN();
  CHECK(lag1_noise_types(x, 1).empty());
  CHECK(lag1_noise_types(std::vector<double>(1000, 3.0), 1).empty());
  CHECK(lag1_noise_types(std::vector<double>(20, 3.0), 1).empty());
  CHECK(lag1_noise_types({}, 1).empty());
}

TEST_CASE("noise types in words") {
  const std::vector<NoiseType> types = {{1, 1, 2, 2}, {2, 2, 2, 1.9}, {4, 4, 1, 1}, {8, 8, -2, -2}};
  CHECK(noise_types_text(types) == "white phase from 1 s to 2 s, flicker phase at 4 s, random-walk frequency at 8 s");
  CHECK(noise_types_text({}).empty());
}

TEST_CASE("Stable32 names the noise of two clocks alike") {
  NEEDS_SHARED("data/clock_cs5071a_vs_hmaser_phase.npy");
  const auto phase = test::npy(test::shared("data/clock_cs5071a_vs_hmaser_phase.npy")).values;
  const auto frequency = test::npy(test::shared("data/clock_ocxo10mhz_freq.npy")).values;
  std::vector<double> sum = {0};
  for (const double f : frequency) sum.push_back(sum.back() + (f / 1e7 - 1));
  const auto compare = [](const std::vector<double>& x, const std::map<std::uint64_t, int>& theirs) {
    int compared = 0;
    for (const auto& [m, alpha] : theirs) {
      if (x.size() / m < 75) continue;  // below, it takes another method
      const auto type = lag1_noise_type(x, m, 1);
      REQUIRE(type);
      CAPTURE(m, type->estimate);
      CHECK(type->alpha == alpha);
      ++compared;
    }
    return compared;
  };
  CHECK(compare(phase, stable32("clock_cs5071a_vs_hmaser_phase.stable32.csv", "oadev")) == 12);
  CHECK(compare(sum, stable32("clock_ocxo10mhz_freq.stable32.csv", "oadev")) == 9);
}
