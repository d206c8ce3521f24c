// Limits, runs, lots and comparisons of characterizations, as people run them.

#include <catch2/catch.hpp>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>

#include "libchar/core/document/json.hpp"
#include "tests/support/noise.hpp"
#include "tests/support/run.hpp"
#include "tests/support/schemas.hpp"

using Catch::Contains;

namespace {

void write_log(const std::filesystem::path& path, const std::string& unit, double q, std::uint64_t seed,
               std::size_t samples = 4000, double rate_hz = 50) {
  test::NoiseSource noise(samples, rate_hz, seed);
  const auto x = noise.record(q, 0, 0), y = noise.record(q, 0, 0);
  std::ofstream out(path);
  out << "t[s],gx[" << unit << "],gy[" << unit << "]\n";
  for (std::size_t i = 0; i < samples; ++i)
    out << static_cast<double>(i) / rate_hz << "," << x[i] << "," << y[i] << "\n";
}

struct Logs {
  test::TemporaryFolder folder;
  std::string path(const std::string& name) const { return (folder / name).string(); }
  test::Ran characterize(const std::vector<std::string>& logs, const std::vector<std::string>& more) const {
    std::vector<std::string> words = {"characterize"};
    for (const std::string& log : logs) words.push_back(path(log));
    words.insert(words.end(), {"-o", path("out"), "--no-second-opinion"});
    words.insert(words.end(), more.begin(), more.end());
    return test::run(words);
  }
  libchar::Json json(const std::string& name) const { return libchar::parse_json(test::slurp(folder / name), name); }
  /// No file below the results.
  bool nothing_written() const {
    if (!std::filesystem::exists(folder / "out")) return true;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder / "out"))
      if (entry.is_regular_file()) return false;
    return true;
  }
};

std::string limits_text(const std::string& value) {
  return "format: noise-limits\nversion: 1\nsensor: <b>sheet</b>\nlimits:\n  - kind: angular_rate\n"
         "    white_noise: {value: " +
         value + ", unit: deg/√h}\n";
}

/// What a lot says, whoever puts it together; links lead from where its page is.
libchar::Json said_of_lot(libchar::Json lot) {
  for (const char* key : {"command", "config", "input", "name", "files_sha256"}) lot.erase(key);
  for (auto& one : lot.at("worst")) one.erase("report");
  return lot;
}

}  // namespace

TEST_CASE("characterize --limits: exit code, report, and refusals that leave nothing") {
  const Logs logs;
  write_log(logs.folder / "a.csv", "deg/s", 5e-3, 1);  // .3 deg/√h
  std::ofstream(logs.folder / "kept.yaml") << limits_text("0.5");
  std::ofstream(logs.folder / "low.yaml") << limits_text("0.1");
  const auto kept = logs.characterize({"a.csv"}, {"--limits", logs.path("kept.yaml")});
  CAPTURE(kept.err);
  CHECK(kept.code == 0);
  CHECK_THAT(kept.out, Contains("All 2 limits are kept."));
  const auto failed = logs.characterize({"a.csv"}, {"--limits", logs.path("low.yaml"), "--force"});
  CHECK(failed.code == 6);
  CHECK_THAT(failed.err, Contains("E0714") && Contains("2 of 2 limits fail"));
  const auto report = logs.json("out/report.json");
  CHECK(report.at("limits").at("fail") == 2);
  CHECK(report.at("limits").at("terms").at(0).at("judgement") == "fail");
  CHECK(report.at("limits").at("terms").at(0).at("limit").get<double>() == Approx(0.1 / 60));
  const std::string page = test::slurp(logs.folder / "out/report.html");
  CHECK_THAT(page, Contains("Limits of &lt;b&gt;sheet&lt;/b&gt;"));
  std::filesystem::remove_all(logs.folder / "out");
  std::ofstream(logs.folder / "other.yaml")
      << "format: noise-limits\nversion: 1\nlimits:\n  - kind: pressure\n    bias_instability: 1\n";
  const auto other = logs.characterize({"a.csv"}, {"--limits", logs.path("other.yaml")});
  CHECK(other.code == 3);
  CHECK_THAT(other.err, Contains("other.yaml:4:11") && Contains("another sensor"));
  CHECK(logs.nothing_written());
}

TEST_CASE("characterize --pool: pages, numbers and a model of runs together") {
  const Logs logs;
  for (const char* name : {"a", "b", "c"})
    write_log(logs.folder / (std::string(name) + ".csv"), "deg/s", 5e-3, 7 + name[0]);
  const auto ran = logs.characterize({"a.csv", "b.csv", "c.csv"}, {"--pool"});
  CAPTURE(ran.err, ran.out);
  REQUIRE(ran.code == 0);
  CHECK_THAT(ran.out, Contains("3 runs, one sensor"));
  for (const char* file : {"runs.html", "runs.json", "gx.sensor.yaml", "a/report.html", "c/report.json"})
    CHECK(std::filesystem::file_size(logs.folder / "out" / file) > 500);
  const auto runs = logs.json("out/runs.json");
  const auto& white = runs.at("fit").at("channels").at(0).at("white_noise");
  CHECK(white.at("ci95").at(0).get<double>() < 5e-3);
  CHECK(white.at("ci95").at(1).get<double>() > 5e-3);
  CHECK(white.at("relative_sd").get<double>() < 0.75 * logs.json("out/a/report.json")
                                                           .at("fit")
                                                           .at("channels")
                                                           .at(0)
                                                           .at("white_noise")
                                                           .at("relative_sd")
                                                           .get<double>());
  CHECK(runs.at("consistency").at("channels").at(0).at("consistent") == true);
  CHECK(test::run({"model", logs.path("out/gx.sensor.yaml")}).code == 0);
  const auto again = logs.characterize({"a.csv", "b.csv", "c.csv"}, {"--pool"});
  CHECK(again.code == 5);  // exists
  const auto compared = test::run({"compare", logs.path("out"), logs.path("out/a")});
  CHECK(compared.code == 0);
  CHECK_THAT(compared.out, Contains("N: a or out, not distinguished") || Contains("N: out or a, not distinguished"));
}

TEST_CASE("characterize --pool: runs that are not of one sensor end in a sentence, with nothing written") {
  const Logs logs;
  write_log(logs.folder / "a.csv", "deg/s", 5e-3, 1);
  write_log(logs.folder / "b.csv", "rad/s", 5e-3, 2);
  write_log(logs.folder / "c.csv", "deg/s", 5e-3, 3, 4000, 100);
  std::ofstream(logs.folder / "empty.csv") << "t[s],gx[deg/s],gy[deg/s]\n";
  std::ofstream(logs.folder / "short.csv") << "t[s],gx[deg/s],gy[deg/s]\n0,1,2\n0.02,1,3\n0.04,2,3\n";
  const auto refused = [&](const std::string& other, int code, const std::string& why) {
    const auto ran = logs.characterize({"a.csv", other}, {"--pool"});
    CAPTURE(other, ran.err);
    CHECK(ran.code == code);
    CHECK_THAT(ran.err, Contains(why));
    CHECK(std::count(ran.err.begin(), ran.err.end(), '\n') <= 2);  // warnings of the log, the sentence
    CHECK(logs.nothing_written());
  };
  refused("b.csv", 3, "one unit");
  refused("c.csv", 3, "one rate");
  refused("empty.csv", 3, "E0322");
  refused("short.csv", 3, "E0761");
  refused("a.csv", 3, "E0762");
  CHECK(logs.characterize({"a.csv"}, {"--pool"}).code == 2);
  CHECK(logs.characterize({"a.csv", "c.csv"}, {"--pool", "--lot"}).code == 2);
}

TEST_CASE("characterize --lot and a fleet of the same logs say the same") {
  const Logs logs;
  std::vector<std::string> names;
  const std::map<int, double> louder = {{3, 1.9}, {6, 2.3}};
  for (int i = 0; i < 9; ++i) {
    names.push_back("imu" + std::to_string(i) + ".csv");
    const double by = louder.count(i) > 0 ? louder.at(i) : 1;
    // Some of them say it in another unit.
    write_log(logs.folder / names.back(), i % 4 == 1 ? "rad/s" : "deg/s",
              (i % 4 == 1 ? std::numbers::pi / 180 : 1) * 5e-3 * by, 40 + i);
  }
  const auto ran = logs.characterize(names, {"--lot"});
  CAPTURE(ran.err, ran.out);
  REQUIRE(ran.code == 0);
  CHECK_THAT(ran.out, Contains("9 devices. 2 devices are outliers of their kind: ") &&
                          Contains("gx, gy: recorded in deg/s, rad/s, compared in deg/s."));
  CHECK_THAT(test::slurp(logs.folder / "out/index.html"),
             Contains("Overlapping Allan deviation, deg/s") && !Contains("deviation, rad/s"));
  std::vector<std::string> plan = {"fleet", "plan", "-o", logs.path("f"), "--no-second-opinion"};
  for (const std::string& name : names) plan.push_back(logs.path(name));
  REQUIRE(test::run(plan).code == 0);
  REQUIRE(test::run({"fleet", "run", logs.path("f")}).code == 0);
  const auto merged = test::run({"fleet", "merge", logs.path("f"), "-o", logs.path("r")});
  REQUIRE(merged.code == 0);
  CHECK(ran.out.substr(0, ran.out.find("\nwrote")) == merged.out.substr(0, merged.out.find("\nwrote")));
  const auto lot = logs.json("out/lot.json");
  CHECK(said_of_lot(lot) == said_of_lot(logs.json("r/lot.json")));
  CHECK(test::slurp(logs.folder / "out/coefficients.npz") == test::slurp(logs.folder / "r/coefficients.npz"));
  CHECK(test::schema_fault(test::slurp(logs.folder / "out/lot.json")) == "");
  for (const auto& q : lot.at("quantities")) {
    CHECK(q.at("members") == (q.at("of_kind") == true ? 18 : 9));
    if (q.at("what") != "white_noise" || q.at("of_kind") == true) continue;
    REQUIRE(q.at("outliers").size() == 2);
    for (const auto& o : q.at("outliers"))
      CHECK(o.at("ratio").get<double>() == Approx(o.at("device") == "imu3" ? 1.9 : 2.3).epsilon(0.06));
  }
  const std::string page = test::slurp(logs.folder / "out/index.html");
  CHECK_THAT(page, Contains("imu3/report.html") && Contains("<h2>Allan curves</h2>"));
  CHECK(std::filesystem::exists(logs.folder / "out/imu4/report.html"));
}

TEST_CASE("characterize --lot: limits hold for each log and for the lot") {
  const Logs logs;
  const std::vector<std::string> names = {"a.csv", "b.csv"};
  write_log(logs.folder / "a.csv", "deg/s", 5e-3, 1);  // .3 deg/√h
  write_log(logs.folder / "b.csv", "deg/s", 1e-2, 2);
  std::ofstream(logs.folder / "sheet.yaml") << limits_text("0.5");
  const auto ran = logs.characterize(names, {"--lot", "--limits", logs.path("sheet.yaml")});
  CHECK(ran.code == 6);
  CHECK_THAT(ran.out, Contains("Of 2 devices compared with limits, 1 fails one, 0 not decided, 1 keeps all"));
  CHECK(logs.json("out/lot.json").at("limits").at("failing") == 1);
  for (const char* report : {"out", "out/lot.json"})
    CHECK_THAT(test::run({"compare", logs.path(report), logs.path("out/a")}).err,
               Contains("report of a lot of devices"));
}

TEST_CASE("compare: recordings, reports and models, and checks of them") {
  const Logs logs;
  write_log(logs.folder / "a.csv", "deg/s", 5e-3, 1);
  write_log(logs.folder / "b.csv", "deg/s", 8e-3, 2);
  REQUIRE(logs.characterize({"a.csv", "b.csv"}, {}).code == 0);
  const auto ran = test::run({"compare", logs.path("out/a"), logs.path("out/b/report.json")});
  CAPTURE(ran.err);
  REQUIRE(ran.code == 0);
  CHECK_THAT(ran.out, Contains("gyro (x, y): a is lowest") && Contains("Lowest N: a"));
  const auto json = test::run({"compare", logs.path("out/a"), logs.path("out/b"), "--json"});
  const auto document = libchar::parse_json(json.out, "stdout");
  CHECK(document.at("format") == "characterization-comparison");
  CHECK(document.at("groups").at(0).at("terms").at(0).at("sensors").at(1).at("difference") == "larger");
  CHECK(document.at("groups").at(0).at("terms").at(0).at("sensors").at(1).at("ratio").get<double>() ==
        Approx(1.6).epsilon(0.05));
  CHECK(test::run({"compare", logs.path("out/a"), logs.path("out/b"), "--unlike"}).code == 2);
  const auto failed = test::run({"compare", logs.path("out/a"), logs.path("out/b"), "--fail-if", "gx:white_noise+10%"});
  CHECK(failed.code == 6);
  CHECK_THAT(failed.err, Contains("E0924") && Contains("gx: white_noise in b is 1."));
  CHECK(test::run({"compare", logs.path("out/a"), logs.path("out/b"), "--fail-if", "white_noise+90%"}).code == 0);
  CHECK_THAT(test::run({"compare", logs.path("out/a"), logs.path("out/b"), "--fail-if", "white_nose+9%"}).err,
             Contains("E0922") && Contains("did you mean white_noise?"));
  CHECK_THAT(test::run({"compare", logs.path("out/a"), logs.path("out/b"), "--markdown"}).out,
             Contains("# Sensors compared"));
  // A recording, a report and a model in one call; the page next to them.
  const auto mixed = test::run({"compare", logs.path("a.csv"), logs.path("out/b"), logs.path("out/a/gx.sensor.yaml"),
                                "-o", logs.path("which.html")});
  CAPTURE(mixed.err);
  REQUIRE(mixed.code == 0);
  CHECK_THAT(mixed.out, Contains("gyro_x:") && Contains("  gx  "));
  CHECK_THAT(test::slurp(logs.folder / "which.html"), Contains("<svg") && Contains("lowest"));
  CHECK(test::run({"plot", logs.path("a.csv"), logs.path("out/b"), "-o", logs.path("both.svg")}).code == 0);
  CHECK_THAT(test::run({"report", logs.path("a.csv"), logs.path("out/b"), "--latex"}).out, Contains("tabular"));
}
