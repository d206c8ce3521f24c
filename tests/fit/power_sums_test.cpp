// Parts of a record joined against the record as one part: bins of clean records, gaps, missing samples.

#include "libchar/fit/record/power_sums.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "tests/fit/power_state.hpp"
#include "tests/support/parts.hpp"

using namespace libchar;

namespace {

constexpr std::size_t kLeafOfFour = 4 * PowerPart::kBlock;

std::vector<double> white_walk(std::size_t n, double offset, double walk_step = 0.01) {
  std::mt19937_64 engine(n);
  std::normal_distribution<double> normal;
  std::vector<double> y(n);
  double walk = 0;
  for (double& x : y) {
    walk += walk_step * normal(engine);
    x = offset + walk + normal(engine);
  }
  return y;
}

PowerSums power_in_parts(const std::vector<double>& y) {
  return test::joined_parts<PowerSums>(
      y, kLeafOfFour,
      [](std::span<const double> part, bool last) {
        PowerPart one;
        one.push(part);
        return one.finish(last);
      },
      [](PowerSums& sums, PowerSums later) { join(sums, std::move(later)); });
}

void check_bins(const std::vector<double>& y, double digits) {
  CAPTURE(y.size());
  PowerPart whole;
  whole.push(y);
  const std::vector<PowerBin> a = power_bins(powers_of(whole.finish(true)), 100),
                              b = power_bins(powers_of(power_in_parts(y)), 100);
  REQUIRE(a.size() == b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    REQUIRE(b[i].frequency_hz == a[i].frequency_hz);
    REQUIRE(b[i].dof == a[i].dof);
    REQUIRE(b[i].length == a[i].length);
    REQUIRE(b[i].energy == Approx(a[i].energy).epsilon(digits));
  }
}

/// Lengths of the series of means.
std::vector<std::uint64_t> series_of(const std::vector<double>& y) {
  std::vector<std::uint64_t> out;
  for (const PowerBin& bin : power_bins(powers_of(power_in_parts(y)), 100))
    if (bin.spacing > 1 && (out.empty() || out.back() != bin.length)) out.push_back(bin.length);
  return out;
}

void blank(std::vector<double>& y, std::size_t from, std::size_t to) {
  std::fill(y.begin() + static_cast<std::ptrdiff_t>(from), y.begin() + static_cast<std::ptrdiff_t>(to), std::nan(""));
}

}  // namespace

TEST_CASE("power sums: parts of a clean record are the record, whatever the length of the last") {
  for (const std::size_t n : {std::size_t{9}, std::size_t{5000}, kLeafOfFour + 1, 3 * kLeafOfFour + 40000,
                              5 * kLeafOfFour + PowerPart::kBlock + 700})
    check_bins(white_walk(n, 0.3), 1e-12);
}

TEST_CASE("power sums: an offset of 1e9 standard deviations") {
  check_bins(white_walk(3 * kLeafOfFour + 40000, 1e9), 1e-9);  // quantized to 1e-7 already
}

TEST_CASE("power sums: a long gap ends a segment, also when two parts share it") {
  std::vector<double> y = white_walk(3 * kLeafOfFour, 0.3);
  REQUIRE(series_of(y) == std::vector<std::uint64_t>{768});
  blank(y, kLeafOfFour - 3000, kLeafOfFour + 3000);  // 6000, and neither half is long
  REQUIRE(series_of(y).size() == 2);
  std::vector<double> short_gap = white_walk(3 * kLeafOfFour, 0.3);
  blank(short_gap, kLeafOfFour - 1000, kLeafOfFour + 1000);
  REQUIRE(series_of(short_gap).size() == 1);
  std::vector<double> part = white_walk(3 * kLeafOfFour, 0.3);
  blank(part, kLeafOfFour, 2 * kLeafOfFour);
  REQUIRE(series_of(part) == std::vector<std::uint64_t>{256});  // twice
}

TEST_CASE("power sums: of white noise with missing samples, the mean of every bin is its variance") {
  std::vector<double> y = white_walk(6 * kLeafOfFour + 1234, 0.3, 0);
  std::mt19937_64 engine(3);
  for (double& x : y)
    if (engine() % 50 == 0) x = std::nan("");
  double chi = 0, bins = 0;
  for (const PowerBin& bin : power_bins(powers_of(power_in_parts(y)), 100)) {
    if (bin.dof < 8) continue;
    chi += std::pow(bin.energy - 1, 2) * bin.dof / 2;
    ++bins;
  }
  REQUIRE(bins > 30);
  REQUIRE(chi < bins + 5 * std::sqrt(2 * bins));  // false alarm 1e-6
}

TEST_CASE("power sums: a state that was written and read is the same") {
  std::vector<double> y = white_walk(2 * kLeafOfFour + 5000, 0.3);
  blank(y, 1000, 1100);
  test::check_power_state(power_in_parts(y));
}
