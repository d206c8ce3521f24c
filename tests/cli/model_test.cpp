#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "libchar/core/document/json.hpp"
#include "libchar/core/text/decimal.hpp"
#include "tests/support/noise.hpp"
#include "tests/support/run.hpp"

using namespace libchar;
using Catch::Contains;

namespace {

// Model files of one IMU, as somebody writes them from a data sheet.
struct ModelBench {
  test::TemporaryFolder folder;
  std::string path(const std::string& name) const { return (folder / name).string(); }
  std::string file(const std::string& name, const std::string& text) const {
    std::ofstream(path(name)) << text;
    return path(name);
  }
  std::string model(const std::string& channel, const std::string& rest) const {
    return file(channel + ".sensor.yaml",
                "format: sensor-model\nversion: 1\nchannel: " + channel + "\nrate_hz: 200\n" + rest);
  }
  std::vector<std::string> imu(const std::vector<std::string>& more) const {
    std::vector<std::string> words = {"model"};
    for (const std::string axis : {"x", "y", "z"}) {
      words.push_back(
          model("gyr_" + axis,
                "unit: deg/s\nwhite_noise: {value: 0.6, unit: deg/√h}\nrandom_walk: {value: 200, unit: deg/h/√h}\n"));
      words.push_back(model("acc_" + axis,
                            "unit: g\ndensity: one-sided\nwhite_noise: {value: 100, unit: µg/√Hz}\nrandom_walk: "
                            "{status: not_detected, upper95: 1.0e-7}\n"));
    }
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
};

}  // namespace

TEST_CASE("model --to writes the file to stdout and what was replaced to stderr") {
  const ModelBench bench;
  const auto ran = test::run(bench.imu({"--to", "kalibr"}));
  INFO(ran.err);
  REQUIRE(ran.code == 0);
  CHECK_THAT(ran.out, Contains("\ngyroscope_noise_density: 0.0001745329252  #"));
  // 100e-6 g, one-sided: 9.80665e-4 / sqrt(2).
  CHECK_THAT(ran.out, Contains("\naccelerometer_noise_density: 0.00069343487"));
  CHECK_THAT(ran.err, Contains("the accelerometer's random_walk was not detected; its upper 95 % limit"));
  CHECK(test::run(bench.imu({"--to", "kalibr", "-q"})).err.empty());
}

TEST_CASE("model -o writes a whole file, and overwrites only with --force") {
  const ModelBench bench;
  const std::string out = bench.path("imu.yaml");
  CHECK(test::run(bench.imu({"--to", "euroc", "-o", out})).code == 0);
  const std::string text = test::slurp(out);
  CHECK_THAT(text, Contains("sensor_type: imu"));
  CHECK(test::run(bench.imu({"--to", "vins", "-o", out})).code == 5);
  CHECK(test::slurp(out) == text);
  CHECK(test::run(bench.imu({"--to", "vins", "-o", out, "--force"})).code == 0);
  CHECK_THAT(test::slurp(out), Contains("acc_n"));
  // An input is never overwritten.
  const auto own = test::run(bench.imu({"--to", "vins", "--force", "-o", bench.path("gyr_x.sensor.yaml")}));
  CHECK(own.code == 5);
  CHECK_THAT(test::slurp(bench.path("gyr_x.sensor.yaml")), Contains("format: sensor-model"));
}

TEST_CASE("model --list names every target with its convention") {
  const auto list = test::run({"model", "--list"});
  CHECK(list.code == 0);
  for (const char* part : {"kalibr", "VINS-Mono, VINS-Fusion", "gyr_n = N sqrt(2 f)", "px4", "needs any sensor"})
    CHECK_THAT(list.out, Contains(part));
  const auto json = test::run({"model", "--list", "--json"});
  const Json document = parse_json(json.out, "stdout");
  CHECK(document["format"] == "model-targets");
  CHECK(document["targets"].size() == 27);  // the last is the method of a replay in C
  CHECK(document["targets"][0]["name"] == "kalibr");
}

TEST_CASE("model FILE says what the model says, in everybody's units, and the sides") {
  const ModelBench bench;
  const std::string file = bench.model("gyro",
                                       "unit: deg/s\ndensity: one-sided\nwhite_noise: {value: 0.0135, unit: "
                                       "deg/s/√Hz}\nbias_instability: {upper95: 1.0e-3, status: not_detected}\n");
  const auto ran = test::run({"model", file});
  CHECK(ran.code == 0);
  CHECK_THAT(ran.out, Contains("gyro [deg/s]: gyroscope, 200 Hz"));
  CHECK_THAT(ran.out, Contains("0.01350 deg/s/√Hz one-sided"));
  CHECK_THAT(ran.out, Contains("rad/s/√Hz two-sided"));
  CHECK_THAT(ran.out, Contains("≤ 0.001"));
  CHECK_THAT(ran.out, Contains("one-sided to two-sided density (divided by √2)"));
  const auto json = test::run({"model", file, "--json"});
  const Json document = parse_json(json.out, "stdout");
  CHECK(document["format"] == "models");
  CHECK(document["input"][0]["sha256"].get<std::string>().size() == 64);
  CHECK(document["models"][0]["white_noise"]["value"].get<double>() == Approx(0.0135 / std::sqrt(2)));
}

TEST_CASE("model --to --json carries text and notes") {
  const ModelBench bench;
  const auto ran = test::run(bench.imu({"--to", "px4", "--json", "--filter-step", "0.008"}));
  REQUIRE(ran.code == 0);
  const Json document = parse_json(ran.out, "stdout");
  CHECK(document["format"] == "model-export");
  CHECK(document["target"] == "px4");
  CHECK(document["input"].size() == 6);
  CHECK_THAT(document["text"].get<std::string>(), Contains("dt = 0.008 s"));
  CHECK(document["notes"].size() >= 2);
}

TEST_CASE("model: options reach the numbers") {
  const ModelBench bench;
  CHECK_THAT(test::run(bench.imu({"--to", "vins", "--gravity", "9.8"})).out, Contains("\ng_norm: 9.8 "));
  CHECK_THAT(test::run(bench.imu({"--to", "kalibr", "--topic", "/other"})).out, Contains("\nrostopic: /other\n"));
  CHECK_THAT(test::run(bench.imu({"--to", "kalibr", "--inflate", "10"})).out,
             Contains("\ngyroscope_noise_density: 0.001745329252 "));
  CHECK_THAT(test::run(bench.imu({"--to", "kalibr", "--axes", "rms"})).out, Contains("root mean square of x"));
  CHECK_THAT(test::run(bench.imu({"--to", "sdf", "--correlation-time", "77"})).out,
             Contains("<dynamic_bias_correlation_time>77.0<"));
  CHECK_THAT(test::run(bench.imu({"--to", "airsim", "--airsim-tau", "300"})).out,
             Contains("\"GyroBiasStabilityTau\": 300.0"));
  CHECK_THAT(test::run(bench.imu({"--to", "orbslam3", "--older"})).out, Contains("IMU.Frequency: 200 "));
}

TEST_CASE("model: what a channel is can be said with --axis") {
  const ModelBench bench;
  auto words = bench.imu({"--to", "kalibr"});
  words[1] = bench.model(
      "first", "unit: deg/s\nwhite_noise: {value: 6, unit: deg/√h}\nrandom_walk: {value: 200, unit: deg/h/√h}\n");
  const auto refused = test::run(words);
  CHECK(refused.code == 3);
  CHECK_THAT(refused.err, Contains("--axis first=gx"));
  words.insert(words.end(), {"--axis", "first=gx"});
  CHECK_THAT(test::run(words).out, Contains("\ngyroscope_noise_density: 0.001745329252 "));
  words.back() = "first=gq";
  CHECK(test::run(words).code == 2);
  words.back() = "first";
  CHECK_THAT(test::run(words).err, Contains("expected CHANNEL=PLACE"));
}

TEST_CASE("model: bad command lines and files") {
  const ModelBench bench;
  CHECK(test::run({"model"}).code == 2);
  const auto target = test::run(bench.imu({"--to", "kalbir"}));
  CHECK(target.code == 2);
  CHECK_THAT(target.err, Contains("did you mean kalibr?"));
  CHECK(test::run(bench.imu({"--to", "kalibr", "--axes", "most"})).code == 2);
  CHECK(test::run(bench.imu({"--to", "kalibr", "--inflate", "0"})).code == 2);
  CHECK(test::run(bench.imu({"--to", "kalibr", "--inflate", "nan"})).code == 2);
  CHECK(test::run({"model", bench.path("absent.yaml")}).code == 3);
  CHECK(test::run({"model", bench.file("log.csv", "t,x\n0,1\n"), "--to", "kalibr"}).code == 3);
  const auto alone = test::run(
      {"model", bench.model("gyr_x", "unit: deg/s\nwhite_noise: {value: 0.6, unit: deg/√h}\n"), "--to", "kalibr"});
  CHECK(alone.code == 3);
  CHECK_THAT(alone.err, Contains("there is no accelerometer among gyr_x (gyroscope)"));
}

TEST_CASE("characterize, then model: the recording's SHA-256 and coefficients arrive at the consumer") {
  const ModelBench bench;
  const std::size_t n = 20000;
  test::NoiseSource source(n, 200, 5);
  std::vector<std::vector<double>> columns;
  for (int i = 0; i < 6; ++i) columns.push_back(source.record(i < 3 ? 1e-3 : 1e-2, 0, i < 3 ? 1e-3 : 1e-2));
  std::string text = "gyr_x[rad/s],gyr_y[rad/s],gyr_z[rad/s],acc_x[m/s^2],acc_y[m/s^2],acc_z[m/s^2]\n";
  for (std::size_t t = 0; t < n; ++t)
    for (std::size_t c = 0; c < 6; ++c) text += shortest(columns[c][t]) + (c < 5 ? "," : "\n");
  const std::string log = bench.file("imu.csv", text), out = bench.path("out");
  const auto made = test::run({"characterize", log, "--rate", "200", "-o", out});
  INFO(made.err);
  REQUIRE(made.code == 0);
  std::vector<std::string> words = {"model"};
  for (const auto& entry : std::filesystem::directory_iterator(out))
    if (entry.path().string().ends_with(".sensor.yaml")) words.push_back(entry.path().string());
  CHECK(words.size() == 7);
  words.insert(words.end(), {"--to", "gtsam"});
  const auto ran = test::run(words);
  INFO(ran.err);
  REQUIRE(ran.code == 0);
  const auto sha = parse_json(test::run({"inspect", log, "--rate", "200", "--json"}).out, "stdout");
  CHECK_THAT(ran.out, Contains(sha["recordings"][0]["sha256"].get<std::string>()));
  const auto number = [&](const std::string& key) {
    const std::size_t at = ran.out.find(key + " = gtsam::I_3x3 * ");
    REQUIRE(at != std::string::npos);
    return std::stod(ran.out.substr(at + key.size() + 18));
  };
  // The largest of three estimates, each to 0.5 % (white) and 14 % (walk).
  CHECK(std::sqrt(number("gyroscopeCovariance")) == Approx(1e-3).epsilon(0.03));
  CHECK(std::sqrt(number("accelerometerCovariance")) == Approx(1e-2).epsilon(0.03));
  CHECK(std::sqrt(number("biasAccCovariance")) == Approx(1e-2).epsilon(0.6));
}
