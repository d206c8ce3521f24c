// One test for each trap of the consumers' conventions (docs/exports.md).

#include <yaml-cpp/yaml.h>

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "libchar/core/document/json.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/model/model_file.hpp"
#include "tests/export/imu_models.hpp"

using namespace libchar;
using Catch::Contains;
using test::at_most;
using test::exported;
using test::has;
using test::known;
using test::number_after;

TEST_CASE("trap 1: %YAML:1.0 is the first line for OpenCV readers and absent for PyYAML's") {
  for (const char* target : {"openvins", "orbslam3", "vins", "okvis"})
    CHECK(exported(target, test::euroc_imu()).text.starts_with("%YAML:1.0\n"));
  for (const char* target : {"kalibr", "euroc", "ros", "lio-sam", "fast-lio", "maplab"})
    CHECK_FALSE(has(exported(target, test::euroc_imu()).text, "%YAML"));
}

TEST_CASE("trap 2: every real has a decimal point") {
  // Values whose shortest text has none: 1e-05, 2e-05, 1, 3, and a rate of 200.
  const auto models = test::imu({known(1e-5), known(2e-5), known(3e-5)}, {known(1), known(2), known(3)});
  const std::regex number_1_1(R"([-+]?[0-9][0-9_]*\.[0-9]*([eE][-+][0-9]+)?)");
  const std::regex word(R"((?:: |\[|, |>|\* )([-+]?[0-9][-+0-9.eE]*)(?=[\],\s;)<]|$))");
  for (const char* target : {"kalibr", "euroc", "openvins", "orbslam3", "vins", "ros", "gtsam", "sdf", "rotors"}) {
    std::string text = exported(target, models).text;
    // The head of an XML file is one comment.
    if (has(text, "<?xml")) text.erase(0, text.find("-->"));
    std::istringstream lines(text);
    std::size_t seen = 0;
    for (std::string line; std::getline(lines, line);) {
      if (line.starts_with("#") || has(line, "cols:") || has(line, "rows:") || has(line, "always_on")) continue;
      const std::string plain = line.substr(0, std::min(line.find("  #"), line.find("<!--")));
      for (std::sregex_iterator it(plain.begin(), plain.end(), word), end; it != end; ++it, ++seen) {
        CAPTURE(target, line);
        CHECK(std::regex_match((*it)[1].str(), number_1_1));
      }
    }
    CAPTURE(target);
    CHECK(seen >= 4);
  }
  CHECK(has(exported("kalibr", models).text, "gyroscope_noise_density: 1.0e-05 "));
}

TEST_CASE("trap 3: VINS wants N sqrt(2f) and K sqrt(f), and the derivation stands in the file") {
  const auto models = test::imu({known(2e-3), {}, known(1e-3)}, {known(2e-3), {}, known(1e-3)});
  const std::string text = exported("vins", models).text;
  CHECK(number_after(text, "acc_n") == Approx(0.04));
  CHECK(number_after(text, "acc_n") / 2e-3 == Approx(20));  // the factor by which N itself is too small
  CHECK(number_after(text, "acc_w") == Approx(1e-3 * std::sqrt(200)));
  CHECK(has(text, "the midpoint integration takes the two"));
  CHECK(has(text, "n = N sqrt(2 f)"));
  CHECK(has(text, "w = K sqrt(f)"));
}

TEST_CASE("trap 4: Kalibr never gets a 0, ORB-SLAM3's frequency is real or, for old files, whole") {
  auto models = test::euroc_imu();
  for (SensorModel& m : models) m.noise[2] = at_most(1e-6);
  const Export made = exported("kalibr", models);
  CHECK(number_after(made.text, "gyroscope_random_walk") == 1e-6);
  CHECK(has(made.text, "upper 95 % limit"));
  CHECK(made.notes.size() == 2);
  // A stated 0 is no limit: there is nothing to write that Kalibr accepts.
  for (SensorModel& m : models) m.noise[2] = known(0);
  CHECK_THROWS_WITH(exported("kalibr", models), Contains("> 0"));

  const std::string current = exported("orbslam3", test::euroc_imu()).text;
  CHECK(has(current, "\nFile.version: \"1.0\""));
  CHECK(has(current, "\nIMU.Frequency: 200.0 "));
  ExportOptions older;
  older.older = true;
  auto odd = test::euroc_imu();
  for (SensorModel& m : odd) m.rate_hz = 199.6;
  const Export old = exported("orbslam3", odd, older);
  CHECK(has(old.text, "\nIMU.Frequency: 200 "));
  CHECK_FALSE(has(old.text, "\nFile.version"));
  CHECK(has(old.notes.back(), "rounded"));
}

TEST_CASE("trap 5: Gazebo turns the sign of the constant bias, so a stated one goes to mean") {
  auto models = test::euroc_imu();
  models[0].bias = {0.01, 0.002, 0, 0};
  const std::string text = exported("sdf", models).text;
  CHECK(number_after(text, "mean") == 0.01);
  CHECK(number_after(text, "bias_mean") == 0);
  CHECK(number_after(text, "bias_stddev") == 0.002);
  // The mean of the recording contains the true input: it is no bias.
  models = test::euroc_imu();
  models[1].mean = 9.81;
  CHECK_FALSE(has(exported("sdf", models).text, "9.81"));
}

TEST_CASE("trap: Webots multiplies the noise by the reading, and is as loud at rest as in motion all the same") {
  const std::string text = exported("webots", test::euroc_imu()).text;
  const auto rows_of_node = [&](const std::string& node) {
    std::istringstream in(text.substr(text.find("lookupTable [", text.find("\n" + node + " {")) + 13));
    std::vector<std::array<double, 3>> rows;
    for (std::array<double, 3> row{}; in >> row[0] >> row[1] >> row[2];) rows.push_back(row);
    return rows;
  };
  // As WbLookupTable::lookup: both columns linear between rows, reading * (1 + noise * Gaussian).
  const auto check = [&](const std::string& node, double sd, double range) {
    const auto rows = rows_of_node(node);
    REQUIRE(rows.size() > 10);
    REQUIRE(rows.front()[0] < -range);
    REQUIRE(rows.back()[0] > range);
    std::vector<double> inputs = {0};
    for (double x = 1e-6; x < range; x *= 1.07) inputs.insert(inputs.end(), {x, -x - sd});
    for (const double input : inputs) {
      std::size_t i = 0;
      while (rows[i + 1][0] <= input) ++i;
      REQUIRE(rows[i][0] < rows[i + 1][0]);
      const double share = (input - rows[i][0]) / (rows[i + 1][0] - rows[i][0]);
      const auto column = [&](int c) { return (1 - share) * rows[i][c] + share * rows[i + 1][c]; };
      CAPTURE(node, input);
      CHECK(std::abs(column(1)) * column(2) == Approx(sd).epsilon(0.005));
      CHECK(std::abs(column(1) - input) < 0.021 * sd);
    }
  };
  check("Gyro", 1.6968e-4 * std::sqrt(200), 99);
  check("Accelerometer", 2.0e-3 * std::sqrt(200), 999);
}

TEST_CASE("trap 6: deg or rad, per h or per s, g or m/s^2") {
  const auto si =
      test::imu({known(1e-3), known(1e-4), known(1e-5)}, {known(9.80665e-3), known(9.80665e-4), known(9.80665e-5)});
  const double degrees = 180 / M_PI;
  const auto habit =
      test::imu({known(1e-3 * degrees * 3600), known(1e-4 * degrees * 3600), known(1e-5 * degrees * 3600)},
                {known(1), known(0.1), known(0.01)}, 200, "deg/h", "mg");
  for (const char* target : {"kalibr", "vins", "gtsam", "ros", "sdf", "rotors", "gnss-ins-sim", "pegasus", "kf-gins",
                             "navego", "px4", "orbslam3"}) {
    CAPTURE(target);
    // Ten digits of every number agree, and nothing else differs.
    CHECK(exported(target, si).text == exported(target, habit).text);
  }
  const Json airsim = parse_json(exported("airsim", habit).text, "s")["DefaultSensors"]["Imu"];
  CHECK(airsim["AngularRandomWalk"].get<double>() == Approx(1e-3 * degrees * 60));
  CHECK(airsim["VelocityRandomWalk"].get<double>() == Approx(1));  // mg/sqrt(Hz)
  CHECK(airsim["AccelBiasStability"].get<double>() == Approx(0.01 * 1000 * std::sqrt(800)));
  // deg/sqrt(h) and (deg/h)/sqrt(h) of a data sheet: pi/180/60 and pi/180/3600/60.
  const SensorModel sheet = parse_sensor_model(
      "format: sensor-model\nversion: 1\nchannel: gyro\nunit: rad/s\nrate_hz: 100\nwhite_noise: {value: 1, unit: "
      "deg/√h}\n"
      "random_walk: {value: 1, unit: deg/h/√h}\n",
      "sheet.yaml");
  const std::string matlab = exported("matlab", {sheet}).text;
  CHECK(number_after(matlab, "'NoiseDensity") == Approx(M_PI / 180 / 60));
  CHECK(number_after(matlab, "'RandomWalk") == Approx(M_PI / 180 / 3600 / 60));
}

TEST_CASE("trap 7: a data sheet's density is one-sided, its angle random walk is not") {
  const auto sheet = [](const std::string& white) {
    return parse_sensor_model(
        "format: sensor-model\nversion: 1\nchannel: gyro\nunit: deg/s\nrate_hz: 100\n" + white + "\n", "sheet.yaml");
  };
  const auto density = [&](const std::string& white) {
    return number_after(exported("matlab", {sheet(white)}).text, "'NoiseDensity") * 180 / M_PI;
  };
  // ADIS16448: 0.0135 deg/s/sqrt(Hz) and 0.66 deg/sqrt(h).
  CHECK(density("density: one-sided\nwhite_noise: {value: 0.0135, unit: deg/s/√Hz}") == Approx(0.0135 / std::sqrt(2)));
  CHECK(density("density: two-sided\nwhite_noise: {value: 0.0135, unit: deg/s/√Hz}") == Approx(0.0135));
  CHECK(density("density: one-sided\nwhite_noise: {value: 0.66, unit: deg/√h}") == Approx(0.66 / 60));
  CHECK_THROWS_WITH(sheet("white_noise: {value: 0.0135, unit: deg/s/√Hz}"), Contains("one-sided or two-sided"));
}

TEST_CASE("trap 8: B is never taken for K") {
  // The minimum of the Allan curve under the name of a walk is what imu_utils wrote.
  auto models = test::euroc_imu();
  for (SensorModel& m : models) {
    m.noise[1] = known(1e-4);
    m.noise[2] = {};
  }
  for (const char* target : {"kalibr", "euroc", "openvins", "orbslam3", "basalt", "vins", "gtsam"})
    CHECK_THROWS_WITH(exported(target, models), Contains("random_walk"));
  const Json airsim = parse_json(exported("airsim", models).text, "s")["DefaultSensors"]["Imu"];
  CHECK(airsim["GyroBiasStability"] == 0.0);
  CHECK(number_after(exported("matlab", models).text, "'BiasInstability") == 1e-4);
}

TEST_CASE("trap: RotorS reads gyroscopeBiasRandomWalk, its models set gyroscopeRandomWalk") {
  const std::string text = exported("rotors", test::euroc_imu()).text;
  CHECK(number_after(text, "gyroscopeBiasRandomWalk") == 1.9393e-5);
  CHECK(number_after(text, "gyroscopeRandomWalk") == 1.9393e-5);
  CHECK_FALSE(has(text, "accelerometerBiasRandomWalk"));
}

TEST_CASE("trap: gnss-ins-sim turns a bias with an infinite correlation time into white noise") {
  auto models = test::euroc_imu();
  for (SensorModel& m : models) m.noise[1] = m.noise[2] = at_most(1e-9);
  const std::string text = exported("gnss-ins-sim", models).text;
  CHECK(number_after(text, "'gyro_b_stability") == 0);
  CHECK(std::isfinite(number_after(text, "'gyro_b_corr")));
  CHECK_FALSE(has(text, "np.inf"));
  CHECK(has(text, "set_gyro_error() does not convert"));
}

TEST_CASE("trap: Basalt takes the first value of the document for value0") {
  const Json document = parse_json(exported("basalt", test::euroc_imu()).text, "c.json");
  CHECK(document.begin().key() == "value0");
}

TEST_CASE("trap: hostile channel names stay inside comments") {
  // XML comments end at "--", C++ lines go on behind a backslash, YAML and MATLAB comments end at a line's end.
  const std::string name = "a--><evil/>\n%YAML:1.0\nx: 1 -- \xE2\x80\xAE\xFF π\\";
  auto models = test::euroc_imu();
  models[0].channel = name;
  models[0].kind = "gyroscope";
  models[0].axis = "x";
  models[0].recording.file = name;
  for (const ExportTarget& target : export_targets()) {
    const std::string text = exported(std::string(target.name), models).text;
    CAPTURE(target.name, text);
    const bool json = target.name == "json" || target.name == "basalt" || target.name == "airsim";
    if (!json) CHECK_FALSE(has(text, "--><evil/>"));
    CHECK_FALSE(has(text, "\n%YAML:1.0\nx"));
    CHECK_FALSE(has(text, "\\\n"));
    CHECK(first_invalid_utf8(text) == std::string::npos);
    if (!json) CHECK(std::all_of(text.begin(), text.end(), [](unsigned char c) { return c < 0x80; }));
  }
  CHECK(YAML::Load(exported("kalibr", models).text).size() == 6);
}

TEST_CASE("a topic is no place for YAML") {
  ExportOptions options;
  options.topic = "/imu0\nevil: 1";
  CHECK_THROWS_WITH(exported("kalibr", test::euroc_imu(), options), Contains("`topic`"));
  options.topic = "/camera/imu_1";
  CHECK(YAML::Load(exported("kalibr", test::euroc_imu(), options).text)["rostopic"].as<std::string>() ==
        "/camera/imu_1");
  for (const char* name : {"~", "on", "imu"}) {
    options.topic = name;
    CHECK(YAML::Load(exported("kalibr", test::euroc_imu(), options).text)["rostopic"].as<std::string>() == name);
    CHECK(has(exported("kalibr", test::euroc_imu(), options).text, std::string("rostopic: \"") + name + '"'));
  }
}
