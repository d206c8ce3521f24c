#include "libchar/export/exports.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "libchar/core/error.hpp"
#include "libchar/core/text.hpp"
#include "libchar/export/detail/export_targets.hpp"

namespace libchar {
namespace {

using enum ExportNeeds;

constexpr std::array<ExportTarget, 15> kTargets = {{
    {"kalibr",
     "Kalibr",
     "continuous densities: Q in rad/s/sqrt(Hz), m/s^2/sqrt(Hz); K in rad/s^2/sqrt(Hz), "
     "m/s^3/sqrt(Hz); all > 0",
     "imu.yaml",
     gyroscope_and_accelerometer,
     "QK",
     export_kalibr},
    {"euroc",
     "EuRoC data sets",
     "continuous densities: Q and K as for Kalibr",
     "sensor.yaml",
     gyroscope_and_accelerometer,
     "QK",
     export_euroc},
    {"openvins",
     "OpenVINS",
     "continuous densities: Q and K; OpenCV YAML",
     "kalibr_imu_chain.yaml",
     gyroscope_and_accelerometer,
     "QK",
     export_openvins},
    {"orbslam3",
     "ORB-SLAM3",
     "continuous densities: Q and K, with the rate as a real number; OpenCV YAML",
     "imu_orbslam3.yaml",
     gyroscope_and_accelerometer,
     "QK",
     export_orbslam3},
    {"basalt",
     "Basalt",
     "continuous densities, though named std: Q and K, one for each axis",
     "calibration_imu.json",
     gyroscope_and_accelerometer,
     "QK",
     export_basalt},
    {"vins",
     "VINS-Mono, VINS-Fusion",
     "per sample, as its code reads them: acc_n, gyr_n = Q sqrt(2 f); acc_w, gyr_w = K sqrt(f); "
     "OpenCV YAML",
     "imu_vins.yaml",
     gyroscope_and_accelerometer,
     "QK",
     export_vins},
    {"gtsam",
     "GTSAM",
     "continuous covariances: Q^2 and K^2",
     "imu_params.cpp",
     gyroscope_and_accelerometer,
     "QK",
     export_gtsam},
    {"ros",
     "ROS sensor_msgs",
     "variance of a sample: Q^2 f on the diagonal, one for each axis",
     "imu_covariance.yaml",
     gyroscope_or_accelerometer,
     "Q",
     export_ros},
    {"sdf",
     "SDFormat, Gazebo",
     "stddev of a sample Q sqrt(f); a Gauss-Markov bias by its continuous driving density",
     "imu.sdf",
     any_sensor,
     "QBK",
     export_sdf},
    {"rotors",
     "RotorS, PX4 Gazebo classic, UUV",
     "continuous densities: Q, and a Gauss-Markov bias by its driving density and correlation time",
     "imu_plugin.xml",
     gyroscope_and_accelerometer,
     "QBK",
     export_rotors},
    {"airsim",
     "AirSim",
     "deg/sqrt(h), mg/sqrt(Hz); the bias is a random walk K = stability / sqrt(tau) in deg/h, ug",
     "settings.json",
     gyroscope_or_accelerometer,
     "QK",
     export_airsim},
    {"gnss-ins-sim",
     "gnss-ins-sim",
     "deg/sqrt(h), m/s/sqrt(h); a Gauss-Markov bias by its steady standard deviation in deg/h, "
     "m/s^2",
     "imu_err.py",
     gyroscope_and_accelerometer,
     "QBK",
     export_gnss_ins_sim},
    {"matlab",
     "MATLAB gyroparams, accelparams",
     "two-sided densities (NoiseType double-sided): Q, K, and B itself",
     "imu_params.m",
     gyroscope_or_accelerometer,
     "QBK",
     export_matlab},
    {"px4",
     "PX4 EKF2, ArduPilot EK3",
     "per filter step dt: Q / sqrt(dt), K / sqrt(dt); a lower bound, not a tuning",
     "ekf_params.txt",
     gyroscope_or_accelerometer,
     "QK",
     export_px4},
    {"json",
     "generic JSON",
     "the sensor model itself, every key of its file; reads back",
     "model.json",
     any_sensor,
     "QBKQzR",
     export_json},
}};

std::string channels_of(const SensorGroup& group) {
  std::string text;
  for (const SensorModel* m : group.all)
    text +=
        fmt::format("{}{} ({})", text.empty() ? "" : ", ", printable(m->channel, 40), kind_of(*m));
  return text;
}

void check_needs(const ExportTarget& target, const SensorGroup& group) {
  const bool gyroscope = group.gyroscope.has_value();
  const bool accelerometer = group.accelerometer.has_value();
  const bool met = target.needs == any_sensor                   ? !group.all.empty()
                   : target.needs == gyroscope_or_accelerometer ? gyroscope || accelerometer
                                                                : gyroscope && accelerometer;
  if (met) return;
  const bool both = target.needs == gyroscope_and_accelerometer;
  throw Error(
      {ErrorKind::input,
       "E0590",
       "",
       fmt::format(
           "{} needs models of a gyroscope {} an accelerometer, and there is no {} among {}",
           target.title,
           both ? "and" : "or",
           both ? (gyroscope ? "accelerometer" : "gyroscope") : "one of them",
           group.all.empty() ? "no models" : channels_of(group)),
       "",
       "give all files of the device; where name and unit do not say what a channel is: --axis "
       "NAME=gx"});
}

void check_options(const ExportOptions& options) {
  const auto positive = [](const char* name, double value) {
    if (!(value > 0))
      throw Error({ErrorKind::usage, "E0591", name, "expected a number > 0", shortest(value), ""});
  };
  positive("--inflate", options.inflate);
  positive("--filter-step", options.filter_step_s);
  if (options.correlation_s) positive("--correlation-time", *options.correlation_s);
  if (options.floor_tau_s) positive("--floor-tau", *options.floor_tau_s);
  if (options.airsim_tau_s) positive("--airsim-tau", *options.airsim_tau_s);
  if (options.gravity) positive("--gravity", *options.gravity);
}

void note_left_out(const ExportTarget& target, const SensorGroup& group, Export& out) {
  if (target.needs == any_sensor) return;
  const auto leave = [&](const SensorModel& m) {
    out.notes.push_back(fmt::format("{}: a {} has no place in a file for {}; left out",
                                    printable(m.channel, 40),
                                    kind_of(m),
                                    target.title));
  };
  for (const SensorModel* m : group.others) leave(*m);
  const bool magnetic =
      target.name == "ros" || target.name == "matlab" || target.name == "gnss-ins-sim";
  if (!group.magnetometer || magnetic) return;
  for (const auto& placed : group.magnetometer->axis)
    if (placed) leave(*placed->model);
}

// What is known of the sensors and gets lost: terms that the consumer has no word for, and the
// low-pass, behind which samples scatter less than Q sqrt(f) and neighbours are correlated.
std::vector<std::string> unexpressed(const ExportTarget& target, const SensorGroup& group) {
  std::vector<std::string> out;
  if (target.name == "json") return out;
  const auto among = [&](const auto& concerned) {
    std::string channels;
    for (const SensorModel* m : group.all)
      if (concerned(*m)) channels += (channels.empty() ? "" : ", ") + printable(m->channel, 40);
    return channels;
  };
  for (std::size_t t = 0; t < kTerms; ++t) {
    if (target.terms.find(kTermNames[t].letter) != std::string_view::npos) continue;
    const std::string channels =
        among([&](const SensorModel& m) { return m.noise[t].value.value_or(0) > 0; });
    if (!channels.empty())
      out.push_back(fmt::format("not in this file: {} of {}", kTermNames[t].key, channels));
  }
  const std::string filtered = among(
      [](const SensorModel& m) { return m.bandwidth_hz && *m.bandwidth_hz <= m.rate_hz / 2; });
  if (!filtered.empty())
    out.push_back(fmt::format(
        "not in this file: the low-pass of {}; densities are kept, single samples scatter less",
        filtered));
  return out;
}

void drop_repeated(std::vector<std::string>& notes) {
  std::vector<std::string> once;
  for (std::string& note : notes)
    if (std::find(once.begin(), once.end(), note) == once.end()) once.push_back(std::move(note));
  notes = std::move(once);
}

}  // namespace

std::string needs_text(ExportNeeds needs) {
  if (needs == any_sensor) return "any sensor";
  return needs == gyroscope_and_accelerometer ? "gyroscope and accelerometer"
                                              : "gyroscope or accelerometer";
}

std::span<const ExportTarget> export_targets() {
  return kTargets;
}

const ExportTarget& find_export_target(std::string_view name) {
  for (const ExportTarget& target : kTargets)
    if (target.name == name) return target;
  std::vector<std::string> names;
  for (const ExportTarget& target : kTargets) names.emplace_back(target.name);
  const auto near = nearest(name, names);
  throw Error({ErrorKind::usage,
               "E0592",
               "--to",
               fmt::format("no such target; targets are {}", fmt::join(names, ", ")),
               std::string(name),
               near ? fmt::format("did you mean {}?", *near) : "sensorchar model --list"});
}

Export export_models(const ExportTarget& target,
                     const std::vector<SensorModel>& models,
                     const ExportOptions& options) {
  check_options(options);
  SensorGroup group = group_sensors(models, options.axis);
  check_needs(target, group);
  group.unexpressed = unexpressed(target, group);
  Export out = target.write(group, options);
  out.notes.insert(out.notes.begin(), group.unexpressed.begin(), group.unexpressed.end());
  if (options.inflate != 1 && target.name != "json")
    out.notes.push_back(
        fmt::format("every noise number is multiplied by {}", shortest(options.inflate)));
  note_left_out(target, group, out);
  drop_repeated(out.notes);
  return out;
}

}  // namespace libchar
