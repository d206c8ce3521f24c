#include "libchar/replay/view/replay_view.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "libchar/replay/detail/tracks/run_tracks.hpp"
#include "libchar/replay/view/ranking.hpp"
#include "libchar/report/replay/replay_text.hpp"
#include "tests/replay/replay_numbers.hpp"
#include "tests/report/synthetic_replay.hpp"

using namespace libchar;
using Catch::Contains;

TEST_CASE("replay view: best first, those without a score behind, each that ran once") {
  ReplayResult r = test::synthetic_replay();
  r.algorithms[1].rmse = std::nan("");
  const ReplayView view = replay_view(r);
  const auto ran =
      std::count_if(r.algorithms.begin(), r.algorithms.end(), [](const AlgorithmResult& a) { return a.ran; });
  REQUIRE(view.ranked.size() == static_cast<std::size_t>(ran));
  for (std::size_t i = 1; i < view.ranked.size(); ++i)
    CHECK_FALSE(view.ranked[i]->result->rmse < view.ranked[i - 1]->result->rmse);
  CHECK(view.ranked.back()->result == &r.algorithms[1]);
  std::size_t skipped = 0;
  for (const SkippedAlgorithms& s : view.skipped) skipped += s.labels.size();
  CHECK(skipped + view.ranked.size() == r.algorithms.size());
}

TEST_CASE("replay view: an alarm on another sensor or at another time is one without a fault") {
  ReplayResult r = test::synthetic_replay();
  r.faults = {{1, FaultKind::bias, 0.5, 40, 50}};
  AlgorithmResult& a = r.algorithms[0];
  a.ran = a.watches_faults = true;
  a.answers = {{0, 0.02, 0.5}};
  a.faults = {{1, "bias", 41, 50.5}, {2, "bias", 41, 50.5}, {1, "bias", 60, {}}};
  const ReplayView view = replay_view(r);
  CHECK(view.algorithms[0].alarms_without_fault == 2);
  REQUIRE(view.algorithms[0].answers.size() == 1);
  CHECK(view.algorithms[0].answers[0]->found_s == 0.02);
}

TEST_CASE("replay view: marks are clipped to the run, and name what they mark") {
  ReplayResult r = test::synthetic_replay();  // from 0 to 100 s
  r.start_s = 20;
  r.instants = 60000;
  r.learning = TimeWindow{0, 30};
  r.scored_from_s = 22;
  r.faults = {{1, FaultKind::scale, 0.85, 10, 25},
              {2, FaultKind::stuck, 0, 70, std::numeric_limits<double>::infinity()},
              {0, FaultKind::bias, 1, 90, 95}};
  const ReplayView view = replay_view(r);
  REQUIRE(view.run.marks.size() == 5);
  CHECK(view.run.marks[0].kind == "learning");
  CHECK(view.run.marks[0].from_s == 20);
  CHECK(view.run.marks[0].to_s == 30);
  CHECK(view.run.marks[1].kind == "warm-up");
  CHECK(view.run.marks[1].to_s == 22);
  CHECK(view.run.marks[2].label == "gyr_1: scale 0.85");
  CHECK(view.run.marks[2].sensor == "gyr_1");
  CHECK(view.run.marks[2].from_s == 20);
  CHECK(view.run.marks[3].label == "gyr_2: stuck");
  CHECK(view.run.marks[3].to_s == 80);
  CHECK(view.run.marks[4].kind == "found");  // by the method that is drawn, and nobody declared it
  CHECK_THAT(view.run.marks[4].label, Catch::EndsWith(" found"));
  CHECK(view.run.method == r.algorithms[*r.best].label);
  CHECK(view.run.sensor == "gyr_0");
}

TEST_CASE("replay view: shares of the run that a sensor was out, clipped to it") {
  ReplayResult r = test::synthetic_replay();
  r.start_s = 20;
  r.instants = 60000;  // to 80 s
  AlgorithmResult& a = r.algorithms[0];
  a.ran = a.watches_faults = true;
  a.faults = {{1, "bias", 10, 26}, {1, "gain", 74, {}}, {2, "noise", 30, 40}, {0, "dead", 30, 33}};
  const ReplayView view = replay_view(r);
  REQUIRE(view.algorithms[0].out_share.size() == r.sensors.size());
  CHECK(view.algorithms[0].out_share[0] == Approx(0.05));
  CHECK(view.algorithms[0].out_share[1] == Approx(0.2));
  CHECK(view.algorithms[0].out_share[2] == 0);
}

TEST_CASE("replay view: run time matters from a thousandth of a core on") {
  ReplayResult r = test::synthetic_replay();
  for (AlgorithmResult& a : r.algorithms) a.ns_per_sample = 50;
  r.algorithms[2].ns_per_sample = 1000;
  r.rate_hz = 999;
  CHECK_FALSE(replay_view(r).figures.time_matters);
  CHECK(replay_view(r).algorithms[2].core_share == Approx(0.999e-3));
  r.rate_hz = 1001;
  CHECK(replay_view(r).figures.time_matters);
  r.algorithms[2].ran = false;
  CHECK_FALSE(replay_view(r).figures.time_matters);
}

TEST_CASE("replay view: deviations of many sensors fit a page, and keep their extremes") {
  ReplayResult r = test::without_reference();
  std::mt19937_64 random(7);
  r.tracks.whole.deviations = test::synthetic_track(64, 2000, 0.05, 100, random);
  r.tracks.whole.deviations.high[63][1234] = 8.5;
  const ReplayView view = replay_view(r);
  const Timeline& thin = view.run.deviations;
  REQUIRE(thin.high.size() == 64);
  CHECK(thin.time_s.size() * 129 <= 2 * 40000);
  CHECK(*std::max_element(thin.high[63].begin(), thin.high[63].end()) == 8.5);
}

TEST_CASE("replay view: what stands at the end has a row a matrix column, and no negative root") {
  ReplayResult r = test::synthetic_replay(3);
  for (AlgorithmResult& a : r.algorithms) {
    a.weights.clear();
    a.variances.clear();
  }
  r.algorithms[0].variances = {4, -1, 0};
  r.algorithms[0].variance_error = 0;
  const ReplayView view = replay_view(r);
  REQUIRE(view.final_rows.size() == 1);
  CHECK(view.final_rows[0].values[0] == 2);
  CHECK(std::isnan(view.final_rows[0].values[1]));
  CHECK(std::isnan(view.final_rows[0].distance));
}

TEST_CASE("replay view: tracks of any number of algorithms fit a page, and keep their extremes") {
  ReplayResult r = test::synthetic_replay(12);
  r.algorithms[3].weight_track.high[4][123] = 7.5;
  const std::size_t divisor = track_divisor(r);
  CHECK(divisor > 1);
  const ReplayView view = replay_view(r);
  CHECK(view.algorithms[3].weight_track.high == merged_bins(r.algorithms[3].weight_track, divisor).high);
  const Timeline merged = merged_bins(r.algorithms[3].weight_track, divisor);
  CHECK(merged.time_s.size() == (400 + divisor - 1) / divisor);
  CHECK(*std::max_element(merged.high[4].begin(), merged.high[4].end()) == 7.5);
  // The run and its close-ups stand beside them.
  CHECK(dump_json(replay_json(r)).size() < 4'500'000);
}

TEST_CASE("replay: the front holds exactly what no method beats in both") {
  const ReplayResult r = test::synthetic_replay();
  const ParetoFront front = pareto_front(r);
  const ReplayView view = replay_view(r);
  for (std::size_t i = 0; i < r.algorithms.size(); ++i) {
    const AlgorithmResult& a = r.algorithms[i];
    bool beaten = !a.ran || a.bound;
    for (const AlgorithmResult& b : r.algorithms)
      beaten = beaten || (b.ran && !b.bound && b.rmse < a.rmse && b.ns_per_sample < a.ns_per_sample);
    INFO(a.label);
    CHECK(front.time[i] == !beaten);
    CHECK(view.algorithms[i].on_time_front == !beaten);
  }
}

TEST_CASE("replay verdict: names the best, who needs a teacher, and who is not told apart") {
  ReplayResult r = test::synthetic_replay();
  CHECK_THAT(test::verdict_of(r, true), Contains("Use mean: RMSE 0.033 rad/s"));
  CHECK_THAT(test::verdict_of(r, true), Contains("3 ns per sample"));
  CHECK_THAT(test::verdict_of(r, false), !Contains("ns per sample"));
  // A trained method wins: the best that needs no reference is named as well.
  for (AlgorithmResult& a : r.algorithms)
    if (a.label == "least-squares") a.rmse = 0.02;
  test::judge(r);
  CHECK_THAT(test::verdict_of(r), Contains("Use least-squares"));
  CHECK_THAT(test::verdict_of(r), Contains("of the methods that need none mean is best"));
  CHECK_THAT(test::verdict_of(r), Contains("Every other method is worse"));
  // A bound is never recommended, however good.
  for (AlgorithmResult& a : r.algorithms)
    if (a.bound) a.rmse = 0.001;
  test::judge(r);
  CHECK_THAT(test::verdict_of(r), Contains("Use least-squares"));
  CHECK_THAT(test::verdict_of(test::without_reference()), Contains("all sensors share"));
  CHECK_THAT(test::verdict_of(test::nothing_scored()), Contains("No algorithm has a score"));
}
