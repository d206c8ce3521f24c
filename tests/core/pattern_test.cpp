#include "libchar/core/text/pattern.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <string>
#include <vector>

using namespace libchar;

TEST_CASE("patterns: stars and question marks, all else for itself") {
  CHECK(matches("gyro*", "gyro"));
  CHECK(matches("gyro*", "gyro_10"));
  CHECK(matches("*", ""));
  CHECK(matches("*x*y*", "axbyc"));
  CHECK(matches("imu?_gz", "imu7_gz"));
  CHECK(matches("a*b*c", "abbbbcbc"));
  CHECK(matches("**", "a"));
  CHECK_FALSE(matches("imu?_gz", "imu10_gz"));
  CHECK_FALSE(matches("gyro*", "Gyro1"));
  CHECK_FALSE(matches("gyro*", "a gyro"));
  CHECK_FALSE(matches("?", ""));
  CHECK_FALSE(matches("a[12]", "a1"));
  CHECK(matches("a[12]", "a[12]"));
  CHECK(matches("a.b", "a.b"));
  CHECK_FALSE(matches("a.b", "acb"));
  // One character, however many bytes; of broken text one byte.
  CHECK(matches("?m", "µm"));
  CHECK_FALSE(matches("??m", "µm"));
  CHECK(matches("?m", "\xffm"));
  CHECK(is_pattern("a*"));
  CHECK(is_pattern("?"));
  CHECK_FALSE(is_pattern("a.[b]+"));
}

TEST_CASE("patterns: many stars cost no exponential time") {
  std::string pattern;
  for (int i = 0; i < 60; ++i) pattern += "a*";
  CHECK_FALSE(matches(pattern + "b", std::string(5000, 'a')));
}

TEST_CASE("patterns: names in the order in which people count") {
  std::vector<std::string> names = {"gyro10", "gyro2",    "gyro1",   "gyro",    "acc3",
                                    "gyro02", "imu2_x10", "imu2_x9", "imu10_x1"};
  std::sort(names.begin(), names.end(), comes_before);
  CHECK(names == std::vector<std::string>{"acc3", "gyro", "gyro1", "gyro02", "gyro2", "gyro10", "imu2_x9", "imu2_x10",
                                          "imu10_x1"});
  // A strict order, long numbers too.
  CHECK_FALSE(comes_before("a1", "a1"));
  CHECK(comes_before("a99999999999999999999998", "a99999999999999999999999"));
}
