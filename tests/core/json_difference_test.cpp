// Where two documents differ.

#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "libchar/core/document/json.hpp"

using namespace libchar;

TEST_CASE("differences: place, both values, and digits of numbers") {
  const Json was = {{"a", 1.0}, {"b", {1, 2, 3}}, {"c", "x"}, {"t", {{"measured", 1}, {"d", 2}}}};
  CHECK(json_differences(was, was).empty());
  Json now = was;
  now["a"] = 1.0 + 1e-9;
  now["b"][1] = 4;
  now["c"] = "y";
  now["t"]["measured"] = 2;
  now["t"].erase("d");
  now["new"] = true;
  const auto found = json_differences(was, now, {"measured"});
  REQUIRE(found.size() == 5);
  CHECK(found[0].at == "/a");
  CHECK(found[0].relative == Approx(1e-9).epsilon(1e-6));
  CHECK(found[1].at == "/b/1");
  CHECK(found[1].relative == 0.5);
  CHECK(found[2].was == "\"x\"");
  CHECK(found[2].now == "\"y\"");
  CHECK(std::isinf(found[2].relative));
  CHECK(found[3].at == "/t/d");
  CHECK(found[3].now == "nothing");
  CHECK(found[4].at == "/new");
  CHECK(json_differences(was, now).size() == 6);
}

TEST_CASE("differences: lists of other lengths and values of other kinds are one difference each") {
  CHECK(json_differences({{"a", {1, 2}}}, {{"a", {1, 2, 3}}}).size() == 1);
  CHECK(json_differences({{"a", nullptr}}, {{"a", 1}}).size() == 1);
  CHECK(json_differences({{"a", 0.0}}, {{"a", 1e-300}})[0].relative == 1);
}
