// What an algorithm learnt, handed out and taken in by another one: the same estimates, bit for bit.
#include "libchar/fusion/learnt.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "libchar/core/error.hpp"
#include "libchar/fusion/registry.hpp"
#include "libchar/fusion/runner.hpp"
#include "libchar/fusion/why_not.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;
using namespace libchar::fusion;
using Catch::Contains;

namespace {

struct TaughtLog {
  Eigen::MatrixXd y, truth;
  Array array;
};

// Three channels of a swinging input (or a gyroscope and two accelerometer axes), with gaps.
TaughtLog taught_log(bool tilt, Eigen::Index instants = 3000) {
  TaughtLog out{Eigen::MatrixXd(3, instants), Eigen::MatrixXd(1, instants), {}};
  test::Gaussian gauss(5);
  const double w = 0.02, rate_hz = 100;
  for (Eigen::Index k = 0; k < instants; ++k) {
    const double t = static_cast<double>(k), x = std::sin(w * t);
    out.truth(0, k) = x;
    if (tilt) {
      out.y.col(k) << w * rate_hz * std::cos(w * t) + 0.05, std::sin(x), std::cos(x);
    } else {
      out.y.col(k) << x, 0.3 + 1.1 * x, x;
    }
    for (Eigen::Index i = 0; i < 3; ++i) out.y(i, k) += 0.01 * static_cast<double>(1 + i) * gauss();
    if (k % 97 == 50) out.y(1, k) = std::nan("");
    if (k % 211 == 7) out.truth(0, k) = std::nan("");
  }
  out.array.channels = 3;
  out.array.noise_levels = Eigen::Vector3d(1e-4, 4e-4, 9e-4);
  out.array.rate_hz = rate_hz;
  out.array.learning_samples = 2000;
  if (tilt) out.array.tilt = TiltChannels{};
  return out;
}

std::unique_ptr<Runner> taught_runner(const Entry& entry, const TaughtLog& data) {
  auto runner = entry.make(data.array, Settings(entry.options));
  runner->learn(data.y.leftCols(2000), data.truth.leftCols(2000));
  runner->finish_learning();
  return runner;
}

Learnt handed_out_by(Runner& runner) {
  LearntExchange with;
  REQUIRE(runner.exchange(with));
  return with.learnt();
}

std::string refusal_of_learnt(const Entry& entry, const TaughtLog& data, Learnt learnt, double ratio = 1) {
  auto runner = entry.make(data.array, Settings(entry.options));
  LearntExchange with(std::move(learnt), ratio);
  try {
    runner->exchange(with);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("learnt: taken in by another one, every algorithm estimates the same bits") {
  int learning = 0;
  for (const bool tilt : {false, true}) {
    const TaughtLog data = taught_log(tilt);
    for (const Entry& entry : algorithms()) {
      const Needs& needs = entry.description->needs;
      if (!(needs.reference || needs.reference_helps) || entry.description->needs.tilt != tilt) continue;
      if (!why_not(*entry.description, data.array).empty()) continue;
      INFO(entry.description->name);
      ++learning;
      const auto one = taught_runner(entry, data);
      const Learnt learnt = handed_out_by(*one);
      CHECK_FALSE(learnt.empty());
      const auto other = entry.make(data.array, Settings(entry.options));
      LearntExchange with(learnt, 1);
      REQUIRE(other->exchange(with));
      Eigen::MatrixXd x(1, 1000), v(1, 1000), x2(1, 1000), v2(1, 1000);
      one->run(data.y.rightCols(1000), x, v);
      other->run(data.y.rightCols(1000), x2, v2);
      CHECK(x.array().isFinite().count() > 900);
      for (Eigen::Index k = 0; k < 1000; ++k) {
        const bool both = std::isnan(x(0, k)) && std::isnan(x2(0, k));
        if (!both) REQUIRE(x(0, k) == x2(0, k));
        if (!std::isnan(v(0, k)) || !std::isnan(v2(0, k))) REQUIRE(v(0, k) == v2(0, k));
      }
      // What was taken in is handed out again as it was.
      const Learnt again = handed_out_by(*taught_runner(entry, data));
      REQUIRE(again.size() == learnt.size());
      for (std::size_t i = 0; i < learnt.size(); ++i) CHECK(again[i].values == learnt[i].values);
    }
  }
  CHECK(learning == 10);
}

TEST_CASE("learnt: what learns nothing hands out nothing, and takes nothing") {
  const TaughtLog data = taught_log(false);
  const Entry& mean = algorithm("mean");
  const auto runner = mean.make(data.array, Settings(mean.options));
  CHECK(handed_out_by(*runner).empty());
  CHECK_THAT(refusal_of_learnt(mean, data, {{"weights", {1, 2, 3}}}), Contains("learnt.weights"));
}

TEST_CASE("learnt: numbers that do not fit are refused by name") {
  const TaughtLog data = taught_log(false);
  const Entry& entry = algorithm("least-squares");
  const Learnt learnt = handed_out_by(*taught_runner(entry, data));
  REQUIRE(refusal_of_learnt(entry, data, learnt).empty());
  Learnt less = learnt;
  less.erase(less.begin());
  CHECK_THAT(refusal_of_learnt(entry, data, less), Contains("learnt.gains: is missing"));
  Learnt longer = learnt;
  longer[2].values.push_back(0);
  CHECK_THAT(refusal_of_learnt(entry, data, longer), Contains("learnt.weights: expected 3 numbers, found 4"));
  Learnt more = learnt;
  more.push_back({"colour", {1}});
  CHECK_THAT(refusal_of_learnt(entry, data, more), Contains("learnt.colour"));
  Learnt zero = learnt;
  zero[0].values[1] = 0;
  CHECK_THAT(refusal_of_learnt(entry, data, zero), Contains("learnt.gains: a gain of zero"));
}

TEST_CASE("learnt: stretches of the past mean nothing at another rate") {
  const TaughtLog data = taught_log(false);
  const Entry& entry = algorithm("kalman-takens-taught");
  const Learnt learnt = handed_out_by(*taught_runner(entry, data));
  CHECK(refusal_of_learnt(entry, data, learnt, 1.005).empty());
  CHECK_THAT(refusal_of_learnt(entry, data, learnt, 2), Contains("2 times"));
  // Weights do not count samples.
  const Entry& weights = algorithm("least-squares");
  CHECK(refusal_of_learnt(weights, data, handed_out_by(*taught_runner(weights, data)), 2).empty());
}
