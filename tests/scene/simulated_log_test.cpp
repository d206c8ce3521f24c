#include <catch2/catch.hpp>
#include <filesystem>

#include "libchar/core/error.hpp"
#include "libchar/log/read.hpp"
#include "libchar/scene/scene_file.hpp"
#include "libchar/scene/simulated_scene.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;
using Catch::Contains;

namespace {

ArraySimulation one_sensor() {
  ArraySimulation simulation;
  simulation.rate_hz = 100;
  simulation.samples = 300;
  simulation.sensors.resize(1);
  simulation.sensors[0].name = "gyro";
  Coefficient& white = simulation.sensors[0].model.noise[0];
  white.status = Status::given;
  white.value = 0.01;
  return simulation;
}

}  // namespace

TEST_CASE("a simulated log is written with the scene that replays it") {
  const test::TemporaryFolder folder;
  const SimulatedRecording recording{(folder / "a.csv").string(), (folder / "a.scene.yaml").string(), {}};
  const SimulatedLog written = simulate_log(one_sensor(), recording);
  CHECK(written.files == std::vector<std::string>{recording.file, recording.scene_file});
  CHECK(written.channels == 2);
  CHECK(written.draws.size() == 1);
  CHECK(read_recording(recording.file).samples[0].size() == 300);
  const Scene scene = read_scene_file(recording.scene_file);
  REQUIRE(scene.sensors.size() == 1);
  CHECK(scene.sensors[0].name == "gyro");
  REQUIRE(scene.simulated);
  CHECK(scene.simulated->simulation->samples == 300);
}

TEST_CASE("a simulated log without a scene file is alone") {
  const test::TemporaryFolder folder;
  const SimulatedLog written = simulate_log(one_sensor(), {(folder / "a.npy").string(), "", {}});
  CHECK(written.files == std::vector<std::string>{(folder / "a.npy").string()});
}

TEST_CASE("a simulated log leaves nothing behind where its scene cannot be written") {
  const test::TemporaryFolder folder;
  const SimulatedRecording recording{(folder / "a.csv").string(), (folder / "no/a.scene.yaml").string(), {}};
  CHECK_THROWS_AS(simulate_log(one_sensor(), recording), Error);
  CHECK(std::filesystem::is_empty(folder / ""));
}

TEST_CASE("a simulated log has one column of each name") {
  const test::TemporaryFolder folder;
  ArraySimulation simulation = one_sensor();
  simulation.temperature = SignalSpec{};
  simulation.sensors[0].name = "temperature";
  CHECK_THROWS_WITH(simulate_log(simulation, {(folder / "a.csv").string(), "", {}}),
                    Contains("the name of the temperature column"));
}

TEST_CASE("faults after the end are counted") {
  ArraySimulation simulation = one_sensor();
  simulation.faults.resize(2);
  simulation.faults[0].from_s = 1;
  simulation.faults[1].from_s = 3;
  REQUIRE(late_faults(simulation).find("fault_after_end") != nullptr);
  CHECK(late_faults(simulation).find("fault_after_end")->count == 1);
}
