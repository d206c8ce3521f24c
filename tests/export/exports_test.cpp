// Exports: known answers (the numbers that EuRoC's files carry), the table, groups of models, what
// stands for an absent term. Traps, simulations and strict readers: the files beside.

#include <yaml-cpp/yaml.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "libchar/core/document/json.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/process/version.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/export/detail/export_figures.hpp"
#include "libchar/model/model_file.hpp"
#include "tests/export/imu_models.hpp"
#include "tests/support/places.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;
using Catch::Contains;
using test::at_most;
using test::exported;
using test::has;
using test::known;
using test::number_after;

namespace test {

double number_after(const std::string& text, const std::string& key) {
  static const std::string kNumber = R"(([-+]?[0-9.]+(?:e[-+]?[0-9]+)?))";
  std::string escaped;
  for (const char c : key) escaped += std::string(c == '.' ? "\\" : "") + c;
  const std::regex pattern(
      "(?:^|[\\s<'\">])" + escaped +
      "(?:>|'?:\\s*(?:np\\.array\\()?\\[?|', \\[?| = [A-Za-z_0-9:]+ \\* | = \\[|\": \\[?\\s*|\\s)" + kNumber);
  std::smatch match;
  if (!std::regex_search(text, match, pattern)) {
    FAIL("no number behind " << key << " in\n" << text);
    return 0;
  }
  return *parse_double(match[1].str());
}

}  // namespace test

namespace {

// The message of the refusal, empty when there was none.
std::string refusal(const std::string& target, const std::vector<SensorModel>& models,
                    const ExportOptions& options = {}) {
  try {
    exported(target, models, options);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("known answers: Kalibr, EuRoC, OpenVINS take the densities as they are") {
  for (const char* target : {"kalibr", "euroc", "openvins"}) {
    const std::string text = exported(target, test::euroc_imu()).text;
    CAPTURE(target);
    CHECK(number_after(text, "accelerometer_noise_density") == Approx(2.0e-3));
    CHECK(number_after(text, "accelerometer_random_walk") == Approx(3.0e-3));
    CHECK(number_after(text, "gyroscope_noise_density") == Approx(1.6968e-4));
    CHECK(number_after(text, "gyroscope_random_walk") == Approx(1.9393e-5));
  }
  CHECK(has(exported("kalibr", test::euroc_imu()).text, "\nrostopic: /imu0\nupdate_rate: 200.0"));
  CHECK(has(exported("euroc", test::euroc_imu()).text, "\nrate_hz: 200.0"));
  auto of_sheet = test::euroc_imu();
  for (SensorModel& m : of_sheet) {
    m.duration_s = m.tau_max_s = 0;
    m.noise[1] = test::at_most(1e-9);
  }
  CHECK(has(exported("sdf", of_sheet).text, "correlation time of 10^6 s, because"));  // in ASCII
  // The topic of the bag, unless the options say another one.
  auto of_bag = test::euroc_imu();
  for (SensorModel& m : of_bag) m.recording.topic = "/mavros/imu/data_raw";
  CHECK(has(exported("kalibr", of_bag).text, "\nrostopic: /mavros/imu/data_raw\n"));
  ExportOptions options;
  options.topic = "/other";
  CHECK(has(exported("kalibr", of_bag, options).text, "\nrostopic: /other\n"));
}

TEST_CASE("known answers: LIO-SAM, OKVIS, maplab take densities, ROVIO and FAST-LIO squares") {
  const double rows[][4] = {{2.0e-3, 3.0e-3, 1.6968e-4, 1.9393e-5}};
  const char* keys[][5] = {{"lio-sam", "imuAccNoise", "imuAccBiasN", "imuGyrNoise", "imuGyrBiasN"},
                           {"okvis", "sigma_a_c", "sigma_aw_c", "sigma_g_c", "sigma_gw_c"},
                           {"maplab", "acc_noise_density", "acc_bias_random_walk_noise_density", "gyro_noise_density",
                            "gyro_bias_random_walk_noise_density"}};
  for (const auto& one : keys)
    for (std::size_t k = 0; k < 4; ++k)
      CHECK(number_after(exported(one[0], test::euroc_imu()).text, one[k + 1]) == Approx(rows[0][k]));
  const char* squares[][5] = {{"rovio", "vel_0", "acb_1", "att_2", "gyb_0"},
                              {"fast-lio", "acc_cov", "b_acc_cov", "gyr_cov", "b_gyr_cov"}};
  for (std::size_t k = 0; k < 4; ++k) {
    const double square = rows[0][k] * rows[0][k];
    CHECK(number_after(exported("rovio", test::euroc_imu()).text, squares[0][k + 1]) == Approx(square));
    // A variance of a sample at 200 Hz.
    CHECK(number_after(exported("fast-lio", test::euroc_imu()).text, squares[1][k + 1]) == Approx(200 * square));
  }
  ExportOptions older;
  older.older = true;
  CHECK(has(exported("lio-sam", test::euroc_imu()).text, "/**:\n  ros__parameters:\n"));
  CHECK(has(exported("lio-sam", test::euroc_imu(), older).text, "lio_sam:\n"));
  CHECK(exported("okvis", test::euroc_imu()).text.starts_with("%YAML:1.0\n"));
  CHECK_FALSE(has(exported("maplab", test::euroc_imu()).text, "%YAML"));
}

TEST_CASE("known answers: CARLA and MuJoCo take the deviation of a sample") {
  const double root = std::sqrt(200.0);
  const std::string carla = exported("carla", test::euroc_imu()).text;
  CHECK(number_after(carla, "sensor_tick") == Approx(0.005));
  CHECK(number_after(carla, "noise_accel_stddev_y") == Approx(2.0e-3 * root));
  CHECK(number_after(carla, "noise_gyro_stddev_z") == Approx(1.6968e-4 * root));
  const std::string mujoco = exported("mujoco", test::euroc_imu()).text;
  const auto noise_of = [&](const std::string& element) {
    const std::size_t at = mujoco.find("<" + element + " ");
    REQUIRE(at != std::string::npos);
    const std::size_t value = mujoco.find("noise=\"", at) + 7;
    return *parse_double(mujoco.substr(value, mujoco.find('"', value) - value));
  };
  CHECK(noise_of("gyro") == Approx(1.6968e-4 * root));
  CHECK(noise_of("accelerometer") == Approx(2.0e-3 * root));
  CHECK(has(mujoco, "3.1.4"));
}

TEST_CASE("known answers: ORB-SLAM3") {
  const std::string text = exported("orbslam3", test::euroc_imu()).text;
  CHECK(has(text, "\nIMU.NoiseGyro: 0.00016968 "));
  CHECK(has(text, "\nIMU.NoiseAcc: 0.002 "));
  CHECK(has(text, "\nIMU.GyroWalk: 1.9393e-05 "));
  CHECK(has(text, "\nIMU.AccWalk: 0.003 "));
  CHECK(has(text, "\nIMU.Frequency: 200.0 "));
}

TEST_CASE("known answers: VINS") {
  ExportOptions options;
  const std::string text = exported("vins", test::euroc_imu(), options).text;
  CHECK(number_after(text, "acc_n") == Approx(4.0e-2));
  CHECK(number_after(text, "gyr_n") == Approx(3.3936e-3));
  CHECK(number_after(text, "acc_w") == Approx(4.2426e-2).epsilon(1e-5));
  CHECK(number_after(text, "gyr_w") == Approx(2.7426e-4).epsilon(1e-5));
  CHECK_FALSE(has(text, "g_norm"));
  options.gravity = 9.81007;
  CHECK(number_after(exported("vins", test::euroc_imu(), options).text, "g_norm") == 9.81007);
}

TEST_CASE("known answers: SDFormat") {
  const std::string text = exported("sdf", test::euroc_imu()).text;
  CHECK(number_after(text, "stddev") == Approx(2.3996e-3).epsilon(1e-4));
  CHECK(number_after(text, "dynamic_bias_stddev") == Approx(1.9393e-5));
  CHECK(number_after(text, "dynamic_bias_correlation_time") == 72000);
  CHECK(number_after(text, "bias_stddev") == 0);
}

TEST_CASE("known answers: GTSAM") {
  const std::string text = exported("gtsam", test::euroc_imu()).text;
  CHECK(number_after(text, "p->gyroscopeCovariance") == Approx(2.8791e-8).epsilon(1e-4));
  CHECK(number_after(text, "p->accelerometerCovariance") == Approx(4.0e-6));
  CHECK(number_after(text, "p->biasOmegaCovariance") == Approx(3.7609e-10).epsilon(1e-4));
  CHECK(number_after(text, "p->biasAccCovariance") == Approx(9.0e-6));
}

TEST_CASE("known answers: AirSim") {
  const Json imu = parse_json(exported("airsim", test::euroc_imu()).text, "settings.json")["DefaultSensors"]["Imu"];
  CHECK(imu["AngularRandomWalk"].get<double>() == Approx(0.58332).epsilon(1e-5));
  CHECK(imu["VelocityRandomWalk"].get<double>() == Approx(0.20394).epsilon(2e-5));
  CHECK(imu["GyroBiasStabilityTau"].get<double>() == 500);
  CHECK(imu["GyroBiasStability"].get<double>() == Approx(89.445).epsilon(1e-5));
  // K = 3e-3 m/s^3/sqrt(Hz): 3e-3 sqrt(800) / 9.80665e-6 ug.
  CHECK(imu["AccelBiasStability"].get<double>() == Approx(8652.579).epsilon(1e-6));
  ExportOptions options;
  options.bias_tau_s = 125;
  const Json other =
      parse_json(exported("airsim", test::euroc_imu(), options).text, "settings.json")["DefaultSensors"]["Imu"];
  CHECK(other["GyroBiasStability"].get<double>() == Approx(89.445 / 2).epsilon(1e-5));
}

TEST_CASE("known answers: Basalt, ROS, MATLAB, PX4, gnss-ins-sim, RotorS") {
  const auto models = test::euroc_imu();
  const Json basalt = parse_json(exported("basalt", models).text, "calibration.json")["value0"];
  CHECK(basalt["gyro_noise_std"] == Json({1.6968e-4, 1.6968e-4, 1.6968e-4}));
  CHECK(basalt["accel_bias_std"] == Json({3e-3, 3e-3, 3e-3}));
  CHECK(basalt["imu_update_rate"] == 200.0);
  const YAML::Node ros = YAML::Load(exported("ros", models).text);
  REQUIRE(ros["angular_velocity_covariance"].size() == 9);
  for (std::size_t i = 0; i < 9; ++i)
    CHECK(ros["linear_acceleration_covariance"][i].as<double>() == Approx(i % 4 == 0 ? 8e-4 : 0));
  const std::string matlab = exported("matlab", models).text;
  CHECK(has(matlab, "gyroparams('NoiseType', 'double-sided', ...\n    'NoiseDensity', 0.00016968"));
  CHECK(number_after(matlab, "'RandomWalk") == 1.9393e-5);
  const std::string px4 = exported("px4", models).text;
  CHECK(number_after(px4, "EKF2_GYR_NOISE") == Approx(1.6968e-3));
  CHECK(number_after(px4, "EKF2_ACC_B_NOISE") == Approx(3.0e-2));
  CHECK(number_after(px4, "EK3_GBIAS_P_NSE") == Approx(1.9393e-4));
  const std::string gnss = exported("gnss-ins-sim", models).text;
  CHECK(number_after(gnss, "'gyro_arw") == Approx(0.58332).epsilon(1e-5));
  CHECK(number_after(gnss, "'accel_vrw") == Approx(0.12));
  const std::string rotors = exported("rotors", models).text;
  CHECK(number_after(rotors, "gyroscopeNoiseDensity") == 1.6968e-4);
  CHECK(number_after(rotors, "accelerometerRandomWalk") == 3.0e-3);
  CHECK(number_after(rotors, "gyroscopeTurnOnBiasSigma") == 0);
}

TEST_CASE("the table: every target writes version, recording and formula, and is in the documentation") {
  const std::string page = test::slurp(test::source_folder().string() + "/docs/exports.md");
  std::set<std::string> names;
  CHECK(export_targets().size() == 26);
  for (const ExportTarget& target : export_targets()) {
    CAPTURE(target.name);
    CHECK(names.insert(std::string(target.name)).second);
    const Export made = export_models(target, test::euroc_imu());
    CHECK(has(made.text, std::string(version())));
    CHECK(has(made.text, std::string(64, 'a')));
    if (target.name != "json") CHECK(has(made.text, "formula"));
    CHECK(has(page, "| `" + std::string(target.name) + "` | " + std::string(target.title) + " | " +
                        std::string(target.convention) + " | " + needs_text(target.needs) + " | `" +
                        std::string(target.file) + "` |"));
  }
}

TEST_CASE("a low-pass that the file cannot express is said") {
  auto models = test::euroc_imu();
  models[0].bandwidth_hz = 28.3;
  CHECK(has(exported("sdf", models).text, "not in this file: the low-pass of gyr_x;"));
  CHECK(has(exported("sdf", models).notes.front(), "the low-pass of gyr_x; densities are kept"));
  models[0].bandwidth_hz = 400;
  CHECK_FALSE(has(exported("ros", models).text, "low-pass"));
}

TEST_CASE("terms that the consumer has no word for are named") {
  auto models = test::euroc_imu();
  models[0].noise[1] = models[3].noise[1] = known(1e-5);
  models[1].noise[3] = known(1e-6);
  const std::string b = "not in this file: bias_instability of gyr_x, acc_y",
                    qz = "not in this file: quantization of acc_x";
  const std::set<std::string> with_b = {"sdf",     "rotors", "gnss-ins-sim", "pegasus",
                                        "kf-gins", "navego", "matlab",       "json"};
  for (const ExportTarget& target : export_targets()) {
    CAPTURE(target.name);
    const Export made = export_models(target, models);
    CHECK(has(made.text, b) == !with_b.contains(std::string(target.name)));
    CHECK(has(made.text, qz) == (target.name != "json"));
    CHECK(has(made.text, "not in this file: random_walk of gyr_x, acc_x") == (target.terms == "N"));
    CHECK((std::find(made.notes.begin(), made.notes.end(), qz) != made.notes.end()) == (target.name != "json"));
  }
}

TEST_CASE("what differs from axis to axis is said axis by axis") {
  auto models = test::euroc_imu();
  models[1].noise[2] = at_most(1e-4);  // acc_x
  CHECK(has(exported("gnss-ins-sim", models).text,
            "m/s^2; x neither bias_instability nor random_walk was detected: no varying bias; y random_walk with"));
  models[1].noise[0] = at_most(1e-4);
  CHECK(has(exported("ros", models).text, "Hz; x not detected: upper 95 % limit\n"));
  const Json basalt = parse_json(exported("basalt", models).text, "c");
  CHECK(basalt["sensorchar"]["comments"]["accel_noise_std"] == "x not detected: upper 95 % limit");
  CHECK(basalt["value0"]["accel_noise_std"] == Json({1e-4, 2e-3, 2e-3}));
}

TEST_CASE("an unknown target is refused with the nearest") {
  CHECK_THROWS_WITH(find_export_target("kalbir"), Contains("did you mean kalibr?"));
  CHECK_THROWS_WITH(find_export_target("unity"), Contains("targets are kalibr"));
  for (const char* name : {"robot_localization", "robot-localization"})
    CHECK_THROWS_WITH(find_export_target(name), Contains("takes what ros takes"));
  CHECK_THROWS_WITH(find_export_target("gazebo"), Contains("takes what sdf takes"));
}

TEST_CASE("axes: the largest by default, with the spread in a comment, rms and one axis on request") {
  auto models = test::euroc_imu();
  models[2].noise[0] = known(3e-4);  // gyr_y
  CHECK(number_after(exported("kalibr", models).text, "gyroscope_noise_density") == 3e-4);
  CHECK(has(exported("kalibr", models).text, "largest of x 0.0001697, y 3e-04, z 0.0001697"));
  CHECK(has(exported("fast-lio", models).text, "white_noise: largest of x 0.0001697, y 3e-04, z 0.0001697"));
  ExportOptions options;
  options.axes = AxisChoice::rms;
  CHECK(number_after(exported("kalibr", models, options).text, "gyroscope_noise_density") ==
        Approx(std::sqrt((9e-8 + 2 * 1.6968e-4 * 1.6968e-4) / 3)));
  options.axes = AxisChoice::y;
  CHECK(number_after(exported("kalibr", models, options).text, "gyroscope_noise_density") == 3e-4);
  options.axes = AxisChoice::z;
  CHECK(number_after(exported("kalibr", models, options).text, "gyroscope_noise_density") == Approx(1.6968e-4));
  // A consumer with three numbers gets three, unless one is asked for.
  const auto std_of = [&](const ExportOptions& o) {
    return parse_json(exported("basalt", models, o).text, "c.json")["value0"]["gyro_noise_std"];
  };
  CHECK(std_of({})[1] == 3e-4);
  CHECK(std_of({})[2] == 1.6968e-4);
  options.axes = AxisChoice::max;
  CHECK(std_of(options)[2] == 3e-4);
  options.older = true;
  CHECK(std_of(options) == 3e-4);
}

TEST_CASE("inflation: on request only, before squaring, and said") {
  ExportOptions options;
  options.inflate = 10;
  const Export made = exported("gtsam", test::euroc_imu(), options);
  CHECK(number_after(made.text, "p->accelerometerCovariance") == Approx(4.0e-4));
  CHECK(has(made.text, "multiplied by 10.0"));
  CHECK_FALSE(has(exported("gtsam", test::euroc_imu()).text, "multiplied"));
  CHECK(number_after(exported("ros", test::euroc_imu(), options).text, "linear_acceleration_covariance") ==
        Approx(8e-2));
  options.inflate = 0;
  CHECK(has(refusal("kalibr", test::euroc_imu(), options), "`inflate`"));
}

TEST_CASE("times and gravity that are not positive are refused by name") {
  const std::pair<std::string, std::optional<double> ExportOptions::*> kAsked[] = {
      {"correlation_s", &ExportOptions::correlation_s},
      {"floor_tau_s", &ExportOptions::floor_tau_s},
      {"bias_tau_s", &ExportOptions::bias_tau_s},
      {"gravity", &ExportOptions::gravity}};
  for (const auto& [name, member] : kAsked) {
    ExportOptions options;
    options.*member = 0;
    CHECK(has(refusal("kalibr", test::euroc_imu(), options), "`" + name + "`: error E0591"));
  }
}

TEST_CASE("an absent term: an upper limit where 0 is refused, 0 in a simulator, left out where optional") {
  auto models = test::euroc_imu();
  for (SensorModel& m : models) m.noise[2] = at_most(m.unit == "rad/s" ? 5e-6 : 4e-4);
  for (const char* target : {"kalibr", "euroc", "openvins", "orbslam3", "basalt", "vins", "gtsam"}) {
    const Export made = exported(target, models);
    CAPTURE(target, made.text);
    CHECK(has(made.text, "upper 95 % limit"));
    CHECK_FALSE(made.notes.empty());
  }
  CHECK(number_after(exported("kalibr", models).text, "gyroscope_random_walk") == 5e-6);
  CHECK(number_after(exported("px4", models).text, "EKF2_GYR_B_NOISE") == Approx(5e-5));
  const Json airsim = parse_json(exported("airsim", models).text, "s.json");
  CHECK(airsim["DefaultSensors"]["Imu"]["GyroBiasStability"] == 0.0);
  CHECK(has(airsim["sensorchar"]["comments"]["GyroBiasStability"].get<std::string>(), "taken as 0"));
  CHECK(number_after(exported("rotors", models).text, "gyroscopeRandomWalk") == 0);
  CHECK(number_after(exported("rotors", models).text, "gyroscopeBiasCorrelationTime") > 0);
  CHECK_FALSE(has(exported("sdf", models).text, "dynamic_bias_stddev"));
  CHECK_FALSE(has(exported("matlab", models).text, "'RandomWalk'"));
  // A value on one axis goes before the limits of the others.
  models[0].noise[2] = known(1e-6);
  CHECK(number_after(exported("kalibr", models).text, "gyroscope_random_walk") == 1e-6);
  // Neither value nor limit: refused where a number is needed, left alone where it is not.
  for (SensorModel& m : models) m.noise[2] = {};
  CHECK(has(refusal("kalibr", models), "neither a value nor an upper limit of random_walk"));
  CHECK(has(exported("px4", models).text, "# EKF2_GYR_B_NOISE keeps its value"));
}

TEST_CASE("an undetermined term keeps its value and the comment says so") {
  auto models = test::euroc_imu();
  for (SensorModel& m : models) m.noise[2].status = Status::undetermined;
  CHECK(has(exported("kalibr", models).text, "1.939e-05 (undetermined)"));
}

TEST_CASE("groups: missing, double and nameless axes are refused with the remedy") {
  auto models = test::euroc_imu();
  auto without = models;
  without.erase(without.begin() + 4);  // gyr_z
  CHECK(has(refusal("kalibr", without), "the gyroscope has no model for z"));
  CHECK(has(refusal("kalibr", without), "`axes` x"));
  ExportOptions x;
  x.axes = AxisChoice::x;
  CHECK(refusal("kalibr", without, x).empty());
  x.axes = AxisChoice::z;
  CHECK(has(refusal("kalibr", without, x), "no model for z"));

  auto twice = models;
  twice.push_back(test::model("gx", "rad/s", {known(1), known(1), known(1)}));
  CHECK(has(refusal("kalibr", twice), "two models claim the x axis of the gyroscope: gyr_x and gx"));
  CHECK(has(refusal("kalibr", twice), "`axis` gx=gy"));

  auto nameless = models;
  nameless[0].channel = "column 3";
  CHECK(has(refusal("kalibr", nameless), "names no axis"));
  CHECK(has(refusal("kalibr", nameless), "`axis` column 3=gx"));
  ExportOptions named;
  named.axis = {{"column 3", "gx"}};
  CHECK(refusal("kalibr", nameless, named).empty());
  named.axis = {{"column 4", "gx"}};
  CHECK(has(refusal("kalibr", nameless, named), "did you mean column 3?"));
  named.axis = {{"column 3", "wx"}};
  CHECK(has(refusal("kalibr", nameless, named), "no such place"));

  CHECK(has(refusal("kalibr", {models[0], models[2], models[4]}), "there is no accelerometer among gyr_x (gyroscope)"));
  CHECK(has(refusal("kalibr", {}), "no models"));
}

TEST_CASE("groups: one model without an axis stands for three") {
  const auto gyroscope = test::model("gyro", "deg/s", {known(0.01), {}, known(1e-3)});
  const auto accelerometer = test::model("accelerometer", "g", {known(1e-4), {}, known(1e-5)});
  const std::string text = exported("kalibr", {gyroscope, accelerometer}).text;
  CHECK(number_after(text, "gyroscope_noise_density") == Approx(0.01 * M_PI / 180));
  CHECK_FALSE(has(text, "largest"));
  CHECK(number_after(exported("sdf", {gyroscope, accelerometer}).text, "stddev") ==
        Approx(0.01 * M_PI / 180 * std::sqrt(200)));
}

TEST_CASE("groups: an unknown or wrong unit says which one is needed") {
  auto models = test::euroc_imu();
  models[0].unit = "";
  models[0].kind = "gyroscope";
  CHECK(has(refusal("kalibr", models), "its model names no unit, a gyroscope needs one of angular rate"));
  CHECK(has(refusal("kalibr", models), "write unit: rad/s or deg/s into the model file"));
  models[0].unit = "m/s^2";
  CHECK(has(refusal("kalibr", models), "gyr_x"));
  CHECK(has(refusal("kalibr", models), "not one of angular rate"));
  models[0].unit = "rad";  // another name would not make increments a rate
  CHECK(has(refusal("kalibr", models), "increments by `channel_scale`"));
  CHECK_FALSE(has(refusal("kalibr", models), "write unit"));
  models[0].unit = "rad/s";
  models[0].rate_hz = 0;
  CHECK(has(refusal("vins", models), "names no sampling rate"));
}

TEST_CASE("what has no place in the file is left out and said, ROS says what is not provided") {
  auto models = test::euroc_imu();
  models.push_back(test::model("temp", "degC", {known(0.1), {}, {}}, 1));
  models.push_back(test::model("mag_x", "uT", {known(0.1), {}, {}}, 100));
  const Export kalibr = exported("kalibr", models);
  CHECK(kalibr.notes == std::vector<std::string>{"temp: a thermometer has no place in a file for Kalibr; left out",
                                                 "mag_x: a magnetometer has no place in a file for Kalibr; left out"});
  const Export ros = exported("ros", {models[0], models[2], models[4]});
  CHECK(YAML::Load(ros.text)["linear_acceleration_covariance"][0].as<double>() == -1);
  CHECK(YAML::Load(ros.text)["angular_velocity_covariance"][0].as<double>() > 0);
}

TEST_CASE("magnetometers and barometers where the consumer has a place for them") {
  std::vector<SensorModel> models = test::euroc_imu();
  for (const char* axis : {"x", "y", "z"})
    models.push_back(test::model(std::string("mag_") + axis, "uT", {known(0.02), {}, {}}, 100));
  models.push_back(test::model("pressure", "hPa", {known(0.003), {}, {}}, 50));
  CHECK(YAML::Load(exported("ros", models).text)["magnetic_field_covariance"][4].as<double>() == Approx(4e-14));
  CHECK(number_after(exported("gnss-ins-sim", models).text, "'mag_std") == Approx(0.2));
  CHECK(has(exported("matlab", models).text,
            "mag = magparams('NoiseType', 'double-sided', ...\n    'NoiseDensity', 0.02)"));
  const std::string sdf = exported("sdf", models).text;
  CHECK(number_after(sdf.substr(sdf.find("<magnetometer>")), "stddev") == Approx(2e-7));
  CHECK(number_after(sdf.substr(sdf.find("<air_pressure>")), "stddev") == Approx(0.3 * std::sqrt(50)));
  CHECK(number_after(exported("sdf", {models.back()}).text, "stddev") == Approx(0.3 * std::sqrt(50)));
}

TEST_CASE("flicker becomes the Gauss-Markov bias with the same maximum") {
  // N = 1e-3, B = 1e-4: white noise ends at N^2 / (0.4413 B^2) = 226.6 s; the record at 1500 s.
  const auto m = test::model("gyr_x", "rad/s", {known(1e-3), known(1e-4), at_most(1e-7)});
  const PlacedModel placed{&m, 1};
  const GaussMarkov process = gauss_markov(placed, {});
  const double tau = std::sqrt(1e-6 / (2 * M_LN2 / M_PI * 1e-8) * 1500);
  CHECK(process.correlation_s == Approx(tau / 1.8926).epsilon(1e-4));
  CHECK(process.steady_sd == Approx(1.0760e-4).epsilon(1e-4));
  CHECK(process.driving == Approx(1.0760e-4 * std::sqrt(2 / process.correlation_s)).epsilon(1e-4));
  // The exact Allan deviation of the process at tau is the floor, and it is a maximum.
  const auto adev = [&](double t) {
    const double r = t / process.correlation_s;
    return process.driving *
           std::sqrt(process.correlation_s / r * (1 - (3 - 4 * std::exp(-r) + std::exp(-2 * r)) / (2 * r)));
  };
  CHECK(adev(tau) == Approx(std::sqrt(2 * M_LN2 / M_PI) * 1e-4).epsilon(1e-9));
  CHECK(adev(0.9 * tau) < adev(tau));
  CHECK(adev(1.1 * tau) < adev(tau));

  ExportOptions options;
  options.floor_tau_s = 100;
  CHECK(gauss_markov(placed, options).correlation_s == Approx(52.837).epsilon(1e-4));
  options.correlation_s = 30;
  CHECK(gauss_markov(placed, options).correlation_s == 30);
  CHECK(gauss_markov(placed, options).steady_sd == Approx(1.0760e-4).epsilon(1e-4));
}

TEST_CASE("a walk that overtakes flicker within the record is exported in its place") {
  auto m = test::model("gyr_x", "rad/s", {known(1e-3), known(1e-4), known(1e-5)});
  const PlacedModel placed{&m, 1};
  CHECK(gauss_markov(placed, {}).driving == 1e-5);  // 1e-5 sqrt(1500/3) = 2.2e-4 > 0.66e-4
  CHECK(gauss_markov(placed, {}).correlation_s == 72000);
  m.noise[2] = known(1e-6);  // 2.2e-5 < 6.6e-5
  CHECK(gauss_markov(placed, {}).steady_sd == Approx(1.076e-4).epsilon(1e-3));
  m.duration_s = m.tau_max_s = 0;
  m.noise[1] = {};
  CHECK(gauss_markov(placed, {}).correlation_s == 1e6);
}

TEST_CASE("generic JSON reads back to the same model, alone and in a list") {
  auto models = test::euroc_imu();
  models[1].bias = {0.1, 0.02, 1e-3, 0};
  models[1].sensitivity = {2, "V"};
  models[1].saturation_low = -20;
  models[1].saturation_high = 20;
  models[1].bandwidth_hz = 62.5;
  models[1].remarks = {"one", "two"};
  const test::TemporaryFolder folder;
  const auto same = [](const SensorModel& a, const SensorModel& b) {
    CHECK(a.channel == b.channel);
    CHECK(a.unit == b.unit);
    CHECK(a.bias == b.bias);
    CHECK(a.sensitivity == b.sensitivity);
    CHECK(a.saturation_high == b.saturation_high);
    CHECK(a.bandwidth_hz == b.bandwidth_hz);
    CHECK(a.remarks == b.remarks);
    CHECK(a.recording.sha256 == b.recording.sha256);
    for (std::size_t t = 0; t < kTerms; ++t) {
      CHECK(a.noise[t].value == b.noise[t].value);
      CHECK(a.noise[t].upper95 == b.noise[t].upper95);
      CHECK(a.noise[t].status == b.noise[t].status);
      CHECK(a.noise[t].ci95.high == b.noise[t].ci95.high);
    }
  };
  const std::string one = (folder / "one.json").string(), six = (folder / "six.json").string();
  std::ofstream(one) << exported("json", {models[1]}).text;
  std::ofstream(six) << exported("json", models).text;
  same(read_model_file(one), models[1]);
  const auto list = read_model_list(six);
  REQUIRE(list.size() == 6);
  for (std::size_t i = 0; i < 6; ++i) same(list[i], models[i]);
  CHECK(read_model_list(one).size() == 1);
  std::ofstream(six) << R"({"format":"sensor-models","version":1,"models":[]})";
  CHECK_THROWS_WITH(read_model_list(six), Contains("empty list"));
  std::ofstream(six) << R"({"format":"sensor-models","version":2,"models":[]})";
  CHECK_THROWS_WITH(read_model_list(six), Contains("newer"));
}

TEST_CASE("a misfit is refused, or goes with a sentence, generic JSON keeps the status itself") {
  std::vector<SensorModel> models = test::euroc_imu();
  models[1].noise[0].status = Status::misfit;
  models[1].noise_shape = {NoiseShape::Kind::boxcar, 4, {}, {}};
  models[2].noise_shape = {NoiseShape::Kind::measured, 0, {0.1, 0.7, 5}, {1.2, 6, 0.9}};
  for (const ExportTarget& target : export_targets()) {
    CAPTURE(target.name);
    const std::string name(target.name);
    if (target.takes.status) {
      CHECK(exported(name, models).text.find("misfit") != std::string::npos);
      continue;
    }
    CHECK_THAT(refusal(name, models), Contains("misfit") && Contains(models[1].channel));
    ExportOptions options;
    options.anyway = true;
    const Export made = exported(name, models, options);
    CHECK(made.text.find("misfit") != std::string::npos);
    CHECK(made.text.find("shape of the noise") != std::string::npos);
    CHECK(made.text.find("is up to 6 times what they give (at 0.7 Hz)") != std::string::npos);
  }
}

TEST_CASE("a bad finding is refused with its remedy, a caution goes with its sentence, a note does not") {
  std::vector<SensorModel> models = test::euroc_imu();
  Finding moved = finding("motion", "The sensor was moved or shaken in 1 stretch.");
  models[0].findings = {moved, finding("heavy_tails", "Tails are heavy.")};
  for (const ExportTarget& target : export_targets()) {
    if (target.takes.status) continue;
    CAPTURE(target.name);
    const std::string name(target.name);
    models[0].findings[0] = moved;
    const std::string text = exported(name, models).text;
    CHECK(text.find("moved or shaken") != std::string::npos);
    CHECK(text.find("Tails are heavy") == std::string::npos);
    models[0].findings[0].severity = Severity::bad;
    models[0].findings[0].help = {{"Use the longest still stretch.", {{"still", "auto"}}}};
    CHECK_THAT(refusal(name, models), Contains("moved or shaken") && Contains("`still` auto"));
    ExportOptions options;
    options.anyway = true;
    CHECK(exported(name, models, options).text.find("moved or shaken") != std::string::npos);
  }
}

TEST_CASE("an undetermined Gauss-Markov process does not become a random walk") {
  std::vector<SensorModel> models = test::euroc_imu();
  for (SensorModel& m : models) {
    m.noise[2] = {};
    m.noise[2].status = Status::not_detected;
    m.noise[2].upper95 = 1e-6;
    m.gauss_markov = {1e-3, 100, {}, {}, Status::undetermined};
  }
  const std::string text = exported("kalibr", models).text;
  CHECK(text.find("upper 95 % limit") != std::string::npos);
  for (SensorModel& m : models) m.gauss_markov.status = Status::detected;
  CHECK(exported("kalibr", models).text.find("Gauss-Markov driving density") != std::string::npos);
}
