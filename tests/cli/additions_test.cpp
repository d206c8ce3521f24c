// What docs/dev/contributing.md says that adding costs: a program with one fusion algorithm, log
// format, export target, Allan statistic and verb more, each from its own file in
// tests/cli/additions, has them in its help, lists, JSON, work and messages. The pages' tests
// compare with the same tables, so that an addition without its row in docs/ fails there.

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "libchar/core/document/json.hpp"
#include "tests/support/run.hpp"
#include "tests/support/shared.hpp"

using Catch::Contains;

namespace {

test::Ran run_with_additions(std::vector<std::string> words) {
  words.insert(words.begin(),
               std::filesystem::path(test::program()).replace_filename("sensorchar_with_additions").string());
  return test::run_words(words);
}

}  // namespace

TEST_CASE("a verb is one file: help, work, JSON and messages have it") {
  const auto help = run_with_additions({"--help"});
  CHECK(help.code == 0);
  CHECK_THAT(help.out, Contains("convert") && Contains("count words"));
  CHECK_THAT(run_with_additions({"count-words", "--help"}).out, Contains("--json"));
  CHECK(run_with_additions({"count-words", "one", "two"}).out == "2\n");
  const auto json = run_with_additions({"count-words", "one", "--json"});
  CHECK_THAT(json.out, Contains("\"format\": \"words\"") && Contains("\"words\": 1"));
  CHECK_THAT(run_with_additions({"cont-words"}).err, Contains("did you mean count-words?"));
  CHECK(test::run({"count-words"}).code == 2);
}

TEST_CASE("a log format is a file and a line: help, suffix and work have it") {
  const test::TemporaryFolder folder;
  const std::string log = (folder / "a.readings").string();
  std::ofstream(log) << "t,x\n0,1\n1,2\n2,4\n";
  CHECK_THAT(run_with_additions({"inspect", "--help"}).out, Contains("readings"));
  const auto json = run_with_additions({"inspect", log, "--format", "readings", "--json"});
  INFO(json.err);
  REQUIRE(json.code == 0);
  CHECK(libchar::parse_json(json.out, "").at("recordings")[0].at("rows") == 3);
  CHECK_THAT(test::run({"inspect", "--help"}).out, !Contains("readings"));
}

TEST_CASE("a fusion algorithm is a file and a line: list, plan and report have it") {
  CHECK_THAT(run_with_additions({"replay", "--list"}).out, Contains("last-channel"));
  const std::string scene = test::fixture("scenes/rv-5.1-fault-free.yaml").string();
  CHECK_THAT(run_with_additions({"replay", scene, "--explain"}).out, Contains("last-channel"));
  CHECK_THAT(test::run({"replay", "--list"}).out, !Contains("last-channel"));
}

TEST_CASE("an export target is a file and a line: list, work and messages have it") {
  CHECK_THAT(run_with_additions({"model", "--list"}).out, Contains("names"));
  const test::TemporaryFolder folder;
  const std::string model = (folder / "m.sensor.yaml").string();
  std::ofstream(model) << "format: sensor-model\nversion: 1\nchannel: gyro_x\nunit: rad/s\n";
  const auto names = run_with_additions({"model", model, "--to", "names"});
  INFO(names.err);
  CHECK(names.out == "gyro_x\n");
  CHECK_THAT(run_with_additions({"model", model, "--to", "name"}).err, Contains("did you mean names?"));
  CHECK(test::run({"model", model, "--to", "names"}).code == 2);
}

TEST_CASE("an Allan statistic is a row: help, work, JSON and messages have it") {
  CHECK_THAT(run_with_additions({"allan", "--help"}).out, Contains("scaled-oadev"));
  const std::string log = test::fixture("imu_at_rest.csv").string();
  const auto curve = [&](const std::string& type) {
    const auto ran = run_with_additions({"allan", log, "-c", "gyro_z", "--type", type, "--json"});
    INFO(ran.err);
    REQUIRE(ran.code == 0);
    return libchar::parse_json(ran.out, "");
  };
  const auto scaled = curve("scaled-oadev"), oadev = curve("oadev");
  CHECK(scaled.at("type") == "scaled-oadev");
  const auto &a = scaled.at("channels")[0], &b = oadev.at("channels")[0];
  REQUIRE(a.at("tau_s") == b.at("tau_s"));
  for (std::size_t i = 0; i < a.at("tau_s").size(); ++i)
    CHECK(a.at("deviation")[i].get<double>() ==
          Approx(b.at("deviation")[i].get<double>() * a.at("tau_s")[i].get<double>() / std::sqrt(3.0)));
  CHECK_THAT(run_with_additions({"allan", log, "--type", "scaled-odev"}).err, Contains("scaled-oadev"));
  CHECK(test::run({"allan", log, "--type", "scaled-oadev"}).code == 2);
}

TEST_CASE("the pages lack what was added, and nothing else: the comparison with the tables finds it") {
  const auto missing = [](const std::string& listed, const std::string& file) {
    const std::string page = test::slurp(test::source_folder() / "docs" / file);
    std::vector<std::string> names;
    std::istringstream lines(listed);
    for (std::string line; std::getline(lines, line);) {
      const std::string name = line.substr(0, line.find(' '));
      if (!name.empty() && page.find("`" + name + "`") == std::string::npos) names.push_back(name);
    }
    return names;
  };
  using Names = std::vector<std::string>;
  CHECK(missing(run_with_additions({"replay", "--list"}).out, "replay.md") == Names{"last-channel"});
  CHECK(missing(run_with_additions({"model", "--list"}).out, "exports.md") == Names{"names"});
  std::string help = run_with_additions({"allan", "--help"}).out;
  const std::string broken = "|\n      ";  // a long list goes on in the next line
  for (std::size_t at = help.find(broken); at != std::string::npos; at = help.find(broken))
    help.replace(at, broken.size(), "|");
  const std::size_t from = help.find("\n  --type ") + 10;
  std::string types = help.substr(from, help.find('\n', from) - from);
  std::replace(types.begin(), types.end(), '|', '\n');
  CHECK(missing(types, "theory/allan.md") == Names{"scaled-oadev"});
}
