// What a sketch of stamps keeps of a series that it thins: the interval, and the stamp that
// deviates most, wherever it stands.

#include "libchar/log/time/stamp_sketch.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

using namespace libchar;

namespace {

std::vector<std::int64_t> even_stamps(std::size_t n, std::int64_t start, std::int64_t interval) {
  std::vector<std::int64_t> stamps(n);
  for (std::size_t i = 0; i < n; ++i) stamps[i] = start + static_cast<std::int64_t>(i) * interval;
  return stamps;
}

StampSketch sketch_of(const std::vector<std::int64_t>& stamps) {
  StampSketch sketch;
  for (std::size_t i = 0; i < stamps.size(); ++i) sketch.add(static_cast<std::int64_t>(i), stamps[i]);
  return sketch;
}

StampSketch sketch_of_runs(const std::vector<std::int64_t>& stamps, std::size_t run) {
  StampSketch sketch;
  for (std::size_t i = 0; i < stamps.size(); i += run)
    sketch.add_run(static_cast<std::int64_t>(i), stamps.data() + i, std::min(run, stamps.size() - i));
  return sketch;
}

}  // namespace

TEST_CASE("the stamp that deviates most is kept through every thinning, early or late") {
  for (const std::size_t n : {5UL, 4096UL, 4097UL, 8193UL, 20000UL, 70001UL})
    for (const std::size_t at : {1UL, 2UL, 3UL, 4095UL, 4098UL, 8190UL, 12345UL, 65537UL})
      for (const std::int64_t off : {-12345, 12345}) {
        if (at + 1 >= n) continue;
        INFO(n << " stamps, the one at " << at << " off by " << off);
        auto stamps = even_stamps(n, -777, 1000000);
        stamps[at] += off;
        const StampSketch sketch = sketch_of(stamps);
        CHECK(sketch.interval_ns() == 1e6);
        const auto deviation = sketch.deviation(1e6);
        CHECK(deviation.largest == 12345);
        CHECK(deviation.robust == 0);
        for (const std::size_t run : {5UL, 64UL, 100000UL}) {
          INFO("in runs of " << run);
          CHECK(sketch_of_runs(stamps, run).deviation(1e6).largest == 12345);
        }
      }
}

TEST_CASE("of several stamps that deviate the largest of either side counts") {
  auto stamps = even_stamps(50000, 0, 1000000);
  for (std::size_t i = 0; i < stamps.size(); ++i) stamps[i] += static_cast<std::int64_t>(i % 7) - 3;
  for (const std::size_t at : {101UL, 20001UL, 40001UL}) stamps[at] -= 1000 + static_cast<int>(at);
  for (const std::size_t at : {111UL, 20011UL, 40011UL}) stamps[at] += 900 + static_cast<int>(at);
  const auto deviation = sketch_of(stamps).deviation(1e6);
  CHECK(deviation.largest == Approx(41001).margin(4));
  CHECK(deviation.robust == Approx(1.4826 * 2).margin(1.5));
}

TEST_CASE("the line through stamps is that of least squares") {
  CHECK(StampSketch().interval_ns() == 0);
  CHECK(StampSketch().line_ns() == 0);
  CHECK(sketch_of({5}).line_ns() == 0);
  CHECK(sketch_of({5, 25}).line_ns() == 20);
  // 0, 1, 5 at 0, 1, 2: slope (5 - 0) / 2; of 0, 0, 3, 3: 1.2.
  CHECK(sketch_of({0, 1, 5}).line_ns() == 2.5);
  CHECK(sketch_of({100, 100, 103, 103}).line_ns() == Approx(1.2).epsilon(1e-15));
  CHECK(sketch_of({7, 17}).deviation(10).largest == 0);
}
