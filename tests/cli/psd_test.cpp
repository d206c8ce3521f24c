#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>
#include <set>
#include <sstream>

#include "libchar/core/document/json.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/spectrum/spectrum.hpp"
#include "libchar/spectrum/welch.hpp"
#include "tests/support/run.hpp"

using namespace libchar;

namespace {

std::vector<double> noise(std::size_t n, unsigned seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  std::vector<double> y(n);
  for (double& v : y) v = normal(generator);
  return y;
}

// 20 000 samples at 100 Hz: white noise, and white noise with a sine of amplitude 1 at 12.3 Hz.
std::string write_log(const test::TemporaryFolder& folder) {
  const auto a = noise(20000, 1), b = noise(20000, 2);
  std::string text = "gyro_x[deg/s],plain\n";
  for (std::size_t i = 0; i < a.size(); ++i)
    text += shortest(a[i]) + "," + shortest(b[i] + std::sin(2 * M_PI * 12.3 * static_cast<double>(i) / 100)) + "\n";
  const std::string path = (folder / "log.csv").string();
  std::ofstream(path) << text;
  return path;
}

std::vector<double> second_column(std::vector<double> b) {
  for (std::size_t i = 0; i < b.size(); ++i) b[i] += std::sin(2 * M_PI * 12.3 * static_cast<double>(i) / 100);
  return b;
}

}  // namespace

TEST_CASE("psd writes the library's spectrum as CSV and as JSON, whole and streamed") {
  const test::TemporaryFolder folder;
  const std::string log = write_log(folder);
  WelchOptions options;
  options.segment = 1000;
  options.sides = Sides::two;
  const Spectrum wanted = welch(second_column(noise(20000, 2)), 100, options);

  const test::Ran csv = test::run({"psd", log, "--rate", "100", "--segment", "1000", "--sides", "two"});
  REQUIRE(csv.code == 0);
  CHECK(csv.err == "");
  std::istringstream lines(csv.out);
  std::string line;
  std::getline(lines, line);
  CHECK(line == "frequency_hz,gyro_x[(deg/s)²/Hz],plain[U²/Hz]");
  for (std::size_t k = 0; k < wanted.value.size(); ++k) {
    REQUIRE(std::getline(lines, line));
    REQUIRE(line.substr(0, line.find(',')) == shortest(wanted.frequency_hz[k]));
    REQUIRE(line.substr(line.rfind(',') + 1) == shortest(wanted.value[k]));
  }
  CHECK_FALSE(std::getline(lines, line));
  CHECK(test::run({"psd", log, "--rate", "100", "--segment", "10s", "--sides", "two"}).out == csv.out);

  const test::Ran whole = test::run({"psd", log, "--rate", "100", "--json", "--scaling", "lsd", "--window", "flat_top",
                                     "--detrend", "linear", "-c", "plain"});
  REQUIRE(whole.code == 0);
  const Json document = parse_json(whole.out, "out");
  CHECK(document["format"] == "spectrum");
  CHECK(document["version"] == 1);
  CHECK(document["sides"] == "one");
  CHECK(document["scaling"] == "lsd");
  REQUIRE(document["channels"].size() == 1);
  options = {};
  options.scaling = Scaling::lsd;
  options.window = Window::flat_top;
  options.detrend = Detrend::linear;
  const Spectrum quarter = welch(second_column(noise(20000, 2)), 100, options);
  const Json& channel = document["channels"][0];
  CHECK(channel["name"] == "plain");
  CHECK(channel["frequency_hz"].get<std::vector<double>>() == quarter.frequency_hz);
  CHECK(channel["value"].get<std::vector<double>>() == quarter.value);
  CHECK(channel["dof"].get<std::vector<double>>() == quarter.dof);
  CHECK(channel["ci95"][7][0].get<double>() == Approx(IntervalFactors(0.95).interval(quarter, 7).first));
  CHECK(channel["ci95"][7][1].get<double>() == Approx(IntervalFactors(0.95).interval(quarter, 7).second));
}

TEST_CASE("psd finds lines and bins on a logarithmic axis") {
  const test::TemporaryFolder folder;
  const std::string log = write_log(folder);
  const test::Ran lines = test::run({"psd", log, "--rate", "100Hz", "--segment", "2000", "--lines"});
  REQUIRE(lines.code == 0);
  REQUIRE(std::count(lines.out.begin(), lines.out.end(), '\n') == 2);
  CHECK(lines.out.starts_with("channel,unit,frequency_hz,amplitude,excess,width_hz\nplain,,12.3"));
  const Json both = parse_json(
      test::run({"psd", log, "--rate", "100", "--segment", "2000", "--lines", "--json", "--log-bins", "20"}).out,
      "out");
  CHECK(both["channels"][0]["lines"].empty());
  CHECK(both["channels"][1]["lines"][0]["amplitude"].get<double>() == Approx(1).epsilon(0.05));
  CHECK(both["channels"][1]["value"].size() <= 20);
}

TEST_CASE("psd writes whole files, keeps old ones, and refuses what cannot be") {
  const test::TemporaryFolder folder;
  const std::string log = write_log(folder), out = (folder / "out.csv").string();
  CHECK(test::run({"psd", log, "--rate", "100", "-o", out}).code == 0);
  const std::string first = test::slurp(out);
  CHECK(first.starts_with("frequency_hz,"));
  CHECK(test::run({"psd", log, "--rate", "100", "-o", out}).code == 5);
  CHECK(test::run({"psd", log, "--rate", "100", "--sides", "two", "--force", "-o", out}).code == 0);
  CHECK(test::slurp(out) != first);
  const std::string before = test::slurp(log);
  CHECK(test::run({"psd", log, "--rate", "100", "--force", "-o", log}).code == 5);
  CHECK(test::slurp(log) == before);
  test::RunOptions full;
  full.stdout_path = "/dev/full";
  CHECK(test::run({"psd", log, "--rate", "100"}, full).code == 5);

  CHECK(test::run({"psd", log}).code == 4);  // no time axis
  CHECK(test::run({"psd", log, "--segment", "5s"}).code == 2);
  CHECK(test::run({"psd", log, "--rate", "100", "--segment", "4"}).code == 2);
  CHECK(test::run({"psd", log, "--rate", "100", "--segment", "x"}).code == 2);
  CHECK(test::run({"psd", log, "--rate", "100", "--overlap", "1"}).code == 2);
  CHECK(test::run({"psd", log, "--rate", "100", "--window", "han"}).err.find("did you mean hann") != std::string::npos);
  CHECK(test::run({"psd", log, "--rate", "100", "--segment", "30000"}).code == 4);
  CHECK(test::run({"psd", (folder / "absent.csv").string(), "--rate", "100"}).code == 3);
}

TEST_CASE("every option of psd means the same of a record in memory and of one that streams") {
  const test::TemporaryFolder folder;
  const std::string log = write_log(folder);
  const std::vector<std::vector<std::string>> options = {{},
                                                         {"--sides", "two"},
                                                         {"--scaling", "ls"},
                                                         {"--overlap", "0.75"},
                                                         {"--window", "blackman_harris"},
                                                         {"--detrend", "none"},
                                                         {"--detrend", "linear"},
                                                         {"--log-bins", "30"},
                                                         {"--lines"},
                                                         {"--json"},
                                                         {"--from", "10s"}};
  std::set<std::string> outputs;
  for (const auto& option : options) {
    const std::string segment = option.empty() || option[0] != "--from" ? "5000" : "4750";
    std::vector<std::string> words = {"psd", log, "--rate", "100"};
    words.insert(words.end(), option.begin(), option.end());
    const test::Ran whole = test::run(words);
    words.insert(words.end(), {"--segment", segment});
    const test::Ran streamed = test::run(words);
    CAPTURE(words);
    REQUIRE(whole.code == 0);
    const auto body = [](const std::string& out) {
      return out.starts_with("{") ? parse_json(out, "out").at("channels").dump() : out;
    };
    CHECK(body(whole.out) == body(streamed.out));
    CHECK(outputs.insert(whole.out).second);  // each changes something
  }
}
