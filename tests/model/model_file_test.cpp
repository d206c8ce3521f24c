#include "libchar/model/model_file.hpp"

#include <yaml-cpp/yaml.h>

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>

#include "libchar/characterize/model_from_fit.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/text.hpp"
#include "tests/report/synthetic.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;

namespace {

SensorModel model_of(const Characterization& result, std::size_t i) {
  const ChannelResult& c = result.channels[i];
  return sensor_model_from(c, result.log);
}

}  // namespace

TEST_CASE("model from a fit: everything a simulation needs, and where it came from") {
  const auto result = test::synthetic_imu();
  const SensorModel m = model_of(result, 5);
  CHECK(m.channel == "acc_z");
  CHECK(m.unit == "m/s^2");
  CHECK(m.rate_hz == 200);
  CHECK(m.noise[0].value == result.channels[5].fit->term[0].value);
  CHECK(m.bandwidth_hz == 62.0);
  CHECK(m.resolution == 0.0025);
  CHECK(m.saturation_high == result.channels[5].quality.maximum);
  CHECK(m.tau_min_s == 0.005);
  CHECK(m.tau_max_s == Approx(163.84));  // the last point with 5 degrees of freedom
  CHECK(m.recording.sha256 == result.log.sha256);
  CHECK(m.remarks.size() == 1);
  CHECK_FALSE(m.findings.empty());
  CHECK(!model_of(result, 0).saturation_low);  // never reached
}

TEST_CASE("model file: reads back to the same doubles") {
  const auto result = test::synthetic_imu();
  for (std::size_t i = 0; i < result.channels.size(); ++i) {
    const SensorModel m = model_of(result, i);
    const YAML::Node file = YAML::Load(model_yaml(m));
    CHECK(file["format"].as<std::string>() == "sensor-model");
    CHECK(file["version"].as<int>() == 1);
    CHECK(file["density"].as<std::string>() == "two-sided");
    CHECK(file["recording"]["sha256"].as<std::string>() == result.log.sha256);
    for (std::size_t t = 0; t < kTerms; ++t) {
      const YAML::Node term = file[std::string(kTermNames[t].key)];
      CHECK(term["status"].as<std::string>() == name_of(m.noise[t].status));
      if (m.noise[t].value) {
        CHECK(parse_double(term["value"].Scalar()) == *m.noise[t].value);
        CHECK(parse_double(term["ci95"][0].Scalar()) == m.noise[t].ci95.low);
        CHECK(parse_double(term["ci95"][1].Scalar()) == m.noise[t].ci95.high);
        CHECK(!term["upper95"]);
      } else {
        CHECK(term["value"].IsNull());
        CHECK(bool(term["upper95"]) == m.noise[t].upper95.has_value());
      }
    }
  }
}

TEST_CASE("model file: numbers are numbers to YAML 1.1 readers too") {
  auto result = test::synthetic_imu();
  SensorModel m = model_of(result, 0);
  m.noise[0].value = 1e-5;
  m.noise[0].ci95 = {9e-6, 2};
  m.rate_hz = 1e20;
  m.mean = -3;
  const std::string text = model_yaml(m);
  CHECK(text.find("value: 1.0e-05") != std::string::npos);
  CHECK(text.find("mean: -3.0 ") != std::string::npos);
  // YAML 1.1 float: a point is compulsory, and an exponent carries a sign.
  const std::regex number_1_1(R"([-+]?([0-9][0-9_]*)\.[0-9]*([eE][-+][0-9]+)?)");
  const std::regex looks_numeric(R"([-+]?[0-9.]+([eE][-+]?[0-9]+)?)");
  const std::regex value(R"((value|upper95|rate_hz|mean|resolution|duration_s|bandwidth_hz): ([^ #\n]+))");
  std::size_t seen = 0;
  for (std::sregex_iterator it(text.begin(), text.end(), value), end; it != end; ++it) {
    const std::string word = (*it)[2];
    if (word == "null") continue;
    CHECK(std::regex_match(word, looks_numeric));
    CHECK(std::regex_match(word, number_1_1));
    ++seen;
  }
  CHECK(seen >= 7);
}

TEST_CASE("model file: hostile text stays text") {
  const auto result = test::hostile();
  for (std::size_t i = 0; i < result.channels.size(); ++i) {
    const std::string text = model_yaml(model_of(result, i));
    const YAML::Node file = YAML::Load(text);
    const std::string& name = test::hostile_names()[i];
    const bool whole = first_invalid_utf8(name) == std::string::npos;  // else its bytes are shown
    CHECK(file["channel"].as<std::string>() == (whole ? name : "bad\\xFF\x01utf8"));
    CHECK(file["version"].as<int>() == 1);
    CHECK(file["random_walk"]["unit"].IsScalar());
    CHECK(file["remarks"].size() == 1);
    CHECK(file["findings"].IsSequence());
  }
  auto quoted = test::synthetic_imu();
  quoted.channels[0].channel.name = "a \"b\" \\ c: #d";
  quoted.channels[0].channel.unit = "";
  const YAML::Node file = YAML::Load(model_yaml(model_of(quoted, 0)));
  CHECK(file["channel"].as<std::string>() == "a \"b\" \\ c: #d");
  CHECK(file["unit"].IsNull());
}

TEST_CASE("model file: a Gauss-Markov process reads back, and one that is not there is not written") {
  const auto result = test::synthetic_imu();
  SensorModel m = model_of(result, 0);
  CHECK(model_yaml(m).find("gauss_markov") == std::string::npos);
  m.gauss_markov = {0.02, 61.25, {0.017, 0.025}, {40}};
  const SensorModel read = parse_sensor_model(model_yaml(m), "model.yaml");
  CHECK(read.gauss_markov == m.gauss_markov);
}

TEST_CASE("model files: Kalibr's and imu_utils' are read, each by its own convention") {
  const test::TemporaryFolder folder;
  const auto write = [&](const char* name, const std::string& text) {
    const std::string path = (folder / name).string();
    std::ofstream(path) << text;
    return path;
  };
  const std::string kalibr =
      "rostopic: /imu0\nupdate_rate: 200.0\naccelerometer_noise_density: 2.0e-3\n"
      "accelerometer_random_walk: 3.0e-3\ngyroscope_noise_density: 1.7e-4\n"
      "gyroscope_random_walk: 1.9e-5\n";
  const auto models = read_model_list(write("kalibr.yaml", kalibr));
  REQUIRE(models.size() == 2);
  CHECK(models[0].unit == "rad/s");
  CHECK(*models[0][Term::white].value == 1.7e-4);
  CHECK(*models[1][Term::walk].value == 3.0e-3);
  CHECK(models[1].rate_hz == 200);
  const std::string axes =
      "  x-axis:\n    gyr_n: 4.0e-3\n    gyr_w: 2.0e-5\n"
      "  avg-axis:\n    gyr_n: 4.0e-3\n    gyr_w: 2.0e-5\n";
  CHECK_THROWS_WITH(read_model_list(write("a.yaml", "%YAML:1.0\n---\ntype: IMU\nGyr:\n" + axes)),
                    Catch::Contains("rate_hz: 200"));
  const auto one = read_model_list(write("b.yaml", "%YAML:1.0\n---\nrate_hz: 400\nGyr:\n" + axes));
  REQUIRE(one.size() == 1);
  // sqrt(f) sigma(1 s), and the floor of bias instability.
  CHECK(*one[0][Term::white].value == Approx(4.0e-3 / 20));
  CHECK(*one[0][Term::flicker].value == Approx(2.0e-5 / 0.664).epsilon(1e-3));
  CHECK_FALSE(one[0][Term::walk].value);
  const auto fork = read_model_list(write("c.yaml", "%YAML:1.0\n---\ndensities: true\nGyr:\n" + axes));
  CHECK(*fork[0][Term::white].value == 4.0e-3);
  CHECK(*fork[0][Term::walk].value == 2.0e-5);
  const std::string mean = "  avg-axis:\n    gyr_n: 4.0e-3\n    gyr_w: 2.0e-5\n";
  const auto means = read_model_list(write("d.yaml", "%YAML:1.0\n---\ndensities: true\nGyr:\n" + mean));
  REQUIRE(means.size() == 1);  // for all three axes
  CHECK(means[0].channel == "gyr");
  CHECK(means[0].axis.empty());
  CHECK(*means[0][Term::white].value == 4.0e-3);
}

TEST_CASE("model file: a log in its place is told where models come from, however long it is") {
  const test::TemporaryFolder folder;
  const std::string path = folder / "log.csv";
  for (const int rows : {3, 100000}) {
    std::string text = "t,gx\n";
    for (int i = 0; i < rows; ++i) text += "0.01,0.123456\n";
    std::ofstream(path) << text;
    CHECK_THROWS_WITH(read_model_list(path), Catch::Contains("E0546") && Catch::Contains("characterize " + path));
  }
}

TEST_CASE("model file: what was no noise in the recording is data, and reads back") {
  auto result = test::synthetic_imu();
  NoiseFit& fit = *result.channels[0].fit;
  Event step, warm, ramp;
  step.at_s = 12.5;
  step.size = -0.25;
  step.sd = 0.01;
  warm.kind = EventKind::warm_up;
  warm.size = 1;
  warm.tau_s = 300;
  ramp.kind = EventKind::ramp;
  ramp.size = -3;
  ramp.slope = -1e-3;
  fit.events = {step, warm, ramp};
  Finding moved = finding("motion", "The sensor was moved in 2 stretches.");
  moved.where.time_s = {{10, 20.5}, {30, 31}};
  moved.help = {{"Use the longest still stretch.", {{"still", "auto"}}}};
  result.channels[0].findings = {moved};
  TemperatureEffect effect;
  effect.order = 2;
  effect.mean = 31;
  effect.coefficient = {0.01, -0.002, 0};
  effect.lag_s = 60;
  fit.temperature = effect;
  result.log.stretch_s = Interval{100, 700};
  const SensorModel m = model_of(result, 0);
  const SensorModel read = parse_sensor_model(model_yaml(m), "m.yaml");
  REQUIRE(read.deterministic.size() == 3);
  CHECK(read.deterministic == m.deterministic);
  CHECK(read.deterministic[0].at_s == 12.5);
  CHECK(read.deterministic[1].kind == DeterministicTerm::Kind::warm_up);
  CHECK(read.deterministic[2].per_s == -1e-3);
  REQUIRE(has(read.findings, "motion"));
  CHECK(read.findings == m.findings);
  CHECK(read.bias == m.bias);
  CHECK(read.bias.tc2_per_k2 == -0.002);
  CHECK(read.bias.lag_s == 60);
  CHECK(read.reference_temperature_degc == 31);
  REQUIRE(read.stretch_s);
  CHECK(read.stretch_s->high == 700);
}
