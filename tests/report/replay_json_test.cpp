#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "libchar/fusion/registry.hpp"
#include "libchar/report/replay/replay_text.hpp"
#include "tests/report/synthetic_replay.hpp"

using namespace libchar;
using Catch::Contains;

TEST_CASE("replay json: the keys that scripts rely on") {
  const ReplayResult r = test::synthetic_replay();
  const Json j = replay_json(r);
  CHECK(j["format"] == "replay-report");
  CHECK(j["version"] == 1);
  CHECK(j["optimum_rmse"] == 0.033);
  CHECK(j["input"][0]["sha256"] == r.logs[0].sha256);
  REQUIRE(j["sensors"].size() == 5);
  CHECK(j["sensors"][2]["name"] == "gyr_2");
  CHECK(j["sensors"][2]["rmse"] == r.sensors[2].error.rmse);
  REQUIRE(j["algorithms"].size() == fusion::algorithms().size());
  const Json& a = j["algorithms"][0];
  CHECK(a["name"] == "mean");
  CHECK(a["status"] == "ran");
  CHECK(a["rmse"] == r.algorithms[0].rmse);
  CHECK(a["ns_per_sample"] == 3.0);
  CHECK(a["peak_bytes"] == 200);
  // One input: a flat list.
  REQUIRE(a["weights"].size() == 5);
  CHECK(a["weights"][0] == 0.2);
  CHECK(a["faults"][0]["sensor"] == "gyr_1");
  CHECK(a["faults"][0]["from_s"] == 40.02);
  CHECK(a["faults"][1]["to_s"].is_null());
  CHECK(a["answers"][1]["found_after_s"].is_null());
  CHECK(j["faults"][2]["to_s"].is_null());
  const auto skips = std::find_if(r.algorithms.begin(), r.algorithms.end(), [](const auto& one) { return !one.ran; });
  REQUIRE(skips != r.algorithms.end());
  const Json& skipped = j["algorithms"][skips - r.algorithms.begin()];
  CHECK(skipped["status"] == "skipped");
  CHECK_THAT(skipped["why"].get<std::string>(), Contains("needs one gyroscope axis"));
  CHECK(skipped["rmse"].is_null());
}

TEST_CASE("replay json: several inputs give weights a row a sensor") {
  const Json j = replay_json(test::synthetic_replay(6, 2));
  const Json& a = j["algorithms"][0];
  REQUIRE(a["weights"].size() == 6);
  CHECK(a["weights"][0].size() == 2);
  CHECK(a["inputs"].size() == 2);
  CHECK(a["inputs"][1]["name"] == "axis_1");
}

TEST_CASE("replay json: without a reference no figure is called RMSE") {
  const Json j = replay_json(test::without_reference());
  CHECK(j["score"] == "predictive_rms");
  CHECK(j["reference"].is_null());
  const Json& a = j["algorithms"][0];
  CHECK(a["rmse"].is_null());
  CHECK(a["without_reference"]["leave_one_out_rms"].get<double>() > 0);
  CHECK(a["without_reference"]["predictive_rms"].get<double>() > 0);
  CHECK(a["without_reference"]["leave_one_out"][1].is_null());
  CHECK(a["without_reference"]["split_array_rms"].get<double>() > 0);
}

TEST_CASE("replay json: what is no number is null, whatever the scene calls itself") {
  for (const char* kind : {"plain", "nothing", "blind", "hostile", "inputs"}) {
    INFO(kind);
    const std::string text = dump_json(replay_json(test::synthetic_replay_of_kind(kind)));
    CHECK_NOTHROW(parse_json(text, kind));
  }
  const Json j = replay_json(test::nothing_scored());
  CHECK(j["best"].is_null());
  CHECK(j["algorithms"][0]["rmse"].is_null());
  CHECK(j["algorithms"][0]["peak_bytes"].is_null());
}

TEST_CASE("replay json: what is written reads back to the same document") {
  for (const char* kind : {"plain", "nothing", "hostile", "inputs"}) {
    INFO(kind);
    const std::string text = dump_json(replay_json(test::synthetic_replay_of_kind(kind)));
    Json written = parse_json(text, kind);
    Json again = document_of(ReplayReport::fields(), parse_replay_report(text, kind));
    for (Json* document : {&written, &again})
      for (Json& algorithm : (*document)["algorithms"]) algorithm.erase("remarks");
    for (const auto& [key, value] : again.items()) {
      INFO(key);
      CHECK(value.dump() == written[key].dump());
    }
  }
}
