// Ways to get coefficients: who gives what on noise whose coefficients are known.

#include <catch2/catch.hpp>
#include <cmath>

#include "libchar/benchmark/bench_document.hpp"
#include "libchar/benchmark/detail/estimators.hpp"
#include "libchar/core/error.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;

namespace {

BenchSignal white_signal(std::uint64_t samples) {
  BenchSignal signal{"white", {}, 100, samples};
  signal.model.noise[0].status = Status::given;
  signal.model.noise[0].value = 2e-3;
  return signal;
}

const EstimatorAccuracy& method(const CharacterizationBench& bench, const std::string& name) {
  for (const EstimatorAccuracy& m : bench.methods)
    if (m.name == name) return m;
  throw std::runtime_error(name);
}

}  // namespace

TEST_CASE("every estimator gets white noise and random walk within what it can") {
  // Not simulated by the library: an exact generator of the tests.
  test::NoiseSource source(1U << 16U, 100, 3);
  const std::vector<double> y = source.record(2e-3, 0, 4e-3);
  const TermSet terms = {true, false, true, false, false};
  for (const Estimator& estimator : estimators()) {
    INFO(estimator.name);
    const NoiseEstimate estimate = estimator.estimate(y, 100, terms);
    REQUIRE(estimate[0].value);
    REQUIRE(estimate[2].value);
    // allan_variance_ros takes the first ten seconds for white, whatever is in them.
    const bool knows_white = estimator.name != "allan_variance_ros";
    if (knows_white) CHECK(*estimate[0].value == Approx(2e-3).epsilon(0.25));
    CHECK(*estimate[2].value == Approx(4e-3).epsilon(0.5));
    if (estimator.is_ours) CHECK(*estimate[0].value == Approx(2e-3).epsilon(0.05));
  }
}

TEST_CASE("the bound is reached by the likelihood, not by the recipes, and coverage is stated") {
  CharacterizationBenchOptions options;
  options.records = 60;
  options.methods = {"sensorchar", "whittle", "log-log"};
  const CharacterizationBench bench = bench_characterization(white_signal(4096), options);
  REQUIRE(bench.methods.size() == 3);
  const EstimatorAccuracy& ours = method(bench, "sensorchar");
  // sd of a white coefficient: 1/sqrt(2 N) relative; the RMSE of 60 records is within 30 % of it at three sd.
  CHECK(ours.terms.at(0).bound == Approx(2e-3 / std::sqrt(2 * 4096.0)).epsilon(0.02));
  CHECK(ours.error == Approx(1).epsilon(0.3));
  CHECK(ours.terms[0].coverage.value > 0.85);
  CHECK(ours.false_terms.count == 60);
  CHECK(ours.false_terms.value < 0.15);
  CHECK(method(bench, "log-log").error > 2);
  CHECK(method(bench, "log-log").terms[0].coverage.count == 0);
  CHECK(method(bench, "whittle").false_terms.count == 0);
  CHECK(ours.ns_per_sample.value > 0);
}

TEST_CASE("the same seed gives the same errors, another gives others") {
  CharacterizationBenchOptions options;
  options.records = 3;
  options.methods = {"whittle"};
  const BenchSignal signal = white_signal(1024);
  const double first = bench_characterization(signal, options).methods[0].error;
  CHECK(bench_characterization(signal, options).methods[0].error == first);
  options.seed = 99;
  CHECK(bench_characterization(signal, options).methods[0].error != first);
}

TEST_CASE("benchmarks of noise: refused in a sentence") {
  CharacterizationBenchOptions options;
  options.records = 2;
  BenchSignal silent = white_signal(1024);
  silent.model.noise[0] = {};
  CHECK_THROWS_WITH(bench_characterization(silent, options), Catch::Contains("E0962"));
  options.methods = {"whitle"};
  CHECK_THROWS_WITH(bench_characterization(white_signal(1024), options),
                    Catch::Contains("E0202") && Catch::Contains("whittle"));
}
