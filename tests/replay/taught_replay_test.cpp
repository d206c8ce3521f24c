// With a reference and nothing said, the first half of a recording teaches, and alignment is taken where it pays.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "libchar/replay/detail/align/alignment_stage.hpp"
#include "libchar/replay/replay.hpp"
#include "libchar/replay/view/ranking.hpp"
#include "libchar/report/replay/replay_text.hpp"
#include "libchar/scene/scene_file.hpp"
#include "tests/replay/replay_numbers.hpp"
#include "tests/replay/scene_text.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;
using Catch::Contains;

namespace {

struct TaughtArray {
  double delay = 0, bias = 0, gain = 0;
  int rows = 4000;
};

std::string taught_log(const TaughtArray& o) {
  std::string text = "t[s],a,b,c,x\n";
  test::Gaussian gauss(11);
  const auto motion = [](double t) { return 2 * std::sin(0.21 * t) + std::sin(0.34 * t + 1) + std::sin(0.0123 * t); };
  for (int k = 0; k < o.rows; ++k)
    text +=
        fmt::format("{},{},{},{},{}\n", 0.01 * k, motion(k) + 0.05 * gauss(),
                    (1 + o.gain) * motion(k - o.delay) + o.bias + 0.05 * gauss(), motion(k) + 0.1 * gauss(), motion(k));
  return text;
}

const std::string kTaught = "format: scene\nversion: 1\nrecording: log.csv\nsensors: [a, b, c]\nreference: x\n";

ReplayResult run_taught(const TaughtArray& array, const std::string& more = "") {
  test::SceneBench bench;
  bench.put("log.csv", taught_log(array));
  return replay(bench.read(kTaught + more));
}

std::vector<std::string> kept(const ReplayResult& result) {
  std::vector<std::string> out;
  for (const AlignmentResult::Trial& trial : result.alignment->trials)
    if (trial.kept && !trial.term.empty()) out.push_back(trial.term);
  return out;
}

double best_rmse(const ReplayResult& result) { return result.algorithms[*result.best].rmse; }

}  // namespace

TEST_CASE("teaching: the first half teaches, and each term is taken only where it pays") {
  const ReplayResult late = run_taught({.delay = 0.6});
  REQUIRE(late.alignment);
  CHECK(kept(late).front() == "delay");
  CHECK(late.alignment->learnt.channels[1].delay == Approx(0.6).margin(0.02));
  CHECK(late.learning->to_s == Approx(20));
  CHECK(late.evaluation.from_s == Approx(20));
  CHECK_THAT(fmt::format("{}", fmt::join(verdict_sentences(late, false), " ")),
             Contains("The first half of the recording (0 s to 20 s) was used for learning") &&
                 Contains("after correcting the sensors, in turn: delay") && Contains("without benefit: bias"));
  const Json json = replay_json(late)["alignment"]["trials"];
  CHECK(json[0]["term"] == "");
  CHECK(json[1]["term"] == "bias");
  CHECK(json[1]["kept"] == false);
  const std::string explained = "learning: [0, 20]\n";
  const ReplayResult learnt = run_taught({.delay = 0.6}, explained),
                     all = run_taught({.delay = 0.6}, explained + "align: {learn: learning}\n"),
                     asked = run_taught({.delay = 0.6}, explained + "align: {learn: learning, choose: true}\n");
  CHECK(best_rmse(late) < 0.8 * best_rmse(learnt));  // the simplex makes up for a part of the delay
  CHECK(best_rmse(late) < 1.01 * best_rmse(all));
  CHECK(best_rmse(late) == best_rmse(asked));
  CHECK(kept(run_taught({.bias = 0.5})) == std::vector<std::string>{"bias"});
  CHECK(kept(run_taught({.gain = 0.1})) == std::vector<std::string>{"gain"});
}

TEST_CASE("teaching: what pays nothing is not applied, and the error budget is there all the same") {
  const ReplayResult plain = run_taught({});
  REQUIRE(plain.alignment);
  CHECK(kept(plain).empty());
  CHECK_FALSE(plain.alignment->applied);
  CHECK(plain.alignment->budget.before > 0);
  CHECK(test::named(plain, "mean").rmse == test::named(run_taught({}, "learning: [0, 20]\n"), "mean").rmse);
  CHECK(test::named(plain, "least-squares").ran);
}

TEST_CASE("teaching: nothing is decided where something is said, or where there is too little") {
  for (const char* said :
       {"evaluation: [0, end]\n", "learning: [0, 10]\n", "fault_free_s: 5\n", "algorithms: [mean, minque]\n",
        "faults: [{sensor: a, kind: bias, value: 1, from_s: 5}]\n"}) {
    INFO(said);
    CHECK_FALSE(run_taught({.delay = 0.6}, said).alignment);
  }
  const ReplayResult little = run_taught({.delay = 0.6, .rows = 400});
  CHECK_FALSE(little.alignment);
  CHECK_FALSE(little.learning);
  test::SceneBench bench;
  bench.put("log.csv", taught_log({}));
  CHECK_THAT(bench.refusal("format: scene\nversion: 1\nrecording: log.csv\nsensors: [a, b, c]\n"
                           "align: {learn: run, choose: true}\n"),
             Contains("E0748") && Contains("a reference judges"));
  const Scene silent =
      bench.read(kTaught.substr(0, kTaught.find("reference")) + "reference: {channels: [x], teach: false}\n");
  CHECK_THAT(scene_yaml(silent), Contains("teach: false"));
  CHECK_FALSE(replay(silent).alignment);
  CHECK(replay(silent).evaluation.from_s == 0);
}

TEST_CASE("taught replay: a method that learnt from the reference is none of those that need none") {
  const ReplayResult result = run_taught({}, "algorithms: [least-squares, neural-simplex, mean]\n");
  REQUIRE(result.best);
  for (const std::string& sentence : verdict_sentences(result, false))
    CHECK_THAT(sentence, !Contains("need none neural-simplex"));
  ReplayResult other = result;
  for (std::size_t k = 0; k < other.algorithms.size(); ++k)
    if (other.algorithms[k].label == "neural-simplex") other.best = k;
  CHECK_THAT(fmt::format("{}", fmt::join(verdict_sentences(other, false), " ")),
             Contains("neural-simplex learns from a reference; of the methods that need none mean"));
}
