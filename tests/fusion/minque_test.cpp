// Recursive re-weighted MINQUE: the 50-digit vector, efficiency against the formulas of thesis.md
// C, faults.

#include <catch2/catch.hpp>

#include "tests/fusion/vectors.hpp"

using namespace libchar::fusion;

namespace {

/// The literal recursion of the vectors: no ridge, one at the start, floor relative to the largest.
const test::Values kLiteral{{"gamma", 0.99},
                            {"damping", 0},
                            {"floor", 0},
                            {"floor_largest", 1e-4},
                            {"start_variance", 1},
                            {"fault_detection", 0}};

}  // namespace

TEST_CASE("minque: 50-digit vector of the recursion") {
  NEEDS_SHARED("oracle/fusion/rminque_g0.99.csv");
  const test::Vectors inputs("fusion_inputs.csv"), expected("rminque_g0.99.csv");
  auto minque = test::make("minque", test::given(5), kLiteral);
  const Eigen::MatrixXd y = inputs.block("c", 5), v = expected.block("var", 5);
  double worst_v = 0, worst_x = 0;
  for (Eigen::Index k = 0; k < y.cols(); ++k) {
    const test::Run out = test::run(*minque, y.col(k));
    worst_x = std::max(
        worst_x,
        test::worst(
            out.x, Eigen::MatrixXd::Constant(1, 1, expected["xhat"][k]), 3.92e-14, 2.93e-13));
    worst_v = std::max(worst_v, test::worst(*minque->variances(), v.col(k), 7.99e-15, 6.29e-12));
  }
  CHECK(worst_x <= 1);
  CHECK(worst_v <= 1);
}

TEST_CASE("minque: faults are found, kept out and let in again") {
  NEEDS_SHARED("oracle/fusion/faults_input.csv");
  const test::Vectors inputs("faults_input.csv");
  Given given = test::given(6);
  given.fault_free_samples = 2000;
  auto minque = test::make("minque", given, {{"recovery_samples", 200}});
  const test::Run out = test::run(*minque, inputs.block("y", 6));
  // Sensor 1 dead from 3000 on (counted from zero), sensor 2 -30 % from 3800, sensor 3 +25 % from
  // 4400 to 4999.
  struct Expected {
    std::int64_t from, to;
    int channel;
    bool faulty;
  };
  const std::vector<Expected> expected{
      {3000, 3002, 0, true}, {3800, 3810, 1, true}, {4400, 4413, 2, true}, {5200, 5320, 2, false}};
  const auto events = minque->faults()->events();
  REQUIRE(events.size() == expected.size());
  for (std::size_t i = 0; i < events.size(); ++i) {
    INFO(i);
    CHECK(events[i].sample >= expected[i].from);
    CHECK(events[i].sample <= expected[i].to);
    CHECK(events[i].channel == expected[i].channel);
    CHECK(events[i].faulty == expected[i].faulty);
  }
  const auto error = [&](Eigen::Index from) {
    return std::sqrt((out.x.row(0).transpose() - inputs["x"]).tail(6000 - from).squaredNorm() /
                     static_cast<double>(6000 - from));
  };
  CHECK(error(1000) < 0.0493);  // the published rule: 0.04925 ... 0.04930
}
