// What the detector does at one rate of false alarms after another, on runs whose faults are known.
#include <catch2/catch.hpp>

#include "libchar/replay/replay.hpp"
#include "tests/replay/scene_text.hpp"

using namespace libchar;

namespace {

ReplayResult watched_run(const std::string& faults, const std::string& algorithms, const std::string& more = "") {
  const test::SceneBench bench;
  std::string text =
      "format: scene\nversion: 1\nsimulate: {rate_hz: 100, duration_s: 300, seed: 3, truth: {kind: sine, amplitude: 2, "
      "frequency_hz: 0.7}}\nsensors:\n";
  for (const char* name : {"a", "b", "c", "d", "e"})
    text += std::string("  - {name: ") + name +
            ", model: {unit: rad/s, density: two-sided, white_noise: {value: 0.01, unit: rad/s/√Hz}}}\n";
  text += faults + "fault_free_s: 100\nreference: truth\nalgorithms: " + algorithms + "\n" + more;
  return replay(bench.read(text));
}

const std::string kTwoFaults =
    "faults:\n  - {sensor: b, kind: bias, value: 0.1, from_s: 150, to_s: 200}\n"
    "  - {sensor: d, kind: scale, value: 0.9, from_s: 250}\n";

}  // namespace

TEST_CASE("detection: delays over the rate of false alarms, at the usual one those of minque") {
  const ReplayResult result = watched_run(kTwoFaults, "[minque]");
  REQUIRE(result.detection.size() == 6);
  for (const DetectionAt& at : result.detection) REQUIRE(at.answers.size() == 2);
  for (const std::size_t fault : {0U, 1U}) {
    const auto delay = [&](std::size_t k) { return *result.detection[k].answers[fault].found_s; };
    CHECK(delay(0) > 0);
    CHECK(delay(0) < delay(5));
    CHECK(delay(5) < 10 * delay(0));  // the threshold grows as a logarithm
    CHECK(result.detection[3].false_alarm_s == 1e5);
    CHECK(delay(3) == result.algorithms[0].answers[fault].found_s);
  }
  CHECK(result.detection[3].answers[0].returned_s == result.algorithms[0].answers[0].returned_s);
  CHECK(result.detection[5].alarms_without_fault == 0);
}

TEST_CASE("detection: any algorithm that has the detector, with its own recovery, else nothing is computed") {
  const ReplayResult watched = watched_run(kTwoFaults, "[{name: mean, fault_detection: 1, recovery_window: 400}]");
  REQUIRE(watched.detection.size() == 6);
  CHECK(watched.detection[3].answers[0].returned_s == watched.algorithms[0].answers[0].returned_s);
  CHECK(watched_run(kTwoFaults, "[mean]").detection.empty());
  CHECK(watched_run("", "[minque]").detection.empty());
}

TEST_CASE("detection: a fault outside the evaluation has no delay") {
  const ReplayResult result = watched_run(kTwoFaults, "[minque]", "evaluation: [0, 230]\n");
  REQUIRE(result.detection.size() == 6);
  for (const DetectionAt& at : result.detection) {
    REQUIRE(at.answers.size() == 1);
    CHECK(at.answers[0].fault == 0);
  }
}
