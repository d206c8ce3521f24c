// The scene that simulate writes beside a log makes the log again.
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>

#include "tests/support/places.hpp"
#include "tests/support/run.hpp"

using Catch::Contains;
namespace fs = std::filesystem;

namespace {

// What it simulates with which words; the log is deleted and made again from the scene beside it.
void same_again(const std::string& source, const std::string& log, std::vector<std::string> words) {
  INFO(source << " " << log);
  const test::TemporaryFolder folder;
  const std::string path = (folder / log).string();
  const std::string scene = fs::path(path).replace_extension("").string() + ".scene.yaml";
  words.insert(words.begin(), {"simulate", source, "-o", path});
  const auto made = test::run(words);
  INFO(made.err);
  REQUIRE(made.code == 0);
  const std::string bytes = test::slurp(path), text = test::slurp(scene);
  CHECK_THAT(text, Contains("command: [\"simulate\""));
  fs::remove(path);
  const auto again = test::run({"simulate", scene});
  INFO(again.err);
  REQUIRE(again.code == 0);
  CHECK(test::slurp(path) == bytes);
  CHECK(test::slurp(scene) == text);
  // It is not overwritten unless that is asked for; elsewhere it is a log of its own.
  CHECK(test::run({"simulate", scene}).code == 5);
  const std::string other = (folder / "other.csv").string();
  REQUIRE(test::run({"simulate", scene, "-o", other, "--seed", "77", "--no-scene"}).code == 0);
  CHECK(test::slurp(other) != bytes);
}

}  // namespace

TEST_CASE("simulate: seed, faults and true inputs are in the scene, which makes the log again") {
  const std::string scenes = (test::fixtures_folder() / "scenes").string() + "/";
  same_again(scenes + "rv-2.5-tilt.yaml", "tilt.csv",
             {"--samples", "2000", "--fault", "gyro:bias=0.1@1..2", "--seed", "18446744073709551615"});
  same_again(scenes + "lever-arm.yaml", "lever.npy", {"--samples", "1500", "--no-truth", "--oversampling", "2"});
  same_again(scenes + "rv-3.3-uncalibrated.yaml", "array.csv", {"--duration", "2", "--no-time-column"});
}

TEST_CASE("simulate: a true input from a log is read again, a scene without a simulation is refused") {
  const test::TemporaryFolder folder;
  const auto path = [&](const char* name) { return (folder / name).string(); };
  std::ofstream(path("motion.csv")) << "t[s],rate\n0,1\n0.01,2\n0.02,3\n0.03,5\n";
  std::ofstream(path("s.yaml"))
      << "format: scene\nversion: 1\nsimulate: {rate_hz: 100, samples: 4, truth: {kind: recording, file: "
         "motion.csv}}\nsensors: [{name: a, model: {unit: m, white_noise: {value: 0.1}, density: two-sided}}]\n";
  REQUIRE(test::run({"simulate", path("s.yaml"), "-o", path("log.csv")}).code == 0);
  const std::string bytes = test::slurp(path("log.csv"));
  REQUIRE(test::run({"simulate", path("log.scene.yaml"), "--force"}).code == 0);
  CHECK(test::slurp(path("log.csv")) == bytes);
  const auto nowhere = test::run({"simulate", path("s.yaml")});
  CHECK(nowhere.code == 2);
  CHECK_THAT(nowhere.err, Contains("--output") && Contains("is required"));
  // To replay the log, that of its input is not needed.
  fs::remove(path("motion.csv"));
  CHECK(test::run({"replay", path("log.scene.yaml"), "--explain"}).code == 0);
  CHECK(test::run({"simulate", path("log.scene.yaml"), "--force"}).code == 3);
  CHECK(test::slurp(path("log.csv")) == bytes);
  std::ofstream(path("old.yaml")) << "format: scene\nversion: 1\nrecording: log.csv\nsensors: [a]\n"
                                     "simulated: {seed: 1}\n";
  const auto old = test::run({"simulate", path("old.yaml")});
  CHECK(old.code == 2);
  CHECK_THAT(old.err, Contains("E0721") && Contains("older version"));
}
