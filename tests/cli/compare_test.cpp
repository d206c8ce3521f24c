#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>

#include "libchar/core/json.hpp"
#include "tests/support/run.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;
using Catch::Contains;

namespace {

// Two replays of one small scene; the second is changed by `change`.
struct Reports {
  test::TemporaryFolder folder;
  std::string path(const std::string& name) const { return (folder / name).string(); }
  std::string file(const std::string& name, const std::string& text) const {
    std::ofstream(path(name)) << text;
    return path(name);
  }
  std::string replayed(const std::string& name, const std::string& seed = "1") const {
    const std::string scene =
        file(name + ".yaml",
             "format: scene\nversion: 1\nsimulate: {rate_hz: 100, samples: 4000, seed: " + seed +
                 ", truth: {kind: sine, amplitude: 1, frequency_hz: 0.2}}\n"
                 "sensors:\n  - {name: a, noise: 0.1}\n  - {name: b, noise: 0.2}\n"
                 "  - {name: c, noise: 0.3}\nreference: truth\n");
    const auto ran =
        test::run({"replay", scene, "-o", path(name), "--algorithms", "mean,inverse-variance"});
    INFO(ran.err);
    REQUIRE(ran.code == 0);
    return path(name) + "/report.json";
  }
};

Json read(const std::string& path) {
  return parse_json(test::slurp(path), path);
}

}  // namespace

TEST_CASE("compare: a report against itself has no change and passes every check") {
  const Reports reports;
  const std::string a = reports.replayed("a");
  const auto ran =
      test::run({"compare", a, a, "--fail-if", "rmse+0%", "--fail-if", "peak_bytes+0%"});
  INFO(ran.err);
  CHECK(ran.code == 0);
  CHECK_THAT(ran.out, Contains("inverse-variance"));
  CHECK_THAT(ran.out, Contains("0 %"));
  const auto json = test::run({"compare", a, a, "--json"});
  const Json j = parse_json(json.out, "stdout");
  CHECK(j["format"] == "replay-comparison");
  CHECK(j["alike"] == true);
  CHECK(j["input"].size() == 2);
  CHECK(j["algorithms"].size() == 2);
  const auto markdown = test::run({"compare", a, a, "--markdown"});
  CHECK_THAT(markdown.out, Contains("| inverse\\-variance |") || Contains("| inverse-variance |"));
}

TEST_CASE("compare: a breach ends with 6, after the table") {
  const Reports reports;
  const std::string a = reports.replayed("a");
  Json worse = read(a);
  worse["algorithms"][0]["rmse"] = worse["algorithms"][0]["rmse"].get<double>() * 1.06;
  const std::string b = reports.file("b.json", dump_json(worse));
  const auto ran = test::run({"compare", "--fail-if", "rmse+5%", a, b});
  CHECK(ran.code == 6);
  CHECK_THAT(ran.out, Contains("+6.00 %"));
  CHECK_THAT(ran.err, Contains("E0925") && Contains("mean: rmse went from"));
  CHECK(test::run({"compare", a, b, "--fail-if", "inverse-variance:rmse+5%"}).code == 0);
  const auto json = test::run({"compare", a, b, "--json", "--fail-if", "rmse+5%"});
  CHECK(json.code == 6);
  CHECK(parse_json(json.out, "stdout")["checks"][0]["passed"] == false);
}

TEST_CASE("compare: unlike scenes are refused, and compared when asked") {
  const Reports reports;
  const std::string a = reports.replayed("a"), b = reports.replayed("b", "2");
  const auto ran = test::run({"compare", a, b});
  CHECK(ran.code == 3);
  CHECK(ran.out.empty());
  CHECK_THAT(ran.err,
             Contains("E0923") && Contains("the seed of the simulation differs: 1 in A, 2 in B"));
  const auto forced = test::run({"compare", a, b, "--unlike"});
  CHECK(forced.code == 0);
  CHECK_THAT(forced.out, Contains("unlike: the seed"));
}

TEST_CASE("compare: what is no report is one sentence with its place") {
  const Reports reports;
  const std::string a = reports.replayed("a");
  const auto refused = [&](const std::string& b, const std::string& word) {
    const auto ran = test::run({"compare", a, b});
    INFO(ran.err);
    CHECK(ran.code == 3);
    CHECK_THAT(ran.err, Contains(word));
  };
  refused(reports.path("absent.json"), "absent.json");
  refused(reports.file("no.json", "not json"), "no.json:1:1");
  refused(reports.file("other.json", "{\"format\":\"fit\",\"version\":1}"), "E0920");
  refused(reports.file("new.json", "{\"format\":\"replay-report\",\"version\":7}"), "E0921");
  refused(reports.file("cut.json", "{\"format\":\"replay-report\",\"version\":1}"), "E0922");
  CHECK(test::run({"compare", a}).code == 2);
  CHECK(test::run({"compare", a, a, "--fail-if", "rsme+5%"}).code == 2);
  CHECK(test::run({"compare", a, a, "--json", "--markdown"}).code == 2);
}
