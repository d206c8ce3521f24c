#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "libchar/core/document/json.hpp"
#include "tests/support/run.hpp"

using Catch::Contains;

namespace {

constexpr const char* kComparedScene = R"(format: scene
version: 1
name: three
simulate:
  rate_hz: 100
  samples: 6000
  seed: SEED
  truth: {kind: sine, amplitude: 2, frequency_hz: 0.1}
sensors:
  - {name: a, model: {unit: m, white_noise: {value: 0.01}, density: two-sided}}
  - {name: b, model: {unit: m, white_noise: {value: 0.02}, density: two-sided}}
  - {name: c, model: {unit: m, white_noise: {value: 0.03}, density: two-sided}}
)";

// Two or more replays of a small scene, each in a folder of its own.
struct Replays {
  test::TemporaryFolder folder;
  std::string path(const std::string& name) const { return (folder / name).string(); }
  void make(const std::string& name, std::vector<std::string> more, const std::string& seed = "1") const {
    std::string text = kComparedScene;
    text.replace(text.find("SEED"), 4, seed);
    std::ofstream(path(name + ".yaml")) << text;
    std::vector<std::string> words = {"replay", path(name + ".yaml"), "-o", path(name)};
    words.insert(words.end(), more.begin(), more.end());
    const auto ran = test::run(words);
    INFO(ran.err);
    REQUIRE(ran.code == 0);
  }
  test::Ran compare(const std::string& a, const std::string& b, std::vector<std::string> more = {}) const {
    std::vector<std::string> words = {"compare", path(a), path(b)};
    words.insert(words.end(), more.begin(), more.end());
    return test::run(words);
  }
};

}  // namespace

TEST_CASE("compare: two replays of one scene side by side") {
  const Replays replays;
  replays.make("a", {"--algorithms", "mean,minque,median"});
  replays.make("b", {"--algorithms", "mean,minque,inverse-variance", "--set", "minque.gamma=0.9"});
  const auto ran = replays.compare("a", "b/report.json");
  INFO(ran.out + ran.err);
  REQUIRE(ran.code == 0);
  CHECK_THAT(ran.out, Contains("differs: minque.gamma: 0.999 in A, 0.9 in B"));
  CHECK_THAT(ran.out, Contains("only in A") && Contains("only in B"));
  CHECK_THAT(ran.out, Contains("RMSE of 2 algorithms that ran in both: 1 not resolved, 1 equal."));
  CHECK_THAT(ran.out, Contains("Best: minque (") && Contains("inverse-variance ("));
  const auto document = replays.compare("a", "b", {"--json"});
  REQUIRE(document.code == 0);
  const auto json = libchar::parse_json(document.out, "stdout");
  CHECK(json["format"] == "replay-comparison");
  CHECK(json["input"].size() == 2);
  CHECK(json["input"][0]["sha256"].get<std::string>().size() == 64);
  CHECK(json["algorithms"].size() == 4);
  CHECK(json["unlike"].empty());
  CHECK(json["failed"].empty());
  const auto page = replays.compare("a", "b", {"--markdown"});
  CHECK(page.code == 0);
  CHECK_THAT(page.out, Contains("| mean |") && Contains("# three"));
}

TEST_CASE("compare: checks end with exit code 6 behind the result") {
  const Replays replays;
  replays.make("a", {"--algorithms", "mean,minque"});
  replays.make("b", {"--algorithms", "mean,minque", "--set", "minque.gamma=0.9"});
  CHECK(replays.compare("a", "b", {"--fail-if", "mean:rmse+0%"}).code == 0);
  const auto failed = replays.compare("a", "b", {"--fail-if", "rmse+0.1%"});
  CHECK(failed.code == 6);
  CHECK_THAT(failed.err, Contains("E0924") && Contains("minque: rmse") && Contains("0.1 % is allowed"));
  CHECK_THAT(failed.out, Contains("minque"));  // the table stands all the same
  const auto several =
      replays.compare("a", "b", {"--json", "--fail-if", "rmse+0.1%", "--fail-if", "minque:regret+0.1%"});
  CHECK(several.code == 6);
  CHECK(libchar::parse_json(several.out, "stdout")["failed"].size() == 2);
  // Better is never a failure.
  CHECK(replays.compare("b", "a", {"--fail-if", "rmse+0%"}).code == 0);
  CHECK(replays.compare("a", "b", {"--fail-if", "rmse"}).code == 2);
  CHECK(replays.compare("a", "b", {"--fail-if", "means:rmse+1%"}).code == 2);
  CHECK(replays.compare("a", "b", {"--json", "--markdown"}).code == 2);
}

TEST_CASE("compare: unlike scenes are refused unless --unlike") {
  const Replays replays;
  replays.make("a", {"--algorithms", "mean"});
  replays.make("seed", {"--algorithms", "mean"}, "2");
  replays.make("window", {"--algorithms", "mean", "--evaluation", "10..50"});
  replays.make("fault", {"--algorithms", "mean", "--fault", "b:bias=1@10..20"});
  const auto refused = replays.compare("a", "seed");
  CHECK(refused.code == 3);
  CHECK(refused.out.empty());
  CHECK_THAT(refused.err,
             Contains("E0921") && Contains("seed of the simulation: 1 in A, 2 in B") && Contains("--unlike"));
  CHECK_THAT(replays.compare("a", "window").err, Contains("evaluation: 0 s to 60 s in A, 10 s to 50 s in B"));
  CHECK_THAT(replays.compare("a", "fault").err, Contains("number of faults: 0 in A, 1 in B"));
  const auto all_the_same = replays.compare("a", "seed", {"--unlike"});
  CHECK(all_the_same.code == 0);
  CHECK_THAT(all_the_same.out, Contains("unlike: seed of the simulation"));
}

TEST_CASE("compare: recordings are known by their content, wherever they stand") {
  const test::TemporaryFolder folder;
  const auto path = [&](const std::string& name) { return (folder / name).string(); };
  for (const std::string name : {"one", "two"}) {
    std::filesystem::create_directory(folder / name);
    std::string log = "t,x,y,z\n";
    for (int k = 0; k < 500; ++k)
      log += std::to_string(k) + "," + std::to_string(k % 7) + "," + std::to_string(k % 5) + "," +
             std::to_string(k % 3) + "\n";
    std::ofstream(path(name + "/log.csv")) << log;
    std::ofstream(path(name + "/scene.yaml")) << "format: scene\nversion: 1\nrecording: log.csv\nsensors: [x, y, z]\n";
    REQUIRE(test::run({"replay", path(name + "/scene.yaml"), "-o", path(name + "/out"), "--algorithms", "mean"}).code ==
            0);
  }
  const auto like = test::run({"compare", path("one/out"), path("two/out")});
  INFO(like.err);
  CHECK(like.code == 0);
  CHECK_THAT(like.out, Contains("leave-one-out"));
  std::ofstream(path("two/log.csv"), std::ios::app) << "500,1,1,1\n";
  REQUIRE(
      test::run({"replay", path("two/scene.yaml"), "-o", path("two/out"), "--algorithms", "mean", "--force"}).code ==
      0);
  const auto unlike = test::run({"compare", path("one/out"), path("two/out")});
  CHECK(unlike.code == 3);
  CHECK_THAT(unlike.err, Contains("contents of the log") && Contains("sha256"));
}

TEST_CASE("compare: bad input is one sentence with its place") {
  const Replays replays;
  replays.make("a", {"--algorithms", "mean"});
  CHECK(replays.compare("a", "nothing").code == 3);
  std::ofstream(replays.path("x.json")) << "{\"format\": \"characterization\", \"version\": 1}\n";
  const auto other = replays.compare("a", "x.json");
  CHECK(other.code == 3);
  CHECK_THAT(other.err, Contains("a/report.json") && Contains("E0771") && Contains("replay-report"));
  const auto turned = replays.compare("x.json", "a");
  CHECK(turned.code == 3);
  CHECK_THAT(turned.err, Contains("x.json") && Contains("fit is missing"));
  std::ofstream(replays.path("y.json")) << "{\"format\": ";
  CHECK(replays.compare("a", "y.json").code == 3);
  std::string text = test::slurp(replays.folder / "a/report.json");
  text.replace(text.find("\"rate_hz\""), 9, "\"rate\"");
  std::ofstream(replays.path("z.json")) << text;
  const auto missing = replays.compare("a", "z.json");
  CHECK(missing.code == 3);
  CHECK_THAT(missing.err, Contains("z.json:1:1") && Contains("rate_hz is missing"));
  CHECK(test::run({"compare", replays.path("a")}).code == 2);
  CHECK_THAT(test::run({"compare", "--help"}).out, Contains("--fail-if") && Contains("--unlike"));
}
