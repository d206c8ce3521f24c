// MINQUE as published: 50-digit vector, and the flags of the run with three faults.

#include <catch2/catch.hpp>

#include "tests/fusion/vectors.hpp"

using namespace libchar::fusion;

TEST_CASE("minque-published: 50-digit vector about the running mean") {
  const test::Vectors inputs("fusion_inputs.csv"), expected("minque_ewma_g0.99.csv");
  auto minque = test::make("minque-published", test::array(5), {{"gamma", 0.99}, {"about_zero", 0}});
  const Eigen::MatrixXd y = inputs.block("c", 5), v = expected.block("var", 5), w = expected.block("w", 5);
  double worst_v = 0, worst_w = 0, worst_x = 0;
  for (Eigen::Index k = 0; k < y.cols(); ++k) {
    const test::Run out = test::run(*minque, y.col(k));
    worst_v = std::max(worst_v, test::worst(*minque->variances(), v.col(k), 4.44e-15, 3.95e-12));
    worst_w = std::max(worst_w, test::worst(*minque->weights(), w.col(k), 3.95e-12, 3.95e-12));
    worst_x =
        std::max(worst_x, test::worst(out.x, Eigen::MatrixXd::Constant(1, 1, expected["xhat"][k]), 3.95e-12, 3.95e-12));
  }
  CHECK(worst_v <= 1);
  CHECK(worst_w <= 1);
  CHECK(worst_x <= 1);
  libchar::Findings warnings;
  minque->remarks(warnings);
  REQUIRE(warnings.find("negative_variance") != nullptr);
  CHECK(warnings.find("negative_variance")->count == 220);
}

TEST_CASE("minque-published: the flags of three faults") {
  const auto answer = nlohmann::json::parse(test::slurp(test::known("fusion/faults_expected.json")));
  const auto& pairs = answer["pairs (differences, consistent state, common threshold)"];
  const test::Vectors inputs("faults_input.csv");
  Array array = test::array(6);
  array.fault_free_samples = answer["fault_free_samples"];
  const double recovery = answer["recovery_time_samples"];
  auto minque = test::make("minque-published", array,
                           {{"gamma", answer["gamma"]},
                            {"about_zero", 0},
                            {"common_threshold", 1},
                            {"settling", 0},
                            {"recovery_samples", recovery}});
  const test::Run out = test::run(*minque, inputs.block("y", 6));
  const auto events = minque->faults()->events();
  const auto& changes = pairs["flag_changes_k_sensor_state"];
  REQUIRE(events.size() == changes.size());
  for (std::size_t i = 0; i < events.size(); ++i) {
    CHECK(events[i].sample + 1 == changes[i][0].get<std::int64_t>());
    CHECK(events[i].channel + 1 == changes[i][1].get<int>());
    CHECK(events[i].faulty == (changes[i][2].get<int>() == 1));
    CHECK(events[i].rule == FaultRule::variance);
  }
  const Eigen::VectorXd variances = *minque->variances();
  for (Eigen::Index i = 0; i < 6; ++i)
    CHECK(variances[i] == Approx(pairs["est_at_6000"][static_cast<std::size_t>(i)].get<double>()).epsilon(5e-4));
  const double rms = std::sqrt((out.x.row(0).transpose() - inputs["x"]).tail(5000).squaredNorm() / 5000);
  // The vector weighs the three instants of exclusion by variances that the failing channel still
  // took part in; here they are those of the channels that remain. An independent computation gives
  // this figure with the one rule and the vector's with the other (docs/theory/fusion.md).
  CHECK(rms == Approx(0.04926546105648161).epsilon(1e-12));
  CHECK(rms == Approx(pairs["rms_fused_1001_6000"].get<double>()).epsilon(5e-4));
}

TEST_CASE("minque-published: about zero a lasting bias stays visible, about the mean it does not") {
  const test::Vectors inputs("faults_input.csv");
  Eigen::MatrixXd y = inputs.block("y", 6).leftCols(3000);
  // Healthy samples over and over, then channel 2 with 0.4 (5.7 sigma) for good.
  Eigen::MatrixXd longer(6, 9000);
  longer << y, y, y;
  longer.row(1).tail(6000).array() += 0.4;
  Array array = test::array(6);
  array.fault_free_samples = 2000;
  for (const bool mended : {true, false}) {
    INFO(mended);
    auto minque =
        test::make("minque-published", array,
                   {{"gamma", 0.99}, {"about_zero", mended}, {"common_threshold", !mended}, {"recovery_samples", 200}});
    test::run(*minque, longer);
    bool out = false;
    for (const FaultEvent& event : minque->faults()->events())
      if (event.channel == 1) out = event.faulty;
    CHECK(out == mended);
  }
}

TEST_CASE("weights of the plain mean are there before the first sample") {
  for (const char* name : {"minque-published", "random-weighting", "random-weighting-published"}) {
    CAPTURE(name);
    const auto weights = test::make(name, test::array(5))->weights();
    REQUIRE(weights);
    CHECK((*weights - Eigen::MatrixXd::Constant(5, 1, 0.2)).cwiseAbs().maxCoeff() < 1e-15);
  }
}
