#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "libchar/report/text/characterization_text.hpp"

using namespace libchar;
using Catch::Contains;

namespace {

ArraySimulation two_sensors() {
  ArraySimulation simulation;
  simulation.rate_hz = 200;
  simulation.samples = 500;
  simulation.seed = 7;
  simulation.sensors.resize(2);
  simulation.sensors[0].name = "plain";
  simulation.sensors[1].name = "spread";
  simulation.sensors[1].model.unit = "deg/s";
  simulation.sensors[1].model.bias.spread = 0.1;
  return simulation;
}

}  // namespace

TEST_CASE("a simulation in text: length, the draws of models that spread, the other files") {
  const ArraySimulation simulation = two_sensors();
  const std::string text = simulation_text(simulation, {{{1, 0}, {1.5, -0.25}}, {"o.csv", "o.scene.yaml"}, 3});
  CHECK(text ==
        "o.csv: 500 samples of 3 channels at 200 Hz, 2.5 s, seed 7\n"
        "  spread: drew scale factor 1.5, bias -0.25 deg/s\n"
        "wrote o.scene.yaml\n");
  CHECK_THAT(simulation_text(simulation, {{{1, 0}, {1.5, -0.25}}, {"o.csv"}, 1}),
             Contains("of 1 channel at") && !Contains("wrote"));
}

TEST_CASE("a simulation in JSON has every sensor with what it drew") {
  const ArraySimulation simulation = two_sensors();
  const Json json = simulation_json(simulation, {{{1, 0}, {1.5, -0.25}}, {"o.csv"}, 3});
  CHECK(json["samples"] == 500);
  CHECK(json["seed"] == 7);
  CHECK(json["output"] == Json::array({"o.csv"}));
  REQUIRE(json["sensors"].size() == 2);
  CHECK(json["sensors"][1]["name"] == "spread");
  CHECK(json["sensors"][1]["unit"] == "deg/s");
  CHECK(json["sensors"][1]["scale_factor"] == 1.5);
  CHECK(json["sensors"][1]["bias"] == -0.25);
  CHECK(json["truth"] == Json::array({"truth"}));
}
