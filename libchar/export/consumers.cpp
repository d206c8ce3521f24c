#include "libchar/export/consumers.hpp"

#include <cmath>
#include <numbers>
#include <optional>

#include "libchar/core/readable.hpp"
#include "libchar/core/units.hpp"

namespace libchar {
namespace {

constexpr double kGravity = 9.80665;  // standard gravity, m/s^2

// A coefficient raised to a power and converted; a limit stays a limit.
std::string converted(const Coefficient& c, double factor, int power) {
  if (power == 1) return people_value(c, factor);
  if (c.value) return people(*c.value * *c.value * factor, 4);
  if (c.upper95) return "≤ " + people(*c.upper95 * *c.upper95 * factor, 3);
  return "–";
}

struct Table {
  const Coefficients& coefficients;
  std::vector<ConsumerRow> rows;
  void add(std::string consumer,
           std::string key,
           std::string formula,
           Term term,
           double factor,
           std::string unit,
           int power = 1) {
    const Coefficient& c = coefficients[static_cast<std::size_t>(term)];
    if (!c.value && !c.upper95) return;
    rows.push_back({std::move(consumer),
                    std::move(key),
                    std::move(formula),
                    converted(c, factor, power),
                    std::move(unit)});
  }
};

void add_gyroscope(Table& t, double si, double f) {
  const double degrees = 180 / std::numbers::pi;
  t.add("Data sheet", "angle random walk", "60·Q", Term::white, si * degrees * 60, "deg/√h");
  t.add("Data sheet", "bias instability", "B", Term::flicker, si * degrees * 3600, "deg/h");
  t.add("Kalibr, EuRoC, OpenVINS", "gyroscope_noise_density", "Q", Term::white, si, "rad/s/√Hz");
  t.add("Kalibr, EuRoC, OpenVINS", "gyroscope_random_walk", "K", Term::walk, si, "rad/s²/√Hz");
  t.add("ORB-SLAM3", "IMU.NoiseGyro", "Q", Term::white, si, "rad/s/√Hz");
  t.add("ORB-SLAM3", "IMU.GyroWalk", "K", Term::walk, si, "rad/s²/√Hz");
  t.add("Basalt", "gyro_noise_std", "Q", Term::white, si, "rad/s/√Hz");
  t.add("Basalt", "gyro_bias_std", "K", Term::walk, si, "rad/s²/√Hz");
  t.add("VINS-Mono, VINS-Fusion", "gyr_n", "Q·√(2f)", Term::white, si * std::sqrt(2 * f), "rad/s");
  t.add("VINS-Mono, VINS-Fusion", "gyr_w", "K·√f", Term::walk, si * std::sqrt(f), "rad/s²");
  t.add("GTSAM", "gyroscopeCovariance", "Q²", Term::white, si * si, "rad²/s", 2);
  t.add("GTSAM", "biasOmegaCovariance", "K²", Term::walk, si * si, "rad²/s³", 2);
  t.add("ROS sensor_msgs/Imu",
        "angular_velocity_covariance",
        "Q²·f",
        Term::white,
        si * si * f,
        "rad²/s²",
        2);
  t.add("Gazebo SDF", "stddev", "Q·√f", Term::white, si * std::sqrt(f), "rad/s");
  t.add("MATLAB gyroparams (double-sided)", "NoiseDensity", "Q", Term::white, si, "rad/s/√Hz");
  t.add("MATLAB gyroparams (double-sided)", "RandomWalk", "K", Term::walk, si, "rad/s·√Hz");
  t.add("MATLAB gyroparams (double-sided)", "BiasInstability", "B", Term::flicker, si, "rad/s");
}

void add_accelerometer(Table& t, double si, double f) {
  t.add("Data sheet", "velocity random walk", "60·Q", Term::white, si * 60, "m/s/√h");
  t.add("Data sheet", "bias instability", "B", Term::flicker, si / kGravity * 1e6, "µg");
  t.add("Kalibr, EuRoC, OpenVINS", "accelerometer_noise_density", "Q", Term::white, si, "m/s²/√Hz");
  t.add("Kalibr, EuRoC, OpenVINS", "accelerometer_random_walk", "K", Term::walk, si, "m/s³/√Hz");
  t.add("ORB-SLAM3", "IMU.NoiseAcc", "Q", Term::white, si, "m/s²/√Hz");
  t.add("ORB-SLAM3", "IMU.AccWalk", "K", Term::walk, si, "m/s³/√Hz");
  t.add("Basalt", "accel_noise_std", "Q", Term::white, si, "m/s²/√Hz");
  t.add("Basalt", "accel_bias_std", "K", Term::walk, si, "m/s³/√Hz");
  t.add("VINS-Mono, VINS-Fusion", "acc_n", "Q·√(2f)", Term::white, si * std::sqrt(2 * f), "m/s²");
  t.add("VINS-Mono, VINS-Fusion", "acc_w", "K·√f", Term::walk, si * std::sqrt(f), "m/s³");
  t.add("GTSAM", "accelerometerCovariance", "Q²", Term::white, si * si, "m²/s³", 2);
  t.add("GTSAM", "biasAccCovariance", "K²", Term::walk, si * si, "m²/s⁵", 2);
  t.add("ROS sensor_msgs/Imu",
        "linear_acceleration_covariance",
        "Q²·f",
        Term::white,
        si * si * f,
        "m²/s⁴",
        2);
  t.add("Gazebo SDF", "stddev", "Q·√f", Term::white, si * std::sqrt(f), "m/s²");
  t.add("MATLAB accelparams (double-sided)", "NoiseDensity", "Q", Term::white, si, "m/s²/√Hz");
  t.add("MATLAB accelparams (double-sided)", "RandomWalk", "K", Term::walk, si, "m/s²·√Hz");
  t.add("MATLAB accelparams (double-sided)", "BiasInstability", "B", Term::flicker, si, "m/s²");
}

}  // namespace

std::vector<ConsumerRow> consumer_rows(const Coefficients& coefficients,
                                       const std::string& unit,
                                       double rate_hz) {
  const auto known = find_unit(unit);
  const std::string u = unit.empty() ? "U" : unit;
  Table t{coefficients, {}};
  t.add("Any discrete filter",
        "standard deviation of a sample",
        "Q·√f",
        Term::white,
        std::sqrt(rate_hz),
        u);
  t.add("Any discrete filter",
        "step of the bias from sample to sample",
        "K/√f",
        Term::walk,
        1 / std::sqrt(rate_hz),
        u);
  if (known && known->quantity == Quantity::angular_rate) {
    const double degrees = known->to_si * 180 / std::numbers::pi;
    t.add("Data sheet",
          "noise density, one-sided",
          "√2·Q",
          Term::white,
          degrees * std::numbers::sqrt2,
          "deg/s/√Hz");
    add_gyroscope(t, known->to_si, rate_hz);
  } else if (known && known->quantity == Quantity::acceleration) {
    t.add("Data sheet",
          "noise density, one-sided",
          "√2·Q",
          Term::white,
          known->to_si / kGravity * 1e6 * std::numbers::sqrt2,
          "µg/√Hz");
    add_accelerometer(t, known->to_si, rate_hz);
  } else {
    t.add("Data sheet",
          "noise density, one-sided",
          "√2·Q",
          Term::white,
          std::numbers::sqrt2,
          u + "/√Hz");
  }
  return t.rows;
}

}  // namespace libchar
