#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "libchar/core/text/text_table.hpp"
#include "tests/support/run.hpp"

using Catch::Contains;

namespace {

// A characterization of the fixture, made once.
const std::string& plotted_report() {
  static const test::TemporaryFolder folder;
  static const std::string path = [] {
    const std::string out = (folder / "report").string();
    const test::Ran ran = test::run({"characterize", test::fixture("imu_at_rest.csv").string(), "-o", out});
    INFO(ran.err);
    REQUIRE(ran.code == 0);
    return out;
  }();
  return path;
}

}  // namespace

TEST_CASE("plot writes what the name of the file says, whole, and never over another") {
  const test::TemporaryFolder folder;
  const std::string svg = (folder / "a.svg").string();
  test::Ran ran = test::run({"plot", plotted_report(), "-c", "gyro_z", "-o", svg});
  INFO(ran.err);
  REQUIRE(ran.code == 0);
  CHECK(ran.out == "");
  const std::string first = test::slurp(svg);
  CHECK_THAT(first, Contains("<text") && Contains("N = 0.00402 deg/s·√s"));
  ran = test::run({"plot", plotted_report(), "-c", "gyro_z", "-o", svg});
  CHECK(ran.code == 5);
  CHECK(test::slurp(svg) == first);
  ran = test::run({"plot", plotted_report(), "-c", "gyro_z", "-o", "-"});
  CHECK(ran.out == first);
  for (const char* name : {"a.pdf", "a.png"}) {
    const std::string path = (folder / name).string();
    ran = test::run({"plot", plotted_report(), "-c", "gyro_*", "-o", path});
    if (ran.code == 2 && ran.err.find("E0980") != std::string::npos) continue;
    INFO(ran.err);
    CHECK(ran.code == 0);
    CHECK(test::slurp(path).size() > 5000);
  }
}

TEST_CASE("plot gives the numbers, and reads what allan and psd print") {
  const test::TemporaryFolder folder;
  const std::string log = test::fixture("imu_at_rest.csv").string();
  const std::string csv = (folder / "n.csv").string(), gp = (folder / "n.gp").string();
  test::Ran ran = test::run({"plot", plotted_report(), "-c", "gyro_z", "--csv", csv, "--gnuplot", gp});
  INFO(ran.err);
  REQUIRE(ran.code == 0);
  CHECK_THAT(test::slurp(csv), Contains("series,fitted model,0.02,"));
  CHECK_THAT(test::slurp(gp), Contains("$series0 << EOD"));
  for (const char* verb : {"allan", "psd"})
    for (const bool json : {false, true}) {
      const std::string curve = (folder / (std::string(verb) + (json ? ".json" : ".csv"))).string();
      std::vector<std::string> words = {verb, log, "-c", "gyro_z", "-o", curve};
      if (json) words.emplace_back("--json");
      REQUIRE(test::run(words).code == 0);
      ran = test::run({"plot", curve, "-o", "-"});
      INFO(ran.err);
      CHECK(ran.code == 0);
      CHECK_THAT(ran.out, Contains(std::string(verb) == "allan" ? "Averaging time" : "Frequency [Hz]"));
    }
  ran = test::run(
      {"plot", plotted_report() + "/gyro_z.sensor.yaml", plotted_report() + "/curves.csv", "-c", "gyro_z", "-o", "-"});
  INFO(ran.err);
  CHECK(ran.code == 0);
}

TEST_CASE("what plot cannot do it says in a sentence, and writes nothing") {
  const test::TemporaryFolder folder, tables;
  const std::string cut = (tables / "cut.csv").string();
  std::ofstream(cut) << "tau_s,deviation\n1,0.5\n10\n";
  const std::string out = (folder / "x.svg").string();
  const std::string log = test::fixture("imu_at_rest.csv").string();
  const struct {
    std::vector<std::string> words;
    int code;
    const char* says;
  } kRows[] = {
      {{"plot"}, 2, "FILE is required"},
      {{"plot", plotted_report()}, 2, "where the figure goes"},
      {{"plot", plotted_report(), "-o", out}, 3, "--channel"},
      {{"plot", plotted_report(), "-o", (folder / "x.jpg").string()}, 2, "E0979"},
      {{"plot", log, "-o", out}, 3, "share an axis"},
      {{"plot", plotted_report(), "-c", "gyro_y", "-o", out}, 2, "gyro_z"},
      {{"plot", plotted_report(), "-c", "gyro_z", "--kind", "front", "-o", out}, 2, "E0978"},
      {{"plot", plotted_report(), "-c", "gyro_z", "--width", "5", "-o", out}, 2, "E0981"},
      {{"plot", plotted_report(), "-c", "gyro_z", "--width", "5mm", "-o", out}, 2, "no room"},
      {{"plot", plotted_report(), "-c", "gyro_z", "--x-range", "3..1", "-o", out}, 2, "E0201"},
      {{"plot", plotted_report(), "-c", "gyro_z", "--kind", "alan", "-o", out}, 2, "allan"},
      {{"plot", (folder / "absent").string(), "-o", out}, 3, "absent"},
      {{"plot", cut, "-o", out}, 3, "each row has a value for each name of the header"},
  };
  for (const auto& row : kRows) {
    const test::Ran ran = test::run(row.words);
    INFO(ran.err);
    CHECK(ran.code == row.code);
    CHECK_THAT(ran.err, Contains(row.says));
    CHECK(ran.out == "");
    CHECK(std::filesystem::is_empty(folder.path()));
  }
}

TEST_CASE("allan and psd draw in the terminal, a plot for each unit") {
  const std::string log = test::fixture("imu_at_rest.csv").string();
  for (const char* verb : {"allan", "psd"}) {
    test::RunOptions options;
    options.environment = {"COLUMNS=72"};
    const test::Ran ran = test::run({verb, log, "--plot"}, options);
    INFO(ran.err);
    REQUIRE(ran.code == 0);
    CHECK_THAT(ran.out, !Contains("\x1b") && Contains("┤") && Contains("┬"));
    CHECK_THAT(ran.out, Contains(std::string(verb) == "allan" ? "deviation [deg/s]" : "PSD [(deg/s)²/Hz]"));
    CHECK_THAT(ran.out, Contains(std::string(verb) == "allan" ? "deviation [g]" : "PSD [g²/Hz]"));
    for (std::size_t at = 0; at < ran.out.size();) {
      const std::size_t end = ran.out.find('\n', at);
      CHECK(libchar::width_of(ran.out.substr(at, end - at)) <= 72);
      at = end + 1;
    }
  }
}

TEST_CASE("report prints a report's table") {
  const test::Ran latex = test::run({"report", plotted_report(), "--latex"});
  CHECK(latex.code == 0);
  CHECK_THAT(latex.out, Contains("\\begin{tabular}") && Contains("gyro\\_z"));
  const test::Ran csv = test::run({"report", plotted_report(), "--csv", "-c", "accel_z"});
  CHECK_THAT(csv.out, Contains("accel_z,g,white_noise,") && !Contains("gyro_z"));
  // A recording is characterized on the way.
  CHECK(test::run({"report", test::fixture("imu_at_rest.csv").string()}).code == 0);
}

TEST_CASE("report --form is a test report to sign") {
  const test::Ran form = test::run({"report", plotted_report(), "--form", "-c", "gyro_z"});
  INFO(form.err);
  REQUIRE(form.code == 0);
  for (const char* part : {"1. Object", "2. Conditions", "SHA-256", "3. Method", "4. Results", "<svg", "5. Limits",
                           "6. Remarks", "7. Signatures", "Tested by", "gyro_z [deg/s]",
                           "N white noise, B bias instability", "Overlapping Allan deviation, 95 % intervals"})
    CHECK_THAT(form.out, Contains(part));
  CHECK_THAT(form.out, !Contains("accel_z [g]"));
  CHECK(test::run({"report", test::fixture("imu_at_rest.csv").string(), "--form"}).code == 0);
  CHECK(test::run({"report", plotted_report(), plotted_report(), "--form"}).code == 2);
  const test::TemporaryFolder marked;
  const std::string log = (marked / "log.csv").string();
  {
    std::ofstream out(log);
    out << "t[s],gx[deg/s]\n";
    for (int k = 0; k < 4000; ++k) {
      out << k * 0.01 << ',';
      if (k % 1000 != 7) out << (k % 200 < 3 ? -999 : std::sin(k * k * 0.7));
      out << '\n';
    }
  }
  CHECK_THAT(test::run({"report", log, "--form"}).out,
             Contains("<li>gx: ") && Contains("no gaps in time, up to 4 samples of a channel missing"));
  CHECK(test::run({"report", plotted_report(), "--form", "--csv"}).code == 2);
  // A report that somebody changed ends in a page or in a sentence.
  const test::TemporaryFolder folder;
  nlohmann::ordered_json document =
      nlohmann::ordered_json::parse(test::slurp(std::filesystem::path(plotted_report()) / "report.json"));
  const std::string path = (folder / "report.json").string();
  for (const char* key : {"recording", "config", "command", "allan", "limits"}) {
    document[key] = 7;
    std::ofstream(path) << document;
    const test::Ran ran = test::run({"report", path, "--form"});
    INFO(key << ran.err);
    CHECK((ran.code == 0 || ran.code == 3));
  }
}
