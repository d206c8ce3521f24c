#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "libchar/core/document/json.hpp"
#include "tests/support/run.hpp"

using Catch::Contains;

namespace {

namespace files = std::filesystem;

struct VerifyBench {
  test::TemporaryFolder folder;
  std::string log = (folder / "log.csv").string(), out = (folder / "out").string();
  VerifyBench() {
    files::copy_file(test::fixture("imu_at_rest.csv"), log);
    REQUIRE(test::run({"characterize", log, "-c", "gyro_z", "-o", out}).code == 0);
  }
  test::Ran verify() const { return test::run({"verify", out}); }
  void append(const files::path& path) const { std::ofstream(path, std::ios::app) << "\n"; }
};

}  // namespace

TEST_CASE("verify: results as they were written hold") {
  const VerifyBench bench;
  const auto ran = bench.verify();
  CHECK(ran.code == 0);
  CHECK_THAT(ran.out, Contains("written by sensorchar") && Contains("log.csv (input)"));
  CHECK_THAT(ran.out, !Contains("changed") && !Contains("missing"));
  const auto json = libchar::parse_json(test::run({"verify", bench.out, "--json"}).out, "verify");
  CHECK(json["documents"][0]["holds"] == true);
  CHECK(json["documents"][0]["same_program"] == true);
  CHECK(json["documents"][0]["files"].size() == 5);  // the log, page, report, curves, a model
}

TEST_CASE("verify: a changed result, a missing one, another log are said, exit 6") {
  const VerifyBench bench;
  const files::path model = files::path(bench.out) / "gyro_z.sensor.yaml";
  bench.append(model);
  auto ran = bench.verify();
  CHECK(ran.code == 6);
  CHECK_THAT(ran.out, Contains("changed   " + model.string()));
  CHECK_THAT(ran.err, Contains("E0520"));
  files::remove(model);
  CHECK_THAT(bench.verify().out, Contains("missing   " + model.string()));
  REQUIRE(test::run({"characterize", bench.log, "-c", "gyro_z", "-o", bench.out, "--force"}).code == 0);
  CHECK(bench.verify().code == 0);
  bench.append(bench.log);
  ran = bench.verify();
  CHECK(ran.code == 6);
  CHECK_THAT(ran.out, Contains("changed   " + bench.log + " (input)"));
}

TEST_CASE("verify: inputs that lie elsewhere are found from a folder") {
  const test::TemporaryFolder folder;
  files::copy_file(test::fixture("imu_at_rest.csv"), folder / "log.csv");
  test::RunOptions there;
  there.folder = folder.path().string();
  REQUIRE(test::run({"characterize", "log.csv", "-c", "gyro_z", "-o", "out"}, there).code == 0);
  const std::string out = (folder / "out").string();
  CHECK(test::run({"verify", out}).code == 6);
  CHECK(test::run({"verify", out, "--in", folder.path().string()}).code == 0);
}

TEST_CASE("verify: what the kernel shows as a file is not an input, since some of it does not end") {
  const VerifyBench bench;
  const files::path report = files::path(bench.out) / "report.json";
  auto document = libchar::parse_json(test::slurp(report), "report");
  document["input"][0]["path"] = "/proc/self/status";
  std::ofstream(report) << document.dump();
  CHECK_THAT(bench.verify().out, Contains("missing   /proc/self/status (input)"));
}

TEST_CASE("verify: a folder without a report, and documents of other kinds, are refused") {
  const test::TemporaryFolder folder;
  CHECK_THAT(test::run({"verify", folder.path().string()}).err, Contains("E0556"));
  std::ofstream(folder / "x.json") << R"({"files": 3, "tool": 4, "input": "x"})";
  const auto odd = test::run({"verify", folder.path().string()});
  CHECK(odd.code == 0);
  std::ofstream(folder / "y.json") << "{";
  CHECK(test::run({"verify", (folder / "y.json").string()}).code == 3);
  CHECK(test::run({"verify", (folder / "none").string()}).code == 3);
}

TEST_CASE("verify --rerun: the same numbers, and the same bytes of tables and models") {
  const VerifyBench bench;
  const std::string again = (bench.folder / "again").string();
  const auto ran = test::run({"verify", bench.out, "--rerun", again});
  CHECK(ran.code == 0);
  CHECK_THAT(ran.out, Contains("same      every number") && Contains("same      gyro_z.sensor.yaml"));
  CHECK(files::exists(files::path(again) / "report.html"));
  // What stands already is not replaced.
  CHECK(test::run({"verify", bench.out, "--rerun", again}).code == 5);
}

TEST_CASE("verify --rerun: a number that was changed by hand is found, exit 6") {
  const VerifyBench bench;
  const files::path report = files::path(bench.out) / "report.json";
  auto document = libchar::parse_json(test::slurp(report), "report");
  document["recording"]["rate_hz"] = 51;
  std::ofstream(report) << document.dump();
  const auto ran = test::run({"verify", bench.out, "--rerun", (bench.folder / "again").string()});
  CHECK(ran.code == 6);
  CHECK_THAT(ran.out, Contains("/recording/rate_hz") && Contains("was 51"));
  CHECK_THAT(ran.err, Contains("E0520"));
}

TEST_CASE("verify --rerun: a document is no order") {
  const VerifyBench bench;
  const files::path report = files::path(bench.out) / "report.json";
  const auto original = libchar::parse_json(test::slurp(report), "report");
  const auto refused = [&](const std::vector<std::string>& command) {
    auto document = original;
    document["command"] = command;
    std::ofstream(report) << document.dump();
    const auto ran = test::run({"verify", bench.out, "--rerun", (bench.folder / "again").string()});
    CHECK(ran.code == 2);
    return ran.err;
  };
  const std::string other = (bench.folder / "other").string();
  CHECK_THAT(refused({"sensorchar", "convert", bench.log, "-o", other}), Contains("E0205"));
  CHECK_THAT(refused({"sensorchar", "replay", bench.log, "--write-scene", other}), Contains("E0205"));
  CHECK_THAT(refused({}), Contains("E0205"));
  // Where the results go is said here, not there.
  auto document = original;
  document["command"] = {"sensorchar", "characterize", bench.log,  "-c", "gyro_z",
                         "-o" + other, "--force",      "--output", other};
  std::ofstream(report) << document.dump();
  // No command that ran names its folder twice.
  CHECK(test::run({"verify", bench.out, "--rerun", (bench.folder / "third").string()}).code == 2);
  CHECK_FALSE(files::exists(other));
}

TEST_CASE("verify --rerun: words count as their verb understands them") {
  const VerifyBench bench;
  const files::path report = files::path(bench.out) / "report.json";
  const auto original = libchar::parse_json(test::slurp(report), "report");
  const std::string other = (bench.folder / "other").string();
  const std::string again = (bench.folder / "again").string();
  const auto rerun = [&](const std::vector<std::string>& words, const std::vector<std::string>& more) {
    auto document = original;
    document["command"] = {"sensorchar", "characterize", bench.log, "-c", "gyro_z"};
    for (const std::string& word : words) document["command"].push_back(word);
    std::ofstream(report) << document.dump();
    std::vector<std::string> command = {"verify", bench.out, "--rerun", again};
    command.insert(command.end(), more.begin(), more.end());
    const auto ran = test::run(command);
    files::remove_all(again);
    CHECK_FALSE(files::exists(other));
    return ran;
  };
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {"-qo" + other}, {"--output=" + other}, {"--force=true", "-o", other}, {"-fo", other}})
    rerun(words, {});
  // A last word that takes a value does not swallow the folder.
  for (const char* last : {"--units", "--preset", "--topic"}) CHECK(rerun({last}, {}).code == 2);
  const auto elsewhere = rerun({"-o", other, "--limits", "/etc/hostname"}, {});
  CHECK(elsewhere.code == 2);
  CHECK_THAT(elsewhere.err, Contains("E0523") && Contains("/etc/hostname"));
  CHECK_THAT(rerun({"-o", other, "--limits", "/etc/hostname"}, {"--allow-read"}).err, !Contains("E0523"));
}
