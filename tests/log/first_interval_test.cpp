#include "libchar/log/time/first_interval.hpp"

#include <catch2/catch.hpp>

using namespace libchar;

TEST_CASE("stamps that rise at all have an interval, however many are equal") {
  std::vector<std::int64_t> stamps(16, 0);
  for (const std::int64_t later : {1000, 2000, 3000, 4000}) stamps.push_back(later);
  const FirstInterval found = first_interval(stamps);
  CHECK(found.ns == 1000);
  CHECK(found.longest_step >= found.ns);
  CHECK(found.pattern == StampPattern::equal);
}

TEST_CASE("of a short log on a coarse clock the interval is that of rows over time") {
  // 4.2 ticks: steps of 4 and, one in five, of 5.
  std::vector<std::int64_t> stamps{0};
  for (int i = 0; i < 40; ++i) stamps.push_back(stamps.back() + (i % 5 == 4 ? 5000000 : 4000000));
  const FirstInterval found = first_interval(stamps);
  CHECK(found.ns == Approx(4.2e6).epsilon(0.002));
  CHECK(found.step_ns == 4e6);
  CHECK(found.longest_step > 5e6);
}
