#include "libchar/fit/record/power_bins.hpp"

#include <catch2/catch.hpp>
#include <vector>

#include "libchar/fit/record/power_sums.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;

namespace {

std::vector<PowerBin> bins_in_blocks(const std::vector<double>& record) {
  PowerPart part;
  part.push(record);
  return power_bins(powers_of(part.finish(true)), 1);
}

}  // namespace

TEST_CASE("power bins: every coefficient of the record counts once, wherever it ends") {
  test::Gaussian gauss(3);
  std::vector<double> record(160000);
  for (double& y : record) y = gauss();
  for (const std::size_t samples : {700UL, 32768UL, 32800UL, 50000UL, 65536UL, 120000UL, 160000UL}) {
    double count = 0;
    for (const PowerBin& bin : bins_in_blocks({record.begin(), record.begin() + static_cast<std::ptrdiff_t>(samples)}))
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
    std::vector<double> record(4 * PowerPart::kBlock);
    record[at] = 1;
    std::vector<double> energies;
    for (const PowerBin& bin : bins_in_blocks(record))
      if (bin.spacing > 1) energies.push_back(bin.energy);
    return energies;
  };
  const std::vector<double> first = slow_bins(51200);
  REQUIRE(first.size() > 3);
  CHECK(first[0] > 0);
  for (std::size_t lane = 1; lane < 16; ++lane) {
    CAPTURE(lane);
    CHECK(slow_bins(51200 + lane) == first);
  }
  CHECK(slow_bins(51200 + 512) != first);
}
