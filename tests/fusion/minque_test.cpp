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
