// Kalman-Takens against fixtures/known/fusion/kalman_takens.csv; the search against sorting; its limits.

#include "libchar/fusion/algorithms/kalman_takens.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <numeric>

#include "libchar/core/error.hpp"
#include "tests/fusion/vectors.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;
using namespace libchar::fusion;

namespace {

Array levels(const Eigen::VectorXd& variances) {
  Array made = test::array(variances.size());
  made.noise_levels = variances;
  return made;
}

Eigen::MatrixXd noisy(const Eigen::VectorXd& x, const Eigen::VectorXd& variances) {
  test::Gaussian gauss(5);
  Eigen::MatrixXd y(variances.size(), x.size());
  for (Eigen::Index k = 0; k < x.size(); ++k)
    for (Eigen::Index i = 0; i < y.rows(); ++i) y(i, k) = x[k] + std::sqrt(variances[i]) * gauss();
  return y;
}

Eigen::VectorXd sine(Eigen::Index instants, double period, double offset = 0) {
  Eigen::VectorXd x(instants);
  for (Eigen::Index k = 0; k < instants; ++k)
    x[k] = offset + std::sin(2 * 3.14159265358979 * static_cast<double>(k) / period);
  return x;
}

double rms(const Eigen::VectorXd& v) { return std::sqrt(v.squaredNorm() / double(v.size())); }

}  // namespace

TEST_CASE("delay search: what sorting finds, ties to the earlier") {
  test::Gaussian gauss(2);
  constexpr std::size_t kDimension = 3, kStarts = 200;
  std::vector<double> series(kStarts + kDimension);
  for (double& z : series) z = std::round(2 * gauss());  // many ties
  series[50] = std::nan("");
  for (const std::size_t neighbours : {1UL, 7UL, 500UL}) {
    DelaySearch search(kDimension, neighbours, kStarts);
    const std::array query{0.0, 1.0, -1.0};
    std::vector<std::pair<double, std::ptrdiff_t>> all;
    for (std::size_t s = 0; s < kStarts; ++s) {
      double distance = 0;
      for (std::size_t j = 0; j < kDimension; ++j) distance += std::abs(series[s + j] - query[j]);
      if (!std::isnan(distance + series[s + kDimension])) all.emplace_back(distance, s);
    }
    std::sort(all.begin(), all.end());
    const auto found = search.nearest(series.data(), kStarts, query.data());
    REQUIRE(found.size() == std::min(neighbours, all.size()));
    for (std::size_t i = 0; i < found.size(); ++i) {
      CHECK(found[i].distance == all[i].first);
      CHECK(found[i].start == all[i].second);
    }
  }
}

TEST_CASE("delay search: neighbours that follow each other, spikes and gaps, search after search") {
  constexpr std::size_t kDimension = 6, kStarts = 1003, kSearches = 400;
  for (const std::size_t neighbours : {3UL, 20UL, 90UL}) {
    test::Gaussian gauss(neighbours);
    std::vector<double> series(kStarts + kSearches + kDimension);
    double slow = 0;
    for (double& z : series) z = slow = 0.99 * slow + gauss();
    for (std::size_t k = 3; k < series.size(); k += 211) series[k] = std::nan("");
    series[700] = 1e9;
    DelaySearch search(kDimension, neighbours, kStarts);
    for (std::size_t from = 0; from < kSearches; ++from) {
      std::vector<double> query(kDimension);
      for (std::size_t j = 0; j < kDimension; ++j) query[j] = 3 * gauss();
      std::vector<std::pair<double, std::ptrdiff_t>> all;
      for (std::size_t s = 0; s < kStarts; ++s) {
        double distance = 0;
        for (std::size_t j = 0; j < kDimension; ++j) distance += std::abs(series[from + s + j] - query[j]);
        if (!std::isnan(distance + series[from + s + kDimension])) all.emplace_back(distance, s);
      }
      std::sort(all.begin(), all.end());
      const auto found = search.nearest(series.data() + from, kStarts, query.data());
      REQUIRE(found.size() == neighbours);
      bool same = true;
      for (std::size_t i = 0; i < neighbours; ++i)
        same = same && found[i].distance == all[i].first && found[i].start == all[i].second;
      CHECK(same);
    }
  }
}

TEST_CASE("kalman-takens-published: 50-digit vectors") {
  const test::Vectors inputs("fusion_inputs.csv"), file("kalman_takens.csv");
  const auto answer = test::answers()["kalman_takens"];
  Eigen::VectorXd variances(5);
  for (Eigen::Index i = 0; i < 5; ++i) variances[i] = answer["R"][static_cast<std::size_t>(i)];
  auto runner = test::make("kalman-takens-published", levels(variances),
                           {{"dimension", answer["d"]},
                            {"neighbours", answer["M"]},
                            {"training", answer["train"]},
                            {"process_variance", answer["Q"]},
                            {"start_variance", answer["P0"]}});
  const test::Run run = test::run(*runner, inputs.block("c", 5).leftCols(800));
  CHECK(test::worst(run.x.rightCols(500), file["xhat"].transpose(), 1.78e-15) <= 1);
  CHECK(test::worst(run.variance.rightCols(500), file["P"].transpose(), 0, 1e-15) <= 1);
  // Neighbours and prediction, from the same search.
  const Eigen::VectorXd average = inputs.block("c", 5).colwise().mean();
  DelaySearch search(3, 4, 297);
  Eigen::MatrixXd predicted(1, 500), starts(4, 500);
  for (Eigen::Index k = 300; k < 800; ++k) {
    const auto found = search.nearest(average.data(), 297, average.data() + k - 3);
    predicted(0, k - 300) = prediction(found, average.data(), 3);
    for (Eigen::Index i = 0; i < 4; ++i)
      starts(i, k - 300) = static_cast<double>(found[static_cast<std::size_t>(i)].start + 1);
  }
  CHECK(test::worst(predicted, file["x_pred"].transpose(), 3.33e-15) <= 1);
  CHECK(starts == file.values.middleCols(file.column("nn1_start_1based"), 4).transpose());
}

TEST_CASE("kalman-takens: a periodic signal without noise is returned") {
  const Eigen::VectorXd x = sine(3000, 50, 10);
  const Eigen::MatrixXd y = x.transpose().replicate(2, 1);
  auto runner = test::make("kalman-takens", levels(Eigen::Vector2d(1e-2, 1e-2)));
  const test::Run run = test::run(*runner, y);
  CHECK((run.x.row(0).transpose() - x).tail(2000).cwiseAbs().maxCoeff() < 1e-9);
  CHECK(run.variance.rightCols(2000).minCoeff() > 0);
}

TEST_CASE("kalman-takens: beats the weighted mean where the past tells, does not lose where not") {
  const Eigen::VectorXd variances = Eigen::Vector3d(1, 0.5, 2);
  test::Gaussian gauss(9);
  Eigen::VectorXd white(12000);
  for (double& v : white) v = 3 * gauss();
  struct Scene {
    Eigen::VectorXd x;
    double at_most;
  };
  for (const Scene& scene : {Scene{sine(12000, 40), 0.75}, Scene{white, 1.003}}) {
    const Eigen::MatrixXd y = noisy(scene.x, variances);
    const Array array = levels(variances);
    const auto error = [&](Runner& runner) {
      const test::Run run = test::run(runner, y);
      return Eigen::VectorXd((run.x.row(0).transpose() - scene.x).tail(10000));
    };
    auto takens = test::make("kalman-takens", array), mean = test::make("inverse-variance", array);
    const double takens_rms = rms(error(*takens)), mean_rms = rms(error(*mean));
    CHECK(takens_rms / mean_rms < scene.at_most);
    // The variance that it states is the one it has.
    auto again = test::make("kalman-takens", array);
    const test::Run run = test::run(*again, y);
    CHECK(run.variance.rightCols(10000).mean() == Approx(takens_rms * takens_rms).epsilon(0.1));
  }
}

TEST_CASE("kalman-takens: limits of Q are the prediction and the channels") {
  const Eigen::VectorXd variances = Eigen::Vector2d(1, 4);
  const Eigen::MatrixXd y = noisy(sine(2000, 40), variances);
  const Array array = levels(variances);
  const auto run = [&](double q) {
    return test::run(*test::make("kalman-takens", array, {{"process_variance", q}}), y).x;
  };
  const Eigen::MatrixXd mean = test::run(*test::make("inverse-variance", array), y).x;
  CHECK((run(1e30) - mean).cwiseAbs().maxCoeff() < 1e-12);
  // A tiny Q: the channels of this very instant no longer count.
  Eigen::MatrixXd moved = y;
  moved.col(1999).array() += 100;
  const auto last = [&](const Eigen::MatrixXd& samples) {
    return test::run(*test::make("kalman-takens", array, {{"process_variance", 1e-30}}), samples).x(0, 1999);
  };
  CHECK(std::abs(last(moved) - last(y)) < 1e-3);
}

TEST_CASE("kalman-takens: an offset of 1e9 and a scale do no harm") {
  const Eigen::VectorXd variances = Eigen::Vector3d(1, 0.5, 2);
  const Eigen::MatrixXd y = noisy(sine(3000, 40), variances);
  const auto run = [&](const Eigen::VectorXd& v, const Eigen::MatrixXd& samples) {
    return test::run(*test::make("kalman-takens", levels(v)), samples).x;
  };
  const Eigen::MatrixXd x = run(variances, y);
  // Rounding of the samples to 1e-7 may exchange two neighbours that are equally far.
  CHECK(((run(variances, (y.array() + 1e9).matrix()).array() - 1e9).matrix() - x).cwiseAbs().maxCoeff() < 1e-3);
  CHECK((run(variances * 16, y * 4) / 4 - x).cwiseAbs().maxCoeff() < 1e-12);
}

TEST_CASE("kalman-takens: gaps are predicted, dead instants do not enter the dictionary") {
  const Eigen::VectorXd variances = Eigen::Vector2d(0.01, 0.01);
  const Eigen::VectorXd x = sine(4000, 40);
  Eigen::MatrixXd y = noisy(x, variances);
  y.block(0, 3000, 2, 20).setConstant(std::nan(""));
  y.block(1, 3500, 1, 100).setConstant(std::nan(""));
  const test::Run run = test::run(*test::make("kalman-takens", levels(variances)), y);
  CHECK(run.x.allFinite());
  CHECK((run.x.row(0).transpose() - x).segment(3000, 20).cwiseAbs().maxCoeff() < 0.3);
  CHECK(run.variance(0, 3019) > 10 * run.variance(0, 2999));
  CHECK(run.variance(0, 3550) > run.variance(0, 2999));
  const Eigen::MatrixXd none = Eigen::MatrixXd::Constant(2, 100, std::nan(""));
  CHECK(test::run(*test::make("kalman-takens", levels(variances)), none).x.array().isNaN().all());
  const Eigen::MatrixXd constant = Eigen::MatrixXd::Constant(2, 3000, 7);
  CHECK(test::run(*test::make("kalman-takens", levels(variances)), constant).x == constant.topRows(1));
}

TEST_CASE("kalman-takens: it predicts once there are two stretches of the past for each neighbour") {
  // Stretches of 2 that end 4 or more before now; six of them from eleven instants on.
  const Eigen::VectorXd variances = Eigen::Vector2d(0.01, 0.01), x = sine(40, 7);
  const test::Values values{{"dimension", 2}, {"neighbours", 3}, {"dictionary", 20}, {"theiler", 4}};
  for (Eigen::Index heard = 3; heard < 30; ++heard) {
    Eigen::MatrixXd y = noisy(x, variances).leftCols(heard + 1);
    y.col(heard).setConstant(std::nan(""));
    const test::Run run = test::run(*test::make("kalman-takens", levels(variances), values), y);
    CAPTURE(heard);
    CHECK(std::isfinite(run.x(0, heard)) == (heard >= 11));
  }
}

TEST_CASE("kalman-takens-taught: before any error is known a prediction is worth the spread") {
  Array array = levels(Eigen::VectorXd::Constant(1, 1e-6));
  array.learning_samples = 4;
  auto taught = test::make("kalman-takens-taught", array, {{"dimension", 1}, {"neighbours", 1}});
  const Eigen::RowVector4d past(1, 2, 4, 7);
  taught->learn(past, past);
  taught->finish_learning();
  const test::Run run = test::run(*taught, Eigen::RowVector2d(1, std::nan("")));
  CHECK(run.x(0, 1) == 2);                                       // what came after the 1
  CHECK(run.variance(0, 1) == Approx(26.0 / 4).epsilon(1e-12));  // of 1, 2, 4, 7 and 1
}

TEST_CASE("kalman-takens-taught: the dictionary is the reference, too short is said") {
  const Eigen::VectorXd variances = Eigen::Vector3d(1, 0.5, 2);
  const Eigen::VectorXd x = sine(6000, 40);
  const Eigen::MatrixXd y = noisy(x, variances);
  Array array = levels(variances);
  array.learning_samples = 2000;
  auto trained = test::make("kalman-takens-taught", array);
  trained->learn(y.leftCols(2000), x.head(2000).transpose());
  trained->finish_learning();
  auto mean = test::make("inverse-variance", array);
  const auto error = [&](Runner& runner) {
    return rms((test::run(runner, y.rightCols(4000)).x.row(0).transpose() - x.tail(4000)));
  };
  CHECK(error(*trained) < 0.65 * error(*mean));
  auto starved = test::make("kalman-takens-taught", array);
  starved->learn(y.leftCols(10), x.head(10).transpose());
  CHECK_THROWS_AS(starved->finish_learning(), Error);
}

TEST_CASE("kalman-takens: blocks of any size give the same bits") {
  const Eigen::VectorXd variances = Eigen::Vector2d(1, 4);
  const Eigen::MatrixXd y = noisy(sine(3500, 40), variances);
  for (const char* name : {"kalman-takens", "kalman-takens-published"}) {
    const Eigen::MatrixXd whole = test::run(*test::make(name, levels(variances)), y).x;
    for (const Eigen::Index block : {1, 13, 1000})
      CHECK(test::run(*test::make(name, levels(variances)), y, 1, block).x == whole);
  }
}

TEST_CASE("kalman-takens: what lives on repetition says so") {
  const auto remark = [](bool periodic) {
    test::Gaussian gauss(4);
    Array array = test::array(3);
    array.noise_levels = Eigen::Vector3d::Constant(0.04);
    Eigen::MatrixXd y(3, 4000);
    for (Eigen::Index k = 0; k < y.cols(); ++k) {
      const double x = periodic ? std::sin(0.15 * static_cast<double>(k)) : gauss();
      for (Eigen::Index i = 0; i < 3; ++i) y(i, k) = x + 0.2 * gauss();
    }
    auto fusion = test::make("kalman-takens", array);
    test::run(*fusion, y);
    libchar::Findings warnings;
    fusion->remarks(warnings);
    return warnings.find("input_repeats") != nullptr;
  };
  CHECK(remark(true));
  CHECK_FALSE(remark(false));
}

TEST_CASE("kalman-takens: two stretches of the past a neighbour, or a full dictionary, predict") {
  const auto predicted = [](Eigen::Index heard, double neighbours, double dictionary) {
    Eigen::MatrixXd y(2, heard + 1);
    for (Eigen::Index k = 0; k < heard; ++k) y.col(k).setConstant(k % 3 == 0 ? 2.5 : -0.5);
    y.col(heard).setConstant(std::nan(""));
    auto runner =
        test::make("kalman-takens", levels(Eigen::Vector2d(1e-4, 1e-4)),
                   {{"dimension", 2}, {"theiler", 2}, {"neighbours", neighbours}, {"dictionary", dictionary}});
    return test::run(*runner, y).variance(0, heard);
  };
  // A stretch is two instants, what follows it, and one that is too near to now.
  CHECK(std::isnan(predicted(8, 3, 1000)));
  CHECK(std::isnan(predicted(22, 15, 20)));
  // No prediction was judged yet: what the samples scatter by stands for its error.
  CHECK(predicted(9, 3, 1000) == Approx(9.0 * 3 * 6 / 9 / 8).epsilon(1e-12));
  CHECK(predicted(23, 15, 20) == Approx(9.0 * 8 * 15 / 23 / 22).epsilon(1e-12));
}
