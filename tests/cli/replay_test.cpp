#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "libchar/core/document/json.hpp"
#include "libchar/log/read.hpp"
#include "tests/support/places.hpp"
#include "tests/support/run.hpp"

using Catch::Contains;
namespace fs = std::filesystem;

namespace {

// Four sensors of a sine, the last one with a fault; 60 s at 100 Hz.
constexpr const char* kScene = R"(format: scene
version: 1
name: four
simulate:
  rate_hz: 100
  samples: 6000
  truth: {name: level, kind: sine, amplitude: 2, frequency_hz: 0.1}
sensors:
  - {name: a, model: {unit: m, white_noise: {value: 0.01}, density: two-sided}}
  - {name: b, model: {unit: m, white_noise: {value: 0.02}, density: two-sided}}
  - {name: c, model: {unit: m, white_noise: {value: 0.03}, density: two-sided}}
  - {name: d, model: {unit: m, white_noise: {value: 0.01}, density: two-sided}}
learning: [0, 10]
faults: [{sensor: d, kind: bias, value: 1, from_s: 30, to_s: 40}]
)";

struct ReplayBench {
  test::TemporaryFolder folder;
  std::string scene = file("scene.yaml", kScene);
  std::string path(const std::string& name) const { return (folder / name).string(); }
  std::string file(const std::string& name, const std::string& text) const {
    std::ofstream(path(name)) << text;
    return path(name);
  }
  test::Ran replay(std::vector<std::string> more) const { return replay_of(scene, more); }
  static test::Ran replay_of(const std::string& scene, const std::vector<std::string>& more) {
    std::vector<std::string> words = {"replay", scene};
    words.insert(words.end(), more.begin(), more.end());
    return test::run(words);
  }
  libchar::Json report(const std::string& out) const {
    return libchar::parse_json(test::slurp(folder / (out + "/report.json")), out);
  }
};

libchar::Json labels(const libchar::Json& report) {
  libchar::Json out = libchar::Json::array();
  for (const auto& algorithm : report["algorithms"]) out.push_back(algorithm["label"]);
  return out;
}

std::size_t files_in(const fs::path& folder) {
  std::size_t count = 0;
  if (fs::exists(folder))
    for ([[maybe_unused]] const auto& entry : fs::directory_iterator(folder)) ++count;
  return count;
}

}  // namespace

TEST_CASE("replay: estimates written again over those of an earlier run stay, without them they go") {
  const ReplayBench bench;
  const auto replayed = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"replay", bench.scene, "-o", bench.path("out"), "--force", "--algorithms", "mean"});
    return test::run(more);
  };
  for (int round = 0; round < 2; ++round) {
    REQUIRE(replayed({"--estimates", "csv"}).code == 0);
    CHECK(fs::exists(bench.path("out/estimates.csv")));
  }
  const auto without = replayed({});
  REQUIRE(without.code == 0);
  CHECK_THAT(without.out, Contains("removed, of an earlier run: estimates.csv"));
  CHECK_FALSE(fs::exists(bench.path("out/estimates.csv")));
}

TEST_CASE("replay: four files, a table, and no progress on stderr") {
  const ReplayBench bench;
  const auto ran = bench.replay({"-o", bench.path("out"), "--algorithms", "mean,minque,tilt-kalman"});
  INFO(ran.out + ran.err);
  REQUIRE(ran.code == 0);
  CHECK(ran.err.empty());
  CHECK_THAT(ran.out, Contains("four: 4 sensors, 5000 instants at 100 Hz"));
  CHECK_THAT(ran.out, Contains("minque") && Contains("skipped tilt-kalman: needs"));
  CHECK(files_in(bench.folder / "out") == 4);
  for (const char* name : {"report.html", "report.json", "report.md", "fusion.yaml"})
    CHECK_THAT(ran.out, Contains(bench.path(std::string("out/") + name)));
  const auto report = bench.report("out");
  CHECK(report["format"] == "replay-report");
  CHECK(report["command"][1] == "replay");
  CHECK(report["evaluation"]["from_s"] == 10);
  CHECK(report["evaluation"]["to_s"] == 60);
  CHECK(report["inputs"][0]["unit"] == "m");
  CHECK(report["sensors"].size() == 4);
  CHECK(report["faults"][0]["sensor"] == "d");
  CHECK(labels(report) == libchar::Json({"mean", "minque", "tilt-kalman"}));
  const auto& mean = report["algorithms"][0];
  CHECK(mean["rmse"].get<double>() > mean["rmse_ci95"][0].get<double>());
  CHECK(mean["rmse"].get<double>() < mean["rmse_ci95"][1].get<double>());
  // A fifth of the run with an error of 1/4, and the mean's noise.
  const double noise = 0.25 * std::sqrt(100 * (1e-4 + 4e-4 + 9e-4 + 1e-4));
  CHECK(mean["rmse"].get<double>() == Approx(std::sqrt(noise * noise + 0.2 * 0.0625)).epsilon(0.05));
  CHECK(report["algorithms"][2]["status"] == "skipped");
  CHECK(report["algorithms"][2]["rmse"].is_null());
}

TEST_CASE("replay: --json is the report itself, and the same scores come again") {
  const ReplayBench bench;
  const auto first = bench.replay({"-o", bench.path("out"), "--json", "--algorithms", "mean"});
  REQUIRE(first.code == 0);
  const auto printed = libchar::parse_json(first.out, "stdout");
  CHECK(printed == bench.report("out"));
  const auto again = bench.replay({"-o", bench.path("out"), "--json", "--algorithms", "mean", "--force"});
  REQUIRE(again.code == 0);
  const auto repeated = libchar::parse_json(again.out, "stdout");
  for (const char* key : {"rmse", "rmse_ci95", "regret", "inputs"})
    CHECK(printed["algorithms"][0][key] == repeated["algorithms"][0][key]);
}

TEST_CASE("replay: without -o results go to a folder that is called after the scene") {
  const ReplayBench bench;
  test::RunOptions there;
  there.folder = bench.folder.path().string();
  const auto ran = test::run({"replay", bench.scene, "--algorithms", "mean"}, there);
  CHECK(ran.code == 0);
  CHECK(labels(bench.report("scene-replay")) == libchar::Json({"mean"}));
}

TEST_CASE("replay: results are not overwritten unless --force") {
  const ReplayBench bench;
  REQUIRE(bench.replay({"-o", bench.path("out"), "--algorithms", "mean"}).code == 0);
  const auto before = test::slurp(bench.folder / "out/report.json");
  const auto refused = bench.replay({"-o", bench.path("out"), "--algorithms", "median"});
  CHECK(refused.code == 5);
  CHECK(refused.out.empty());
  CHECK_THAT(refused.err, Contains("report.") && Contains("--force"));
  CHECK(test::slurp(bench.folder / "out/report.json") == before);
  CHECK(bench.replay({"-o", bench.path("out"), "--algorithms", "median", "--force"}).code == 0);
  CHECK(labels(bench.report("out")) == libchar::Json({"median"}));
  // A file stands where the folder should.
  CHECK(bench.replay({"-o", bench.scene, "--algorithms", "mean"}).code == 5);
  CHECK(test::slurp(bench.scene) == kScene);
}

TEST_CASE("replay: --explain says what would be done and writes nothing") {
  const ReplayBench bench;
  const auto both = bench.replay({"--explain", "-o", bench.path("out")});
  CHECK(both.code == 2);
  CHECK_THAT(both.err, Contains("E0209"));
  const auto ran = bench.replay({"--explain"});
  INFO(ran.err);
  REQUIRE(ran.code == 0);
  CHECK_THAT(ran.out, Contains("simulates 4 sensors, 6000 samples at 100 Hz, seed 1"));
  CHECK_THAT(ran.out, Contains("noise levels: from the models"));
  CHECK_THAT(ran.out, Contains("learning on 1000 instants from 0 s to 10 s: "));
  CHECK_THAT(ran.out, Contains("evaluation: 5000 instants at 100 Hz from 10 s to 60 s"));
  CHECK_THAT(ran.out, Contains("no sensor fails in the first 20 s of it"));
  CHECK_THAT(ran.out, Contains("failed sensors left out"));
  CHECK_THAT(ran.out, Contains("skips tilt-kalman: needs"));
  CHECK_FALSE(fs::exists(bench.folder / "out"));
  // Nobody learns: the learning window is not read, and the plan says so.
  const auto mean = bench.replay({"--explain", "--algorithms", "mean"});
  CHECK_THAT(mean.out, Contains("the learning window is not read"));
  CHECK_THAT(mean.out, Contains("runs mean\n"));
}

TEST_CASE("replay: of units of time that exclude each other none is in the command to type next") {
  const ReplayBench bench;
  std::string log = "time,a,b,c\n";
  for (int i = 0; i < 400; ++i)  // each 30 s, or 30 ms: nothing says which
    log += fmt::format("{},{},{},{}\n", 30 * i, i % 7 + 0.1 * (i % 3), i % 7 + 0.1 * (i % 5), i % 7 + 0.1 * (i % 11));
  const auto ran = test::run({"replay", bench.file("log.csv", log), "--sensors", "a,b,c", "-o", bench.path("out")});
  CAPTURE(ran.out, ran.err);
  REQUIRE(ran.code == 0);
  CHECK_THAT(ran.err, Contains("--time-unit ms") && Contains("--time-unit s"));
  CHECK_THAT(ran.out, !Contains("next: sensorchar replay"));
}

TEST_CASE("replay: algorithms and their options from the command line") {
  const ReplayBench bench;
  const auto typo = bench.replay({"-o", bench.path("out"), "--algorithms", "mean,minqe"});
  CHECK(typo.code == 2);
  CHECK_THAT(typo.err, Contains("E0853") && Contains("minque"));
  const auto set = bench.replay({"-o", bench.path("out"), "--algorithms", "mean,minque", "--set", "minque.gamma=0.98"});
  INFO(set.err);
  REQUIRE(set.code == 0);
  CHECK(bench.report("out")["algorithms"][1]["options"]["gamma"] == 0.98);
  const auto refused = [&](const std::string& words) {
    const auto ran = bench.replay({"-o", bench.path("other"), "--algorithms", "mean,minque", "--set", words});
    CHECK(ran.code == 2);
    CHECK(files_in(bench.folder / "other") == 0);
    return ran.err;
  };
  CHECK_THAT(refused("minque.gama=0.9"), Contains("E0850") && Contains("gamma"));
  CHECK_THAT(refused("minque.gamma=2"), Contains("E0851"));
  CHECK_THAT(refused("minque.gamma=x"), Contains("E0963"));
  CHECK_THAT(refused("minque=0.9"), Contains("E0963"));
  CHECK_THAT(refused("gamma"), Contains("E0963"));
  CHECK_THAT(refused("median.gamma=1"), Contains("E0850"));
  CHECK_THAT(refused("random-weighting.window=10"), Contains("not among those that run") || Contains("E0850"));
}

TEST_CASE("replay: windows from the command line win over the scene's") {
  const ReplayBench bench;
  const auto window = [&](std::vector<std::string> more) {
    more.insert(more.end(), {"-o", bench.path("out"), "--algorithms", "least-squares", "--force"});
    const auto ran = bench.replay(more);
    INFO(ran.err);
    REQUIRE(ran.code == 0);
    return bench.report("out");
  };
  auto report = window({"--evaluation", "20..50"});
  CHECK(report["evaluation"]["from_s"] == 20);
  CHECK(report["evaluation"]["to_s"] == 50);
  CHECK(report["instants"] == 3000);
  CHECK(report["learning"]["to_s"] == 10);
  report = window({"--learning", "5s..15s"});
  CHECK(report["learning"]["from_s"] == 5);
  CHECK(report["evaluation"]["from_s"] == 15);
  report = window({"--evaluation", "0.5min.."});
  CHECK(report["evaluation"]["from_s"] == 30);
  CHECK(report["evaluation"]["to_s"] == 60);
  report = window({"--evaluation", "..30"});
  CHECK(report["evaluation"]["from_s"] == 0);
  CHECK(report["findings"].size() == 1);  // it holds the learning window
  CHECK(report["findings"][0]["code"] == "learning_in_evaluation");
  for (const char* bad : {"20", "50..20", "20..20", "x..5", "-1..5", "20..."}) {
    INFO(bad);
    const auto ran = bench.replay({"-o", bench.path("no"), "--evaluation", bad});
    CHECK(ran.code == 2);
    CHECK_THAT(ran.err, Contains("--evaluation"));
  }
  const auto beyond = bench.replay({"-o", bench.path("no"), "--evaluation", "70..80"});
  CHECK(beyond.code == 3);
  CHECK_THAT(beyond.err, Contains("evaluation"));
}

TEST_CASE("replay: faults from the command line stand beside the scene's") {
  const ReplayBench bench;
  const auto faults = [&](std::vector<std::string> more) {
    more.insert(more.end(), {"-o", bench.path("out"), "--algorithms", "mean", "--force"});
    const auto ran = bench.replay(more);
    INFO(ran.err);
    REQUIRE(ran.code == 0);
    return bench.report("out");
  };
  const double with_one = faults({})["algorithms"][0]["rmse"];
  const auto none = faults({"--no-faults"});
  CHECK(none["faults"].empty());
  CHECK(none["algorithms"][0]["rmse"].get<double>() < 0.9 * with_one);
  const auto two = faults({"--fault", "a:stuck@45..50", "--fault", "b:noise=0.5@12.."});
  REQUIRE(two["faults"].size() == 3);
  CHECK(two["faults"][2]["kind"] == "noise");
  CHECK(two["algorithms"][0]["rmse"].get<double>() > with_one);
  // On top of a scene without its own.
  CHECK(faults({"--no-faults", "--fault", "a:stuck@45..50"})["faults"].size() == 1);
  for (const auto& [words, says] :
       {std::pair{"e:stuck@1..2", "there is no such sensor"}, std::pair{"a:broken@1..2", "expected one of"},
        std::pair{"a:bias@1..2", "needs a value"}, std::pair{"a:stuck=1@1..2", "takes no value"},
        std::pair{"a:stuck@2..1", "to a later one"}, std::pair{"a:stuck", "SENSOR:KIND"}}) {
    const auto ran = bench.replay({"-o", bench.path("no"), "--fault", words});
    CHECK(ran.code == 2);
    CHECK_THAT(ran.err, Contains("E0722") && Contains(says));
  }
}

TEST_CASE("replay: FROM..TO has one answer of every option, which names it") {
  const ReplayBench bench;
  for (const std::string option : {"--learning", "--evaluation", "--rest", "--align", "--fault"}) {
    const std::string before = option == "--fault" ? "a:stuck@" : option == "--align" ? "all@" : "";
    for (const std::string wrong : {"20..10", "..", "1x..2x"}) {
      const auto ran = bench.replay({"--explain", option, before + wrong});
      INFO(option << " " << wrong);
      CHECK(ran.code == 2);
      CHECK_THAT(ran.err, Catch::StartsWith(option + ": error E0") &&
                              (Contains("from a time to a later one") || Contains("a duration such as")));
    }
  }
  for (const char* right : {"5..", "..10", "5s..end", "0.1min..0.2min"}) {
    const auto ran = bench.replay(
        {"--explain", "--learning", right, "--evaluation", right, "--fault", std::string("a:stuck@") + right});
    INFO(right << " " << ran.err);
    CHECK(ran.code == 0);
  }
}

TEST_CASE("replay: --estimates reads back: truth, then each algorithm") {
  const ReplayBench bench;
  for (const std::string format : {"csv", "npy", "f64"}) {
    const auto ran =
        bench.replay({"-o", bench.path(format), "--estimates", format, "--algorithms", "mean,median,tilt-kalman"});
    INFO(ran.err);
    REQUIRE(ran.code == 0);
    CHECK_THAT(ran.out, Contains("estimates." + format));
    libchar::ReadOptions reading;
    if (format == "npy") reading.rate_hz = 100;
    const auto log = libchar::read_recording(bench.path(format + "/estimates." + format), reading);
    REQUIRE(log.samples.size() == 3);
    REQUIRE(log.samples[0].size() == 5000);
    CHECK(log.info.time.rate_hz == Approx(100));
    if (format != "npy") {
      CHECK(log.info.channels[0].name == "level");
      CHECK(log.info.channels[1].name == "mean");
      CHECK(log.info.channels[2].name == "median");
      CHECK(log.info.channels[1].unit == "m");
    }
    // The scores of the report are those of the file.
    double squares = 0;
    for (std::size_t k = 0; k < 5000; ++k) squares += std::pow(log.samples[1][k] - log.samples[0][k], 2);
    CHECK(std::sqrt(squares / 5000) ==
          Approx(bench.report(format)["algorithms"][0]["rmse"].get<double>()).epsilon(1e-9));
  }
  const auto wrong = bench.replay({"-o", bench.path("no"), "--estimates", "xlsx", "--algorithms", "mean"});
  CHECK((wrong.code == 2 || wrong.code == 5));
  CHECK(files_in(bench.folder / "no") == 0);
}

TEST_CASE("replay: --no-skip changes no number") {
  const ReplayBench bench;
  REQUIRE(bench.replay({"-o", bench.path("a"), "--algorithms", "mean,median"}).code == 0);
  REQUIRE(bench.replay({"-o", bench.path("b"), "--algorithms", "mean,median", "--no-skip"}).code == 0);
  const auto a = bench.report("a"), b = bench.report("b");
  for (std::size_t k = 0; k < 2; ++k)
    for (const char* key : {"label", "rmse", "rmse_ci95", "regret", "weights", "inputs"})
      CHECK(a["algorithms"][k][key] == b["algorithms"][k][key]);
  CHECK(b["measured"]["instants_fused"] > a["measured"]["instants_fused"]);
  const auto without = bench.replay({"-o", bench.path("c"), "--algorithms", "mean", "--no-allan"});
  REQUIRE(without.code == 0);
  CHECK(bench.report("c")["algorithms"][0]["inputs"][0]["allan"].is_null());
  CHECK_FALSE(a["algorithms"][0]["inputs"][0]["allan"].is_null());
}

TEST_CASE("replay: a recording without reference is scored by leave-one-out") {
  const ReplayBench bench;
  std::string log = "t,x,y,z\n";
  for (int k = 0; k < 2000; ++k)
    log += std::to_string(k) + "," + std::to_string(k % 7) + "," + std::to_string(k % 5) + "," + std::to_string(k % 3) +
           "\n";
  bench.file("log.csv", log);
  const std::string scene =
      bench.file("recorded.yaml", "format: scene\nversion: 1\nrecording: log.csv\nsensors: [x, y, z]\n");
  const auto ran = ReplayBench::replay_of(scene, {"-o", bench.path("out"), "--algorithms", "mean"});
  INFO(ran.err);
  REQUIRE(ran.code == 0);
  CHECK_THAT(ran.out, Contains("leave-one-out"));
  const auto report = bench.report("out");
  CHECK(report["reference"].is_null());
  REQUIRE(report["input"].size() == 2);
  CHECK(report["input"][0]["sha256"].get<std::string>().size() == 64);
  CHECK(report["input"][1]["path"] == scene);
  CHECK(report["algorithms"][0]["regret"].is_null());
  CHECK(report["algorithms"][0]["rmse"].is_null());
  CHECK(report["algorithms"][0]["without_reference"]["leave_one_out_rms"].get<double>() > 0.5);
  // compare speaks of the same score.
  const auto same = test::run({"compare", bench.path("out/report.json"), bench.path("out/report.json")});
  const double predictive = report["algorithms"][0]["without_reference"]["predictive_rms"].get<double>();
  CHECK_THAT(same.out, Contains(fmt::format("{:.3g}", predictive)));
  CHECK(report["algorithms"][0]["inputs"].empty());
}

TEST_CASE("replay: scenes that do not fit their files end with exit code 3 and write nothing") {
  const ReplayBench bench;
  bench.file("log.csv", "t,left,right,truth\n0,1,2,1\n1,2,1,1\n2,1,2,1\n3,2,1,1\n");
  const auto refused = [&](const std::string& rest, std::vector<std::string> more = {}) {
    const std::string scene = bench.file("bad.yaml", "format: scene\nversion: 1\n" + rest);
    more.insert(more.end(), {"-o", bench.path("out")});
    const auto ran = ReplayBench::replay_of(scene, more);
    INFO(ran.out + ran.err);
    CHECK(ran.code == 3);
    CHECK(ran.out.empty());
    CHECK(files_in(bench.folder / "out") == 0);
    return ran.err;
  };
  CHECK_THAT(refused("recording: none.csv\nsensors: [left, right]\n"), Contains("none.csv"));
  CHECK_THAT(refused("recording: log.csv\nsensors: [left, rihgt]\n"), Contains("rihgt") && Contains("right"));
  CHECK_THAT(refused("recording: log.csv\nsensors: [left, right]\nreference: turth\n"),
             Contains("turth") && Contains("truth"));
  CHECK_THAT(refused("recording: log.csv\nsensor: [left]\n"), Contains("bad.yaml:4:1"));
  CHECK_THAT(refused("recording: ../log.csv\nsensors: [left, right]\n"), Contains("E0731"));
  CHECK_THAT(refused("recording: log.csv\nsensors: [left, right]\nalgorithms: [mean, medain]\n"),
             Contains("bad.yaml:5:") && Contains("median"));
  CHECK_THAT(refused("recording: log.csv\nsensors: [left, right]\nevaluation: [10, 20]\n"), Contains("evaluation"));
  CHECK(ReplayBench::replay_of(bench.path("absent.yaml"), {"-o", bench.path("out")}).code == 3);
  // A log is no scene: which of its channels are sensors is asked.
  const auto log = ReplayBench::replay_of(bench.path("log.csv"), {"-o", bench.path("out")});
  CHECK(log.code == 2);
  CHECK_THAT(log.err, Contains("--sensors: error E0749"));
}

TEST_CASE("replay: nothing can run is said with exit code 4") {
  const ReplayBench bench;
  const auto ran = bench.replay({"-o", bench.path("out"), "--algorithms", "tilt-kalman"});
  CHECK(ran.code == 4);
  CHECK_THAT(ran.err, Contains("no algorithm can run") && Contains("--explain"));
  CHECK(files_in(bench.folder / "out") == 0);
}

TEST_CASE("replay: stopped by Ctrl-C: exit code 130 and nothing is left") {
  const ReplayBench bench;
  std::string longer = kScene;
  longer.replace(longer.find("6000"), 4, "60000000");
  const std::string scene = bench.file("long.yaml", longer);
  for (const char* signal : {"INT", "TERM"}) {
    const auto ran = test::run_words({"timeout", "--preserve-status", "-s", signal, "0.7", test::program(), "replay",
                                      scene, "-o", bench.path("out"), "--estimates", "csv", "--algorithms", "mean"});
    INFO(ran.out + ran.err);
    CHECK(ran.code == (std::string(signal) == "INT" ? 130 : 143));
    CHECK(ran.out.empty());
    CHECK(files_in(bench.folder / "out") == 0);
  }
}
