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

TEST_CASE("in a longer log two rounded stamps may be up to two ticks apart from one line") {
  // The same clock, and now and then a step of 5 comes early and the next one late: 1.6 ticks from end to end.
  const auto found = [](int groups) {
    std::vector<std::int64_t> stamps{0};
    for (int g = 0; g < groups; ++g)
      for (int i = 0; i < 5; ++i)
        stamps.push_back(stamps.back() + (i == (2 * g >= groups && 2 * g < groups + 2 ? 0 : 4)
                                              ? 5000000
                                              : 4000000));
    return first_interval(stamps).ns;
  };
  CHECK(found(16) == Approx(4.2e6).epsilon(0.002));  // sixteen odd steps
  CHECK(found(10) == 4e6);  // too short to tell it from steps of 4 and gaps
}
