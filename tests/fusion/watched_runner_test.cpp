// The fault detector in front of estimates with fixed weights: sensors that fail are left out, and
// nothing else changes.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "libchar/fusion/registry.hpp"
#include "libchar/fusion/runner.hpp"
#include "libchar/fusion/why_not.hpp"
#include "tests/fusion/scenes.hpp"
#include "tests/fusion/vectors.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;
using namespace libchar::fusion;

namespace {

constexpr Eigen::Index kWatchedInstants = 12'000, kFails = 6000;

struct WatchedScene {
  Array array;
  Eigen::MatrixXd y, truth;
};

/// Six sensors on one input; the third fails in the middle, by what is said.
WatchedScene failing(double gain, double bias, double noise, std::uint64_t seed) {
  test::Gaussian gauss(seed);
  WatchedScene scene;
  const Eigen::VectorXd deviation = Eigen::VectorXd::LinSpaced(6, 0.1, 0.3);
  scene.y.resize(6, kWatchedInstants);
  scene.truth.resize(1, kWatchedInstants);
  for (Eigen::Index k = 0; k < kWatchedInstants; ++k) {
    const double x = scene.truth(0, k) = 2 * std::sin(0.05 * static_cast<double>(k));
    for (Eigen::Index i = 0; i < 6; ++i) scene.y(i, k) = x + deviation[i] * gauss();
    if (k >= kFails) scene.y(2, k) = gain * scene.y(2, k) + bias + noise * gauss();
  }
  scene.array.channels = 6;
  scene.array.noise_levels = deviation.cwiseAbs2();
  scene.array.noise_models = test::drifting(scene.array.noise_levels);
  scene.array.rate_hz = 100;
  scene.array.learning_samples = 2000;
  scene.array.fault_free_samples = 2000;
  return scene;
}

std::unique_ptr<Runner> watched(const Entry& entry, const WatchedScene& scene, bool on) {
  Settings settings(entry.options);
  settings.set("fault_detection", on ? 1 : 0);
  auto runner = entry.make(scene.array, settings);
  if (entry.description->needs.reference || entry.description->needs.reference_helps)
    runner->learn(scene.y.leftCols(2000), scene.truth.leftCols(2000));
  runner->finish_learning();
  return runner;
}

double rms(const Eigen::MatrixXd& error) { return std::sqrt(error.squaredNorm() / static_cast<double>(error.size())); }

std::vector<const Entry*> watchable(const WatchedScene& scene) {
  std::vector<const Entry*> out;
  for (const Entry& entry : algorithms())
    if (entry.own_options < entry.options.size() && why_not(*entry.description, scene.array).empty())
      out.push_back(&entry);
  return out;
}

}  // namespace

TEST_CASE("watched: every mean without a search of its own has the options, and only those") {
  const WatchedScene scene = failing(1, 0, 0, 1);
  std::vector<std::string_view> names;
  for (const Entry* entry : watchable(scene)) names.push_back(entry->description->name);
  for (const char* name : {"mean", "inverse-variance", "least-squares", "virtual-sensor"})
    CHECK(std::count(names.begin(), names.end(), name) == 1);
  for (const char* name : {"minque", "minque-published", "optimal-weights", "tilt-kalman"})
    CHECK(std::count(names.begin(), names.end(), name) == 0);
}

TEST_CASE("watched: without a fault the estimates are the same bits, in any blocks") {
  const WatchedScene scene = failing(1, 0, 0, 2);
  for (const Entry* entry : watchable(scene)) {
    INFO(entry->description->name);
    const auto with = watched(*entry, scene, true);
    const test::Run on = test::run(*with, scene.y, 1, 1000),
                    off = test::run(*watched(*entry, scene, false), scene.y, 1, kWatchedInstants);
    CHECK(on.x == off.x);
    CHECK(with->faults()->events().empty());
  }
}

TEST_CASE("watched: a bias, a gain, noise and silence of one sensor are left out") {
  struct Fault {
    double gain, bias, noise;
  };
  for (const Fault& fault : {Fault{1, 0.8, 0}, Fault{0.5, 0, 0}, Fault{1, 0, 2}, Fault{0, 0, 0}}) {
    const WatchedScene scene = failing(fault.gain, fault.bias, fault.noise, 3);
    const Eigen::Index seen = kFails + 500, rest = kWatchedInstants - seen;
    for (const Entry* entry : watchable(scene)) {
      // Those that use one sensor here, and not the one that fails.
      const std::string_view name = entry->description->name;
      if (name == "covariance-intersection" || name == "best-axes") continue;
      INFO(entry->description->name << ": gain " << fault.gain << ", bias " << fault.bias << ", noise " << fault.noise);
      const auto with = watched(*entry, scene, true);
      const Eigen::MatrixXd on = test::run(*with, scene.y, 1, kWatchedInstants).x - scene.truth;
      const Eigen::MatrixXd off =
          test::run(*watched(*entry, scene, false), scene.y, 1, kWatchedInstants).x - scene.truth;
      CHECK(rms(on.rightCols(rest)) < 1.25 * rms(off.leftCols(kFails)));
      CHECK(rms(on.rightCols(rest)) < rms(off.rightCols(rest)));
      REQUIRE(with->faults()->events().size() >= 1);
      CHECK(with->faults()->events()[0].channel == 2);
      CHECK(with->faults()->events()[0].sample >= kFails);
    }
  }
}

TEST_CASE("watched: two sensors cannot be told, and it is said") {
  WatchedScene scene = failing(1, 0.8, 0, 4);
  scene.y = scene.y.topRows(2).eval();
  scene.array.channels = 2;
  scene.array.noise_levels.conservativeResize(2);
  scene.array.noise_models.resize(2);
  const auto runner = watched(algorithm("mean"), scene, true);
  const test::Run on = test::run(*runner, scene.y, 1, 500),
                  off = test::run(*watched(algorithm("mean"), scene, false), scene.y, 1, 500);
  CHECK(on.x == off.x);
  CHECK(runner->faults()->events().empty());
  Findings warnings;
  runner->remarks(warnings);
  CHECK(warnings.find("faults_not_watched") != nullptr);
}
