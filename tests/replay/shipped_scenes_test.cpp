// Every shipped scene is read, simulated, and is what its README says.
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>

#include "libchar/core/error.hpp"
#include "libchar/scene/scene_file.hpp"
#include "tests/support/shared.hpp"
#include "tests/support/thesis_scenes.hpp"

using namespace libchar;
namespace fs = std::filesystem;

namespace {

std::vector<fs::path> files(const fs::path& folder) {
  std::vector<fs::path> found;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".yaml") found.push_back(entry.path());
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace

TEST_CASE("scenes to simulate are read, said in the README, and give numbers", "[shipped]") {
  const fs::path folder = test::fixture("scenes");
  const std::string readme = test::slurp(folder / "README.md");
  const auto all = files(folder);
  REQUIRE(all.size() >= 6);
  for (const fs::path& path : all) {
    INFO(path.filename().string());
    CHECK(readme.find(path.filename().string()) != std::string::npos);
    Scene scene = read_scene_file(path.string());
    REQUIRE(scene.simulate);
    CHECK(scene.warnings.empty());
    REQUIRE(scene.learning);
    REQUIRE(scene.evaluation);
    CHECK(scene.reference);
    scene.simulate->samples = 500;
    ArraySimulator simulator(*scene.simulate);
    const auto block = simulator.next(500);
    REQUIRE(block.size() == scene.sensors.size() + scene.simulate->truth.size());
    for (const auto& column : block) {
      double square = 0;
      for (const double v : column) square += v * v;
      CHECK(std::isfinite(square));
      CHECK(square > 0);
    }
  }
}

TEST_CASE("noise of the scenes of the source: 608 S and 304 Q^2", "[shipped]") {
  const auto five = test::thesis::simulate("rv-3.3-calibrated.yaml", 11);
  const double s[] = {5e-3, 1e-3, 5e-4, 1e-4, 5e-5};
  for (Eigen::Index i = 0; i < 5; ++i) {
    CHECK(five.array.noise_levels[i] / s[i] == Approx(608.4).epsilon(1e-3));
    const double measured = (five.y.row(i) - five.x).squaredNorm() / 1e5 / s[i];
    CHECK(measured == Approx(623).epsilon(0.05));  // with the flicker's slow part
  }
  CHECK(five.x.squaredNorm() / 1e5 == Approx(5.78).epsilon(0.03));
  const auto six = test::thesis::simulate("rv-5.1-fault-free.yaml", 11);
  for (Eigen::Index i = 0; i < 6; ++i) {
    const double q = (3 + static_cast<double>(i)) * 1e-3;
    CHECK(six.array.noise_levels[i] / q / q == Approx(304.2).epsilon(0.002));
    CHECK((six.y.row(i) - six.x).squaredNorm() / 2e5 / q / q == Approx(304.2).epsilon(0.03));
  }
}

// Else the models' held noise would be taken for three times as loud in the log as in the scene.
TEST_CASE("a simulated recording keeps its oversampling", "[shipped]") {
  Scene scene = read_scene_file((test::fixture("scenes") / "rv-5.1-fault-free.yaml").string());
  scene.recording = (test::fixture("imu_at_rest.csv")).string();
  scene.file = (test::fixture("") / "written.scene.yaml").string();
  scene.simulated.emplace().seed = 7;
  scene.simulated->oversampling = scene.simulate->oversampling;
  scene.simulate.reset();
  const Scene again = parse_scene(scene_yaml(scene), scene.file);
  REQUIRE(again.simulated);
  CHECK(again.simulated->oversampling == 5);
  std::string text = scene_yaml(scene);
  text.replace(text.find("oversampling: 5"), 15, "oversampling: 0");
  CHECK_THROWS_AS(parse_scene(text, scene.file), Error);
}

TEST_CASE("tilt and lever arm say what they must", "[shipped]") {
  const Scene tilt = read_scene_file((test::fixture("scenes") / "rv-2.5-tilt.yaml").string());
  REQUIRE(tilt.tilt);
  CHECK(tilt.sensors[tilt.tilt->gyroscope].name == "gyro");
  const Scene arm = read_scene_file((test::fixture("scenes") / "lever-arm.yaml").string());
  CHECK(arm.sensors.size() >= 6);
  for (const SceneSensor& sensor : arm.sensors) CHECK(sensor.h.size() == 2);
}
