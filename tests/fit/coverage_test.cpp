// A smaller, seeded version of tests/bench/fit_bench.cpp. With R records an efficiency scatters by
// sqrt(2/R) relative and a coverage by sqrt(.95 .05/R): limits are three of these below the
// targets, so that a right program fails one seed in about a hundred; the seed is fixed.
#include <catch2/catch.hpp>
#include <cmath>

#include "libchar/core/coefficient.hpp"
#include "libchar/core/noise_terms.hpp"
#include "libchar/fit/curve/bounds.hpp"
#include "libchar/fit/detail/band/bin_likelihood.hpp"
#include "libchar/fit/noise_fit.hpp"
#include "libchar/fit/record/power_bins.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;

TEST_CASE("efficiency, coverage, false terms and optimum on simulated records") {
  struct Scene {
    const char* name;
    double rate_hz, q, b, k;
  };
  constexpr std::size_t kCoverageSamples = 32768;
  constexpr int kRecords = 150;
  for (const Scene& scene : {Scene{"f", 200, 1e-3, 1e-2, 1e-2}, Scene{"c", 1000, 1e-3, 4e-3, 0},
                             Scene{"e", 200, 5e-3, 0, 2e-2}, Scene{"d", 200, 5e-3, 0, 0}}) {
    test::NoiseSource source(kCoverageSamples, scene.rate_hz, 77);
    test::Gaussian starts(1);
    const std::array<double, 3> truth = {scene.q, scene.b, scene.k};
    const TermSet present = {true, scene.b > 0, scene.k > 0, false, false};
    const auto bound = cramer_rao({scene.q * scene.q, scene.b * scene.b, scene.k * scene.k, 0, 0}, scene.rate_hz,
                                  kCoverageSamples, present);
    std::array<double, 3> square{}, covered{};
    int false_terms = 0, remedies = 0;
    for (int r = 0; r < kRecords; ++r) {
      const std::vector<double> y = source.record(scene.q, scene.b, scene.k);
      FitOptions options;
      options.white_top = true;  // the bounds are those of the terms alone
      const NoiseFit fit = fit_record(y, scene.rate_hz, nullptr, options);
      REQUIRE(fit.search.converged);
      remedies += fit.remedies.empty() ? 0 : 1;
      bool any_false = false;
      for (std::size_t i = 0; i < 3; ++i) {
        const Coefficient& c = fit.term[i];
        if (!present[i]) {
          any_false = any_false || c.status != Status::not_detected;
          continue;
        }
        square[i] += std::pow((c.value.value_or(0) - truth[i]) / (*bound[i] * truth[i]), 2) / kRecords;
        covered[i] += c.ci95.low <= truth[i] && truth[i] <= c.ci95.high ? 1.0 / kRecords : 0.0;
      }
      false_terms += any_false ? 1 : 0;
      // The likelihood looked at here is that of the whole spectrum.
      if (r >= 20 || !fit.band.whole || fit.shape.kind != NoiseShape::Kind::none) continue;
      const BinProblem problem = bin_problem(power_bins(y, scene.rate_hz));
      for (int s = 0; s < 4; ++s) {
        ModelPoint start;
        for (std::size_t i = 0; i < 3; ++i)
          start.theta[i] = fit.theta[i] > 0 ? fit.theta[i] * std::exp(4 * starts()) : 0;
        CHECK(score(problem, only_positive(start.theta), &start, 1e-12).half_deviance >
              half_deviance(problem, {fit.theta, {}}) - 1e-3);
      }
    }
    const std::array<double, 3> wanted = {0.90, 0.88, 0.85};
    for (std::size_t i = 0; i < 3; ++i) {
      if (!present[i]) continue;
      INFO(scene.name << " " << kTermNames[i].letter << " bound " << *bound[i] << " efficiency " << 1 / square[i]
                      << " coverage " << covered[i]);
      if (*bound[i] <= 0.13) CHECK(1 / square[i] > wanted[i] * (1 - 3 * std::sqrt(2.0 / kRecords)));
      CHECK(covered[i] > 0.95 - 3 * std::sqrt(0.95 * 0.05 / kRecords));
    }
    INFO(scene.name << " false terms " << false_terms << ", remedies " << remedies);
    CHECK(false_terms <= 8);  // records with a false or an undetermined term: 2 % expected
    CHECK(remedies <= 7);     // 1 % expected
  }
}

TEST_CASE("coverage near the limit: of everything that is said, and of what is called detected") {
  constexpr std::size_t kNearSamples = 32768;
  constexpr int kNearRecords = 400;
  constexpr double kNearRate = 200;
  const std::array<double, 3> truth = {5e-3, 2.5e-3, 1e-3};
  test::NoiseSource source(kNearSamples, kNearRate, 4711);
  FitOptions options;
  options.remedies = options.second_opinion = false;
  std::array<int, 3> covered{}, detected{}, detected_covered{};
  for (int r = 0; r < kNearRecords; ++r) {
    const std::vector<double> y = source.record(truth[0], truth[1], truth[2]);
    const NoiseFit fit = fit_power_bins(power_bins(y, kNearRate), kNearRate, kNearSamples, nullptr, options);
    for (std::size_t i = 0; i < 3; ++i) {
      const Coefficient& c = fit.term[i];
      const int inside = c.ci95.low <= truth[i] && truth[i] <= c.ci95.high ? 1 : 0;
      covered[i] += inside;
      if (c.status != Status::detected) continue;
      ++detected[i];
      detected_covered[i] += inside;
    }
  }
  for (std::size_t i = 0; i < 3; ++i) {
    INFO(kTermNames[i].letter << ": " << covered[i] << " of " << kNearRecords << ", detected " << detected_covered[i]
                              << " of " << detected[i]);
    CHECK(covered[i] >= 0.93 * kNearRecords);
    CHECK(detected_covered[i] >= 0.95 * detected[i] - 3 * std::sqrt(0.95 * 0.05 * detected[i]));
  }
  // Neither hopeless nor easy: otherwise nothing was selected.
  CHECK(detected[1] > 40);
  CHECK(detected[1] < kNearRecords - 40);
  CHECK(detected[2] > 40);
  CHECK(detected[2] < kNearRecords - 40);
}

TEST_CASE("coverage of what is said of short records of three terms, their limits among it") {
  constexpr int kShortRecords = 200;
  const std::array<double, 3> truth = {1, 1, 0.3};
  for (const std::size_t samples : {64U, 500U}) {
    test::NoiseSource source(samples, 1, 31);
    std::array<int, 3> held{};
    for (int r = 0; r < kShortRecords; ++r) {
      const NoiseFit fit = fit_record(source.record(truth[0], truth[1], truth[2]), 1, nullptr);
      for (std::size_t i = 0; i < 3; ++i) {
        const Coefficient& c = fit.term[i];
        held[i] += c.upper95 ? truth[i] <= *c.upper95 : c.ci95.low <= truth[i] && truth[i] <= c.ci95.high;
      }
    }
    for (std::size_t i = 0; i < 3; ++i) {
      INFO(samples << " samples, " << kTermNames[i].letter << ": " << held[i] << " of " << kShortRecords);
      // N of 500 samples was held in .81 where one small shape and one set of terms were all that limits knew.
      CHECK(held[i] >= 0.88 * kShortRecords);
    }
  }
}
