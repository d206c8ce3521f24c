#include "libchar/replay/detail/copied_sensors.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <string>
#include <vector>

#include "tests/support/noise.hpp"

using namespace libchar;

namespace {

using Column = std::vector<double>;

double rounded(double y, double step) { return step > 0 ? std::round(y / step) * step : y; }

Column noisy(int rows, double noise, double step, std::uint64_t seed) {
  test::Gaussian gauss(seed);
  Column out;
  for (int k = 0; k < rows; ++k) out.push_back(rounded(20 + 5 * std::sin(0.05 * k) + noise * gauss(), step));
  return out;
}

Likeness between(const Column& x, const Column& y, std::size_t block) {
  CopiedSensors copies;
  for (std::size_t from = 0; from < x.size(); from += block) {
    const std::size_t rows = std::min(block, x.size() - from);
    const std::span<const double> both[] = {std::span(x).subspan(from, rows), std::span(y).subspan(from, rows)};
    copies.push(both);
  }
  return copies.between(0, 1);
}

Column line(const Column& x, double scale, double shift, double step) {
  Column out;
  for (const double one : x) out.push_back(rounded(scale * one + shift, step));
  return out;
}

}  // namespace

TEST_CASE("copied sensors: equal, scaled, shifted, turned or rounded, in any blocks") {
  for (const double step : {0.0, 1e-6, 1e-3})
    for (const std::size_t block : {70, 1000, 5000}) {
      const Column x = noisy(4000, 0.1, step, 1);
      INFO(step << " " << block);
      CHECK(between(x, x, block) == Likeness::equal);
      CHECK(between(x, line(x, 1, 0.75, step), block) == Likeness::line);
      CHECK(between(x, line(x, -1.02, 300, step), block) == Likeness::line);
      CHECK(between(x, line(x, 9.80665, 0, 0x1p-20), block) == Likeness::line);
      Column holes = x;
      for (std::size_t k = 0; k < holes.size(); k += 7) holes[k] = NAN;
      CHECK(between(holes, x, block) == Likeness::equal);
    }
}

TEST_CASE("copied sensors: what has a noise of its own repeats nothing") {
  for (const std::size_t block : {70, 5000}) {
    const Column x = noisy(4000, 0.1, 1e-3, 1);
    CHECK(between(x, noisy(4000, 0.1, 1e-3, 2), block) == Likeness::none);
    CHECK(between(noisy(4000, 2e-3, 1e-3, 1), noisy(4000, 2e-3, 1e-3, 2), block) == Likeness::none);
    CHECK(between(noisy(4000, 1e-4, 0, 1), noisy(4000, 1e-4, 0, 2), block) == Likeness::none);
    CHECK(between(noisy(4000, 5e-5, 1e-5, 1), noisy(4000, 5e-5, 1e-5, 2), block) == Likeness::none);
    // Coarse thermometers read one value most of the time.
    CHECK(between(noisy(4000, 0.02, 0.5, 1), line(noisy(4000, 0.02, 0.5, 2), 1, 1, 0), block) == Likeness::none);
    Column late(x.begin() + 1, x.end());
    CHECK(between(Column(x.begin(), x.end() - 1), late, block) == Likeness::none);
    Column differs = x;
    differs[3500] += 0.01;
    CHECK(between(x, differs, block) != Likeness::equal);
    CHECK(between(Column(4000, 1.0), Column(4000, 1.0), block) == Likeness::none);
  }
  const Column few = noisy(99, 0.1, 0, 1);
  CHECK(between(few, few, 10) == Likeness::none);
}
