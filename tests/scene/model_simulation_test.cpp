#include <catch2/catch.hpp>
#include <fstream>

#include "libchar/core/error.hpp"
#include "libchar/scene/scene_file.hpp"
#include "libchar/scene/simulated_scene.hpp"
#include "tests/support/run.hpp"

using namespace libchar;
using Catch::Contains;

namespace {

struct ModelFolder {
  test::TemporaryFolder folder;
  std::string file(const std::string& name, const std::string& keys) const {
    const std::string path = (folder / name).string();
    std::ofstream(path) << "version: 1\n" << keys;
    return path;
  }
  std::string model(const std::string& name, const std::string& keys) const {
    return file(name, "format: sensor-model\n" + keys);
  }
};

std::vector<std::string> sensor_names(const ArraySimulation& simulation) {
  std::vector<std::string> names;
  for (const SimulatedSensor& sensor : simulation.sensors) names.push_back(sensor.name);
  return names;
}

}  // namespace

TEST_CASE("sensors of models are named by channel or file, and told apart") {
  const ModelFolder models;
  const std::string named = models.model("a.sensor.yaml", "channel: gyr_x\nrate_hz: 100\n"),
                    nameless = models.model("b.sensor.yaml", "rate_hz: 100\n");
  CHECK(sensor_names(simulation_of_models({named, nameless})) == std::vector<std::string>{"gyr_x", "b"});
  CHECK(sensor_names(simulation_of_models({named, named})) == std::vector<std::string>{"gyr_x", "gyr_x_2"});
  ModelSimulationOptions options;
  options.devices = 3;
  CHECK(sensor_names(simulation_of_models({nameless}, options)) == std::vector<std::string>{"b1", "b2", "b3"});
}

TEST_CASE("models of several rates need one that is said") {
  const ModelFolder models;
  const std::string slow = models.model("a.yaml", "rate_hz: 50\n"), fast = models.model("b.yaml", "rate_hz: 200\n");
  CHECK(simulation_of_models({slow}).rate_hz == 50);
  CHECK_THROWS_WITH(simulation_of_models({slow, fast}),
                    Contains("200 Hz") && Contains("50 Hz") && Contains("`rate_hz`"));
  ModelSimulationOptions options;
  options.rate_hz = 10;
  CHECK(simulation_of_models({slow, fast}, options).rate_hz == 10);
}

TEST_CASE("a scene is told from a model by its format") {
  const ModelFolder models;
  CHECK_FALSE(is_scene_file(models.model("a.yaml", "rate_hz: 50\n")));
  CHECK_FALSE(is_scene_file(models.file("b.yaml", "rate_hz: 50\n")));
  CHECK(is_scene_file(models.file("c.yaml", "format: scene\n")));
}
