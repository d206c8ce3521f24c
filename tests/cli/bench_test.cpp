// The verb bench: on built-in signals, on a model, a log and a scene; what is refused.

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "libchar/core/document/json.hpp"
#include "tests/support/run.hpp"

using Catch::Contains;

namespace {

namespace files = std::filesystem;

const std::vector<std::string> kShort = {"--quick",   "--records",         "2", "--samples", "2048",
                                         "--methods", "sensorchar,log-log"};

std::vector<std::string> bench_words(std::vector<std::string> words) {
  words.insert(words.begin(), "bench");
  words.insert(words.end(), kShort.begin(), kShort.end());
  return words;
}

}  // namespace

TEST_CASE("bench: three files that agree, from the fixture's own models") {
  const test::TemporaryFolder folder;
  const std::string out = (folder / "out").string();
  const auto ran = test::run(bench_words({test::fixture("imu_at_rest.csv"), "--parts", "characterization", "-o", out}));
  REQUIRE(ran.code == 0);
  CHECK_THAT(ran.out, Contains("Noise coefficients: gyro_z") && Contains("log-log"));
  for (const char* name : {"bench.html", "bench.json", "bench.md"}) CHECK(files::exists(files::path(out) / name));
  const auto document = libchar::parse_json(test::slurp(files::path(out) / "bench.json"), "bench.json");
  CHECK(document["characterization"].size() == 2);
  CHECK(document["fusion"].is_null());
  // Errors of one seed are the same to the last bit, so the gate finds none worse.
  const auto again = test::run(bench_words({test::fixture("imu_at_rest.csv"), "--parts", "characterization",
                                            "--against", out + "/bench.json", "--tolerance", "1000"}));
  CHECK(again.code == 0);
  CHECK_THAT(again.out, Contains("Against the older run"));
  CHECK(test::run(bench_words({"--parts", "characterization", "-o", out})).code == 5);
}

TEST_CASE("bench: a gate that a worse error does not pass, exit 6") {
  const test::TemporaryFolder folder;
  const std::string out = (folder / "out").string();
  const std::vector<std::string> words = bench_words({test::fixture("imu_at_rest.csv"), "--parts", "characterization"});
  auto first = words;
  first.insert(first.end(), {"-o", out});
  REQUIRE(test::run(first).code == 0);
  const files::path report = files::path(out) / "bench.json";
  auto document = libchar::parse_json(test::slurp(report), "bench.json");
  auto& figure = document["characterization"][0]["methods"][0]["terms"][0]["rmse_over_bound"];
  figure["value"] = 1e-3;
  figure["ci95"] = {1e-3, 1e-3};
  std::ofstream(report) << document.dump();
  auto second = words;
  second.insert(second.end(), {"--against", report.string()});
  const auto ran = test::run(second);
  CHECK(ran.code == 6);
  CHECK_THAT(ran.err, Contains("E0969") && Contains("RMSE of white_noise"));
}

TEST_CASE("bench: a scene with a sweep, a model with a target") {
  const test::TemporaryFolder folder;
  auto ran = test::run({"bench", test::fixture("scenes/lever-arm.yaml"), "--runs", "2", "--algorithms", "mean,minque",
                        "--sweep", "minque.gamma=.99,.999"});
  CHECK(ran.code == 0);
  CHECK_THAT(ran.out, Contains("minque (gamma=0.99)") && Contains("minque (gamma=0.999)"));
  const std::string model = (folder / "m.yaml").string();
  std::ofstream(model) << "format: sensor-model\nversion: 1\nchannel: g\nunit: deg/s\n"
                          "rate_hz: 100\ndensity: two-sided\nwhite_noise: 0.005\n";
  ran = test::run({"bench", model, "--parts", "design", "--target", "2e-3", "--quick"});
  INFO(ran.err);
  CHECK(ran.code == 0);
  // (5e-3/2e-3)^2 = 6.25
  CHECK_THAT(ran.out, Contains("Design: how many sensors") && Contains(" 7 "));
}

TEST_CASE("bench: what is asked of fusion is looked at before anything is measured") {
  const std::string scene = test::fixture("scenes/lever-arm.yaml");
  const auto err = [](const std::vector<std::string>& words) { return test::run(words).err; };
  CHECK_THAT(err({"bench", "--sweep", "minque.gamma"}), Contains("E0963"));
  CHECK_THAT(err({"bench", "--sweep", "minque.gama=.9"}), Contains("gamma"));
  CHECK_THAT(err({"bench", "--algorithms", "minqe"}), Contains("E0853"));
  CHECK_THAT(err({"bench", scene, "--parts", "scaling", "--sweep", "minque.gamma=.9"}),
             Contains("E0205") && Contains("--sweep"));
  CHECK_THAT(err({"bench", test::fixture("imu_at_rest.csv"), "--algorithms", "minque"}),
             Contains("E0205") && Contains("--algorithms"));
}

TEST_CASE("bench: an option of a part that is not done is refused, with that part") {
  const std::string scene = test::fixture("scenes/lever-arm.yaml"), log = test::fixture("imu_at_rest.csv");
  const auto err = [](const std::vector<std::string>& words) { return test::run(words).err; };
  CHECK_THAT(
      err({"bench", log, "--parts", "characterization", "--target", "1e-3"}),
      Contains("E0205") && Contains("--target: ") && Contains("about design") && Contains("add design to --parts"));
  CHECK_THAT(err({"bench", scene, "--at", "1s", "--target", "1"}),
             Contains("about design") && Contains("give a model or a log"));
  CHECK_THAT(err({"bench", log, "--parts", "design", "--at", "10s"}), Contains("E0205") && Contains("--target"));
  CHECK_THAT(err({"bench", "--parts", "fusion", "--within", "5"}), Contains("--within") && Contains("about design"));
  CHECK_THAT(err({"bench", log, "--runs", "3"}), Contains("--runs") && Contains("about fusion"));
  CHECK_THAT(err({"bench", scene, "--methods", "whittle"}), Contains("--methods") && Contains("characterization"));
  CHECK_THAT(err({"bench", log, "--instants-rate", "1kHz"}), Contains("about scaling") && Contains("--parts scaling"));
  CHECK_THAT(err({"bench", "--parts", "scaling", "--records", "5"}), Contains("characterization and design"));
}

TEST_CASE("bench: --samples bounds the records that check a design") {
  const auto not_checked = [](const char* samples) {
    const std::string out = test::run({"bench", test::fixture("imu_at_rest.csv"), "--quick", "--parts", "design",
                                       "--records", "2", "--samples", samples})
                                .out;
    std::size_t times = 0;
    for (std::size_t at = 0; (at = out.find("not checked", at)) != std::string::npos; ++at) ++times;
    return times;
  };
  CHECK(not_checked("64") > not_checked("100000"));
}

TEST_CASE("bench: a file may stand behind a list") {
  CHECK_THAT(test::run({"bench", "--parts", "characterization", "no-such-file.csv"}).err,
             Contains("no-such-file.csv") && Contains("E0101"));
  CHECK_THAT(test::run({"bench", "--algorithms", "mean", "no-such-file.csv"}).err, Contains("E0101"));
}

TEST_CASE("bench: refused in a sentence") {
  CHECK_THAT(test::run({"bench", "--parts", "charakterization"}).err,
             Contains("E0202") && Contains("characterization"));
  CHECK(test::run({"bench", "--parts", "charakterization"}).code == 2);
  CHECK(test::run({"bench", "no-such-file.csv"}).code == 3);
  CHECK_THAT(test::run({"bench", test::fixture("scenes/lever-arm.yaml"), "--parts", "design"}).err, Contains("E0205"));
  const auto ran = test::run({"bench", test::fixture("imu_at_rest.csv"), "--quick", "--records", "2", "--against",
                              test::fixture("imu_at_rest.csv")});
  CHECK(ran.code == 3);
}

TEST_CASE("bench --stress: nothing wrong, all cells in the document") {
  const auto ran = test::run({"bench", "--stress", "--quick", "--json"});
  REQUIRE(ran.code == 0);
  const auto document = libchar::parse_json(ran.out, "stdout");
  CHECK(document["stress"]["wrong"] == 0);
  CHECK(document["stress"]["cells"].size() > 1000);
  CHECK(document["scaling"].is_null());
}

TEST_CASE("bench: --samples is heeded by the built-in signals, and refused where nothing has samples") {
  const auto ran = test::run(bench_words({"--parts", "characterization", "--json"}));
  REQUIRE(ran.code == 0);
  CHECK_THAT(ran.out, Contains("\"samples\": 2048") && !Contains("\"samples\": 32768"));
  const auto refused = test::run({"bench", "--quick", "--parts", "fusion", "--samples", "2048"});
  CHECK(refused.code == 2);
  CHECK_THAT(refused.err, Contains("E0205") && Contains("--samples"));
}
