// Kalibr: continuous densities in SI units, one for three axes, with update_rate and rostopic, at the top or below
// imu0. imu_utils of 2018: gyr_n, acc_n are sqrt(f) times the Allan deviation at 1 s, that of a sample; gyr_w, acc_w
// are the lowest Allan deviation, which is the floor of bias instability and no random walk (gaowenliang/imu_utils,
// src/fitallan_gyr.cpp). A fork writes N and K under the same keys. The file says neither which nor f: a line has to.
#include <cmath>
#include <numbers>

#include "libchar/core/document/schema.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/model/model_file.hpp"

namespace libchar::detail {
namespace {

const Document* below(const Document& document, std::string_view key) {
  const DocumentEntry* const entry = document.kind == Document::Kind::map ? document.find(std::string(key)) : nullptr;
  return entry == nullptr ? nullptr : &entry->value;
}

const Document* kalibr_part(const Document& document) {
  for (const Document* part : {&document, below(document, "imu0")})
    if (part != nullptr &&
        (below(*part, "gyroscope_noise_density") != nullptr || below(*part, "accelerometer_noise_density") != nullptr))
      return part;
  return nullptr;
}

bool is_of_imu_utils(const Document& document) {
  for (const char* sensor : {"Gyr", "Acc"})
    for (const char* axis : {"avg-axis", "x-axis"})
      if (const Document* part = below(document, sensor); part != nullptr && below(*part, axis) != nullptr) return true;
  return false;
}

Coefficient given(double value) {
  Coefficient out;
  out.status = Status::given;
  out.value = value;
  return out;
}

SensorModel stated(const std::string& channel, bool gyroscope, const std::string& program, const std::string& file) {
  SensorModel out;
  out.channel = channel;
  out.unit = gyroscope ? "rad/s" : "m/s²";
  out.kind = gyroscope ? "gyroscope" : "accelerometer";
  out.obtained = program + " (" + file + ")";
  return out;
}

std::vector<SensorModel> of_kalibr(const MapReader& at, const std::string& file) {
  std::vector<SensorModel> out;
  for (const char* sensor : {"gyroscope", "accelerometer"}) {
    const std::string name = sensor;
    if (!at.has(name + "_noise_density")) continue;
    SensorModel& model = out.emplace_back(stated(name, name == "gyroscope", "Kalibr's file", file));
    model.rate_hz = at.number_or("update_rate", 0);
    model.recording.topic = at.text_or("rostopic", "");
    model.noise[0] = given(at.number(name + "_noise_density"));
    if (at.has(name + "_random_walk"))
      model.noise[static_cast<std::size_t>(Term::walk)] = given(at.number(name + "_random_walk"));
  }
  return out;
}

/// The lowest Allan deviation of bias instability B is B sqrt(2 ln 2 / pi).
double instability_of_floor(double floor) { return floor / std::sqrt(2 * std::numbers::ln2 / std::numbers::pi); }

/// One axis of imu_utils; `rate_hz` 0: densities.
SensorModel of_axis(const MapReader& one, const std::string& key, const std::string& axis, double rate_hz,
                    const std::string& file) {
  SensorModel out = stated(axis.empty() ? key : key + "_" + axis, key == "gyr", "imu_utils", file);
  out.axis = axis;
  out.rate_hz = rate_hz;
  out.noise[0] = given(one.number(key + "_n") / (rate_hz > 0 ? std::sqrt(rate_hz) : 1));
  const double slow = one.number(key + "_w");
  if (rate_hz == 0) {
    out.noise[static_cast<std::size_t>(Term::walk)] = given(slow);
    return out;
  }
  out.noise[static_cast<std::size_t>(Term::flicker)] = given(instability_of_floor(slow));
  out.remarks.push_back(key + "_w is the lowest Allan deviation: read as bias instability, not as a random walk");
  return out;
}

/// The mean of the axes stands in only for a sensor whose axes are not in the file.
std::vector<SensorModel> of_imu_utils(const MapReader& at, const std::string& file) {
  const bool densities = at.has("densities");
  if (densities == at.has("rate_hz"))
    throw input_error("E0588", file)
        .says("versions of imu_utils write different numbers under one name, and the file does not say which")
        .hint(
            "add a line rate_hz: 200 (the rate) where gyr_n is the noise of a sample, as the version of 2018 writes "
            "it, or densities: true for the fork that writes densities");
  const double rate_hz = at.number_or("rate_hz", 0);
  std::vector<SensorModel> out;
  for (const auto& [part, key] : {std::pair{"Gyr", "gyr"}, std::pair{"Acc", "acc"}}) {
    if (!at.has(part)) continue;
    const MapReader sensor = at.map(part);
    const std::size_t before = out.size();
    for (const std::string axis : {"x", "y", "z"})
      if (sensor.has(axis + "-axis")) out.push_back(of_axis(sensor.map(axis + "-axis"), key, axis, rate_hz, file));
    if (out.size() == before && sensor.has("avg-axis"))
      out.push_back(of_axis(sensor.map("avg-axis"), key, "", rate_hz, file));
  }
  return out;
}

}  // namespace

bool holds_models(const Document& document) {
  if (document.kind == Document::Kind::list) return true;
  const Document* const format = below(document, "format");
  if (format != nullptr && format->kind == Document::Kind::text)
    return format->text == "sensor-model" || format->text == "sensor-models";
  return kalibr_part(document) != nullptr || is_of_imu_utils(document);
}

std::vector<SensorModel> foreign_models(const Document& document, const std::string& file) {
  if (below(document, "format") != nullptr) return {};
  if (const Document* const part = kalibr_part(document)) return of_kalibr(MapReader(*part, file, ""), file);
  if (is_of_imu_utils(document)) return of_imu_utils(MapReader(document, file, ""), file);
  return {};
}

}  // namespace libchar::detail
