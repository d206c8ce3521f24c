#include "libchar/log/time/clock_breaks.hpp"

#include <catch2/catch.hpp>

using namespace libchar;

namespace {

constexpr std::int64_t kUs = 1000, kS = 1000000000;

TimeBase clock_in(std::int64_t unit_ns, bool local = false) {
  TimeBase clock;
  clock.unit_ns = unit_ns;
  clock.local = local;
  return clock;
}

std::int64_t wrap(std::int64_t before, std::int64_t stamp, const TimeBase& clock, double dt) {
  const auto found = find_wrap(before, stamp, clock, dt);
  return found ? found->range_ns : 0;
}

}  // namespace

TEST_CASE("a step back is a rollover only at the end of a counter's range") {
  const TimeBase us = clock_in(kUs);
  const std::int64_t range = 65536 * kUs, longer = range * 65536;
  const double dt = 10.0 * kUs;
  CHECK(wrap(range - 5 * kUs, 5 * kUs, us, dt) == range);
  CHECK(wrap(longer - 5 * kUs, 5 * kUs, us, dt) == longer);
  CHECK(wrap(longer / 2 - 5 * kUs, -longer / 2 + 5 * kUs, us, dt) == longer);  // signed
  CHECK(wrap(longer - 5 * kUs, 5 * kUs, clock_in(kS), dt) == longer);          // in seconds
  CHECK(wrap(range / 2, 5 * kUs, us, dt) == 0);
  CHECK(wrap(range - 5 * kUs, -5 * kUs, us, dt) == 0);
  CHECK(wrap(range - 5 * kUs, 5 * kUs, us, 0.2 * kUs) == 0);  // more than 20 steps
  CHECK(wrap(longer - 5 * kUs, 5 * kUs, us, 1.0) == 0);       // more than 1000
  // 24 bits; a log that ends after 16 s and begins again is no such clock, nor is one of 60 s in ms.
  const std::int64_t bytes = std::int64_t{16777216} * kUs;
  CHECK(wrap(bytes - 5 * kUs, 5 * kUs, us, dt) == bytes);
  CHECK(wrap(16 * kS, 0, us, 0.01 * kS) == 0);
  CHECK(wrap(60 * kS, 0, clock_in(1000 * kUs), 0.01 * kS) == 0);
}

TEST_CASE("seconds of a day, of a week and hours of local time begin again") {
  const TimeBase s = clock_in(kS), local = clock_in(1, true);
  const double dt = 1.0 * kS;
  CHECK(wrap(86399 * kS, 0, s, dt) == 86400 * kS);
  CHECK(wrap(604799 * kS, 0, s, dt) == 604800 * kS);
  CHECK(wrap(3599 * kS, 0, s, dt) == 3600 * kS);
  CHECK(wrap(3000 * kS, 0, s, dt) == 0);
  const std::int64_t autumn = 1729994400 * kS;  // 2024-10-27 02:00
  CHECK(wrap(autumn + 3599 * kS, autumn, local, dt) == 3600 * kS);
  CHECK(wrap(autumn + 3599 * kS, autumn, clock_in(1), dt) == 0);
  const std::int64_t spring = 1711850400 * kS;  // 2024-03-31 02:00
  CHECK(skipped_hour(spring - kS, spring + 3600 * kS, local, dt) == 3600 * kS);
  CHECK(skipped_hour(spring - kS, spring + 3600 * kS, clock_in(1), dt) == 0);
  CHECK(skipped_hour(spring - kS, spring + 3700 * kS, local, dt) == 0);
  CHECK(skipped_hour(spring + 86399 * kS, spring + 90000 * kS, local, dt) == 0);  // a Monday
}

TEST_CASE("first rows of another run are no rows of this one") {
  std::vector<std::int64_t> stamps = {93877 * kS, 93878 * kS, 93879 * kS};
  for (int i = 0; i < 100; ++i) stamps.push_back((13000 + i) * kS);
  CHECK(wild_start(stamps, clock_in(kS)) == 3);
  stamps.erase(stamps.begin(), stamps.begin() + 3);
  CHECK(wild_start(stamps, clock_in(kS)) == 0);
  for (int i = 0; i < 6; ++i) stamps.insert(stamps.begin(), (12990 - 1000 * i) * kS);  // a slow start
  CHECK(wild_start(stamps, clock_in(kS)) == 0);
}

TEST_CASE("a lone first row further away than the log is long is no row of it") {
  std::vector<std::int64_t> stamps = {5 * kS};
  for (int i = 0; i < 200; ++i) stamps.push_back((405 + i) * kS);
  CHECK(wild_start(stamps, clock_in(kS), stamps.size()) == 1);
  CHECK(wild_start(stamps, clock_in(kS), 1000) == 0);  // a pause of 400 s in a log of 1000
  CHECK(wild_start(stamps, clock_in(kS)) == 0);        // nobody knows how long it is
  stamps.insert(stamps.begin() + 1, 6 * kS);
  CHECK(wild_start(stamps, clock_in(kS), stamps.size()) == 0);  // two rows are a beginning
}

TEST_CASE("a first zero is no stamp where the next one is far away") {
  std::vector<std::int64_t> stamps = {0};
  for (int i = 0; i < 100; ++i) stamps.push_back((1700 + i) * kS);
  CHECK(wild_start(stamps, clock_in(kS)) == 1);
  stamps[0] = 1600 * kS;
  CHECK(wild_start(stamps, clock_in(kS)) == 0);
}
