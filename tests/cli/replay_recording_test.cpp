// replay of a log without a scene file, and the scene file that it writes.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "libchar/core/document/json.hpp"
#include "tests/support/places.hpp"
#include "tests/support/run.hpp"

using Catch::Contains;
namespace fs = std::filesystem;

namespace {

// Three sensors of a slow wave beside each other, gyro10 the noisy one; 20 s at 50 Hz.
std::string array_log(char between = ',') {
  std::string text = fmt::format("t[s]{0}gyro10[deg/s]{0}gyro1[deg/s]{0}gyro2[deg/s]{0}truth[deg/s]\n", between);
  std::uint32_t state = 1;
  const auto noise = [&] {
    state = state * 1664525U + 1013904223U;
    return static_cast<double>(state >> 8U) / 16777216.0 - 0.5;
  };
  for (int k = 0; k < 1000; ++k) {
    const double truth = std::sin(0.02 * k);
    text += fmt::format("{1:.2f}{0}{2:.5f}{0}{3:.5f}{0}{4:.5f}{0}{5:.5f}\n", between, 0.02 * k, truth + noise(),
                        truth + 0.1 * noise(), truth + 0.2 * noise(), truth);
  }
  return text;
}

struct RecordingBench {
  test::TemporaryFolder folder;
  std::string log = file("array.csv", array_log());
  std::string path(const std::string& name) const { return (folder / name).string(); }
  std::string file(const std::string& name, const std::string& text) const {
    std::ofstream(path(name), std::ios::binary) << text;
    return path(name);
  }
  static test::Ran replay(const std::string& source, const std::vector<std::string>& more) {
    std::vector<std::string> words = {"replay", source};
    words.insert(words.end(), more.begin(), more.end());
    return test::run(words);
  }
  // What does not change from run to run.
  libchar::Json found(const std::string& out) const {
    libchar::Json report = libchar::parse_json(test::slurp(folder / (out + "/report.json")), out);
    for (const char* key : {"command", "config", "verdict_with_costs", "scene"}) report.erase(key);
    for (auto& algorithm : report["algorithms"])
      for (const char* key : {"ns_per_sample", "peak_bytes", "learning_s", "on_front"}) algorithm.erase(key);
    report["measured"].erase("seconds");
    for (const char* page : {"report.html", "report.md"})  // command and times stand in them
      report["files_sha256"].erase(page);
    return report;
  }
};

const std::vector<std::string> kWords = {"--sensors", "gyro*", "--reference", "truth"};

std::vector<std::string> with(std::vector<std::string> words, const std::vector<std::string>& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

}  // namespace

TEST_CASE("replay of a log: patterns, reference, reports, the scene it writes gives the same bytes") {
  const RecordingBench bench;
  const auto ran = RecordingBench::replay(bench.log, with(kWords, {"--learning",
                                                                   "0..8",
                                                                   "--rest",
                                                                   "0..1",
                                                                   "--align",
                                                                   "delay,gain",
                                                                   "--warm-up",
                                                                   "0.5",
                                                                   "--algorithms",
                                                                   "mean,minque,least-squares",
                                                                   "--set",
                                                                   "minque.gamma=0.98",
                                                                   "--fault",
                                                                   "gyro2:bias=1@15..16",
                                                                   "--estimates",
                                                                   "csv",
                                                                   "-o",
                                                                   bench.path("one"),
                                                                   "--write-scene",
                                                                   bench.path("s.yaml")}));
  INFO(ran.out + ran.err);
  REQUIRE(ran.code == 0);
  CHECK_THAT(ran.out, Contains("array: 3 sensors, 600 instants at 50 Hz"));
  CHECK_THAT(test::slurp(bench.path("s.yaml")), Contains("recording: \"array.csv\""));
  const auto again = RecordingBench::replay(bench.path("s.yaml"), {"--estimates", "csv", "-o", bench.path("two")});
  INFO(again.out + again.err);
  REQUIRE(again.code == 0);
  CHECK(test::slurp(bench.path("one/estimates.csv")) == test::slurp(bench.path("two/estimates.csv")));
  const auto one = bench.found("one");
  auto two = bench.found("two");
  REQUIRE(two["input"].size() == 2);
  CHECK(two["input"][1]["path"] == bench.path("s.yaml"));
  two["input"].erase(1);  // the scene is read in the second run only
  CHECK(one["sensors"][2]["name"] == "gyro10");
  CHECK(one["faults"].size() == 1);
  CHECK(one == two);
}

TEST_CASE("replay of a log: reading options as everywhere") {
  const RecordingBench bench;
  const std::string other = bench.file("array.txt", array_log(';'));
  std::string bare = array_log();
  bare.erase(0, bare.find('\n') + 1);
  const std::string nameless = bench.file("bare.csv", bare);
  const auto rmse = [&](const std::string& log, const std::vector<std::string>& words) {
    const auto ran = RecordingBench::replay(
        log, with(words, {"--json", "--force", "--algorithms", "mean", "-o", bench.path("out")}));
    INFO(ran.err);
    REQUIRE(ran.code == 0);
    return libchar::parse_json(ran.out, "stdout")["algorithms"][0]["rmse"].get<double>();
  };
  const double usual = rmse(bench.log, kWords);
  CHECK(usual > 0.05);
  CHECK(rmse(other, with(kWords, {"--delimiter", ";"})) == usual);
  CHECK(rmse(nameless, {"--header", "no", "--time-column", "c0", "--names", "gyro10,gyro1,gyro2,truth", "--sensors",
                        "gyro?,gyro10", "--reference", "truth"}) == Approx(usual).epsilon(1e-12));
  CHECK(rmse(bench.log, with(kWords, {"--from", "4", "--to", "9"})) != usual);
}

TEST_CASE("replay of a log: refusals name the option and leave nothing behind") {
  const RecordingBench bench;
  const auto refused = [&](const std::string& source, const std::vector<std::string>& words) {
    const auto ran = RecordingBench::replay(source, with(words, {"-o", bench.path("out")}));
    CHECK(ran.code == 2);
    CHECK(ran.out.empty());
    CHECK_FALSE(fs::exists(bench.folder / "out"));
    return ran.err;
  };
  CHECK_THAT(refused(bench.log, {}), Contains("--sensors: error E0749") && Contains("gyro10, gyro1, gyro2, truth"));
  CHECK_THAT(refused(bench.log, {"--sensors", "acc*"}), Contains("E0320") && Contains("gyro10"));
  CHECK_THAT(refused(bench.log, {"--sensors", "gyro1,gyro2", "--reference", "gyro1"}),
             Contains("--reference: error E0749"));
  CHECK_THAT(refused(bench.log, with(kWords, {"--align", "phase"})), Contains("--align"));
  CHECK_THAT(refused(bench.log, with(kWords, {"--align", "gain@rest"})), Contains("no such window"));
  CHECK_THAT(refused(bench.log, with(kWords, {"--align", "gain@0"})), Contains("--align"));
  CHECK_THAT(refused(bench.log, with(kWords, {"--model", "gyro1"})), Contains("SENSOR=FILE"));
  CHECK_THAT(refused(bench.log, with(kWords, {"--rest", "5"})), Contains("--rest"));
  // A scene says itself what it is made of; how it is replayed may be said on top.
  const auto wrote = RecordingBench::replay(bench.log, with(kWords, {"--write-scene", bench.path("s.yaml")}));
  REQUIRE(wrote.code == 0);
  CHECK_THAT(refused(bench.path("s.yaml"), {"--sensors", "gyro*"}),
             Contains("--sensors: error E0910") && Contains("is a scene"));
  CHECK_THAT(refused(bench.path("s.yaml"), {"--delimiter", ","}), Contains("--delimiter"));
  CHECK_THAT(RecordingBench::replay(bench.path("s.yaml"), {"--rest", "0..2", "--explain"}).out,
             Contains("at rest from 0 s to 2 s"));
  // It is not overwritten, and no input is.
  CHECK(RecordingBench::replay(bench.log, with(kWords, {"--write-scene", bench.path("s.yaml")})).code == 5);
  CHECK(RecordingBench::replay(bench.log, with(kWords, {"--write-scene", bench.log, "--force"})).code == 5);
  CHECK(test::slurp(bench.log) == array_log());
}

TEST_CASE("replay of a log without a rate is told the option that says it") {
  const RecordingBench bench;
  std::string text = "gyro1,gyro2,gyro3\n";
  for (int k = 0; k < 50; ++k) text += fmt::format("{},{},{}\n", k % 7, k % 5, k % 3);
  const auto ran = RecordingBench::replay(bench.file("bare.csv", text), {"--sensors", "gyro*"});
  CHECK(ran.code == 3);
  CHECK_THAT(ran.err, Contains("E0901") && Contains("give --rate RATE") && !Contains("recording: {"));
}
