#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "libchar/core/document/json.hpp"
#include "libchar/core/text/decimal.hpp"
#include "tests/support/noise.hpp"
#include "tests/support/run.hpp"

using namespace libchar;

TEST_CASE("fit: channels without a fit for one reason are said together") {
  const test::TemporaryFolder folder;
  const std::string log = (folder / "wide.csv").string();
  std::ofstream out(log);
  for (int row = 0; row < 3; ++row)
    for (int c = 0; c < 2000; ++c) out << (row * row * 7 + c * 13) % 101 << (c < 1999 ? "," : "\n");
  out.close();
  const auto ran = test::run({"fit", log, "--rate", "100", "--time-column", "none"});
  CHECK(ran.code == 4);
  CHECK_THAT(ran.err, Catch::Contains("c0, c1, c2") && Catch::Contains("and 1988 more:"));
  CHECK(std::count(ran.err.begin(), ran.err.end(), '\n') < 10);
}

TEST_CASE("verbs that find no rate offer the column that could be the time, by one sentence") {
  const test::TemporaryFolder folder;
  const std::string log = (folder / "packets.csv").string();
  std::ofstream out(log);
  out << "my time,x\n";
  for (int row = 0; row < 300; ++row)
    out << fmt::format("{:.3f},{}\n", 0.04 * (row / 4) + 0.001 * (row % 4), row * 7919 % 101);
  out.close();
  for (const char* verb : {"allan", "psd", "fit", "characterize"}) {
    INFO(verb);
    std::vector<std::string> words = {verb, log};
    if (verb == std::string("characterize")) words.insert(words.end(), {"-o", (folder / "report").string()});
    const auto ran = test::run(words);
    CHECK(ran.code == 4);
    CHECK_THAT(ran.out + ran.err, Catch::Contains("--time-column 'my time' takes that column for the time"));
    words.insert(words.end(), {"--time-column", "my time", "--force"});
    if (verb != std::string("characterize")) words.pop_back();
    CHECK(test::run(words).code == 0);
  }
}

TEST_CASE("fit LOG gives the coefficients as a table and as JSON") {
  const test::TemporaryFolder folder;
  const std::string path = (folder / "log.csv").string();
  test::NoiseSource source(20000, 100, 3);
  std::string text = "gx[deg/s]\n";
  for (const double y : source.record(1e-2, 0, 0)) text += shortest(y) + "\n";
  std::ofstream(path) << text;
  const auto json = test::run({"fit", path, "--rate", "100", "--json"});
  REQUIRE(json.code == 0);
  const Json document = parse_json(json.out, "stdout");
  CHECK(document["format"] == "noise-fit");
  CHECK(document["channels"][0]["name"] == "gx");
  CHECK(document["channels"][0]["white_noise"]["value"].get<double>() == Approx(1e-2).epsilon(0.03));
  CHECK(document["channels"][0]["random_walk"]["value"].is_null());
  const auto table = test::run({"fit", path, "--rate", "100"});
  CHECK(table.code == 0);
  CHECK(table.out.find("deg/√h") != std::string::npos);
}

TEST_CASE("fit CURVE --curve allan") {
  const test::TemporaryFolder folder;
  const std::string path = (folder / "curve.csv").string();
  std::string text = "tau_s,adev\n";
  for (double tau = 0.01; tau < 1e4; tau *= 2) {
    text += shortest(tau) + "," + shortest(std::sqrt(25e-6 / tau + 1e-8 * tau / 3)) + "\n";
  }
  std::ofstream(path) << text;
  const auto json = test::run({"fit", path, "--curve", "allan", "--json"});
  REQUIRE(json.code == 0);
  const Json channel = parse_json(json.out, "stdout")["channels"][0];
  CHECK(channel["white_noise"]["value"].get<double>() == Approx(5e-3).epsilon(1e-8));
  CHECK(channel["random_walk"]["value"].get<double>() == Approx(1e-4).epsilon(1e-8));
  CHECK(channel["bias_instability"]["value"].is_null());
}

TEST_CASE("a table of a curve that is read as a log is named as one") {
  const test::TemporaryFolder folder;
  const std::string table = (folder / "a curve.csv").string();
  std::ofstream(table) << "channel,tau_s,adev\nx,1,2\nx,2,1.5\n";
  for (const char* verb : {"inspect", "fit", "allan", "psd"}) {
    const auto ran = test::run({verb, table});
    CHECK(ran.code == 3);
    CHECK_THAT(ran.err, Catch::Contains("sensorchar fit '" + table + "' --curve allan"));
  }
  std::ofstream(table) << "tau_s,adev\n1,2\n2,1.5\n4,1\n";
  CHECK_THAT(test::run({"fit", table}).err, Catch::Contains("--curve allan"));
}

TEST_CASE("fit of a stretch, beside a temperature, neither goes with a curve") {
  const test::TemporaryFolder folder;
  const std::string path = (folder / "log.csv").string();
  test::NoiseSource source(20000, 100, 4);
  std::string text = "gx[deg/s],temp[degC]\n";
  std::size_t t = 0;
  for (const double y : source.record(1e-2, 0, 0)) {
    const double celsius = 20 + 5 * std::sin(static_cast<double>(t++) / 2000);
    text += shortest(y + 0.1 * celsius) + "," + shortest(celsius) + "\n";
  }
  std::ofstream(path) << text;
  const auto still = test::run({"fit", path, "--rate", "100", "--still", "20s..1min", "--json"});
  REQUIRE(still.code == 0);
  const Json stretch = parse_json(still.out, "stdout");
  CHECK(stretch["stretch_s"] == Json::array({20, 60}));
  CHECK(stretch["channels"][0]["samples"] == 4000);
  const auto open = test::run({"fit", path, "--rate", "100", "--still", "20s..", "--json"});
  REQUIRE(open.code == 0);
  const Json to_the_end = parse_json(open.out, "stdout");
  CHECK(to_the_end["stretch_s"][0] == 20);
  CHECK(to_the_end["stretch_s"][1].get<double>() == 20 + to_the_end["channels"][0]["samples"].get<double>() / 100);
  CHECK(still.err.find("Only the stretch from 20 to 60 s was analysed, as requested.") != std::string::npos);
  const auto warm = test::run({"fit", path, "--rate", "100", "--channel", "gx", "--temperature", "temp", "--json"});
  REQUIRE(warm.code == 0);
  const Json channels = parse_json(warm.out, "stdout")["channels"];
  REQUIRE(channels.size() == 1);
  const Json& temperature = channels[0]["temperature"];
  CHECK(temperature["channel"] == "temp");
  CHECK(temperature["coefficients"][0].get<double>() == Approx(0.1).epsilon(0.05));
  CHECK(temperature["without"].contains("random_walk"));
  const std::vector<std::vector<std::string>> refused = {{"--curve", "allan", "--still", "auto"},
                                                         {"--curve", "allan", "--temperature", "temp"},
                                                         {"--still", "40..20"},
                                                         {"--still", ".."},
                                                         {"--still", "soon"},
                                                         {"--still", "10..20", "--from", "5"},
                                                         {"--temperature", "gx"}};
  for (const auto& more : refused) {
    std::vector<std::string> words = {"fit", path, "--rate", "100"};
    words.insert(words.end(), more.begin(), more.end());
    INFO(more.back());
    const auto ran = test::run(words);
    CHECK(ran.code == 2);
    CHECK(ran.out.empty());
  }
}

TEST_CASE("fit and characterize: no line of a library reaches stderr, whatever the signal") {
  const test::TemporaryFolder folder;
  test::Gaussian gauss(1);
  const auto noise = [&] { return 1e-3 * gauss(); };
  double walk = 0;
  const std::map<std::string, std::function<double(int)>> signals{
      {"index", [](int k) { return k; }},
      {"ramp", [&](int k) { return 0.01 * k + noise(); }},
      {"sine", [](int k) { return std::sin(0.01 * k); }},
      {"noisy_sine", [&](int k) { return std::sin(0.3 * k) + noise(); }},
      {"square", [](int k) { return k / 50 % 2; }},
      {"sawtooth", [](int k) { return k % 128; }},
      {"step", [](int k) { return k < 700 ? 0 : 1e6; }},
      {"exponential", [](int k) { return std::exp(-0.01 * k); }},
      {"growing", [](int k) { return std::exp(0.1 * k); }},
      {"parabola", [](int k) { return 1.0 * k * k; }},
      {"impulse", [](int k) { return k == 600 ? 1e12 : 0; }},
      {"two_values", [](int k) { return k * 7919 % 3 == 0; }},
      {"tiny", [&](int) { return 1e-290 * gauss(); }},
      {"huge", [&](int) { return 1e140 * gauss(); }},
      {"alternating", [](int k) { return k % 2; }},
      {"walk", [&](int) { return walk += noise(); }},
      {"constant", [](int) { return 9.81; }}};
  for (const auto& [name, signal] : signals) {
    const std::string log = (folder / (name + ".csv")).string();
    std::ofstream file(log);
    file << "t[s]," << name << "\n";
    for (int k = 0; k < 1500; ++k) file << fmt::format("{:.2f},{:.17g}\n", 0.01 * k, signal(k));
    file.close();
    for (const auto& words :
         {std::vector<std::string>{"fit", log}, std::vector<std::string>{"characterize", log, "-o", log + ".out"}}) {
      std::vector<std::string> all{test::program()};
      all.insert(all.end(), words.begin(), words.end());
      const auto done = test::run_words(all);
      INFO(name << ": " << done.err);
      CHECK(done.code <= 4);
      // Every line is the program's own: FILE: …, or a channel and, indented, its findings.
      std::istringstream lines(done.err);
      for (std::string line; std::getline(lines, line);)
        CHECK((line.starts_with(log) || line.starts_with(name + ":") || line.starts_with("  ") || line.empty()));
    }
  }
}
