#include "libchar/fit/power_bins.hpp"

#include <catch2/catch.hpp>
#include <vector>

#include "libchar/core/error.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;

namespace {

std::vector<PowerBin> bins_of(const std::vector<double>& record, std::uint64_t block) {
  PowerBinner binner(block);
  binner.push(record);
  return binner.finish(1);
}

}  // namespace

TEST_CASE("power bins: 64 samples are the shortest block") {
  CHECK_NOTHROW(PowerBinner(64));
  CHECK_THROWS_AS(PowerBinner(63), Error);
}

TEST_CASE("power bins: every coefficient of the record counts once, wherever it ends") {
  test::Gaussian gauss(3);
  std::vector<double> record(5000);
  for (double& y : record) y = gauss();
  for (const std::size_t samples : {700UL, 1024UL, 1030UL, 1536UL, 2048UL, 3584UL, 5000UL}) {
    double count = 0;
    for (const PowerBin& bin :
         bins_of({record.begin(), record.begin() + static_cast<std::ptrdiff_t>(samples)}, 1024))
      count += bin.dof;
    CAPTURE(samples);
    // The mean is none of them, and where the ways of a long record meet a few are left out: up to
    // eight samples at its end, and a coefficient where the bands touch.
    CHECK(count <= static_cast<double>(samples - 1));
    CHECK(count >= static_cast<double>(samples) - 12);
  }
}

TEST_CASE("power bins: of eight neighbouring samples each counts the same in a mean") {
  const auto slow_bins = [](std::size_t at) {
    std::vector<double> record(4096);
    record[at] = 1;
    std::vector<double> energies;
    for (const PowerBin& bin : bins_of(record, 1024))
      if (bin.spacing > 1) energies.push_back(bin.energy);
    return energies;
  };
  const std::vector<double> first = slow_bins(1600);
  REQUIRE(first.size() > 3);
  CHECK(first[0] > 0);
  for (std::size_t lane = 1; lane < 16; ++lane) {
    CAPTURE(lane);
    CHECK(slow_bins(1600 + lane) == first);
  }
  CHECK(slow_bins(1616) != first);
}
