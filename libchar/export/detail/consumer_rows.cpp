#include "libchar/export/detail/consumer_rows.hpp"

#include <fmt/format.h>

#include <cctype>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace libchar {
namespace {

using enum Term;

constexpr double kGravity = 9.80665;  // standard gravity, m/s^2
constexpr double kRoot2 = std::numbers::sqrt2;

// Factors: what the formulas beside them say, and the change from SI to the row's unit.
double one(const RowTimes&) { return 1; }
double rate(const RowTimes& t) { return t.rate_hz; }
double root_rate(const RowTimes& t) { return std::sqrt(t.rate_hz); }
double per_root_rate(const RowTimes& t) { return 1 / std::sqrt(t.rate_hz); }
// VINS: the derivation is in targets/vins.cpp.
double root_two_rate(const RowTimes& t) { return std::sqrt(2 * t.rate_hz); }
double per_root_step(const RowTimes& t) { return 1 / std::sqrt(t.filter_step_s); }
double root_2(const RowTimes&) { return kRoot2; }
double root_2_degrees(const RowTimes&) { return kDegreesPerRadian * kRoot2; }
double root_2_micro_g(const RowTimes&) { return 1 / kGravity * 1e6 * kRoot2; }
double sixty(const RowTimes&) { return 60; }
double sixty_degrees(const RowTimes&) { return 60 * kDegreesPerRadian; }
double degrees_per_hour(const RowTimes&) { return kDegreesPerRadian * 3600; }
double micro_g(const RowTimes&) { return 1 / kGravity * 1e6; }
double milli_g(const RowTimes&) { return 1e3 / kGravity; }
double root_tau_degrees_per_hour(const RowTimes& t) { return std::sqrt(t.bias_tau_s) * 3600 * kDegreesPerRadian; }
double root_tau_micro_g(const RowTimes& t) { return std::sqrt(t.bias_tau_s) * 1e6 / kGravity; }
double micro(const RowTimes&) { return 1e6; }
double micro_root_rate(const RowTimes& t) { return 1e6 * std::sqrt(t.rate_hz); }

constexpr std::string_view kKalibr = "Kalibr, EuRoC, OpenVINS", kKalibrTargets = "kalibr euroc openvins";
constexpr std::string_view kVins = "VINS-Mono, VINS-Fusion", kRos = "ROS sensor_msgs/Imu";
constexpr std::string_view kGyroparams = "MATLAB gyroparams (double-sided)";
constexpr std::string_view kAccelparams = "MATLAB accelparams (double-sided)";
constexpr std::string_view kMagparams = "MATLAB magparams (double-sided)";
constexpr std::string_view kGyro = "gyroscope", kAccel = "accelerometer", kMag = "magnetometer";
constexpr std::string_view kDataSheet = "Data sheet", kFilter = "Any discrete filter";
constexpr std::string_view kDensity = "noise density, one-sided";
constexpr bool kFileOnly = false;

// clang-format off
// consumer, targets, sensor, key, term, power, formula, factor, unit, unit in the file, in the report
constexpr ConsumerRow kRows[] = {
    {kFilter, "", "", "standard deviation of a sample", white, 1, "N·√f", root_rate, "U"},
    {kFilter, "", "", "step of the bias from sample to sample", walk, 1, "K/√f", per_root_rate, "U"},

    {kDataSheet, "", kGyro, kDensity, white, 1, "√2·N", root_2_degrees, "deg/s/√Hz"},
    {kDataSheet, "", kGyro, "angle random walk", white, 1, "60·N", sixty_degrees, "deg/√h"},
    {kDataSheet, "", kGyro, "bias instability", flicker, 1, "B", degrees_per_hour, "deg/h"},
    {kKalibr, kKalibrTargets, kGyro, "gyroscope_noise_density", white, 1, "N", one, "rad/s/√Hz"},
    {kKalibr, kKalibrTargets, kGyro, "gyroscope_random_walk", walk, 1, "K", one, "rad/s²/√Hz"},
    {"ORB-SLAM3", "orbslam3", kGyro, "IMU.NoiseGyro", white, 1, "N", one, "rad/s/√Hz"},
    {"ORB-SLAM3", "orbslam3", kGyro, "IMU.GyroWalk", walk, 1, "K", one, "rad/s²/√Hz"},
    {"Basalt", "basalt", kGyro, "gyro_noise_std", white, 1, "N", one, "rad/s/√Hz"},
    {"Basalt", "basalt", kGyro, "gyro_bias_std", walk, 1, "K", one, "rad/s²/√Hz"},
    {kVins, "vins", kGyro, "gyr_n", white, 1, "N·√(2f)", root_two_rate, "rad/s"},
    {kVins, "vins", kGyro, "gyr_w", walk, 1, "K·√f", root_rate, "rad/s²"},
    {"OKVIS", "okvis", kGyro, "sigma_g_c", white, 1, "N", one, "rad/s/√Hz", "", kFileOnly},
    {"OKVIS", "okvis", kGyro, "sigma_gw_c", walk, 1, "K", one, "rad/s²/√Hz", "", kFileOnly},
    {"ROVIO", "rovio", kGyro, "att", white, 2, "N²", one, "rad²/s", "", kFileOnly},
    {"ROVIO", "rovio", kGyro, "gyb", walk, 2, "K²", one, "rad²/s³", "", kFileOnly},
    {"maplab", "maplab", kGyro, "gyro_noise_density", white, 1, "N", one, "rad/s/√Hz", "", kFileOnly},
    {"maplab", "maplab", kGyro, "gyro_bias_random_walk_noise_density", walk, 1, "K", one, "rad/s²/√Hz", "", kFileOnly},
    {"LIO-SAM", "lio-sam", kGyro, "imuGyrNoise", white, 1, "N", one, "rad/s/√Hz", "", kFileOnly},
    {"LIO-SAM", "lio-sam", kGyro, "imuGyrBiasN", walk, 1, "K", one, "rad/s²/√Hz", "", kFileOnly},
    {"FAST-LIO", "fast-lio", kGyro, "gyr_cov", white, 2, "N²·f", rate, "rad²/s²", "(rad/s)^2", kFileOnly},
    {"FAST-LIO", "fast-lio", kGyro, "b_gyr_cov", walk, 2, "K²·f", rate, "rad²/s⁴", "(rad/s^2)^2", kFileOnly},
    {"GTSAM", "gtsam", kGyro, "gyroscopeCovariance", white, 2, "N²", one, "rad²/s", "(rad/s)^2/Hz"},
    {"GTSAM", "gtsam", kGyro, "biasOmegaCovariance", walk, 2, "K²", one, "rad²/s³",
     "(rad/s^2)^2/Hz, combined factor only"},
    {kRos, "ros", kGyro, "angular_velocity_covariance", white, 2, "N²·f", rate, "rad²/s²", "(rad/s)^2"},
    {"Gazebo SDF", "sdf", kGyro, "stddev", white, 1, "N·√f", root_rate, "rad/s"},
    {kGyroparams, "matlab", kGyro, "NoiseDensity", white, 1, "N", one, "rad/s/√Hz"},
    {kGyroparams, "matlab", kGyro, "RandomWalk", walk, 1, "K", one, "rad/s·√Hz"},
    {kGyroparams, "matlab", kGyro, "BiasInstability", flicker, 1, "B", one, "rad/s"},
    {"RotorS", "rotors", kGyro, "gyroscopeNoiseDensity", white, 1, "N", one, "rad/s/√Hz", "", kFileOnly},
    {"AirSim", "airsim", kGyro, "AngularRandomWalk", white, 1, "60·N", sixty_degrees, "deg/√h", "", kFileOnly},
    {"AirSim", "airsim", kGyro, "GyroBiasStability", walk, 1, "K·√τ", root_tau_degrees_per_hour, "deg/h", "",
     kFileOnly},
    {"gnss-ins-sim", "gnss-ins-sim", kGyro, "gyro_arw", white, 1, "60·N", sixty_degrees, "deg/√h", "", kFileOnly},
    {"Pegasus", "pegasus", kGyro, "noise_density", white, 1, "N", one, "rad/s/√Hz", "", kFileOnly},
    {"CARLA", "carla", kGyro, "noise_gyro_stddev", white, 1, "N·√f", root_rate, "rad/s", "", kFileOnly},
    {"MuJoCo", "mujoco", kGyro, "noise", white, 1, "N·√f", root_rate, "rad/s", "", kFileOnly},
    {"Webots", "webots", kGyro, "lookupTable", white, 1, "N·√f", root_rate, "rad/s", "", kFileOnly},
    {"KF-GINS", "kf-gins", kGyro, "arw", white, 1, "60·N", sixty_degrees, "deg/√h", "", kFileOnly},
    {"NaveGo", "navego", kGyro, "arw", white, 1, "60·N", sixty_degrees, "deg/√h", "", kFileOnly},
    {"PX4 EKF2", "px4", kGyro, "EKF2_GYR_NOISE", white, 1, "N/√dt", per_root_step, "rad/s", "", kFileOnly},
    {"PX4 EKF2", "px4", kGyro, "EKF2_GYR_B_NOISE", walk, 1, "K/√dt", per_root_step, "rad/s²", "", kFileOnly},
    {"ArduPilot EK3", "ardupilot", kGyro, "EK3_GYRO_P_NSE", white, 1, "N/√dt", per_root_step, "rad/s", "", kFileOnly},
    {"ArduPilot EK3", "ardupilot", kGyro, "EK3_GBIAS_P_NSE", walk, 1, "K/√dt", per_root_step, "rad/s²", "", kFileOnly},

    {kDataSheet, "", kAccel, kDensity, white, 1, "√2·N", root_2_micro_g, "µg/√Hz"},
    {kDataSheet, "", kAccel, "velocity random walk", white, 1, "60·N", sixty, "m/s/√h"},
    {kDataSheet, "", kAccel, "bias instability", flicker, 1, "B", micro_g, "µg"},
    {kKalibr, kKalibrTargets, kAccel, "accelerometer_noise_density", white, 1, "N", one, "m/s²/√Hz"},
    {kKalibr, kKalibrTargets, kAccel, "accelerometer_random_walk", walk, 1, "K", one, "m/s³/√Hz"},
    {"ORB-SLAM3", "orbslam3", kAccel, "IMU.NoiseAcc", white, 1, "N", one, "m/s²/√Hz"},
    {"ORB-SLAM3", "orbslam3", kAccel, "IMU.AccWalk", walk, 1, "K", one, "m/s³/√Hz"},
    {"Basalt", "basalt", kAccel, "accel_noise_std", white, 1, "N", one, "m/s²/√Hz"},
    {"Basalt", "basalt", kAccel, "accel_bias_std", walk, 1, "K", one, "m/s³/√Hz"},
    {kVins, "vins", kAccel, "acc_n", white, 1, "N·√(2f)", root_two_rate, "m/s²"},
    {kVins, "vins", kAccel, "acc_w", walk, 1, "K·√f", root_rate, "m/s³"},
    {"OKVIS", "okvis", kAccel, "sigma_a_c", white, 1, "N", one, "m/s²/√Hz", "", kFileOnly},
    {"OKVIS", "okvis", kAccel, "sigma_aw_c", walk, 1, "K", one, "m/s³/√Hz", "", kFileOnly},
    {"ROVIO", "rovio", kAccel, "vel", white, 2, "N²", one, "m²/s³", "", kFileOnly},
    {"ROVIO", "rovio", kAccel, "acb", walk, 2, "K²", one, "m²/s⁵", "m^2/s^5", kFileOnly},
    {"maplab", "maplab", kAccel, "acc_noise_density", white, 1, "N", one, "m/s²/√Hz", "", kFileOnly},
    {"maplab", "maplab", kAccel, "acc_bias_random_walk_noise_density", walk, 1, "K", one, "m/s³/√Hz", "", kFileOnly},
    {"LIO-SAM", "lio-sam", kAccel, "imuAccNoise", white, 1, "N", one, "m/s²/√Hz", "", kFileOnly},
    {"LIO-SAM", "lio-sam", kAccel, "imuAccBiasN", walk, 1, "K", one, "m/s³/√Hz", "", kFileOnly},
    {"FAST-LIO", "fast-lio", kAccel, "acc_cov", white, 2, "N²·f", rate, "m²/s⁴", "(m/s^2)^2", kFileOnly},
    {"FAST-LIO", "fast-lio", kAccel, "b_acc_cov", walk, 2, "K²·f", rate, "m²/s⁶", "(m/s^3)^2", kFileOnly},
    {"GTSAM", "gtsam", kAccel, "accelerometerCovariance", white, 2, "N²", one, "m²/s³", "(m/s^2)^2/Hz"},
    {"GTSAM", "gtsam", kAccel, "biasAccCovariance", walk, 2, "K²", one, "m²/s⁵",
     "(m/s^3)^2/Hz, combined factor only"},
    {kRos, "ros", kAccel, "linear_acceleration_covariance", white, 2, "N²·f", rate, "m²/s⁴", "(m/s^2)^2"},
    {"Gazebo SDF", "sdf", kAccel, "stddev", white, 1, "N·√f", root_rate, "m/s²"},
    {kAccelparams, "matlab", kAccel, "NoiseDensity", white, 1, "N", one, "m/s²/√Hz"},
    {kAccelparams, "matlab", kAccel, "RandomWalk", walk, 1, "K", one, "m/s²·√Hz"},
    {kAccelparams, "matlab", kAccel, "BiasInstability", flicker, 1, "B", one, "m/s²"},
    {"RotorS", "rotors", kAccel, "accelerometerNoiseDensity", white, 1, "N", one, "m/s²/√Hz", "", kFileOnly},
    {"AirSim", "airsim", kAccel, "VelocityRandomWalk", white, 1, "N", milli_g, "mg/√Hz", "", kFileOnly},
    {"AirSim", "airsim", kAccel, "AccelBiasStability", walk, 1, "K·√τ", root_tau_micro_g, "µg", "", kFileOnly},
    {"gnss-ins-sim", "gnss-ins-sim", kAccel, "accel_vrw", white, 1, "60·N", sixty, "m/s/√h", "", kFileOnly},
    {"Pegasus", "pegasus", kAccel, "noise_density", white, 1, "N", one, "m/s²/√Hz", "", kFileOnly},
    {"CARLA", "carla", kAccel, "noise_accel_stddev", white, 1, "N·√f", root_rate, "m/s²", "", kFileOnly},
    {"MuJoCo", "mujoco", kAccel, "noise", white, 1, "N·√f", root_rate, "m/s²", "", kFileOnly},
    {"Webots", "webots", kAccel, "lookupTable", white, 1, "N·√f", root_rate, "m/s²", "", kFileOnly},
    {"KF-GINS", "kf-gins", kAccel, "vrw", white, 1, "60·N", sixty, "m/s/√h", "", kFileOnly},
    {"NaveGo", "navego", kAccel, "vrw", white, 1, "60·N", sixty, "m/s/√h", "", kFileOnly},
    {"PX4 EKF2", "px4", kAccel, "EKF2_ACC_NOISE", white, 1, "N/√dt", per_root_step, "m/s²", "", kFileOnly},
    {"PX4 EKF2", "px4", kAccel, "EKF2_ACC_B_NOISE", walk, 1, "K/√dt", per_root_step, "m/s³", "", kFileOnly},
    {"ArduPilot EK3", "ardupilot", kAccel, "EK3_ACC_P_NSE", white, 1, "N/√dt", per_root_step, "m/s²", "", kFileOnly},
    {"ArduPilot EK3", "ardupilot", kAccel, "EK3_ABIAS_P_NSE", walk, 1, "K/√dt", per_root_step, "m/s³", "", kFileOnly},

    {kDataSheet, "", "other", kDensity, white, 1, "√2·N", root_2, "U/√Hz"},
    {"ROS sensor_msgs/MagneticField", "ros", kMag, "magnetic_field_covariance", white, 2, "N²·f", rate, "T²",
     "T^2, of sensor_msgs/MagneticField", kFileOnly},
    {"Gazebo SDF", "sdf", kMag, "stddev", white, 1, "N·√f", root_rate, "T", "", kFileOnly},
    {"Gazebo SDF", "sdf", "barometer", "stddev", white, 1, "N·√f", root_rate, "Pa", "", kFileOnly},
    {kMagparams, "matlab", kMag, "NoiseDensity", white, 1, "N", micro, "µT/√Hz", "", kFileOnly},
    {kMagparams, "matlab", kMag, "RandomWalk", walk, 1, "K", micro, "µT·√Hz", "", kFileOnly},
    {kMagparams, "matlab", kMag, "BiasInstability", flicker, 1, "B", micro, "µT", "", kFileOnly},
    {"gnss-ins-sim", "gnss-ins-sim", kMag, "mag_std", white, 1, "N·√f", micro_root_rate, "µT",
     "uT, of a sample (axis=9)", kFileOnly},
};
// clang-format on

// Whether `word` is one of the blank-separated `words`.
bool among(std::string_view words, std::string_view word) {
  while (!words.empty()) {
    const std::size_t end = words.find(' ');
    if (words.substr(0, end) == word) return true;
    words.remove_prefix(end == std::string_view::npos ? words.size() : end + 1);
  }
  return false;
}

}  // namespace

std::span<const ConsumerRow> consumer_table() { return kRows; }

std::vector<const ConsumerRow*> rows_of(std::string_view target, std::string_view sensor) {
  std::vector<const ConsumerRow*> out;
  for (const ConsumerRow& row : kRows)
    if (row.sensor == sensor && among(row.targets, target)) out.push_back(&row);
  return out;
}

const ConsumerRow& row_of(std::string_view target, std::string_view sensor, Term term) {
  for (const ConsumerRow* row : rows_of(target, sensor))
    if (row->term == term) return *row;
  throw std::logic_error(fmt::format("the table of consumers has no {} of a {} for {}",
                                     kTermNames[static_cast<std::size_t>(term)].key, sensor, target));
}

double row_value(const ConsumerRow& row, double coefficient, const RowTimes& times) {
  return (row.power == 2 ? coefficient * coefficient : coefficient) * row.factor(times);
}

std::string ascii_unit(std::string_view unit) {
  static constexpr std::pair<std::string_view, std::string_view> kSpelled[] = {
      {"²", "^2"}, {"³", "^3"}, {"µ", "u"}, {"·", " "}};
  std::string out;
  while (!unit.empty()) {
    if (unit.starts_with("√")) {
      unit.remove_prefix(std::string_view("√").size());
      std::size_t end = 0;
      while (end < unit.size() && std::isalpha(static_cast<unsigned char>(unit[end])) != 0) ++end;
      out += fmt::format("sqrt({})", unit.substr(0, end));
      unit.remove_prefix(end);
      continue;
    }
    std::string_view taken = unit.substr(0, 1), spelled = taken;
    for (const auto& [sign, ascii] : kSpelled)
      if (unit.starts_with(sign)) taken = sign, spelled = ascii;
    out += spelled;
    unit.remove_prefix(taken.size());
  }
  return out;
}

std::string file_unit(const ConsumerRow& row) {
  return row.unit_in_file.empty() ? ascii_unit(row.unit) : std::string(row.unit_in_file);
}

}  // namespace libchar
