#include "libchar/core/document/json.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>

#include "libchar/core/error.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;

namespace {

std::string json_refusal(const std::string& text) {
  try {
    parse_json(text, "f.json");
  } catch (const Error& error) {
    CHECK(error.problem().kind == ErrorKind::input);
    CHECK(std::string(error.what()).find('\n') == std::string::npos);
    return error.problem().where + " " + error.what();
  }
  return "accepted";
}

bool starts(const std::string& text, const std::string& front) { return text.rfind(front, 0) == 0; }

}  // namespace

TEST_CASE("JSON that is right is read, in order, with and without a byte order mark") {
  const Json j =
      parse_json("\xEF\xBB\xBF{\"b\": [1, -2, 0.5, 1e-400, true, null], \"a\": {\"a\": \"\\u00b0\"}}\n", "f");
  CHECK(j.begin().key() == "b");
  CHECK(j["b"][2] == 0.5);
  CHECK(j["b"][3] == 0.0);
  CHECK(j["a"]["a"] == "°");
  CHECK(parse_json("18446744073709551615", "f").get<std::uint64_t>() == 18446744073709551615U);
  CHECK(parse_json(std::string(64, '[') + std::string(64, ']'), "f").is_array());
}

TEST_CASE("JSON that readers usually let through is refused with its place") {
  CHECK(starts(json_refusal("{\"a\":1,\"a\":2}"), "f.json:1:8"));
  CHECK(starts(json_refusal("{\"a\":{\"b\":1},\n \"a\":2}"), "f.json:2:"));
  CHECK(json_refusal("{\"a\":{\"b\":1},\"c\":{\"b\":1}}") == "accepted");  // the same key in two objects is fine
  CHECK(starts(json_refusal("{\"N\":1e400}"), "f.json:1:6"));
  CHECK(starts(json_refusal("[-1e400]"), "f.json:1:2"));
  CHECK(starts(json_refusal("1e400"), "f.json:1:1"));
  CHECK(starts(json_refusal("\n 1e400"), "f.json:2:2"));
  CHECK(json_refusal("{\"n\":18446744073709551616}") !=
        "accepted");  // no integer type holds it: it would become a double
  CHECK(json_refusal("[-9223372036854775809]") != "accepted");
  CHECK(starts(json_refusal("[NaN]"), "f.json:1:2"));
  CHECK(starts(json_refusal("[Infinity]"), "f.json:1:2"));
  CHECK(starts(json_refusal("{\"version\":1} x"), "f.json:1:15"));
  CHECK(starts(json_refusal("{\"version\":1} // c"), "f.json:1:15"));
  CHECK(starts(json_refusal("[1,]"), "f.json:1:4"));
  CHECK(starts(json_refusal("{\"version\":"), "f.json:1:"));
  CHECK(starts(json_refusal("{\n\"a\": \"\xff\"}"), "f.json:2:7 (byte 8)"));
  CHECK(starts(json_refusal("\xEF\xBB\xBF[1,]"),
               "f.json:1:4 (byte 6)"));  // columns as an editor counts them, bytes of the file
  CHECK(json_refusal("[\"\\ud800\"]") != "accepted");
  CHECK(json_refusal("") != "accepted");
  CHECK(json_refusal(" \n\t") != "accepted");
  CHECK(json_refusal("\xEF\xBB\xBF") != "accepted");
  CHECK(json_refusal("{\"a\":01}") != "accepted");
  CHECK(json_refusal("{'a':1}") != "accepted");
}

TEST_CASE("depth and size have limits") {
  CHECK(json_refusal(std::string(65, '[') + std::string(65, ']')).find("deeper than 64") != std::string::npos);
  CHECK(json_refusal(std::string(100'000, '[')).find("deeper than 64") != std::string::npos);
  CHECK(json_refusal("\"" + std::string(std::size_t{17} << 20U, 'a') + "\"").find("limit") != std::string::npos);
}

TEST_CASE("the bad JSON files end as their table says") {
  for (const char* name : {"002_dup", "003_1e400", "004_NaN", "005_u64", "006_bad_utf8", "007_lone_surrogate",
                           "008_trailing", "009_comment", "010_trunc"}) {
    CAPTURE(name);
    CHECK(json_refusal(test::slurp(test::known(std::string("badinputs/json/") + name + ".json"))) != "accepted");
  }
  for (const char* name : {"000_control", "011_bom"})
    CHECK(json_refusal(test::slurp(test::known(std::string("badinputs/json/") + name + ".json"))) == "accepted");
}

TEST_CASE("documents are written so that they read back to the same bits") {
  Json j = {
      {"x", 0.1}, {"tiny", 5e-324}, {"big", 1.7976931348623157e308}, {"list", {1.0 / 3, -0.0, 123456789012345678}}};
  const std::string text = dump_json(j);
  CHECK(text.back() == '\n');
  CHECK(parse_json(text, "f") == j);
  CHECK(std::signbit(parse_json(text, "f")["list"][1].get<double>()));
  CHECK_THROWS(dump_json(Json{{"x", {std::numeric_limits<double>::quiet_NaN()}}}));
  CHECK_THROWS(dump_json(Json{{"x", std::numeric_limits<double>::infinity()}}));
}

TEST_CASE("strings that are not UTF-8 are written escaped, also as keys, and nothing else is touched") {
  Json j;
  j["bad"] = {"\xB0 deg", "° fine\n"};
  j["k\xFF"] = 1;
  const Json back = parse_json(dump_json(j), "f");
  CHECK(back["bad"][0] == "\\xB0 deg");
  CHECK(back["bad"][1] == "° fine\n");
  CHECK(back["k\\xFF"] == 1);
}

TEST_CASE("one string that is not UTF-8 is found wherever it stands, and no other is touched") {
  const std::string fine = "\"°\" \\ \n";
  for (const Json& j : {Json(Json::array({fine, Json::array({1, "\xB0"})})), Json{{"a", {{"b", fine}, {"c", "\xB0"}}}},
                        Json::array({Json{{"a", 1}, {"\xB0", fine}}}), Json("\xB0")}) {
    const std::string text = dump_json(j);
    CHECK_THAT(text, Catch::Contains("\\\\xB0"));
    CHECK_THAT(text, !Catch::Contains("\xEF\xBF\xBD"));
    const Json back = parse_json(text, "f");
    if (text.find("°") != std::string::npos) CHECK_THAT(back.dump(), Catch::Contains("\\\"°\\\""));
  }
  CHECK_THROWS(dump_json(Json{{"a", {{"b", {std::nan("")}}}}}));
}

TEST_CASE("JSON that nobody vouches for is read in linear time: as it stands, or the members asked for") {
  const Json read =
      detail::parse_loose_json(R"({"a": [1, -2, 2.5, "x", null, true, {"b": {}}], "c": {"a": []}, "d": 3})");
  CHECK(read == Json::parse(R"({"a": [1, -2, 2.5, "x", null, true, {"b": {}}], "c": {"a": []}, "d": 3})"));
  CHECK(detail::parse_loose_json(R"({"a": {"c": 1, "d": [2]}, "c": 1, "d": {"a": [{}]}, "e": [{}]})", {"c", "d"}) ==
        Json::parse(R"({"c": 1, "d": {"a": [{}]}})"));
  CHECK(detail::parse_loose_json("[1, [2]]", {"c"}) == Json::parse("[1, [2]]"));
  for (const char* bad : {"", "{", "{} 1", "[1,]", "{\"a\": }", "nan"}) {
    CAPTURE(bad);
    CHECK(detail::parse_loose_json(bad).is_discarded());
  }
  CHECK(detail::parse_loose_json(std::string(1'000'000, '[')).is_discarded());
  // By comparing each key with all before it this would take minutes.
  std::string keys = "{\"k\": 1";
  for (int k = 0; k < 400'000; ++k) keys += ", \"k" + std::to_string(k) + "\": 1";
  CHECK(detail::parse_loose_json(keys + "}").size() == 400'001);
  CHECK(parse_json(keys + "}", "f.json").size() == 400'001);
}
