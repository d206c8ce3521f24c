#include "libchar/core/numeric/whole.hpp"

#include <catch2/catch.hpp>
#include <cstdint>
#include <limits>

using libchar::clamped_whole;

TEST_CASE("a number beyond a whole type is the nearer end of its range", "[core]") {
  constexpr double kInf = std::numeric_limits<double>::infinity(), kNan = std::numeric_limits<double>::quiet_NaN();
  CHECK(clamped_whole<int>(2.9) == 2);
  CHECK(clamped_whole<int>(-2.9) == -2);
  CHECK(clamped_whole<std::size_t>(-1.0) == 0);
  CHECK(clamped_whole<int>(1e302) == std::numeric_limits<int>::max());
  CHECK(clamped_whole<std::int64_t>(kInf) == std::numeric_limits<std::int64_t>::max());
  CHECK(clamped_whole<std::int64_t>(-kInf) == std::numeric_limits<std::int64_t>::min());
  CHECK(clamped_whole<std::uint64_t>(0x1p64) == std::numeric_limits<std::uint64_t>::max());
  CHECK(clamped_whole<std::int64_t>(kNan) == 0);
  CHECK(clamped_whole(kNan, 3, 7) == 3);
  CHECK(clamped_whole(kNan, -7, -3) == -3);
  CHECK(clamped_whole(5.5, 3, 7) == 5);
  CHECK(clamped_whole(0.0, 3, 7) == 3);
}
