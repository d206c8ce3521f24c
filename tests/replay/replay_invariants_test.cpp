// Every shipped scene, cut short, through every algorithm it can run: what must not change the numbers does not.

#include <catch2/catch.hpp>
#include <filesystem>
#include <numeric>

#include "libchar/replay/replay.hpp"
#include "libchar/scene/scene_file.hpp"
#include "tests/replay/replay_numbers.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;

namespace {

constexpr std::uint64_t kShort = 6000;

std::vector<std::string> shipped() {
  std::vector<std::string> out;
  for (const auto& entry : std::filesystem::directory_iterator(test::fixture("scenes")))
    if (entry.path().extension() == ".yaml") out.push_back(entry.path().string());
  std::sort(out.begin(), out.end());
  return out;
}

// Its first samples, learning in the first third, with a fault behind it.
Scene short_scene(const std::string& path) {
  Scene scene = read_scene_file(path);
  REQUIRE(scene.simulate);
  scene.simulate->samples = std::min(scene.simulate->samples, kShort);
  const double end_s = static_cast<double>(scene.simulate->samples) / scene.simulate->rate_hz;
  scene.learning = TimeWindow{0, end_s / 3};
  scene.evaluation = TimeWindow{end_s / 3, end_s};
  scene.fault_free_s = end_s / 3;
  scene.faults = {{0, FaultKind::scale, 0.5, 0.7 * end_s, 0.8 * end_s},
                  {1, FaultKind::dropout, 0, 0.85 * end_s, 0.9 * end_s}};
  scene.simulate->faults = scene.faults;
  return scene;
}

}  // namespace

TEST_CASE("every shipped scene: doing all work changes no number") {
  REQUIRE(shipped().size() >= 6);
  for (const std::string& path : shipped()) {
    INFO(path);
    const Scene scene = short_scene(path);
    ReplayOptions options;
    options.no_skip = true;
    CHECK(test::numbers(replay(scene)) == test::numbers(replay(scene, options)));
  }
}

TEST_CASE("every shipped scene: a run again, or in other blocks, gives the same bits") {
  for (const std::string& path : shipped()) {
    INFO(path);
    const Scene scene = short_scene(path);
    ReplayOptions options;
    options.block = 256;
    const ReplayResult first = replay(scene, options);
    CHECK(test::numbers(first) == test::numbers(replay(scene, options)));
    options.block = 97;
    const ReplayResult other = replay(scene, options);
    for (std::size_t k = 0; k < first.algorithms.size(); ++k) {
      const AlgorithmResult &a = first.algorithms[k], &b = other.algorithms[k];
      INFO(a.label);
      CHECK(a.ran == b.ran);
      CHECK((a.rmse == b.rmse || (std::isnan(a.rmse) && std::isnan(b.rmse))));
      CHECK(a.availability == b.availability);
      CHECK(a.weights == b.weights);
    }
  }
}

TEST_CASE("every shipped scene: nobody beats the optimum of fixed weights without using time") {
  for (const std::string& path : shipped()) {
    INFO(path);
    const Scene scene = short_scene(path);
    const ReplayResult result = replay(scene);
    for (const AlgorithmResult& a : result.algorithms)
      if (a.ran && (a.label == "mean" || a.label == "inverse-variance" || a.label == "least-squares"))
        CHECK(a.regret > -0.01);
    CHECK(result.inputs[0].optimum_rmse > 0);
    for (const AlgorithmResult& a : result.algorithms)
      if (a.ran && a.weights.size() == 1 && a.label != "least-squares-published" &&
          a.label.find("published") == std::string::npos && a.label.find("blind") == std::string::npos) {
        INFO(a.label);
        CHECK(std::accumulate(a.weights[0].begin(), a.weights[0].end(), 0.0) == Approx(1).epsilon(1e-12));
      }
  }
}
