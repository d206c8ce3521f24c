#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <random>

#include "libchar/fit/record/power_sums.hpp"
#include "libchar/spectrum/fft.hpp"

using namespace libchar;

namespace {

constexpr std::uint64_t kBlock = PowerPart::kBlock;

std::vector<double> walk(std::size_t n) {
  std::mt19937_64 generator(5);
  std::normal_distribution<double> normal;
  std::vector<double> x(n);
  double sum = 9.81;
  for (double& v : x) v = (sum += 0.02 * normal(generator)) + normal(generator);
  return x;
}

// Transforms the blocks that the binner takes, as a spectrum by halves does.
std::vector<PowerBin> by_blocks(const std::vector<double>& x, std::size_t& taken) {
  PowerPart binner;
  SharedBlocks blocks(kBlock, binner);
  Dct dct(kBlock);
  std::vector<double> power(kBlock, 0.0);
  std::span<const double> rest = x;
  for (taken = 0; rest.size() >= kBlock; rest = rest.subspan(kBlock)) {
    const auto piece = rest.first(kBlock);
    const bool whole = std::none_of(piece.begin(), piece.end(), [](double v) { return std::isnan(v); });
    if (!blocks.offer(piece, whole)) continue;
    ++taken;
    const auto c = dct.transform(piece);
    for (std::size_t k = 0; k < kBlock; ++k) power[k] += c[k] * c[k];
  }
  blocks.close(rest, power);
  return power_bins(powers_of(binner.finish(true)), 200);
}

void same_bins(const std::vector<PowerBin>& a, const std::vector<PowerBin>& b) {
  REQUIRE(a.size() == b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    REQUIRE(a[i].energy == Approx(b[i].energy).epsilon(1e-12));
    REQUIRE(a[i].dof == b[i].dof);
    REQUIRE(a[i].unit == b[i].unit);
    REQUIRE(a[i].low_hz == b[i].low_hz);
  }
}

std::vector<PowerBin> pushed(const std::vector<double>& x) {
  PowerPart binner;
  binner.push(x);
  return power_bins(powers_of(binner.finish(true)), 200);
}

}  // namespace

TEST_CASE("blocks that are transformed elsewhere give the bins of blocks that are pushed") {
  for (const std::size_t n : {3 * kBlock, 3 * kBlock + 1, 5 * kBlock + 1234}) {
    CAPTURE(n);
    const auto x = walk(n);
    std::size_t taken = 0;
    const auto bins = by_blocks(x, taken);
    CHECK(taken == n / kBlock);
    same_bins(bins, pushed(x));
  }
}

TEST_CASE("after a missing sample the blocks no longer fit and are transformed by the binner") {
  auto x = walk(6 * kBlock + 100);
  x[2 * kBlock + 50] = std::numeric_limits<double>::quiet_NaN();
  std::size_t taken = 0;
  const auto bins = by_blocks(x, taken);
  CHECK(taken == 2);
  same_bins(bins, pushed(x));
}

TEST_CASE("a long gap between taken blocks starts a new segment") {
  auto x = walk(8 * kBlock + 10);
  for (std::size_t t = 2 * kBlock; t < 4 * kBlock; ++t) x[t] = std::numeric_limits<double>::quiet_NaN();
  std::size_t taken = 0;
  const auto bins = by_blocks(x, taken);
  CHECK(taken == 6);
  // A block that ends a segment is a tail when it is pushed, so that only the sums can be compared: all samples are in.
  double got = 0, wanted = 0;
  for (const PowerBin& bin : bins) got += bin.dof;
  for (const PowerBin& bin : pushed(x)) wanted += bin.dof;
  CHECK(got == Approx(wanted).epsilon(0.02));
}

TEST_CASE("only whole blocks are taken") {
  const auto x = walk(2 * kBlock);
  PowerPart binner;
  CHECK_FALSE(binner.take_block(std::span(x).first(kBlock - 1)));
  CHECK(binner.take_block(std::span(x).first(kBlock)));
  binner.push(std::span(x).first(1));
  CHECK_FALSE(binner.take_block(std::span(x).first(kBlock)));
}
