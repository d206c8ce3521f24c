// AirSim settings.json, sensor type 2 (IMU). White noise: AngularRandomWalk in deg/sqrt(h), VelocityRandomWalk in
// mg/sqrt(Hz) (its documentation says mg). The bias is a pure random walk of density stability/sqrt(tau):
// GyroBiasStability (deg/h) and AccelBiasStability (ug) are not the bias instability B. A key that is left out keeps
// AirSim's MPU-6000, so an absent walk is written as 0.

#include <nlohmann/json.hpp>

#include "libchar/export/detail/consumer_rows.hpp"
#include "libchar/export/detail/export_figures.hpp"
#include "libchar/export/detail/export_text.hpp"
#include "libchar/export/detail/target_list.hpp"

namespace libchar {
namespace {

struct AirsimWriter {
  const ExportOptions& options;
  Export& out;
  Json imu{{"SensorType", 2}, {"Enabled", true}};
  Json comments = Json::object();

  void put(const SensorTriad& triad, Term term, double bias_tau_s = 0) {
    const ConsumerRow& row = row_of("airsim", triad.kind, term);
    const std::string key(row.key);
    const ExportFigure figure = scalar_figure(triad, term, Absent::zero, options);
    note_figure(out.notes, key, figure);
    if (!figure.origin.empty()) comments[key] = "before conversion: " + figure.origin;
    imu[key] = row_value(row, value_or_zero(figure), {.bias_tau_s = bias_tau_s});
  }
};

Export write_airsim(const SensorGroup& group, const ExportOptions& options) {
  Export out;
  AirsimWriter writer{options, out};
  if (group.gyroscope) {
    const double tau = options.bias_tau_s.value_or(500);
    writer.put(*group.gyroscope, Term::white);
    writer.imu["GyroBiasStabilityTau"] = tau;
    writer.put(*group.gyroscope, Term::walk, tau);
  }
  if (group.accelerometer) {
    const double tau = options.bias_tau_s.value_or(800);
    writer.put(*group.accelerometer, Term::white);
    writer.imu["AccelBiasStabilityTau"] = tau;
    writer.put(*group.accelerometer, Term::walk, tau);
  }
  if (!group.gyroscope || !group.accelerometer)
    out.notes.push_back(std::string("no ") + (group.gyroscope ? "accelerometer" : "gyroscope") +
                        " was given: AirSim's own (an MPU-6000) stays");
  Json head = head_json(group, options,
                        "AngularRandomWalk = white_noise 60 180/pi; VelocityRandomWalk = white_noise 1000/9.80665; "
                        "BiasStability = random_walk sqrt(tau), in deg/h and ug (not bias_instability)");
  if (!writer.comments.empty()) head["comments"] = writer.comments;
  Json document = Json::object();
  document["SettingsVersion"] = 1.2;
  document["DefaultSensors"] = {{"Imu", writer.imu}};
  document["sensorchar"] = head;
  out.text = dump_json(document);
  return out;
}

}  // namespace

ExportTarget airsim_target() {
  return {"airsim",
          "AirSim",
          "deg/sqrt(h), mg/sqrt(Hz); the bias is a random walk K = stability / sqrt(tau) in deg/h, ug",
          "settings.json",
          ExportNeeds::gyroscope_or_accelerometer,
          "NK",
          {.bias_tau = true},
          write_airsim};
}

}  // namespace libchar
