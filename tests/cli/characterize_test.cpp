// The main job, run as people run it.

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "libchar/core/document/json.hpp"
#include "tests/support/run.hpp"

using namespace libchar;

namespace {

Json report_of(const std::filesystem::path& folder) {
  return parse_json(test::slurp(folder / "report.json"), "report.json");
}

const Json& fit_of(const Json& report, const std::string& channel) {
  for (const Json& c : report.at("fit").at("channels"))
    if (c.at("name") == channel) return c;
  FAIL("no fit of " << channel);
  return report;
}

bool inside(const Json& term, double truth) {
  return term.at("ci95").at(0).get<double>() <= truth && truth <= term.at("ci95").at(1).get<double>();
}

void write_text(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

}  // namespace

TEST_CASE("characterize the fixture: every file, and intervals that hold the truth") {
  const test::TemporaryFolder folder;
  const auto out = folder / "out";
  const auto ran = test::run({"characterize", test::fixture("imu_at_rest.csv").string(), "-o", out.string()});
  CAPTURE(ran.err);
  REQUIRE(ran.code == 0);
  for (const char* name : {"report.html", "report.json", "curves.csv", "gyro_z.sensor.yaml", "accel_z.sensor.yaml"})
    CHECK(std::filesystem::file_size(out / name) > 500);
  const Json report = report_of(out);
  CHECK(report.at("fit").at("format") == "noise-fit");
  const Json& gyro = fit_of(report, "gyro_z");
  CHECK(inside(gyro.at("white_noise"), 4e-3));
  CHECK(inside(gyro.at("bias_instability"), 4e-3));
  CHECK(inside(gyro.at("random_walk"), 1.5e-3));
  const Json& accel = fit_of(report, "accel_z");
  CHECK(inside(accel.at("white_noise"), 1e-4));
  for (const char* absent : {"bias_instability", "random_walk"}) {
    CHECK(accel.at(absent).at("status") == "not_detected");
    CHECK(accel.at(absent).at("value").is_null());
    CHECK(accel.at(absent).at("upper95").get<double>() > 0);
  }
}

TEST_CASE("characterize without -o makes LOG-report, and what it says to type next runs") {
  const test::TemporaryFolder folder;
  test::RunOptions there;
  there.folder = folder.path().string();
  const auto ran = test::run({"characterize", test::fixture("imu_at_rest.csv").string()}, there);
  REQUIRE(ran.code == 0);
  CHECK(std::filesystem::exists(folder / "imu_at_rest-report/report.json"));
  const std::size_t at = ran.out.find("\nnext: sensorchar ");
  REQUIRE(at != std::string::npos);
  std::istringstream line(ran.out.substr(at + 18));
  std::vector<std::string> words;
  for (std::string word; line >> word;) words.push_back(word);
  CHECK(test::run(words, there).code == 0);
  // A folder of results and its report stand for the models in it.
  const auto model = test::run({"model", "imu_at_rest-report", "--json"}, there);
  const auto report = test::run({"model", "imu_at_rest-report/report.json", "--json"}, there);
  REQUIRE(model.code == 0);
  CHECK(parse_json(model.out, "model").at("models").size() == 2);
  CHECK(parse_json(report.out, "report").at("models") == parse_json(model.out, "model").at("models"));
  CHECK(test::run({"simulate", "imu_at_rest-report", "--samples", "3", "-o", "three.csv"}, there).code == 0);
  CHECK(test::run({"model", "."}, there).code == 0);  // a folder of such folders
  std::filesystem::create_directory(folder / "none");
  CHECK(test::run({"model", "none"}, there).code == 3);
}

TEST_CASE("characterize gives the same bytes for the same input, measured times apart") {
  const test::TemporaryFolder folder;
  const std::string log = test::fixture("imu_at_rest.csv").string();
  for (const char* threads : {"1", "2"}) {
    const auto out = folder / "out";  // the same place each time: paths are part of the command
    REQUIRE(test::run({"characterize", log, "-o", out.string(), "--force", "--threads", threads}).code == 0);
    std::filesystem::rename(out, folder / (std::string("threads") + threads));
  }
  const auto a = folder / "threads1", b = folder / "threads2";
  CHECK(test::slurp(a / "curves.csv") == test::slurp(b / "curves.csv"));
  CHECK(test::slurp(a / "gyro_z.sensor.yaml") == test::slurp(b / "gyro_z.sensor.yaml"));
  Json first = report_of(a), second = report_of(b);
  for (Json* document : {&first, &second}) {
    document->erase("measured");
    document->erase("command");                        // differs by --threads,
    (*document)["files_sha256"].erase("report.html");  // and stands in the page
  }
  CHECK(first == second);
}

TEST_CASE("kept and streamed records agree") {
  const test::TemporaryFolder folder;
  const std::string log = test::fixture("imu_at_rest.csv").string();
  const auto kept = folder / "kept", streamed = folder / "streamed";
  REQUIRE(test::run({"characterize", log, "-o", kept.string(), "--segment", "4096"}).code == 0);
  REQUIRE(test::run({"characterize", log, "-o", streamed.string(), "--segment", "4096", "--memory", "1k"}).code == 0);
  const Json a = report_of(kept), b = report_of(streamed);
  for (const char* term : {"white_noise", "bias_instability", "random_walk"}) {
    const Json &x = fit_of(a, "gyro_z").at(term), &y = fit_of(b, "gyro_z").at(term);
    // One transform of the whole against transforms of blocks: the same information but for the
    // seams, so the estimates may differ by a small part of their uncertainty.
    const double half_width = (x.at("ci95").at(1).get<double>() - x.at("ci95").at(0).get<double>()) / 2;
    CHECK(std::abs(x.at("value").get<double>() - y.at("value").get<double>()) < 0.25 * half_width);
  }
}

TEST_CASE("characterize never overwrites unasked, and never its input") {
  const test::TemporaryFolder folder;
  const std::string log = test::fixture("imu_at_rest.csv").string();
  const auto out = folder / "out";
  std::filesystem::create_directory(out);
  write_text(out / "curves.csv", "precious");
  const auto ran = test::run({"characterize", log, "-o", out.string()});
  CHECK(ran.code == 5);
  CHECK(test::slurp(out / "curves.csv") == "precious");
  CHECK_FALSE(std::filesystem::exists(out / "report.html"));
  std::filesystem::copy_file(log, folder / "curves.csv");
  const std::string before = test::slurp(folder / "curves.csv");
  CHECK(test::run({"characterize", (folder / "curves.csv").string(), "-o", folder.path().string(), "--force"}).code ==
        5);
  CHECK(test::slurp(folder / "curves.csv") == before);
}

TEST_CASE("a broken log leaves nothing behind and says where it broke") {
  const test::TemporaryFolder folder;
  write_text(folder / "broken.csv", "t[s],x\n0,1\n0.01,2\n0.02,1.2.3\n");
  const auto ran = test::run({"characterize", (folder / "broken.csv").string(), "-o", (folder / "out").string()});
  CHECK(ran.code == 3);
  CHECK(ran.err.find("broken.csv:4:") != std::string::npos);
  CHECK(std::count(ran.err.begin(), ran.err.end(), '\n') == 1);
  CHECK_FALSE(std::filesystem::exists(folder / "out"));
}

TEST_CASE("a record that is too short, or has no time axis, is a numeric refusal with its reason") {
  const test::TemporaryFolder folder;
  write_text(folder / "one.csv", "t[s],x\n0,1\n");
  const auto one = test::run({"characterize", (folder / "one.csv").string(), "-o", (folder / "out").string()});
  CHECK(one.code == 4);
  CHECK_FALSE(one.err.empty());
  std::string text = "x\n";
  for (int i = 0; i < 1000; ++i) text += std::to_string(i * 7919 % 101) + "\n";
  write_text(folder / "untimed.csv", text);
  const auto untimed = test::run({"characterize", (folder / "untimed.csv").string(), "-o", (folder / "out2").string()});
  CHECK(untimed.code == 4);
  CHECK(untimed.out.find("--rate") + untimed.err.find("--rate") != 2 * std::string::npos);
}

TEST_CASE("names and units for a log that has none") {
  const test::TemporaryFolder folder;
  const auto ran = test::run({"characterize", test::fixture("npy/c_order.npy").string(), "--rate", "10Hz", "--names",
                              "a,b,c,d,e", "-o", (folder / "out").string()});
  CHECK(ran.code == 2);  // not five channels
  std::string text;
  for (int i = 0; i < 2000; ++i)
    text += std::to_string(i * 7919 % 1013) + "," + std::to_string(i * 104729 % 997) + "\n";
  write_text(folder / "bare.csv", text);
  const auto named = test::run({"allan", (folder / "bare.csv").string(), "--time-column", "none", "--rate", "10Hz",
                                "--names", "gyro_x,gyro_y", "--units", "deg/s"});
  CAPTURE(named.err);
  REQUIRE(named.code == 0);
  CHECK(named.out.find("gyro_y,deg/s,0.1,") != std::string::npos);
}

TEST_CASE("allan as JSON has the keys that scripts rely on") {
  const auto ran = test::run({"allan", test::fixture("imu_at_rest.csv").string(), "--json"});
  REQUIRE(ran.code == 0);
  const Json document = parse_json(ran.out, "stdout");
  CHECK(document.at("format") == "allan");
  CHECK(document.at("version") == 1);
  CHECK(document.at("type") == "oadev");
  const Json& channel = document.at("channels").at(0);
  for (const char* key : {"name", "unit", "tau_s", "deviation", "ci95", "edf", "terms"}) CHECK(channel.contains(key));
  CHECK(channel.at("tau_s").size() == channel.at("deviation").size());
  CHECK(channel.at("terms").at(0) == 49999);
}

TEST_CASE("allan of phase data is the allan of its rate") {
  // Intervals are those of the noise that was fitted, and a clock's phase is offered more kinds of it.
  const auto deviations = [](const std::string& table) {
    std::istringstream lines(table);
    std::string line, out;
    while (std::getline(lines, line)) {
      std::size_t end = 0;
      for (int column = 0; column < 4; ++column) end = line.find(',', end) + 1;
      out += line.substr(0, end) + "\n";
    }
    return out;
  };
  const test::TemporaryFolder folder;
  std::string rate, phase = "0\n";
  long long sum = 0;
  for (int i = 0; i < 500; ++i) {
    const int y = i * 7919 % 1013;
    rate += std::to_string(y) + "\n";
    sum += y;
    phase += std::to_string(sum) + "\n";
  }
  write_text(folder / "rate.csv", rate);
  write_text(folder / "phase.csv", phase);
  const auto a =
      test::run({"allan", (folder / "rate.csv").string(), "--time-column", "none", "--rate", "1", "--taus", "decade"});
  const auto b = test::run({"allan", (folder / "phase.csv").string(), "--time-column", "none", "--rate", "1", "--taus",
                            "decade", "--data", "phase"});
  REQUIRE(a.code == 0);
  CHECK(deviations(a.out).size() > 100);
  CHECK(deviations(a.out) == deviations(b.out));
}

TEST_CASE("options that cannot be followed are said, not swallowed") {
  const test::TemporaryFolder folder;
  const std::string log = test::fixture("imu_at_rest.csv").string();
  const auto window = test::run({"characterize", log, "--from", "2000s", "-o", (folder / "out").string()});
  CHECK(window.code == 2);
  CHECK(window.err.find("holds no sample") != std::string::npos);
  // The sentence is one for every option that chooses a stretch: none is named that was not given.
  const auto still = test::run({"characterize", log, "--still", "2000s..3000s", "-o", (folder / "out").string()});
  CHECK(still.code == 2);
  CHECK(still.err.find("holds no sample") != std::string::npos);
  CHECK(still.err.find("--from") == std::string::npos);
  CHECK(test::run({"allan", log, "--rate", "10Hz", "--taus", "1s"}).err.find("is not used") != std::string::npos);
  CHECK(test::run({"allan", log, "--taus", "0.027s"}).err.find("nearest multiple") != std::string::npos);
  std::string uneven = "t[s],x\n";
  double t = 0;
  for (int i = 0; i < 3000; ++i) {
    uneven += std::to_string(t) + "," + std::to_string(i * 7919 % 101) + "\n";
    t += i % 3 == 0 ? 0.004 : 0.01;
  }
  write_text(folder / "uneven.csv", uneven);
  CHECK(test::run({"allan", (folder / "uneven.csv").string(), "--taus", "1s"}).err.find("uneven") != std::string::npos);
}

TEST_CASE("channels whose names make one file name get a model file each, letters kept") {
  const test::TemporaryFolder folder;
  std::string text = "a/b,A b,größe\n";
  std::uint32_t state = 1;
  for (int i = 0; i < 400; ++i) {
    for (int c = 0; c < 3; ++c)
      text += std::to_string((state = state * 1664525U + 1013904223U) >> 12U) + (c < 2 ? "," : "\n");
  }
  write_text(folder / "x.csv", text);
  const auto ran =
      test::run({"characterize", (folder / "x.csv").string(), "--rate", "100", "-o", (folder / "out").string()});
  CAPTURE(ran.err);
  REQUIRE(ran.code == 0);
  for (const char* name : {"a_b.sensor.yaml", "A_b_2.sensor.yaml", "größe.sensor.yaml"})
    CHECK(std::filesystem::exists(folder / "out" / name));
}

TEST_CASE("fit --json and the fit in report.json are the same bytes, key by key") {
  const test::TemporaryFolder folder;
  const std::string log = test::fixture("imu_at_rest.csv").string();
  REQUIRE(test::run({"characterize", log, "-o", (folder / "out").string()}).code == 0);
  const auto fit = test::run({"fit", log, "--json"});
  REQUIRE(fit.code == 0);
  const Json alone = parse_json(fit.out, "stdout"), report = report_of(folder / "out").at("fit");
  for (const char* key : {"format", "version", "density_sides"}) CHECK(alone.at(key) == report.at(key));
  REQUIRE(alone.at("channels").size() == 2);
  for (std::size_t c = 0; c < 2; ++c) {
    Json in_report = report.at("channels").at(c);
    CHECK(in_report.erase("derived") == 1);
    CHECK(in_report.erase("residuals") == 1);
    CHECK(dump_json(in_report) == dump_json(alone.at("channels").at(c)));
    for (const char* key : {"name", "unit", "white_noise", "bias_instability", "random_walk", "quantization",
                            "rate_ramp", "second_opinion", "goodness"})
      CHECK(in_report.contains(key));
  }
}
