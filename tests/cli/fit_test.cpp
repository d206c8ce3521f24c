#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "libchar/core/json.hpp"
#include "libchar/core/text.hpp"
#include "tests/support/noise.hpp"
#include "tests/support/run.hpp"

using namespace libchar;

TEST_CASE("fit LOG gives the coefficients as a table and as JSON") {
  const test::TemporaryFolder folder;
  const std::string path = (folder / "log.csv").string();
  test::NoiseSource source(20000, 100, 3);
  std::string text = "gx[deg/s]\n";
  for (const double y : source.record(1e-2, 0, 0)) text += shortest(y) + "\n";
  std::ofstream(path) << text;
  const auto json = test::run({"fit", path, "--rate", "100", "--json"});
  REQUIRE(json.code == 0);
  const Json document = parse_json(json.out, "stdout");
  CHECK(document["format"] == "noise-fit");
  CHECK(document["channels"][0]["name"] == "gx");
  CHECK(document["channels"][0]["white_noise"]["value"].get<double>() ==
        Approx(1e-2).epsilon(0.03));
  CHECK(document["channels"][0]["random_walk"]["value"].is_null());
  const auto table = test::run({"fit", path, "--rate", "100"});
  CHECK(table.code == 0);
  CHECK(table.out.find("deg/√h") != std::string::npos);
}

TEST_CASE("fit CURVE --curve allan") {
  const test::TemporaryFolder folder;
  const std::string path = (folder / "curve.csv").string();
  std::string text = "tau_s,adev\n";
  for (double tau = 0.01; tau < 1e4; tau *= 2) {
    text += shortest(tau) + "," + shortest(std::sqrt(25e-6 / tau + 1e-8 * tau / 3)) + "\n";
  }
  std::ofstream(path) << text;
  const auto json = test::run({"fit", path, "--curve", "allan", "--json"});
  REQUIRE(json.code == 0);
  const Json channel = parse_json(json.out, "stdout")["channels"][0];
  CHECK(channel["white_noise"]["value"].get<double>() == Approx(5e-3).epsilon(1e-8));
  CHECK(channel["random_walk"]["value"].get<double>() == Approx(1e-4).epsilon(1e-8));
  CHECK(channel["bias_instability"]["value"].is_null());
}
