// Offsets and noise levels of the sensors, before anything is fused. A level is taken from the
// scene's own figure, else from the sensor's model, else from the stretch at rest. Behind a filter
// the first two are multiplied by what it leaves of white noise, the third is measured there.

#include "libchar/replay/detail/plan/sensor_knowledge.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libchar/core/refusal.hpp"
#include "libchar/core/units.hpp"
#include "libchar/replay/detail/plan/noise_level.hpp"

namespace libchar {

void RestMeter::push(const Eigen::MatrixXd& samples) {
  for (std::size_t i = 0; i < sensors_.size(); ++i) {
    Sums& s = sensors_[i];
    for (Eigen::Index k = 0; k < samples.cols(); ++k) {
      const double y = samples(static_cast<Eigen::Index>(i), k);
      if (!std::isfinite(y)) {
        s.has_last = false;
        continue;
      }
      if (s.samples == 0) s.origin = y;  // an offset must cost no digits
      s.sum += y - s.origin;
      s.squares += (y - s.origin) * (y - s.origin);
      ++s.samples;
      if (s.has_last) {
        s.differences += (y - s.last) * (y - s.last);
        ++s.pairs;
      }
      s.last = y;
      s.has_last = true;
    }
  }
}

std::vector<double> RestMeter::means() const {
  std::vector<double> out;
  for (const Sums& s : sensors_) out.push_back(s.samples > 0 ? s.origin + s.sum / static_cast<double>(s.samples) : 0);
  return out;
}

std::vector<double> RestMeter::noise_variances() const {
  std::vector<double> out;
  for (const Sums& s : sensors_)
    out.push_back(s.pairs > 0 ? s.differences / (2 * static_cast<double>(s.pairs))
                              : std::numeric_limits<double>::quiet_NaN());
  return out;
}

std::vector<double> RestMeter::variances() const {
  std::vector<double> out;
  for (const Sums& s : sensors_) {
    const auto n = static_cast<double>(s.samples);
    out.push_back(n > 1 ? std::max(0.0, (s.squares - s.sum * s.sum / n) / (n - 1))
                        : std::numeric_limits<double>::quiet_NaN());
  }
  return out;
}

namespace {

constexpr std::size_t kRestBlock = 4096;

RestMeter at_rest(const Scene& scene, const Instants& instants, Progress& progress) {
  RestMeter meter(scene.sensors.size());
  const std::int64_t from = std::max(instants.instant_at(scene.rest->from_s), instants.settled()),
                     to = instants.instant_at(scene.rest->to_s);
  if (to - from < 2)
    throw input_error("E0903", scene.file)
        .says("rest: the window holds fewer than two instants of the recording")
        .hint(instants.settled() > 0 ? "the filter has to settle first" : "");
  instants.pass(from, to, kRestBlock, progress, [&](const InstantBlock& b) { meter.push(b.samples); });
  return meter;
}

}  // namespace

double model_factor(const Scene& scene, const Instants& instants, std::size_t sensor) {
  const SensorModel& model = *scene.sensors[sensor].model;
  const std::string& own = model.sensitivity.unit.empty() ? model.unit : model.sensitivity.unit;
  const std::string& recorded = instants.source().info().units[sensor];
  if (const auto factor = unit_factor(own, recorded)) return *factor;
  throw usage_error("E0938", scene.sensors[sensor].name)
      .says("its model is in " + own + ", and it is recorded in " + recorded)
      .hint("give it the model of such a sensor");
}

SensorKnowledge know_sensors(const Scene& scene, const Instants& instants, Progress& progress) {
  SensorKnowledge out;
  const std::size_t n = scene.sensors.size();
  out.offsets.assign(n, 0);
  out.noise_variances.assign(n, kMissing);
  out.noise_sources.assign(n, "");
  if (scene.rest) {
    const RestMeter rest = at_rest(scene, instants, progress);
    out.offsets = rest.means();
    out.noise_variances = scene.preparation.filters() ? rest.variances() : rest.noise_variances();
    out.noise_sources.assign(n, "rest");
    // Gravity is no offset.
    if (scene.tilt) out.offsets[scene.tilt->accelerometer_x] = out.offsets[scene.tilt->accelerometer_z] = 0;
  }
  const InstantsInfo& info = instants.info();
  for (std::size_t i = 0; i < n; ++i) {
    const SceneSensor& sensor = scene.sensors[i];
    const double to_fused =
        instants.factor(i) * instants.factor(i) * instants.noise_gain() / static_cast<double>(info.averaged);
    if (sensor.noise) {
      out.noise_variances[i] = *sensor.noise * *sensor.noise * to_fused;
      out.noise_sources[i] = "the scene";
    } else if (sensor.model) {
      const double scale = std::pow(sensor.scale * model_factor(scene, instants, i), 2);
      const std::uint64_t oversampling = scene.simulate    ? scene.simulate->oversampling
                                         : scene.simulated ? scene.simulated->oversampling
                                                           : 1;
      const double variance = sample_noise_variance(*sensor.model, instants.source().info().rate_hz, oversampling);
      if (variance > 0) {
        out.noise_variances[i] = variance * scale * to_fused;
        out.noise_sources[i] = "the models";
      }
    }
    if (!(out.noise_variances[i] > 0)) out.noise_sources[i].clear();
  }
  return out;
}

}  // namespace libchar
