// Which method is recommended, and of what "does fusion pay?" is answered.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <catch2/catch.hpp>

#include "libchar/fusion/registry.hpp"
#include "libchar/replay/detail/judge/judgement.hpp"
#include "libchar/replay/replay.hpp"
#include "libchar/replay/view/ranking.hpp"
#include "tests/replay/replay_numbers.hpp"
#include "tests/replay/scene_text.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;
using Catch::Contains;

namespace {

struct Rated {
  const char* name;
  double rmse, low, high, cost;
  std::vector<double> weights = {};
};

std::string chosen(const std::vector<Rated>& methods, bool reference = true, bool fusions = false) {
  ReplayResult result;
  result.has_reference = reference;
  std::vector<double> costs;
  for (const Rated& m : methods) {
    AlgorithmResult a;
    a.label = m.name;
    a.description = fusion::algorithm(m.name).description;
    a.ran = true;
    a.availability = 1;
    a.rmse = m.rmse;
    a.rmse_ci95 = {m.low, m.high};
    if (!m.weights.empty()) a.weights = {m.weights};
    result.algorithms.push_back(a);
    costs.push_back(m.cost);
  }
  const auto best = choose_method(result, costs, fusions);
  return best ? result.algorithms[*best].label : "";
}

}  // namespace

TEST_CASE("choice: the smallest error, and of ties the mended and the cheaper") {
  CHECK(chosen({{"mean", 1.2, 1, 1.3, 1}, {"minque", 1.0, .9, 1.1, 50}}) == "minque");
  CHECK(chosen({{"mean", 1.009, 1, 1.3, 1}, {"minque", 1.0, .9, 1.1, 50}}) == "mean");
  CHECK(chosen({{"minque-published", .995, .9, 1.1, 1}, {"minque", 1.0, .9, 1.1, 50}}) == "minque");
  CHECK(chosen({{"minque-published", .5, .4, .6, 1}, {"minque", 1.0, .9, 1.1, 50}}) == "minque-published");
  // Without a reference a score holds the noise of the sensor that is left out: less than one per cent may decide.
  CHECK(chosen({{"mean", 1.009, 1, 1.3, 1}, {"minque", 1.0, .9, 1.1, 50}}, false) == "minque");
  CHECK(chosen({{"median", 1, 1, 1.3, 2}, {"mean", 1, 1, 1.3, 1}}, false) == "mean");
}

TEST_CASE("choice: a method whose interval spans a decade does not win") {
  CHECK(chosen({{"kalman-takens", .006, .00012, .29, 1}, {"minque", .033, .0329, .0333, 50}}) == "minque");
  CHECK(chosen({{"kalman-takens", .006, .00012, .29, 1}}) == "kalman-takens");
}

TEST_CASE("choice: one sensor handed on is no fusion") {
  const std::vector<Rated> methods = {{"best-axes", 1, .9, 1.1, 1, {0, 1, 0}},
                                      {"mean", 1.5, 1.4, 1.6, 1, {.3, .3, .4}}};
  CHECK(chosen(methods) == "best-axes");
  CHECK(chosen(methods, true, true) == "mean");
}

TEST_CASE(
    "choice: forms as published run by name or on request, and the question of fusion is that of the best fusion") {
  test::SceneBench bench;
  std::string text = "t[s],a,b,c,x\n";
  test::Gaussian gauss(9);
  for (int k = 0; k < 4000; ++k) {
    const double x = 2 * std::sin(0.05 * k), drift = std::sin(0.002 * k);
    text += fmt::format("{},{},{},{},{}\n", 0.01 * k, x + 0.01 * gauss(), x + 0.5 + drift + 0.3 * gauss(),
                        x - 0.9 + 0.3 * gauss(), x);
  }
  bench.put("log.csv", text);
  const std::string head =
      "format: scene\nversion: 1\nrecording: log.csv\nsensors: [a, b, c]\nreference: x\nlearning: [0, 20]\n";
  const Scene scene = bench.read(head);
  const ReplayResult plain = replay(scene);
  for (const AlgorithmResult& a : plain.algorithms)
    if (a.description->as_published) CHECK_THAT(a.why, Contains("`published`"));
  ReplayOptions options;
  options.published = true;
  CHECK(test::named(replay(scene, options), "random-weighting-published").ran);
  const ReplayResult asked = replay(bench.read(head + "algorithms: [mean, minque-published]\n"));
  CHECK(test::named(asked, "minque-published").ran);
  const ReplayResult alone = replay(bench.read(head + "algorithms: [mean, best-axes]\n"));
  REQUIRE(alone.best);
  CHECK(alone.algorithms[*alone.best].label == "best-axes");
  CHECK(alone.best_fusion == "mean");
  CHECK_THAT(fmt::format("{}", fmt::join(verdict_sentences(alone, false), " ")),
             Contains("best-axes takes a alone.") && Contains("the error of mean, the best fusion, is"));
}
