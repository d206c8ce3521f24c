#include "libchar/log/time/time_repairs.hpp"

#include <catch2/catch.hpp>

#include "libchar/log/time/stamp_model.hpp"

using namespace libchar;

TEST_CASE("of a gap, what lies in the window counts") {
  const double dt = 10;
  const auto stretch = [&](std::int64_t from, std::int64_t to) {
    const GridStretch inside = gap_in_window(5, 100, dt, from, to);  // points at 110 … 150
    return std::vector<std::int64_t>{inside.first, inside.last, static_cast<std::int64_t>(inside.count())};
  };
  CHECK(stretch(0, INT64_MAX) == std::vector<std::int64_t>{1, 5, 5});
  CHECK(stretch(125, INT64_MAX) == std::vector<std::int64_t>{3, 5, 3});
  CHECK(stretch(130, INT64_MAX) == std::vector<std::int64_t>{3, 5, 3});
  CHECK(stretch(0, 130) == std::vector<std::int64_t>{1, 2, 2});
  CHECK(stretch(0, 131) == std::vector<std::int64_t>{1, 3, 3});
  CHECK(stretch(500, INT64_MAX)[2] == 0);
}

TEST_CASE("a row that is late alone is no gap, rows that are late together are") {
  CHECK(common_lag({7}) == 7);
  CHECK(common_lag({7, 0, 0, 0, 0, 0, 0, 0}) == 0);
  CHECK(common_lag({7, 7, 7, 7.4, 6.6, 7, 7, 7}) == 7);
  CHECK(common_lag({2, 7, 7, 7, 7, 7, 7, 7}) == 2);  // never later than the row itself
}
