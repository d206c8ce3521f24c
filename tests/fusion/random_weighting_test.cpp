// Random weighting: the published form against 50-digit vectors, the default against batch MINQUE.

#include <catch2/catch.hpp>

#include "libchar/core/error.hpp"
#include "tests/fusion/vectors.hpp"

using namespace libchar::fusion;

TEST_CASE("random-weighting-published: 50-digit vectors") {
  const test::Vectors inputs("fusion_inputs.csv"), expected("random_weighting.csv");
  auto fusion = test::make("random-weighting-published", test::array(5));
  const Eigen::MatrixXd y = inputs.block("c", 5), v = expected.block("var", 5);
  double worst_v = 0, worst_x = 0;
  for (Eigen::Index k = 0; k < y.cols(); ++k) {
    const test::Run out = test::run(*fusion, y.col(k));
    worst_v = std::max(worst_v, test::worst(*fusion->variances(), v.col(k), 2.31e-14, 7.54e-11));
    worst_x =
        std::max(worst_x, test::worst(out.x, Eigen::MatrixXd::Constant(1, 1, expected["xhat"][k]), 1.48e-10, 4.65e-11));
  }
  CHECK(worst_v <= 1);
  CHECK(worst_x <= 1);
  CHECK_THROWS_AS(test::make("random-weighting-published", test::array(5), {{"second_channel", 1}}), libchar::Error);
  CHECK_THROWS_AS(test::make("random-weighting-published", test::array(5), {{"second_channel", 6}}), libchar::Error);
}

TEST_CASE("random-weighting: the variances of the whole record, whatever the offset") {
  const test::Vectors inputs("fusion_inputs.csv");
  const Eigen::MatrixXd y = inputs.block("c", 5);
  // MINQUE of n channels of one input (Rao 1970): n/(n-2) [s_i - sum s / (n (n-1))], s_i the mean
  // square of y_i - mean(y).
  const Eigen::ArrayXd s = (y.rowwise() - y.colwise().mean()).array().square().rowwise().mean();
  const Eigen::VectorXd expected = (5.0 / 3 * (s - s.sum() / 20)).matrix();
  for (const double offset : {0.0, 10.0, 1e3}) {
    INFO(offset);
    auto fusion = test::make("random-weighting", test::array(5));
    const test::Run out = test::run(*fusion, (y.array() + offset).matrix());
    CHECK(test::worst(*fusion->variances(), expected, 1e-13, 1e-11 * (1 + offset)) <= 1);
    const double rms =
        std::sqrt(((out.x.row(0).transpose() - inputs["x"]).array() - offset).tail(1000).square().mean());
    CHECK(rms < 0.145);  // the published form: 0.2568 without an offset
  }
}
