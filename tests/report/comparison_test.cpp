#include "libchar/report/comparison.hpp"

#include <catch2/catch.hpp>

#include "libchar/core/error.hpp"
#include "libchar/report/replay_json.hpp"
#include "tests/report/synthetic_replay.hpp"

using namespace libchar;
using Catch::Contains;

namespace {

ReportedReplay reported(const ReplayResult& r, const std::string& file = "a.json") {
  return read_reported_replay(dump_json(replay_json(r)), file);
}

AlgorithmResult& named(ReplayResult& r, const std::string& label) {
  for (AlgorithmResult& a : r.algorithms)
    if (a.label == label) return a;
  throw std::runtime_error("no " + label);
}

Comparison with_change(double rmse_factor) {
  const ReplayResult a = test::synthetic_replay();
  ReplayResult b = a;
  AlgorithmResult& m = named(b, "minque");
  m.rmse *= rmse_factor;
  m.rmse_ci95 = {0.99 * m.rmse, 1.01 * m.rmse};
  return compare_replays(reported(a), reported(b, "b.json"));
}

const ComparedAlgorithm& row(const Comparison& c, const std::string& label) {
  for (const ComparedAlgorithm& r : c.both)
    if (r.a.label == label) return r;
  throw std::runtime_error("no " + label);
}

}  // namespace

TEST_CASE("comparison: changes, and whether the intervals tell them") {
  const Comparison small = with_change(1.01), large = with_change(1.1);
  CHECK(small.differences.empty());
  CHECK(*row(small, "minque").score_change == Approx(0.01));
  CHECK(*row(small, "minque").resolved == false);
  CHECK(*row(large, "minque").resolved == true);
  CHECK(*row(large, "mean").score_change == 0);
  CHECK(large.only_a.empty());
}

TEST_CASE("comparison: a check fails above its limit and not at it") {
  const Comparison c = with_change(1.1);
  CHECK(breaches(c, check_from_words("rmse+10.1%")).empty());
  const auto broken = breaches(c, check_from_words("rmse+9.9%"));
  REQUIRE(broken.size() == 1);
  CHECK_THAT(broken[0], Contains("minque: rmse went from"));
  CHECK(breaches(c, check_from_words("mean:rmse+0%")).empty());
  CHECK(breaches(c, check_from_words("minque:rmse+0.001")).size() == 1);
  CHECK(breaches(c, check_from_words("ns_per_sample+0%")).empty());
  CHECK(breaches(c, check_from_words("peak_bytes+0")).empty());
  // Better is no breach.
  CHECK(breaches(with_change(0.5), check_from_words("rmse+0%")).empty());
}

TEST_CASE("comparison: percents of a regret are percentage points") {
  const ReplayResult a = test::synthetic_replay();
  ReplayResult b = a;
  named(b, "minque").regret += 0.03;
  const Comparison c = compare_replays(reported(a), reported(b));
  CHECK(breaches(c, check_from_words("regret+4%")).empty());
  CHECK(breaches(c, check_from_words("regret+2%")).size() == 1);
  CHECK(breaches(c, check_from_words("regret+0.02")).size() == 1);
}

TEST_CASE("comparison: what no longer runs, or was never measured, does not pass a check") {
  const ReplayResult a = test::synthetic_replay();
  ReplayResult b = a;
  named(b, "minque").ran = false;
  named(b, "minque").why = "minque needs more sensors";
  const Comparison c = compare_replays(reported(a), reported(b));
  REQUIRE(c.only_a.size() == 1);
  CHECK(c.only_a[0].second == "minque needs more sensors");
  REQUIRE(breaches(c, check_from_words("minque:rmse+5%")).size() == 1);
  CHECK_THAT(breaches(c, check_from_words("minque:rmse+5%"))[0], Contains("ran in A and not in B"));
  REQUIRE(breaches(c, check_from_words("minqe:rmse+5%")).size() == 1);
  CHECK_THAT(breaches(c, check_from_words("minqe:rmse+5%"))[0], Contains("nothing to compare"));
  ReplayResult unmeasured = a;
  for (AlgorithmResult& x : unmeasured.algorithms) x.peak_bytes.reset();
  CHECK(!breaches(compare_replays(reported(a), reported(unmeasured)),
                  check_from_words("peak_bytes+5%"))
             .empty());
}

TEST_CASE("comparison: unlike scenes are named") {
  const ReplayResult a = test::synthetic_replay();
  const auto differs = [&](auto&& change, const char* word) {
    ReplayResult b = a;
    change(b);
    const auto sentences = scene_differences(reported(a), reported(b));
    INFO(word);
    REQUIRE(sentences.size() == 1);
    CHECK_THAT(sentences[0], Contains(word));
  };
  differs([](ReplayResult& r) { r.logs[0].sha256[0] = 'f'; }, "recording differs");
  differs([](ReplayResult& r) { r.sensors[4].name = "other"; }, "sensors");
  differs([](ReplayResult& r) { r.sensors[4].unit = "deg/s"; }, "units");
  differs([](ReplayResult& r) { r.inputs[0].unit = "deg/s"; }, "inputs");
  differs([](ReplayResult& r) { r.start_s = 10; }, "evaluation differs");
  differs([](ReplayResult& r) { r.instants = 7; }, "evaluation differs");
  differs([](ReplayResult& r) { r.scene.reference->channels = {"another"}; }, "reference differs");
  differs([](ReplayResult& r) { r.faults[0].value = 0.6; }, "faults");
  // What a clock measured, which algorithms run, and where the file lies are no part of the scene.
  ReplayResult b = a;
  b.scene.file = "elsewhere.yaml";
  b.logs[0].file = "elsewhere.csv";
  b.algorithms.pop_back();
  b.seconds = 1;
  CHECK(scene_differences(reported(a), reported(b)).empty());
}

TEST_CASE("comparison: leave-one-out scores compare with their like") {
  const ReplayResult a = test::without_reference();
  const Comparison c = compare_replays(reported(a), reported(a));
  CHECK(*row(c, "mean").a.score == a.algorithms[0].rmse);
  CHECK(!scene_differences(reported(a), reported(test::synthetic_replay())).empty());
  CHECK_THAT(comparison_markdown(c, {}), Contains("leave-one-out RMS"));
}

TEST_CASE("comparison: a document that is none is refused with its place") {
  const Json good = replay_json(test::synthetic_replay());
  const auto refused = [&](const std::string& text) {
    try {
      read_reported_replay(text, "b.json");
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("taken");
  };
  CHECK_THAT(refused("{\"format\":"), Contains("b.json:1:"));
  CHECK_THAT(refused("[]"), Contains("E0920"));
  CHECK_THAT(refused("{\"format\":\"characterization\",\"version\":1}"),
             Contains("characterization"));
  Json newer = good;
  newer["version"] = 2;
  CHECK_THAT(refused(dump_json(newer)), Contains("version 2 is newer"));
  Json lacking = good;
  lacking["algorithms"][3].erase("rmse");
  CHECK_THAT(refused(dump_json(lacking)), Contains("algorithms[3].rmse"));
  Json wrong = good;
  wrong["algorithms"][2]["rmse"] = "much";
  CHECK_THAT(refused(dump_json(wrong)), Contains("algorithms[2].rmse"));
  Json twice = good;
  twice["algorithms"][1]["label"] = twice["algorithms"][0]["label"];
  CHECK_THAT(refused(dump_json(twice)), Contains("algorithms[1].label"));
  Json scalar = good;
  scalar["scene"] = 3;
  CHECK_THAT(refused(dump_json(scalar)), Contains("E0922"));
}

TEST_CASE("comparison: a check is read or refused") {
  const Check c = check_from_words("least-squares (2):ns_per_sample+5.5%");
  CHECK(c.label == "least-squares (2)");
  CHECK(c.metric == "ns_per_sample");
  CHECK(c.relative);
  CHECK(c.limit == Approx(0.055));
  for (const char* bad : {"",
                          "rmse",
                          "rmse5%",
                          "rmse+",
                          "rmse+x",
                          "rmse+-5%",
                          "rmse+%",
                          "+5%",
                          ":rmse+5%",
                          "rsme+5%",
                          "rmse+nan",
                          "rmse+inf"}) {
    INFO(bad);
    CHECK_THROWS_AS(check_from_words(bad), Error);
  }
  CHECK_THROWS_WITH(check_from_words("rsme+5%"), Contains("did you mean rmse?"));
}
