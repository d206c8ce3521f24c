// A method that looks at the whole run before it estimates: with a reference, without one, behind the fault
// detector, and applied to a log.
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <tuple>

#include "libchar/core/text/decimal.hpp"
#include "libchar/replay/fuse.hpp"
#include "libchar/replay/replay.hpp"
#include "tests/replay/kept_columns.hpp"
#include "tests/replay/scene_text.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;

namespace {

const std::string kSmoothed =
    "algorithms: [virtual-sensor, {name: virtual-sensor, smoothed: 1}, {name: virtual-sensor, smoothed: 1, "
    "fault_detection: 1}]\n";

std::string walking_sensors() {
  std::string text = "sensors:\n";
  for (const auto& [name, white, walk] : {std::tuple{"a", 0.01, 0.02}, std::tuple{"b", 0.01, 0.02},
                                          std::tuple{"c", 0.04, 0.002}, std::tuple{"d", 0.04, 0.002}})
    text += fmt::format(
        "  - {{name: {}, model: {{unit: rad/s, density: two-sided, white_noise: {{value: {}, unit: rad/s/√Hz}}, "
        "random_walk: {{value: {}, unit: rad/s/√s}}}}}}\n",
        name, white, walk);
  return text;
}

std::string simulated_walks() {
  return "format: scene\nversion: 1\nsimulate: {rate_hz: 20, duration_s: 600, seed: 5, truth: {kind: noise, "
         "standard_deviation: 1, bandwidth_hz: 2}}\n" +
         walking_sensors();
}

std::string log_of_walks(double fault = 0) {
  test::Gaussian gauss(3);
  std::string text = "t[s],a[rad/s],b[rad/s],c[rad/s],d[rad/s]\n";
  double walk[4] = {};
  for (int k = 0; k < 3000; ++k) {
    text += shortest(k / 20.0);
    for (int i = 0; i < 4; ++i) {
      const double failed = i == 2 && k > 1500 ? fault : 0;
      text += "," + shortest(std::sin(0.1 * k) + walk[i] + failed + (i < 2 ? 0.045 : 0.18) * gauss());
      walk[i] += (i < 2 ? 0.02 : 0.002) / std::sqrt(20.0) * gauss();
    }
    text += "\n";
  }
  return text;
}

}  // namespace

TEST_CASE("smoother: with a reference it is scored and explained") {
  const test::SceneBench bench;
  const Scene scene = bench.read(simulated_walks() + "reference: truth\n" + kSmoothed);
  const ReplayResult result = replay(scene);
  REQUIRE(result.algorithms.size() == 3);
  const AlgorithmResult &filter = result.algorithms[0], &smoother = result.algorithms[1];
  CHECK(smoother.label == "virtual-sensor (smoothed=1)");
  CHECK(smoother.availability == 1);
  CHECK(smoother.rmse < 0.98 * filter.rmse);
  CHECK(result.algorithms[2].rmse == Approx(smoother.rmse).epsilon(1e-9));  // no sensor fails
  CHECK(filter.remarks.find("looks_ahead") == nullptr);
  CHECK(smoother.remarks.find("looks_ahead") != nullptr);
  const std::string looks = "looks at the whole evaluation before it estimates: virtual-sensor (smoothed=1),";
  CHECK(std::any_of(result.plan.begin(), result.plan.end(),
                    [&](const std::string& sentence) { return sentence.starts_with(looks); }));
}

TEST_CASE("smoother: without a reference every part looks ahead as well") {
  const test::SceneBench bench;
  bench.put("walks.csv", log_of_walks());
  const ReplayResult result =
      replay(bench.read("format: scene\nversion: 1\nrecording: walks.csv\n" + walking_sensors() + kSmoothed));
  const AlgorithmResult &filter = result.algorithms[0], &smoother = result.algorithms[1];
  REQUIRE(smoother.blind);
  for (const double one : smoother.blind->leave_one_out) CHECK(std::isfinite(one));
  CHECK(smoother.blind->leave_one_out_rms < filter.blind->leave_one_out_rms);
  CHECK(smoother.blind->split_rms < filter.blind->split_rms);
}

TEST_CASE("smoother: a log is fused as it was in the replay, a sensor that fails left out") {
  const test::SceneBench bench;
  bench.put("walks.csv", log_of_walks(5));
  KeptColumns replayed;
  ReplayWorkspace workspace;
  workspace.estimates = &replayed;
  const Scene scene = bench.read("format: scene\nversion: 1\nrecording: walks.csv\n" + walking_sensors() + kSmoothed);
  const ReplayResult result = replay(scene, {}, no_progress(), workspace);
  const LearntFusion learnt = parse_fusion_file(fusion_yaml(result.learnt), "fusion.yaml");
  double squares[3] = {};
  for (std::size_t a = 0; a < 3; ++a) {
    KeptColumns fused;
    FuseOptions options;
    options.algorithm = replayed.head.channels[2 + a].name;
    fuse(bench.path("walks.csv"), learnt, fused, options);
    CHECK(fused.columns[0] == replayed.columns[2 + a]);
    for (std::size_t k = 0; k < fused.columns[0].size(); ++k)
      squares[a] += std::pow(fused.columns[0][k] - std::sin(0.1 * static_cast<double>(k)), 2);
  }
  CHECK(squares[2] < 0.5 * squares[1]);  // the step of the third sensor is not taken for a drift
}
