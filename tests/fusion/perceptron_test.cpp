// The tanh network against fixtures/known/fusion/mlp.csv; its training: what it reaches and what it refuses.

#include "libchar/fusion/algorithms/perceptron.hpp"

#include <Eigen/Core>
#include <catch2/catch.hpp>

#include "libchar/core/error.hpp"
#include "libchar/core/parallel/parallel.hpp"
#include "libchar/fusion/detail/network/network_training.hpp"
#include "tests/fusion/vectors.hpp"
#include "tests/support/algebra.hpp"
#include "tests/support/code_of.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;
using namespace libchar::fusion;

namespace {

struct TrainingScene {
  Eigen::MatrixXd y;
  Eigen::VectorXd x;
  Array array;
};

/// Three channels of unlike gain, bias and noise; the first `learning` instants are learnt from.
TrainingScene scene(Eigen::Index instants, Eigen::Index learning) {
  test::Gaussian gauss(11);
  const Eigen::Array3d gain(1.01, 0.9, 1.1), bias(-0.1, 0.4, 0), deviation(0.5, 0.2, 1);
  TrainingScene made{Eigen::MatrixXd(3, instants), Eigen::VectorXd(instants), test::array(3)};
  for (Eigen::Index k = 0; k < instants; ++k) {
    made.x[k] = 2.4 * gauss();
    for (Eigen::Index i = 0; i < 3; ++i) made.y(i, k) = gain[i] * made.x[k] + bias[i] + deviation[i] * gauss();
  }
  made.array.learning_samples = learning;
  return made;
}

std::unique_ptr<Runner> trained(const TrainingScene& s, const test::Values& values = {}) {
  auto runner = test::make("perceptron", s.array, values);
  const Eigen::Index n = s.array.learning_samples;
  runner->learn(s.y.leftCols(n), s.x.head(n).transpose());
  runner->finish_learning();
  return runner;
}

double rms_of(const Eigen::VectorXd& v) { return std::sqrt(v.squaredNorm() / static_cast<double>(v.size())); }

}  // namespace

TEST_CASE("tanh network: 50-digit outputs and Jacobian") {
  const test::Vectors file("mlp.csv");
  const std::vector<double> p = test::answers()["mlp"]["params"];
  const TanhNetwork network{5, 3};
  REQUIRE(network.size() == 22);
  Eigen::MatrixXd out(10, 1), rows(22, 10);
  const Eigen::MatrixXd x = file.block("x", 5);
  for (Eigen::Index k = 0; k < 10; ++k) {
    out(k, 0) = network.output(p.data(), x.col(k).data(), rows.col(k).data());
    CHECK(network.output(p.data(), x.col(k).data()) == out(k, 0));
  }
  CHECK(test::worst(out, file["out"], 2.22e-16) <= 1);
  CHECK(test::worst(rows, file.block("J", 22), 1.11e-16) <= 1);
}

TEST_CASE("tanh network: derivatives against differences, neurons in any order") {
  const TanhNetwork network{4, 6};
  test::Gaussian gauss(1);
  std::vector<double> p(network.size()), z(4), row(network.size());
  for (double& v : p) v = gauss();
  for (double& v : z) v = gauss();
  const double out = network.output(p.data(), z.data(), row.data());
  for (std::size_t i = 0; i < p.size(); ++i) {
    constexpr double kStep = 1e-5;
    std::vector<double> up = p, down = p;
    up[i] += kStep;
    down[i] -= kStep;
    const double slope = (network.output(up.data(), z.data()) - network.output(down.data(), z.data())) / (2 * kStep);
    CHECK(row[i] == Approx(slope).epsilon(1e-6).margin(1e-8));
  }
  std::vector<double> other = p;  // neurons 0 and 5 exchanged
  for (std::size_t i = 0; i < 4; ++i) std::swap(other[i], other[5 * 4 + i]);
  std::swap(other[network.b()], other[network.b() + 5]);
  std::swap(other[network.v()], other[network.v() + 5]);
  CHECK(network.output(other.data(), z.data()) == Approx(out).epsilon(1e-13));
}

TEST_CASE("network normals: sums over the rows, the same bits on one core and on all") {
  const TanhNetwork network{4, 5};
  test::Gaussian gauss(3);
  std::vector<double> p(network.size()), rows(5 * 1500);
  for (double& v : p) v = gauss();
  for (double& v : rows) v = gauss();
  const TrainingRows all{rows.data(), 1500};
  Eigen::MatrixXd slopes(1500, network.size());
  Eigen::VectorXd errors(1500);
  std::vector<double> row(network.size());
  for (Eigen::Index k = 0; k < 1500; ++k) {
    const double* const z = rows.data() + 5 * k;
    errors[k] = network.output(p.data(), z, row.data()) - z[4];
    slopes.row(k) = Eigen::Map<Eigen::RowVectorXd>(row.data(), slopes.cols());
  }
  NetworkNormals normals(network);
  REQUIRE(normals.linearise(all, p.data()));
  CHECK(normals.squares(all, p.data()) == Approx(errors.squaredNorm()).epsilon(1e-13));
  const Eigen::MatrixXd square = slopes.transpose() * slopes;
  const Eigen::VectorXd slope = slopes.transpose() * errors;
  const double size = square.cwiseAbs().maxCoeff();
  for (Eigen::Index i = 0; i < square.rows(); ++i) {
    CHECK(normals.slope()[i] == Approx(slope[i]).epsilon(1e-12).margin(1e-12 * size));
    for (Eigen::Index j = 0; j < square.cols(); ++j)
      CHECK(normals.curvature(i, j) == Approx(square(i, j)).epsilon(1e-12).margin(1e-13 * size));
  }
  const parallel::OneThread one;
  NetworkNormals alone(network);
  REQUIRE(alone.linearise(all, p.data()));
  for (Eigen::Index i = 0; i < square.rows(); ++i)
    for (Eigen::Index j = 0; j < square.cols(); ++j) CHECK(alone.curvature(i, j) == normals.curvature(i, j));
  CHECK(alone.squares(all, p.data()) == normals.squares(all, p.data()));
  p[0] = std::nan("");
  CHECK_FALSE(normals.linearise(all, p.data()));
  CHECK(std::isinf(normals.squares(all, p.data())));
}

TEST_CASE("perceptron: as good as affine least squares on a linear scene") {
  const TrainingScene s = scene(22000, 4000);
  // The best there can be: least squares with a constant, from the same window.
  Eigen::MatrixXd design(4000, 4);
  design << s.y.leftCols(4000).transpose(), Eigen::VectorXd::Ones(4000);
  const Eigen::VectorXd affine = test::solution(design, s.x.head(4000));
  const Eigen::MatrixXd rest = s.y.rightCols(18000);
  const double best = rms_of((rest.transpose() * affine.head(3)).array() + affine[3] - s.x.tail(18000).array());
  for (const double neurons : {3, 10}) {
    auto runner = trained(s, {{"neurons", neurons}});
    const test::Run run = test::run(*runner, rest);
    const double ours = rms_of(run.x.row(0).transpose() - s.x.tail(18000));
    INFO(neurons);
    CHECK(ours < 1.01 * best);
    CHECK(std::sqrt(run.variance(0, 0)) == Approx(ours).epsilon(0.08));
  }
}

TEST_CASE("perceptron: learns a bent sensor") {
  TrainingScene s = scene(8000, 4000);
  s.y = (s.y.array() / 2).tanh().matrix();  // every channel saturates
  auto runner = trained(s, {{"starts", 1}, {"neurons", 6}});
  const double ours = rms_of(test::run(*runner, s.y.rightCols(4000)).x.row(0).transpose() - s.x.tail(4000));
  Eigen::MatrixXd design(4000, 4);
  design << s.y.leftCols(4000).transpose(), Eigen::VectorXd::Ones(4000);
  const Eigen::VectorXd affine = test::solution(design, s.x.head(4000));
  const double straight =
      rms_of((s.y.rightCols(4000).transpose() * affine.head(3)).array() + affine[3] - s.x.tail(4000).array());
  CHECK(ours < 0.8 * straight);
}

TEST_CASE("perceptron: same seed, same bits, another seed, others, blocks do not matter") {
  const TrainingScene s = scene(3000, 2000);
  const Eigen::MatrixXd rest = s.y.rightCols(1000);
  const Eigen::MatrixXd x = test::run(*trained(s), rest).x;
  CHECK(test::run(*trained(s), rest).x == x);
  CHECK(test::run(*trained(s, {{"seed", 2}}), rest).x != x);
  {
    const parallel::OneThread one;
    CHECK(test::run(*trained(s), rest).x == x);
  }
  for (const Eigen::Index block : {1, 17}) CHECK(test::run(*trained(s), rest, 1, block).x == x);
  auto in_parts = test::make("perceptron", s.array);
  for (Eigen::Index k = 0; k < 2000; k += 250) in_parts->learn(s.y.middleCols(k, 250), s.x.segment(k, 250).transpose());
  in_parts->finish_learning();
  CHECK(test::run(*in_parts, rest).x == x);
}

TEST_CASE("perceptron: offset and scale cost nothing, a constant channel drops out") {
  const TrainingScene s = scene(3000, 2000);
  const Eigen::MatrixXd rest = s.y.rightCols(1000);
  const Eigen::MatrixXd x = test::run(*trained(s, {{"neurons", 3}}), rest).x;
  for (const double offset : {1e9, -1e6}) {
    TrainingScene moved = s;
    moved.y.array() += offset;
    moved.x.array() += offset;
    const Eigen::MatrixXd got = test::run(*trained(moved, {{"neurons", 3}}), moved.y.rightCols(1000)).x;
    CHECK(((got.array() - offset).matrix() - x).cwiseAbs().maxCoeff() < 1e-3);
  }
  TrainingScene scaled = s;
  scaled.y *= 0x1p-300;
  scaled.x *= 0x1p-300;
  CHECK(
      (test::run(*trained(scaled, {{"neurons", 3}}), scaled.y.rightCols(1000)).x * 0x1p300 - x).cwiseAbs().maxCoeff() <
      1e-9);
  TrainingScene dead = s;
  dead.y.row(2).setConstant(0.1);
  auto runner = trained(dead);
  Eigen::MatrixXd alive = dead.y.rightCols(1000);
  const Eigen::MatrixXd before = test::run(*runner, alive).x;
  alive.row(2).setConstant(55);
  CHECK(test::run(*runner, alive).x == before);
}

TEST_CASE("perceptron: of a long window a part is kept, missing samples give no estimate") {
  const TrainingScene s = scene(9000, 8000);
  auto runner = trained(s, {{"most_samples", 2000}, {"neurons", 3}});
  Eigen::MatrixXd rest = s.y.rightCols(1000);
  rest(1, 5) = std::nan("");
  const test::Run run = test::run(*runner, rest);
  CHECK(std::isnan(run.x(0, 5)));
  CHECK(std::isfinite(run.x(0, 6)));
  CHECK(rms_of(run.x.rightCols(990).transpose() - s.x.tail(990)) < 0.25);
}

TEST_CASE("perceptron: a wide array gets fewer neurons and says so") {
  const auto remarks = [](Eigen::Index channels) {
    Array array = test::array(channels);
    array.learning_samples = 1000;
    libchar::Findings warnings;
    test::make("perceptron", array)->remarks(warnings);
    return warnings;
  };
  CHECK(remarks(5).empty());
  CHECK_FALSE(remarks(200).empty());
  // A neuron has a weight for each channel, one for its offset and one to the output, which has an offset of its own.
  for (const double most : {300.0, 301.0, 312.0, 313.0}) {
    Array array = test::array(10);
    array.learning_samples = 1000;
    libchar::Findings warnings;
    test::make("perceptron", array, {{"neurons", 64}, {"most_weights", most}})->remarks(warnings);
    REQUIRE(warnings.find("perceptron_fewer_neurons") != nullptr);
    const int neurons = static_cast<int>((most - 1) / 12);
    CHECK_THAT(warnings.find("perceptron_fewer_neurons")->sentence,
               Catch::Contains("has " + std::to_string(neurons) + " neurons instead of 64"));
  }
}

TEST_CASE("perceptron: too few instants and useless numbers are refused") {
  TrainingScene s = scene(3000, 120);
  CHECK(test::code_of([&] { trained(s); }) == "E0860");
  CHECK(test::code_of([&] { trained(s, {{"neurons", 1}}); }) == "");
  // The engine keeps such samples away; the algorithm itself does not trust it.
  Perceptron perceptron(s.array, Settings(Perceptron::options));
  s.y.row(0).head(10).setConstant(1e308);
  s.y.row(0).segment(10, 10).setConstant(-1e308);
  for (Eigen::Index k = 0; k < 2000; ++k) perceptron.learn(Sample(s.y.col(k).data(), 3), Sample(&s.x[k], 1));
  CHECK(test::code_of([&] { perceptron.finish_learning(); }) == "E0861");
}

TEST_CASE("perceptron: a window longer than the room is no worse, however its length falls") {
  // 20 Hz at 200 Hz: every second sample, then every fourth, is one phase or two.
  const auto error_of = [](Eigen::Index learning) {
    TrainingScene s = scene(learning + 2000, learning);
    test::Gaussian gauss(3);
    for (Eigen::Index k = 0; k < s.x.size(); ++k) {
      s.x[k] = std::sin(2 * 3.14159265358979 * 0.1 * static_cast<double>(k) + 0.3);
      for (Eigen::Index i = 0; i < 3; ++i) s.y(i, k) = s.x[k] + 0.01 * gauss();
    }
    const auto runner = trained(s, {{"most_samples", 1000}});
    return rms_of(test::run(*runner, s.y.rightCols(2000)).x.row(0).transpose() - s.x.tail(2000));
  };
  const double whole = error_of(1000);
  CHECK(whole < 0.012);
  for (const Eigen::Index learning : {1001, 2001, 4003, 5005}) CHECK(error_of(learning) < 1.3 * whole);
}

TEST_CASE("perceptron: a reference that stands still is refused") {
  TrainingScene s = scene(2000, 1000);
  s.x.setConstant(4.5);
  CHECK(test::code_of([&] { trained(s); }) == "E0864");
}
