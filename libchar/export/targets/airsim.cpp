// AirSim settings.json, sensor type 2 (IMU). White noise: AngularRandomWalk in deg/sqrt(h),
// VelocityRandomWalk in mg/sqrt(Hz) (its documentation says mg). The bias is a pure random walk of
// density stability/sqrt(tau): GyroBiasStability (deg/h) and AccelBiasStability (ug) are not the
// bias instability B. A key that is left out keeps AirSim's MPU-6000, so an absent walk is written
// as 0.

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "libchar/export/detail/export_figures.hpp"
#include "libchar/export/detail/export_targets.hpp"
#include "libchar/export/detail/export_text.hpp"

namespace libchar {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr double kGravity = 9.80665;

struct Writer {
  const ExportOptions& options;
  Export& out;
  Json imu{{"SensorType", 2}, {"Enabled", true}};
  Json comments = Json::object();

  void put(const char* key, const SensorTriad& triad, Term term, double factor) {
    const Figure figure = scalar_figure(triad, term, Absent::zero, options);
    note_figure(out.notes, key, figure);
    if (!figure.origin.empty()) comments[key] = "before conversion: " + figure.origin;
    imu[key] = value_or_zero(figure) * factor;
  }
};

}  // namespace

Export export_airsim(const SensorGroup& group, const ExportOptions& options) {
  Export out;
  Writer writer{options, out};
  if (group.gyroscope) {
    const double tau = options.airsim_tau_s.value_or(500);
    writer.put("AngularRandomWalk", *group.gyroscope, Term::white, 60 * kDegrees);
    writer.imu["GyroBiasStabilityTau"] = tau;
    writer.put("GyroBiasStability", *group.gyroscope, Term::walk, std::sqrt(tau) * 3600 * kDegrees);
  }
  if (group.accelerometer) {
    const double tau = options.airsim_tau_s.value_or(800);
    writer.put("VelocityRandomWalk", *group.accelerometer, Term::white, 1e3 / kGravity);
    writer.imu["AccelBiasStabilityTau"] = tau;
    writer.put(
        "AccelBiasStability", *group.accelerometer, Term::walk, std::sqrt(tau) * 1e6 / kGravity);
  }
  if (!group.gyroscope || !group.accelerometer)
    out.notes.push_back(std::string("no ") + (group.gyroscope ? "accelerometer" : "gyroscope") +
                        " was given: AirSim's own (an MPU-6000) stays");
  Json head = head_json(
      group,
      options,
      "AngularRandomWalk = white_noise 60 180/pi; VelocityRandomWalk = white_noise 1e3/9.80665; "
      "BiasStability = random_walk sqrt(tau), in deg/h and ug (not bias_instability)");
  if (!writer.comments.empty()) head["comments"] = writer.comments;
  Json document;
  document["SettingsVersion"] = 1.2;
  document["DefaultSensors"]["Imu"] = writer.imu;
  document["sensorchar"] = head;
  out.text = dump_json(document);
  return out;
}

}  // namespace libchar
