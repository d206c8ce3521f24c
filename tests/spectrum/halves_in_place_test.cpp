#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <random>

#include "libchar/spectrum/detail/half_pass.hpp"
#include "libchar/spectrum/detail/half_segments.hpp"
#include "libchar/spectrum/welch.hpp"

using namespace libchar;

namespace {

constexpr double kHole = std::numeric_limits<double>::quiet_NaN();

std::vector<double> walk_and_noise(std::size_t n) {
  std::mt19937_64 generator(5);
  std::normal_distribution<double> normal;
  std::vector<double> x(n);
  double walk = 1e6;
  for (double& value : x) {
    walk += 0.01 * normal(generator);
    value = walk + normal(generator);
  }
  return x;
}

/// The same by HalfSegments, which leaves the record as it is.
std::vector<double> power_beside(const std::vector<double>& x, std::size_t half) {
  HalfSegments halves(2 * half);
  auto sums = halves.zero_sums();
  const std::size_t count = x.size() / half;
  for (std::size_t i = 0; i < count; i += 2) {
    const auto a = halves.half_at(x.data() + i * half);
    const auto b = i + 1 < count ? halves.half_at(x.data() + (i + 1) * half) : HalfSegments::Half();
    halves.push(a, b, sums.get(), sums.get());
  }
  std::vector<double> power;
  halves.take_power(*sums, power);
  return power;
}

}  // namespace

TEST_CASE("halves in place: the bits of halves beside, for any number of halves and threads") {
  // Odd and even numbers of rows, 8 and 16 columns at a time, one row a thread at the least.
  for (const std::size_t half : {2048U, 2400U, 4000U, 50000U, 78400U, 160000U}) {
    for (const std::size_t halves : {2U, 3U, 7U, 8U}) {
      const std::vector<double> x = walk_and_noise(halves * half + half / 3);
      const std::vector<double> expected = power_beside(x, half);
      for (const int threads : {1, 2, 3, 5}) {
        CAPTURE(half, halves, threads);
        HalvesInPlace in_place(half, threads);
        std::vector<double> used_up = x;
        const std::vector<char> used = in_place.add_all(used_up);
        REQUIRE(used == std::vector<char>(halves - 1, 1));
        REQUIRE(in_place.power() == expected);
      }
    }
  }
}

TEST_CASE("halves in place: segments that touch a missing sample are left out") {
  const std::size_t half = 4000;
  for (const std::size_t missing : {0U, 1U, 2U, 3U, 6U, 7U}) {
    std::vector<double> x = walk_and_noise(8 * half);
    x[missing * half + 17] = kHole;
    if (missing == 6) x[7 * half] = kHole;  // a whole pair
    const std::vector<double> expected = power_beside(x, half);
    HalvesInPlace in_place(half, 2);
    const std::vector<char> used = in_place.add_all(x);
    CAPTURE(missing);
    for (std::size_t i = 0; i < used.size(); ++i) {
      const bool touched = i == missing || i + 1 == missing || (missing == 6 && i + 1 == 7);
      CHECK((used[i] != 0) == !touched);
    }
    REQUIRE(in_place.power() == expected);
  }
}

TEST_CASE("welch: a record used up gives the bits of one that is kept") {
  const auto same = [](const std::vector<double>& x, const WelchOptions& options) {
    const Spectrum kept = welch(x, 100, options), used_up = welch_using_up(x, 100, options);
    CHECK(used_up.value == kept.value);
    CHECK(used_up.dof == kept.dof);
    CHECK(used_up.frequency_hz == kept.frequency_hz);
    CHECK(used_up.segment == kept.segment);
    CHECK(used_up.segments == kept.segments);
    CHECK(used_up.dropped == kept.dropped);
    CHECK(used_up.notes == kept.notes);
    CHECK(used_up.neighbour_correlation == kept.neighbour_correlation);
  };
  std::vector<double> x = walk_and_noise(std::size_t{9} << 20U);
  same(x, {});  // long segments, in place
  WelchOptions options;
  options.segment = std::uint64_t{1} << 22U;
  options.threads = 1;
  x[std::size_t{7} << 20U] = kHole;
  same(x, options);
  options.segment = 65536;  // many short ones
  same(x, options);
  options = {};
  options.detrend = Detrend::linear;  // not by halves
  x.resize(100000);
  same(x, options);
}
