// Learning windows in which the truth is missing now and then: the time of such an instant has passed all the same.

#include <catch2/catch.hpp>

#include "libchar/core/error.hpp"
#include "tests/fusion/scenes.hpp"
#include "tests/fusion/vectors.hpp"

using namespace libchar::fusion;

namespace {

Eigen::MatrixXd with_gaps(Eigen::MatrixXd truth, Eigen::Index from, Eigen::Index count) {
  truth.middleCols(from, count).setConstant(test::kNaN);
  return truth;
}

}  // namespace

TEST_CASE("sections are those of the run, whatever is missing from the reference") {
  // Channel 1 is good in the first half, channel 2 in the second.
  test::Gaussian gauss(4);
  constexpr Eigen::Index kInstants = 2000, kTurn = 1000;
  Eigen::MatrixXd y(2, kInstants), truth(1, kInstants);
  for (Eigen::Index k = 0; k < kInstants; ++k) {
    truth(0, k) = gauss();
    y(0, k) = truth(0, k) + (k < kTurn ? 0.01 : 1) * gauss();
    y(1, k) = truth(0, k) + (k < kTurn ? 1 : 0.01) * gauss();
  }
  Array array = test::array(2);
  array.reference_throughout = true;
  array.section_starts = {0, kTurn};
  const auto error = [&](const Eigen::MatrixXd& trained) {
    auto runner = test::make("sectioned-least-squares", array);
    // In blocks, as the engine does.
    for (Eigen::Index k = 0; k < kInstants; k += 64) {
      const Eigen::Index size = std::min<Eigen::Index>(64, kInstants - k);
      runner->learn(y.middleCols(k, size), trained.middleCols(k, size));
    }
    runner->finish_learning();
    const Eigen::MatrixXd x = test::run(*runner, y).x;
    return std::sqrt((x - truth).squaredNorm() / kInstants);
  };
  CHECK(error(truth) < 0.011);
  CHECK(error(with_gaps(truth, 0, 700)) < 0.011);
  CHECK(error(with_gaps(truth, 500, 1000)) < 0.011);
  // A sensor that is missing where the truth is known counts too.
  y.block(0, 100, 2, 400).setConstant(test::kNaN);
  auto runner = test::make("sectioned-least-squares", array);
  runner->learn(y, truth);
  runner->finish_learning();
  const Eigen::MatrixXd x = test::run(*runner, y).x;
  CHECK((x - truth).rightCols(1000).cwiseAbs().maxCoeff() < 0.06);
}

TEST_CASE("tuned tilt filters run through instants without a truth") {
  const test::FusionScene scene = test::tilt_scene();
  Array array = scene.array;
  array.learning_samples = scene.y.cols();
  // Known at every fourth instant only: the same constants, near enough for the same estimates.
  Eigen::MatrixXd sparse = scene.truth;
  for (Eigen::Index k = 0; k < sparse.cols(); ++k)
    if (k % 4 != 0) sparse(0, k) = test::kNaN;
  for (const char* name : {"tilt-complementary-tuned", "tilt-kalman-tuned"}) {
    INFO(name);
    const auto rms = [&](const Eigen::MatrixXd& trained) {
      auto runner = test::make(name, array);
      runner->learn(scene.y, trained);
      runner->finish_learning();
      return std::sqrt((test::run(*runner, scene.y).x - scene.truth).squaredNorm() /
                       static_cast<double>(scene.y.cols()));
    };
    CHECK(rms(sparse) < 1.15 * rms(scene.truth));
  }
}

TEST_CASE("kalman-takens-taught: no stretch reaches over a gap of the reference") {
  // A saw tooth without noise is predicted exactly, but not across a cut.
  constexpr Eigen::Index kInstants = 600;
  Eigen::MatrixXd y(2, kInstants), truth(1, kInstants);
  for (Eigen::Index k = 0; k < kInstants; ++k) truth(0, k) = static_cast<double>(k % 7);
  y << truth, truth;
  y.rightCols(100).setConstant(test::kNaN);
  Array array = test::array(2);
  array.noise_levels = Eigen::Vector2d(1, 1) * 1e-6;
  array.learning_samples = kInstants;
  const auto predicted = [&](const Eigen::MatrixXd& trained) {
    auto runner = test::make("kalman-takens-taught", array, {{"neighbours", 5}});
    runner->learn(y, trained);
    runner->finish_learning();
    return test::run(*runner, y).x;
  };
  // Gaps of three after every forty: joined, the parts would not be a saw tooth.
  Eigen::MatrixXd cut = truth;
  for (Eigen::Index k = 40; k + 3 < kInstants; k += 40) cut.middleCols(k, 3).setConstant(test::kNaN);
  CHECK((predicted(cut) - truth).rightCols(100).cwiseAbs().maxCoeff() < 1e-9);
  // Nothing but scattered truths: no stretch at all, said so.
  Eigen::MatrixXd scattered = truth;
  for (Eigen::Index k = 0; k < kInstants; ++k)
    if (k % 3 != 0) scattered(0, k) = test::kNaN;
  CHECK_THROWS_AS(predicted(scattered), libchar::Error);
}
