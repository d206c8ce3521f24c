// Fusion over seeds, options and scenes.

#include <catch2/catch.hpp>
#include <cmath>

#include "libchar/benchmark/bench_document.hpp"
#include "libchar/core/error.hpp"
#include "libchar/scene/scene_file.hpp"

using namespace libchar;

namespace {

Scene three_sensors() {
  return parse_scene(
      "format: scene\nversion: 1\nname: three\nsimulate: {rate_hz: 100, samples: 20000, seed: 5, truth: {kind: sine, "
      "amplitude: 1, frequency_hz: 0.1}}\n"
      "sensors:\n"
      "  - {name: a, model: {density: two-sided, white_noise: 0.01}}\n"
      "  - {name: b, model: {density: two-sided, white_noise: 0.02}}\n"
      "  - {name: c, model: {density: two-sided, white_noise: 0.04}}\n",
      "three.yaml");
}

const FusionBenchRow& row(const FusionBench& bench, const std::string& label) {
  for (const FusionBenchRow& r : bench.rows)
    if (r.label == label) return r;
  throw std::runtime_error(label);
}

}  // namespace

TEST_CASE("fusion bench: the mean is as much worse than the best weights as the formula says") {
  FusionBenchOptions options;
  options.seeds = 6;
  options.algorithms = {"mean", "inverse-variance"};
  const FusionBench bench = bench_fusion({three_sensors()}, options);
  // Variances 1, 4, 16: the mean has 21/9, the optimum 1/(1 + 1/4 + 1/16).
  const double expected = std::sqrt(21.0 / 9 * (1 + 1.0 / 4 + 1.0 / 16)) - 1;
  const FusionBenchRow& mean = row(bench, "mean");
  CHECK(mean.excess.count == 6);
  CHECK(mean.excess.value == Approx(expected).epsilon(0.03));
  CHECK(mean.excess.ci95.low < mean.excess.value);
  CHECK(std::abs(row(bench, "inverse-variance").excess.value) < 0.01);
  REQUIRE(bench.scenes.size() == 1);
  for (const FusionBenchRow& one : bench.rows)
    CHECK(std::isnan(one.cells.at(0).front_gap) == (one.bound || !one.cells[0].ran));
}

TEST_CASE("fusion bench: a sweep is a row a value, and the excess follows the option") {
  FusionBenchOptions options;
  options.seeds = 3;
  options.algorithms = {"minque", "mean"};
  options.sweeps = {parse_sweep("minque.gamma=.9,.999", "--sweep")};
  const FusionBench bench = bench_fusion({three_sensors()}, options);
  const FusionBenchRow &fast = row(bench, "minque (gamma=0.9)"), &slow = row(bench, "minque (gamma=0.999)");
  CHECK(fast.swept);
  CHECK_FALSE(row(bench, "mean").swept);
  // Weights of ten instants scatter, those of a thousand do not.
  CHECK(fast.excess.value > slow.excess.value);
}

TEST_CASE(
    "fusion bench: a scene that feeds none of the algorithms is left out and said, and refused where there is no "
    "other") {
  FusionBenchOptions options;
  options.seeds = 2;
  options.algorithms = {"minque", "mean"};
  Scene tilt;
  for (const Scene& scene : bench_scenes())
    if (scene.tilt) tilt = scene;
  REQUIRE(tilt.tilt);
  for (const bool first : {true, false}) {
    const std::vector<Scene> scenes = first ? std::vector{tilt, three_sensors()} : std::vector{three_sensors(), tilt};
    const FusionBench bench = bench_fusion(scenes, options);
    REQUIRE(bench.scenes.size() == 1);
    CHECK(bench.scenes[0].name == "three");
    REQUIRE(bench.left_out.size() == 1);
    CHECK(bench.left_out[0].name == tilt.name);
    CHECK_THAT(bench.left_out[0].why, Catch::Contains("no algorithm can run on this scene"));
    for (const FusionBenchRow& r : bench.rows) CHECK(r.cells.size() == 1);
  }
  CHECK_THROWS_AS(bench_fusion({tilt, tilt}, options), Error);
}

TEST_CASE("the built-in scenes are read") {
  const std::vector<Scene> scenes = bench_scenes();
  CHECK(scenes.size() == 6);
  for (const Scene& scene : scenes) CHECK(scene.simulate);
}
