#include "libchar/replay/comparison.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "libchar/core/error.hpp"
#include "libchar/replay/report/replay_report.hpp"
#include "libchar/report/compare/comparison_text.hpp"
#include "tests/support/shared.hpp"

using Catch::Contains;
using libchar::Json;

namespace {

Json algorithm(const std::string& label, double rmse, double low, double high, double ns = 10) {
  return {{"name", label},
          {"label", label},
          {"status", "ran"},
          {"why", nullptr},
          {"bound", false},
          {"rmse", rmse},
          {"rmse_ci95", {low, high}},
          {"regret", rmse - 1},
          {"ns_per_sample", ns},
          {"peak_bytes", 1000},
          {"options", {{"gamma", 0.99}}}};
}

Json skipped(const std::string& label) {
  return {{"name", label},   {"label", label},       {"status", "skipped"}, {"why", "needs"},
          {"rmse", nullptr}, {"rmse_ci95", nullptr}, {"regret", nullptr}};
}

// A report of two sensors with the keys that replay writes.
Json report() {
  return {
      {"format", "replay-report"},
      {"version", 1},
      {"tool", {{"name", "sensorchar"}, {"version", "0.1.0"}}},
      {"input", {{{"path", "log.csv"}, {"sha256", "aa"}, {"bytes", 10}}}},
      {"scene", {{"name", "pair"}, {"file", "pair.yaml"}, {"simulated", false}}},
      {"rate_hz", 100.0},
      {"instants", 5000},
      {"learning", nullptr},
      {"evaluation", {{"from_s", 0}, {"to_s", 50}}},
      {"reference", {{"use", "each instant"}, {"lag_s", 0.1}, {"lag_estimated", true}}},
      {"inputs", {{{"name", "truth"}, {"unit", "m"}}}},
      {"sensors",
       {{{"name", "left"}, {"unit", "m"}, {"rmse", 2.0}, {"h", {1}}, {"noise_variance", 4}},
        {{"name", "right"}, {"unit", "m"}, {"rmse", 3.0}, {"h", {1}}}}},
      {"faults", {{{"sensor", "left"}, {"kind", "bias"}, {"value", 1}, {"from_s", 5}, {"to_s", nullptr}}}},
      {"best", "mean"},
      {"algorithms", {algorithm("mean", 1.0, 0.9, 1.1), algorithm("median", 1.2, 1.15, 1.3), skipped("tilt-kalman")}}};
}

libchar::ReplayReport summary(const Json& json, const std::string& name = "report.json") {
  return libchar::parse_replay_report(json.dump(1), name);
}

libchar::Comparison compared(const Json& a, const Json& b) {
  return libchar::compare_replays(summary(a, "a.json"), summary(b, "b.json"));
}

std::string refused(const Json& b) {
  const auto comparison = compared(report(), b);
  try {
    libchar::refuse_unlike(comparison);
  } catch (const libchar::Error& error) {
    CHECK(error.problem().code == "E0921");
    CHECK(error.problem().kind == libchar::ErrorKind::input);
    return error.what();
  }
  return "";
}

// What is said of the first report after `change`.
template <class Change>
std::string refused_after(const Change& change) {
  Json b = report();
  change(b);
  return refused(b);
}

std::string reading_error(const std::string& text) {
  try {
    libchar::parse_replay_report(text, "r.json");
  } catch (const libchar::Error& error) {
    CHECK(error.problem().kind == libchar::ErrorKind::input);
    return error.what();
  }
  return "";
}

template <class Change>
std::string reading_error_after(const Change& change) {
  Json changed = report();
  change(changed);
  return reading_error(changed.dump(1));
}

std::string check_error(const std::string& text) {
  try {
    libchar::parse_comparison_check(text);
  } catch (const libchar::Error& error) {
    CHECK(error.problem().kind == libchar::ErrorKind::usage);
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("comparison: changes, and what the intervals say of them") {
  Json b = report();
  b["algorithms"] = {algorithm("mean", 0.8, 0.75, 0.85, 12), algorithm("median", 1.25, 1.2, 1.4, 5),
                     algorithm("minque", 0.7, 0.6, 0.8)};
  b["best"] = "minque";
  const auto c = compared(report(), b);
  CHECK(c.unlike.empty());
  REQUIRE(c.algorithms.size() == 4);
  CHECK(c.algorithms[0].label == "minque");  // by RMSE of B
  CHECK(c.algorithms[0].a == nullptr);
  CHECK(std::isnan(c.algorithms[0].rmse_change));
  CHECK(side_of(c.algorithms[0]) == "only in B");
  CHECK(c.algorithms[1].label == "mean");
  CHECK(c.algorithms[1].difference == libchar::Difference::better);
  CHECK(c.algorithms[1].rmse_change == Approx(-0.2));
  CHECK(c.algorithms[1].ns_change == Approx(0.2));
  CHECK(c.algorithms[1].bytes_change == 0);
  CHECK(c.algorithms[2].difference == libchar::Difference::not_resolved);
  CHECK(c.algorithms[2].ns_change == Approx(-0.5));
  CHECK(side_of(c.algorithms[3]) == "only in A, skipped");
  const std::string& verdict = c.verdict;
  CHECK_THAT(verdict, Contains("RMSE of 2 algorithms that ran in both: 1 better, 1 not resolved."));
  CHECK_THAT(verdict, Contains("Time a sample: -15.0 % (median)"));
  CHECK_THAT(verdict, Contains("mean (1) in A, minque (0.7) in B"));
  // The other way round everything changes sides.
  const auto back = compared(b, report());
  for (const auto& row : back.algorithms)
    if (row.label == "mean") CHECK(row.difference == libchar::Difference::worse);
}

TEST_CASE("comparison: a report against itself is equal and passes every check") {
  const auto c = compared(report(), report());
  CHECK(c.unlike.empty());
  CHECK(c.remarks.empty());
  for (const auto& row : c.algorithms)
    CHECK(row.difference == (row.both_ran() ? libchar::Difference::equal : libchar::Difference::unknown));
  for (const char* check : {"rmse+0%", "regret+0%", "ns_per_sample+0%", "peak_bytes+0%"})
    CHECK(failures(c, libchar::parse_comparison_check(check)).empty());
}

TEST_CASE("comparison: unlike scenes are refused by what differs") {
  CHECK(refused(report()).empty());
  CHECK_THAT(refused_after([](Json& b) { b["input"][0]["sha256"] = "bb"; }),
             Contains("contents of the log: log.csv (sha256 aa…) in A, log.csv (sha256 bb…) in B"));
  // The place of a file is not its content.
  CHECK(refused_after([](Json& b) { b["input"][0]["path"] = "elsewhere/log.csv"; }).empty());
  CHECK_THAT(refused_after([](Json& b) { b["input"][0]["sha256"] = nullptr; }),
             Contains("sha256 of log.csv is not in both"));
  CHECK_THAT(refused_after([](Json& b) { b["sensors"].erase(1); }),
             Contains("sensors that the other does not have: right in A, nothing in B"));
  CHECK_THAT(refused_after([](Json& b) { std::swap(b["sensors"][0], b["sensors"][1]); }),
             Contains("sensors are in another order"));
  CHECK_THAT(refused_after([](Json& b) { b["sensors"][1]["unit"] = "mm"; }),
             Contains("unit of sensor right: m in A, mm in B"));
  CHECK_THAT(refused_after([](Json& b) { b["sensors"][1]["h"] = {-1}; }), Contains("row h of sensor right"));
  CHECK_THAT(refused_after([](Json& b) { b["sensors"][0]["rmse"] = 2.1; }),
             Contains("sensor left alone has an RMSE of 2 in A, 2.1 in B"));
  CHECK_THAT(refused_after([](Json& b) { b["evaluation"]["from_s"] = 10; }),
             Contains("evaluation: 0 s to 50 s in A, 10 s to 50 s in B"));
  CHECK_THAT(refused_after([](Json& b) { b["instants"] = 4999; }),
             Contains("instants of the evaluation: 5000 in A, 4999 in B"));
  CHECK_THAT(refused_after([](Json& b) { b["rate_hz"] = 200; }), Contains("rate: 100 Hz in A, 200 Hz in B"));
  CHECK_THAT(refused_after([](Json& b) { b["reference"] = nullptr; }), Contains("reference: one in A, none in B"));
  CHECK_THAT(refused_after([](Json& b) { b["reference"]["lag_s"] = 0.2; }),
             Contains("lag behind the reference: 0.1 s in A, 0.2 s in B"));
  CHECK_THAT(refused_after([](Json& b) { b["reference"]["use"] = "interpolated"; }), Contains("use of the reference"));
  CHECK_THAT(refused_after([](Json& b) { b["inputs"][0]["name"] = "angle"; }),
             Contains("true inputs that the other does not have: truth in A, angle in B"));
  CHECK_THAT(refused_after([](Json& b) { b["faults"][0]["value"] = 2; }),
             Contains("fault 1: left bias 1 from 5 s in A, left bias 2 from 5 s in B"));
  CHECK_THAT(refused_after([](Json& b) { b["faults"] = Json::array(); }), Contains("number of faults: 1 in A, 0 in B"));
}

TEST_CASE("comparison: simulations are told apart by seed, then by what was simulated") {
  Json a = report();
  a["scene"] = {{"name", "s"}, {"file", "s"}, {"simulated", true}, {"seed", 1}, {"identity", "x"}};
  a["input"] = Json::array();
  Json b = a;
  CHECK(compared(a, b).unlike.empty());
  b["scene"]["identity"] = "y";
  CHECK_THAT(compared(a, b).unlike.at(0), Contains("the same seed, but another simulation"));
  b["scene"]["seed"] = 2;
  CHECK(compared(a, b).unlike.at(0) == "seed of the simulation: 1 in A, 2 in B");
  CHECK(compared(a, report()).unlike.at(0) == "the scene is: a simulation in A, a recording in B");
}

TEST_CASE("comparison: settings that differ are remarked, not refused") {
  Json b = report();
  b["learning"] = {{"from_s", 0}, {"to_s", 10}};
  b["tool"]["version"] = "0.2.0";
  b["sensors"][0]["noise_variance"] = 5;
  b["algorithms"][0]["options"]["gamma"] = 0.999;
  const auto c = compared(report(), b);
  CHECK(c.unlike.empty());
  CHECK(c.remarks == std::vector<std::string>{
                         "program: 0.1.0 in A, 0.2.0 in B", "learning window: none in A, 0 s to 10 s in B",
                         "algorithms were given other noise levels of left", "mean.gamma: 0.99 in A, 0.999 in B"});
}

TEST_CASE("comparison: checks hold at their limit and fail above it") {
  Json b = report();
  b["algorithms"][0] = algorithm("mean", 1.0625, 1, 1.1, 15);
  const auto c = compared(report(), b);
  const auto failing = [&](const char* text) { return failures(c, libchar::parse_comparison_check(text)); };
  CHECK(failing("rmse+6.25%").empty());
  REQUIRE(failing("rmse+6.2%").size() == 1);
  CHECK(failing("rmse+6.2%")[0] == "mean: rmse 1 in A, 1.0625 in B: 6.25 % more, 6.2 % is allowed");
  CHECK(failing("median:rmse+0%").empty());
  CHECK(failing("mean:ns_per_sample+49%").size() == 1);
  CHECK(failing("mean:ns_per_sample+50%").empty());
  // Regret is a share already: the limit is in its own points.
  CHECK(failing("mean:regret+6.25%").empty());
  CHECK_THAT(failing("mean:regret+6%").at(0), Contains("6.25 points more, 6 are allowed"));
  // Less than 1 kB more is the allocator's; more counts.
  b["algorithms"][0]["peak_bytes"] = 2024;
  const auto grown = libchar::parse_comparison_check("mean:peak_bytes+10%");
  CHECK(failures(compared(report(), b), grown).empty());
  b["algorithms"][0]["peak_bytes"] = 2025;
  CHECK(failures(compared(report(), b), grown).size() == 1);
  // A loss is a failure, an algorithm that B was not asked for is none.
  b["algorithms"][0] = skipped("mean");
  const auto lost = compared(report(), b);
  CHECK_THAT(failures(lost, libchar::parse_comparison_check("rmse+50%")).at(0),
             Contains("mean: rmse is 1 in A, and there is none in B: needs"));
  b["algorithms"].erase(0);
  const auto not_asked = compared(report(), b);
  CHECK(failures(not_asked, libchar::parse_comparison_check("rmse+50%")).empty());
  CHECK(failures(not_asked, libchar::parse_comparison_check("mean:rmse+50%")).size() == 1);
}

TEST_CASE("comparison: a check that cannot fail is refused") {
  const auto c = compared(report(), report());
  CHECK_THROWS_WITH(failures(c, libchar::parse_comparison_check("tilt-kalman:rmse+5%")), Contains("E0923"));
  CHECK_THROWS_WITH(failures(c, libchar::parse_comparison_check("medain:rmse+5%")), Contains("did you mean median?"));
  for (const char* text :
       {"", "rmse", "rmse+5", "rmse+%", "rmse+-5%", "rmse+nan%", "rmse+inf%", "+5%", ":rmse+5%", "speed+5%", "rmse-5%"})
    CHECK_THAT(check_error(text), Contains("E0922"));
  CHECK_THAT(check_error("ns_per_smaple+5%"), Contains("did you mean ns_per_sample?"));
  CHECK(libchar::parse_comparison_check("minque (gamma=0.9):rmse+5%").label == "minque (gamma=0.9)");
}

TEST_CASE("comparison: what is no report of a replay is refused with its place") {
  CHECK_THAT(reading_error("no"), Contains("r.json:1:") && Contains("E0601"));
  CHECK_THAT(reading_error(""), Contains("is empty"));
  CHECK_THAT(reading_error("[]"), Contains("E0546"));
  CHECK_THAT(reading_error("{\n \"format\": \"characterization\",\n \"version\": 1\n}"),
             Contains("r.json:2:12") && Contains("E0920") && Contains("\"characterization\""));
  CHECK_THAT(reading_error_after([](Json& r) { r["version"] = 2; }),
             Contains("r.json:3:") && Contains("is newer than this program"));
  for (const char* key : {"scene", "rate_hz", "instants", "evaluation", "inputs", "sensors", "algorithms"})
    CHECK_THAT(reading_error_after([&](Json& r) { r.erase(key); }), Contains(std::string(key) + " is missing"));
  for (const char* key : {"name", "status"})
    CHECK_THAT(reading_error_after([&](Json& r) { r["algorithms"][1].erase(key); }),
               Contains("algorithms[1]." + std::string(key) + " is missing"));
  CHECK_THAT(reading_error_after([](Json& r) { r["algorithms"][1]["rmse"] = "x"; }),
             Contains("r.json:9") && Contains("algorithms[1].rmse: expected a number"));
  CHECK_THAT(reading_error_after([](Json& r) { r["algorithms"][1]["rmse"] = -1; }), Contains("algorithms[1].rmse"));
  CHECK_THAT(reading_error_after([](Json& r) { r["algorithms"][1]["status"] = "won"; }),
             Contains("expected one of ran, skipped"));
  CHECK_THAT(reading_error_after([](Json& r) {
               r["algorithms"][1]["rmse_ci95"] = {2, 1};
             }),
             Contains("algorithms[1].rmse_ci95"));
  CHECK_THAT(reading_error_after([](Json& r) { r["algorithms"][1]["label"] = "mean"; }),
             Contains("algorithms[1].label: is repeated"));
  CHECK_THAT(reading_error_after([](Json& r) { r["algorithms"] = {1}; }), Contains("algorithms[0]: expected a map"));
  CHECK_THAT(reading_error_after([](Json& r) {
               r["evaluation"] = {{"from_s", 5}, {"to_s", 5}};
             }),
             Contains("evaluation.to_s"));
}

TEST_CASE("comparison: keys of a later program are left alone, clocks may be missing") {
  Json later = report();
  later["more"] = {1, 2};
  later["algorithms"][0]["more"] = "x";
  later["algorithms"][0].erase("ns_per_sample");
  later["algorithms"][0].erase("peak_bytes");
  const auto read = summary(later);
  CHECK(read.algorithms.size() == 3);
  CHECK(std::isnan(read.algorithms[0].ns_per_sample));
  CHECK(compared(report(), later).unlike.empty());
}

TEST_CASE("comparison: a folder stands for the report in it") {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "report.json") << report().dump();
  CHECK(libchar::read_replay_report(folder.path().string()).algorithms.size() == 3);
  CHECK_THROWS_WITH(libchar::read_replay_report((folder / "none").string()), Contains("E0551"));
}

TEST_CASE("comparison: as JSON and as Markdown") {
  Json b = report();
  b["algorithms"][0]["label"] = "me|an <b>";
  b["scene"]["name"] = "# x";
  const auto c = compared(b, report());
  const Json json = comparison_json(c);
  CHECK(json["score"] == "rmse");
  CHECK(json["algorithms"].size() == 4);
  CHECK(json["algorithms"][0]["difference"] == "unknown");
  CHECK(json["algorithms"][1]["rmse_change"] == 0);
  CHECK(json["a"]["best"] == "mean");
  const std::string page = comparison_markdown(c);
  CHECK_THAT(page, Contains("| me\\|an \\<b\\> | 1 | – | – | 10 ns | – | – | 1000 B | – | only in A |"));
  CHECK_THAT(page, Contains("| median | 1.2 | 1.2 | 0 % | 10 ns | 10 ns | 0 % | 1000 B | 1000 B | equal |"));
  CHECK_THAT(page, Contains("# \\# x"));
  CHECK(page.find("tilt-kalman") == std::string::npos);
}
