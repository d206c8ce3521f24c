// Scores without a reference that would cost more than they are allowed: on stretches, or not at all, and said.

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <limits>

#include "libchar/core/error.hpp"
#include "libchar/fusion/array.hpp"
#include "libchar/replay/detail/blind_share.hpp"
#include "libchar/replay/replay.hpp"
#include "tests/replay/replay_numbers.hpp"
#include "tests/replay/scene_text.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;
using Catch::Contains;
using test::named;

namespace {

constexpr int kRows = 60000;

// Four sensors of one slow input; their noise is up to four times as loud in the middle.
std::string uneven_log(std::uint64_t seed) {
  test::Gaussian gauss(seed);
  std::string out = "t[s],a,b,c,d\n";
  for (int k = 0; k < kRows; ++k) {
    const double loud = 1 + 3 * std::pow(std::sin(3.14159265358979 * k / kRows), 8);
    char cell[32];
    std::snprintf(cell, sizeof cell, "%.2f", 0.01 * k);
    out += cell;
    for (int i = 0; i < 4; ++i) {
      std::snprintf(cell, sizeof cell, ",%.8g", 5 * std::sin(0.02 * k) + loud * (1 + 0.2 * i) * gauss());
      out += cell;
    }
    out += '\n';
  }
  return out;
}

Scene uneven_scene(const test::SceneBench& bench, std::uint64_t seed) {
  bench.put("array.csv", uneven_log(seed));
  return bench.read(
      "format: scene\nversion: 1\nrecording: array.csv\nsensors: [a, b, c, d]\nrest: [0, 20]\n"
      "algorithms: [mean, inverse-variance, kalman-takens]\n");
}

ReplayResult within(const Scene& scene, double budget_s, std::size_t block = 0) {
  ReplayOptions options;
  options.budget_s = budget_s;
  options.block = block;
  return replay(scene, options);
}

bool said(const std::vector<std::string>& plan, const std::string& words) {
  for (const std::string& sentence : plan)
    if (sentence.find(words) != std::string::npos) return true;
  return false;
}

}  // namespace

TEST_CASE("budget: leave-one-out on stretches tells what it tells on all of the record") {
  for (const std::uint64_t seed : {3, 4}) {
    CAPTURE(seed);
    const test::SceneBench bench;
    const Scene scene = uneven_scene(bench, seed);
    const ReplayResult all = within(scene, std::numeric_limits<double>::infinity());
    const ReplayResult part = within(scene, 0.2);
    const AlgorithmResult &whole = named(all, "kalman-takens"), &cut = named(part, "kalman-takens");
    REQUIRE(cut.blind);
    CHECK(whole.blind->share == 1);
    CHECK(cut.blind->share > 0.05);
    CHECK(cut.blind->share < 0.5);
    CHECK(part.work.blind_steps < all.work.blind_steps);
    // The middle is louder: the plain RMS of stretches and of the whole are not what is compared.
    CHECK(cut.rmse == Approx(whole.rmse).epsilon(0.02));
    CHECK(cut.rmse_ci95.low < whole.rmse);
    CHECK(cut.rmse_ci95.high > whole.rmse);
    // Both uncertainties: not less than that of the method by which it is extended, but for what is drawn.
    const auto length = [](const Interval& i) { return std::log(i.high / i.low); };
    CHECK(length(cut.rmse_ci95) > 0.8 * length(whole.rmse_ci95));
    // The others are what they were.
    CHECK(named(part, "mean").rmse == named(all, "mean").rmse);
    CHECK(part.best == all.best);
    CHECK_FALSE(all.warnings.find("leave_one_out_budget"));
    const Finding* warning = part.warnings.find("leave_one_out_budget");
    REQUIRE(warning);
    CHECK_THAT(warning->where.rows.at(0), Contains("kalman-takens: on 16 stretches"));
    CHECK(said(part.plan, "leave-one-out of kalman-takens: on 16 stretches"));
  }
}

TEST_CASE("budget: the stretches and their scores depend on no block") {
  const test::SceneBench bench;
  const Scene scene = uneven_scene(bench, 5);
  const ReplayResult first = within(scene, 0.2);
  for (const std::size_t block : {97, 5000}) {
    const ReplayResult other = within(scene, 0.2, block);
    CHECK(named(other, "kalman-takens").rmse == named(first, "kalman-takens").rmse);
    CHECK(other.work.blind_steps == first.work.blind_steps);
  }
  ReplayOptions options;
  options.budget_s = 0.2;
  options.no_skip = true;
  CHECK(named(replay(scene, options), "kalman-takens").rmse == named(first, "kalman-takens").rmse);
}

TEST_CASE("budget: what would be too short to tell is left out, with a sentence") {
  const test::SceneBench bench;
  const Scene scene = uneven_scene(bench, 6);
  const ReplayResult result = within(scene, 1e-3);
  const AlgorithmResult& takens = named(result, "kalman-takens");
  CHECK(takens.ran);
  CHECK_FALSE(takens.blind);
  CHECK(std::isnan(takens.rmse));
  CHECK(said(result.plan, "leave-one-out of kalman-takens: left out, all of it would take"));
  REQUIRE(result.best);
  CHECK(result.algorithms[*result.best].label != "kalman-takens");
  for (const double bad : {0.0, -1.0, std::nan("")}) {
    std::string code;
    try {
      within(scene, bad);
    } catch (const Error& error) {
      code = error.problem().code;
    }
    CHECK(code == "E0917");
  }
}

TEST_CASE("budget: stretches lie in order, within the run, on whole cells of the meters") {
  const fusion::Entry& entry = fusion::algorithm("kalman-takens");
  fusion::Array array;
  array.channels = 6;
  array.noise_levels = Eigen::VectorXd::Ones(6);
  const fusion::Settings settings(entry.options);
  for (const std::int64_t run : {40000, 1234567, 20000000})
    for (const std::int64_t warm_up : {0, 777})
      for (const double budget : {0.05, 0.4, 3.0}) {
        CAPTURE(run, warm_up, budget);
        const BlindShare share = blind_share(entry, settings, array, run, warm_up, budget);
        const double allowed = static_cast<double>(run) * budget / share.cost_s;
        if (share.whole) {
          CHECK(share.cost_s <= budget);
          continue;
        }
        const auto cell =
            static_cast<std::int64_t>(ErrorMeter::cell_samples_of(static_cast<std::uint64_t>(run - warm_up)));
        std::int64_t before = 0, instants = 0;
        for (const BlindStretch& s : share.stretches) {
          CHECK(s.from >= before);
          CHECK(s.scored_from - s.from >= (s.to - s.from) / 5);
          CHECK((s.scored_from - warm_up) % cell == 0);
          CHECK((s.to - warm_up) % cell == 0);
          before = s.to;
          instants += s.to - s.from;
        }
        CHECK(before <= run);
        CHECK(static_cast<double>(instants) <= allowed);
      }
}
