// What each algorithm promises, in one table: an algorithm that is registered without a row here fails.

#include <catch2/catch.hpp>
#include <cstring>
#include <map>

#include "libchar/fusion/why_not.hpp"
#include "tests/fusion/scenes.hpp"
#include "tests/fusion/vectors.hpp"

using namespace libchar::fusion;

namespace {

struct Promise {
  /// The estimate lies between the smallest and the largest sample of the instant.
  bool between;
  /// Largest relative change of the estimate when everything is scaled by a power of two; 0: not a
  /// bit; NaN: an option is in the units of the input.
  double scale;
};

constexpr double kInUnits = std::numeric_limits<double>::quiet_NaN();

const std::map<std::string_view, Promise> kPromises{
    {"mean", {true, 0}},
    {"median", {true, 0}},
    {"inverse-variance", {true, 0}},
    {"covariance-intersection", {true, 0}},
    {"minque", {true, 0}},
    {"minque-published", {true, 0}},
    {"random-weighting", {true, 0}},
    {"random-weighting-published", {false, 0}},  // weights of either sign
    {"kalman-takens", {false, 0}},               // leans on its own past
    {"kalman-takens-published", {false, kInUnits}},
    {"blind-calibration", {false, 1e-10}},  // gains of its own
    {"blind-calibration-published", {false, 0}},
    {"blind-gls", {false, 1e-10}},
    {"virtual-sensor", {false, 1e-12}},  // leans on its own past
    {"least-squares", {false, 1e-12}},   // weights of either sign
    {"least-squares-published", {false, 1e-12}},
    {"shrunk-least-squares", {false, 1e-12}},  // calibrated
    {"non-negative-least-squares", {false, 1e-12}},
    {"perceptron", {false, 1e-10}},
    {"neural-simplex", {false, 1e-10}},
    {"kalman-takens-taught", {false, 0}},
    {"best-axes", {false, 0}},  // one of the samples, but it refuses to learn from none
    {"best-sensor", {true, 0}},
    {"optimal-weights", {false, 1e-12}},
    {"sectioned-least-squares", {false, 1e-12}},
    // Angles: other units, other promises (tilt_test.cpp).
    {"tilt-gyroscope", {false, kInUnits}},
    {"tilt-accelerometer", {false, kInUnits}},
    {"tilt-complementary", {false, kInUnits}},
    {"tilt-kalman", {false, kInUnits}},
    {"tilt-complementary-tuned", {false, kInUnits}},
    {"tilt-kalman-tuned", {false, kInUnits}},
};

test::FusionScene five() { return test::noisy_scene("five", (Eigen::VectorXd(5) << 2, .4, .2, .04, .02).finished()); }

test::Run run(const Entry& entry, const test::FusionScene& scene) {
  auto runner = entry.make(scene.array, Settings(entry.options));
  const Needs& needs = entry.description->needs;
  if (needs.reference || needs.reference_throughout || needs.reference_helps) runner->learn(scene.y, scene.truth);
  runner->finish_learning();
  return test::run(*runner, scene.y);
}

test::FusionScene scaled(test::FusionScene scene, double factor) {
  scene.y *= factor;
  scene.truth *= factor;
  test::scale_levels(scene.array, factor);
  return scene;
}

}  // namespace

TEST_CASE("promises: every algorithm has a row, every row an algorithm") {
  for (const Entry& entry : algorithms()) {
    INFO(entry.description->name);
    CHECK(kPromises.contains(entry.description->name));
  }
  for (const auto& [name, promise] : kPromises) {
    INFO(name);
    CHECK(find_algorithm(name) != nullptr);
  }
}

TEST_CASE("promises: an estimate with weights above zero lies between the samples") {
  int held = 0;
  for (const test::FusionScene& scene : test::fusion_scenes())
    for (const Entry& entry : algorithms()) {
      const auto row = kPromises.find(entry.description->name);
      if (row == kPromises.end() || !row->second.between) continue;
      if (!why_not(*entry.description, scene.array).empty()) continue;
      INFO(entry.description->name << " on " << scene.name);
      const test::Run out = run(entry, scene);
      for (Eigen::Index k = 0; k < scene.y.cols(); ++k) {
        if (!std::isfinite(out.x(0, k))) continue;
        double low = std::numeric_limits<double>::infinity(), high = -low;
        for (const double y : scene.y.col(k))
          if (std::abs(y) <= 1e100) {
            low = std::min(low, y);
            high = std::max(high, y);
          }
        const double rounding =
            4e-16 * static_cast<double>(scene.y.rows()) * std::max({std::abs(low), std::abs(high), high - low});
        REQUIRE(out.x(0, k) >= low - rounding);
        REQUIRE(out.x(0, k) <= high + rounding);
      }
      ++held;
    }
  CHECK(held > 100);
}

TEST_CASE("promises: a power of two is a unit like any other") {
  const test::FusionScene scene = five();
  for (const double factor : {0x1p-100, 0x1p-7, 0x1p60})
    for (const Entry& entry : algorithms()) {
      const auto row = kPromises.find(entry.description->name);
      if (row == kPromises.end() || std::isnan(row->second.scale)) continue;
      if (!why_not(*entry.description, scene.array).empty()) continue;
      INFO(entry.description->name << " times " << factor);
      const Eigen::MatrixXd plain = run(entry, scene).x;
      const Eigen::MatrixXd moved = run(entry, scaled(scene, factor)).x / factor;
      if (row->second.scale == 0)
        CHECK(test::same_values(moved, plain));
      else
        CHECK((moved - plain).cwiseAbs().maxCoeff() < row->second.scale * plain.cwiseAbs().maxCoeff());
    }
}

TEST_CASE("promises: samples beyond 1e100 are missing samples, whatever they are") {
  const test::FusionScene scene = five();
  for (const double sample : {1e150, -1e300, std::numeric_limits<double>::infinity()})
    for (const Entry& entry : algorithms()) {
      // What learns needs complete instants.
      if (!why_not(*entry.description, scene.array).empty() || entry.description->needs.reference) continue;
      if (entry.description->needs.reference_throughout && entry.description->name != "best-sensor") continue;
      INFO(entry.description->name << ", " << sample);
      test::FusionScene wild = scene, missing = scene;
      wild.y.row(2).setConstant(sample);
      missing.y.row(2).setConstant(test::kNaN);
      wild.y(4, 100) = sample;
      missing.y(4, 100) = test::kNaN;
      const Eigen::MatrixXd a = run(entry, wild).x, b = run(entry, missing).x;
      // A sum with a weight of zero times 1e300 in it may run in another order.
      for (Eigen::Index k = 0; k < a.cols(); ++k)
        if (!(std::isnan(a(0, k)) && std::isnan(b(0, k)))) REQUIRE(a(0, k) == Approx(b(0, k)).margin(1e-13));
    }
}

TEST_CASE("promises: a channel of deviation 1e150 changes nothing") {
  const test::FusionScene scene = five();
  test::FusionScene more = scene;
  more.y.conservativeResize(6, Eigen::NoChange);
  test::Gaussian gauss(2);
  for (double& y : more.y.row(5)) y = 1e3 * gauss();
  more.array.channels = 6;
  more.array.noise_levels.conservativeResize(6);
  more.array.noise_levels[5] = 1e300;
  const Entry& entry = algorithm("inverse-variance");
  CHECK((run(entry, more).x - run(entry, scene).x).cwiseAbs().maxCoeff() < 1e-14);
}

TEST_CASE("promises: a channel twice is that channel once with half the variance") {
  const test::FusionScene scene = five();
  test::FusionScene twice = scene, half = scene;
  twice.y.conservativeResize(6, Eigen::NoChange);
  twice.y.row(5) = scene.y.row(1);
  twice.array.channels = 6;
  twice.array.noise_levels.conservativeResize(6);
  twice.array.noise_levels[5] = scene.array.noise_levels[1];
  half.array.noise_levels[1] /= 2;
  const Entry& entry = algorithm("inverse-variance");
  const test::Run a = run(entry, twice), b = run(entry, half);
  CHECK((a.x - b.x).cwiseAbs().maxCoeff() < 1e-14);
  CHECK((a.variance - b.variance).cwiseAbs().maxCoeff() < 1e-16);
}

TEST_CASE("promises: minque gathers, but what it gathers belongs to the channels in use") {
  // The set changes at every instant or never: the same variances within their scatter.
  const test::FusionScene scene = test::noisy_scene("", (Eigen::VectorXd(6) << 1, 2, 3, 4, 5, 6).finished(), 40000);
  const auto variances = [&](bool holes) {
    Eigen::MatrixXd y = scene.y;
    for (Eigen::Index k = 0; holes && k < y.cols(); k += 2) y(k / 2 % 6, k) = test::kNaN;
    auto minque = test::make("minque", test::array(6));
    test::run(*minque, y);
    return *minque->variances();
  };
  const Eigen::VectorXd never = variances(false), often = variances(true);
  for (Eigen::Index i = 0; i < 6; ++i) {
    CHECK(never[i] == Approx(static_cast<double>(i + 1)).epsilon(0.25));
    CHECK(often[i] == Approx(never[i]).epsilon(0.15));
  }
}
