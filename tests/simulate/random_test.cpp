#include "libchar/simulate/random.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <set>
#include <vector>

#include "libchar/core/numeric/distributions.hpp"

using namespace libchar;

namespace {

std::vector<double> normals(const StreamKey& key, std::size_t n) {
  std::vector<double> out(n);
  DeviateStream stream(key);
  stream.fill_normal(out);
  return out;
}

double normal_cdf(double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); }

/// sqrt(n) times the largest distance between the empirical distribution and `cdf`.
template <typename Cdf>
double kolmogorov(std::vector<double> x, const Cdf& cdf) {
  std::sort(x.begin(), x.end());
  const double n = static_cast<double>(x.size());
  double worst = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double f = cdf(x[i]), below = static_cast<double>(i) / n;
    worst = std::max({worst, f - below, below + 1 / n - f});
  }
  return worst * std::sqrt(n);
}

constexpr double kKolmogorov999 = 1.9495;  // exceeded with probability 1e-3

double correlation(const std::vector<double>& a, const std::vector<double>& b, std::size_t lag) {
  double sum = 0;
  for (std::size_t i = lag; i < a.size(); ++i) sum += a[i] * b[i - lag];
  return sum / std::sqrt(static_cast<double>(a.size() - lag));
}

}  // namespace

// The three vectors that Random123 publishes for philox4x64 with ten rounds (kat_vectors).
TEST_CASE("philox gives the published known answers") {
  using Four = std::array<std::uint64_t, 4>;
  constexpr std::uint64_t ones = ~std::uint64_t{0};
  CHECK(philox({0, 0, 0, 0}, {0, 0}) ==
        Four{0x16554d9eca36314c, 0xdb20fe9d672d0fdc, 0xd7e772cee186176b, 0x7e68b68aec7ba23b});
  CHECK(philox({ones, ones, ones, ones}, {ones, ones}) ==
        Four{0x87b092c3013fe90b, 0x438c3c67be8d0224, 0x9cc7d7c69cd777b6, 0xa09caebf594f0ba0});
  CHECK(philox({0x243f6a8885a308d3, 0x13198a2e03707344, 0xa4093822299f31d0, 0x082efa98ec4e6c89},
               {0x452821e638d01377, 0xbe5466cf34e90c6c}) ==
        Four{0xa528f45403e61d95, 0x38c72dbd566e9788, 0xa5a1610e72fd18b5, 0x57bd43b5e52b7fe6});
}

TEST_CASE("a stream is the philox blocks of its key in order") {
  DeviateStream stream({7, 3, Purpose::walk});
  for (std::uint64_t block = 0; block < 40; ++block)
    for (const std::uint64_t word : philox({block, 0, 0, static_cast<std::uint64_t>(Purpose::walk)}, {7, 3}))
      CHECK(stream.uniform() == static_cast<double>(word >> 11U) * 0x1.0p-53);
}

// Rejections included: a deviate that needs more words than one takes none from its neighbours.
TEST_CASE("a deviate depends on its position alone") {
  const StreamKey key{2, 9, Purpose::flicker};
  const std::vector<double> whole = normals(key, 20'000);
  DeviateStream stream(key);
  for (std::size_t position = 17; position < whole.size(); position += 113) {
    stream.seek(position);
    REQUIRE(stream.normal() == whole[position]);
  }
  stream.seek(0);
  for (std::size_t position = 0; position < 1000; ++position) {
    if (position % 3 == 0)
      stream.uniform();
    else
      REQUIRE(stream.normal() == whole[position]);
  }
  // far out, where a simulation of years would be: the blocks there are those of philox
  stream.seek(std::uint64_t{1} << 62U);
  const auto far = philox({std::uint64_t{1} << 60U, 0, 0, 2}, {2, 9});
  CHECK(stream.uniform() == static_cast<double>(far[0] >> 11U) * 0x1.0p-53);
}

TEST_CASE("deviates do not depend on the size of the blocks they are drawn in") {
  const StreamKey key{11, 4, Purpose::white};
  const std::vector<double> whole = normals(key, 10'000);
  DeviateStream stream(key);
  std::vector<double> parts(whole.size());
  std::size_t at = 0;
  for (std::size_t size = 1; at < parts.size(); size = size * 3 % 1000 + 1) {
    const std::size_t count = std::min(size, parts.size() - at);
    if (count == 1)
      parts[at] = stream.normal();
    else
      stream.fill_normal(std::span(parts).subspan(at, count));
    at += count;
  }
  CHECK(whole == parts);
}

TEST_CASE("normal deviates have the moments and the distribution of the normal law") {
  constexpr std::size_t n = 1'000'000;
  const double root = std::sqrt(static_cast<double>(n));
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
    const std::vector<double> x = normals({seed, 0, Purpose::white}, n);
    std::array<double, 5> power{};
    for (const double v : x)
      for (std::size_t p = 1; p < power.size(); ++p)
        power[p] += std::pow(v, static_cast<double>(p)) / static_cast<double>(n);
    const double variance = power[2] - power[1] * power[1];
    const double kurtosis =
        (power[4] - 4 * power[1] * power[3] + 6 * power[1] * power[1] * power[2]) / (variance * variance);
    INFO("seed " << seed);
    CHECK(std::fabs(power[1]) * root < 3.3);  // standard deviations, two-sided 1e-3
    CHECK(std::fabs(variance - 1) * root / std::sqrt(2.0) < 3.3);
    CHECK(std::fabs(power[3]) * root / std::sqrt(15.0) < 3.3);
    CHECK(std::fabs(kurtosis - 3) * root / std::sqrt(24.0) < 3.3);
    CHECK(kolmogorov(x, normal_cdf) < kKolmogorov999);
  }
}

// A ziggurat goes wrong at the seams of its layers and in its tail, which moments do not see.
TEST_CASE("normal deviates fill fine bins and the tails as they should") {
  constexpr std::size_t n = 4'000'000, bins = 1024;
  DeviateStream stream({5, 0, Purpose::white});
  std::vector<double> count(bins, 0.0), block(4000);
  std::array<double, 3> beyond{};  // 3, 4, 5 standard deviations
  for (std::size_t t = 0; t < n; t += block.size()) {
    stream.fill_normal(block);
    for (const double v : block) {
      ++count[std::min(bins - 1, static_cast<std::size_t>(normal_cdf(v) * bins))];
      for (std::size_t i = 0; i < 3; ++i) beyond[i] += std::fabs(v) > 3.0 + static_cast<double>(i);
    }
  }
  const double expected = static_cast<double>(n) / bins;
  double chi2 = 0;
  for (const double c : count) chi2 += (c - expected) * (c - expected) / expected;
  CHECK(chi_square_tail(chi2, bins - 1) > 1e-3);
  CHECK(chi_square_cdf(chi2, bins - 1) > 1e-3);
  for (std::size_t i = 0; i < 3; ++i) {
    const double mean = 2 * n * normal_cdf(-3.0 - static_cast<double>(i));
    INFO("beyond " << 3 + i << ": " << beyond[i] << ", expected " << mean);
    CHECK(std::fabs(beyond[i] - mean) < 3.3 * std::sqrt(mean));
  }
}

TEST_CASE("uniform deviates are uniform from 0 to below 1") {
  DeviateStream stream({1, 0, Purpose::truth});
  std::vector<double> x(500'000);
  for (double& v : x) v = stream.uniform();
  CHECK(*std::min_element(x.begin(), x.end()) >= 0);
  CHECK(*std::max_element(x.begin(), x.end()) < 1);
  CHECK(kolmogorov(x, [](double v) { return v; }) < kKolmogorov999);
}

TEST_CASE("streams of different seed, sensor or purpose are uncorrelated") {
  constexpr std::size_t n = 100'000;
  const std::vector<StreamKey> keys = {{1, 0, Purpose::white}, {1, 0, Purpose::flicker}, {1, 0, Purpose::walk},
                                       {1, 1, Purpose::white}, {1, 1, Purpose::flicker}, {1, 2, Purpose::white},
                                       {2, 0, Purpose::white}, {2, 1, Purpose::white},   {0, 1, Purpose::white},
                                       {0, 2, Purpose::white}};
  std::vector<std::vector<double>> x;
  for (const StreamKey& key : keys) x.push_back(normals(key, n));
  double worst = 0;
  for (std::size_t i = 0; i < x.size(); ++i)
    for (std::size_t j = 0; j < x.size(); ++j)
      for (const std::size_t lag : {0U, 1U, 2U, 4U, 64U})
        if (i != j || lag > 0) worst = std::max(worst, std::fabs(correlation(x[i], x[j], lag)));
  CHECK(worst < 4.75);  // 500 normal values: 1e-3
  std::set<double> first;
  for (const auto& stream : x) first.insert(stream.front());
  CHECK(first.size() == keys.size());
}

// What a seed means must not change: simulated records are named by their seed. (Values of the
// first version; another Boost.Random that moved them would show here.)
TEST_CASE("the first deviates of a seed stay what they are") {
  CHECK(normals({1, 0, Purpose::white}, 4) ==
        std::vector<double>{-1.5248252747834246, -1.202456723386357, 2.2070818652025435, 0.45154033601968402});
}
