#include "libchar/replay/detail/learnt_fusion.hpp"

#include <algorithm>
#include <cmath>

namespace libchar {
namespace {

LearntAlignment learnt_alignment(const SceneAlignment& alignment, std::size_t sensor) {
  const fusion::ChannelAlignment& channel = alignment.alignment.channels[sensor];
  LearntAlignment out{channel.delay, channel.bias, channel.gain, channel.cross, {}, {}};
  const std::vector<fusion::ChannelLimits>& limits = alignment.alignment.limits;
  bool any = false;
  for (std::size_t k = sensor; k < limits.size(); k += alignment.alignment.channels.size()) {
    out.low.push_back(std::max(limits[k].low, -kNoLimit));
    out.high.push_back(std::min(limits[k].high, kNoLimit));
    any = any || out.low.back() > -kNoLimit || out.high.back() < kNoLimit;
  }
  if (!any) out.low = out.high = {};
  return out;
}

void add_noise(const fusion::Array& array, std::size_t i, LearntSensor& sensor) {
  const auto row = static_cast<Eigen::Index>(i);
  if (array.noise_levels.size() > 0 && array.noise_levels[row] > 0) sensor.noise_variance = array.noise_levels[row];
  if (array.noise_models.empty()) return;
  const fusion::NoiseModel& model = array.noise_models[i];
  sensor.flicker = model.flicker;
  sensor.walk = model.walk;
  for (const fusion::RememberedNoise& process : model.gauss_markov) {
    sensor.gauss_markov_sigma.push_back(process.sigma);
    sensor.gauss_markov_tau_s.push_back(process.tau_s);
  }
}

fusion::NoiseModel noise_model_of(const LearntSensor& sensor) {
  fusion::NoiseModel out{*sensor.noise_variance, *sensor.flicker, *sensor.walk, {}};
  for (std::size_t k = 0; k < sensor.gauss_markov_sigma.size(); ++k)
    out.gauss_markov.push_back({sensor.gauss_markov_sigma[k], sensor.gauss_markov_tau_s[k]});
  return out;
}

fusion::ChannelLimits limits_of_row(const LearntAlignment& alignment, std::size_t axis) {
  fusion::ChannelLimits out;
  if (axis < alignment.low.size() && alignment.low[axis] > -kNoLimit) out.low = alignment.low[axis];
  if (axis < alignment.high.size() && alignment.high[axis] < kNoLimit) out.high = alignment.high[axis];
  return out;
}

// From the numbers and the unit that the log has to those that are fused, whatever the reader made of
// them. The further axes of a device are as the reader made them, and so is its own.
void set_units(const SourceInfo& source, const Scene& scene, const std::string& read_in, LearntSensor& out) {
  std::string stated = scene.reading.units.empty() ? read_in : "";
  double factor = 1;
  if (!source.logs.empty() && out.cross.empty())
    for (const Channel& channel : source.logs[0].channels)
      if (channel.name == out.channel && !channel.stated.empty()) {
        stated = channel.stated;
        factor = channel.factor;
      }
  out.recorded_unit = stated;
  if (out.unit.empty() && stated != read_in && (std::abs(out.scale) == 1 || scene.tilt)) out.unit = read_in;
  out.scale *= factor;
}

LearntSensor learnt_sensor(const Scene& scene, const ReplayPlan& plan, const Instants& instants,
                           const Eigen::MatrixXd& h, std::size_t i) {
  const SceneSensor& from = scene.sensors[i];
  const auto row = static_cast<Eigen::Index>(i);
  LearntSensor out;
  out.name = from.name;
  out.channel = from.channel;
  out.unit = from.unit;
  out.scale = from.scale;
  out.cross = from.cross;
  const SourceInfo& source = instants.source().info();
  set_units(source, scene, source.units[i], out);
  if (!scene.tilt && instants.factor(i) != 1) {
    out.scale *= instants.factor(i);
    out.unit = instants.info().units[i];
  }
  if (!scene.tilt) out.h.assign(h.row(row).begin(), h.row(row).end());
  add_noise(plan.array, i, out);
  out.left_out = !plan.live.empty() && std::find(plan.live.begin(), plan.live.end(), row) == plan.live.end();
  return out;
}

}  // namespace

LearntFusion learnt_of(const Scene& scene, const ReplayPlan& plan, const Instants& instants,
                       const SensorKnowledge& knowledge, const SceneAlignment* alignment) {
  LearntFusion out;
  const InstantsInfo& info = instants.info();
  out.name = scene.name;
  for (const LogInfo& log : info.logs) out.learnt_from.push_back({log.file, log.sha256});
  out.rate_hz = info.rate_hz;
  if (info.averaged > 1) out.average_s = 1 / info.rate_hz;
  out.resample_hz = scene.resample_hz;
  out.preparation = scene.preparation;
  out.learning_instants = static_cast<std::uint64_t>(plan.array.learning_samples);
  out.fault_free_s = static_cast<double>(plan.array.fault_free_samples) / info.rate_hz;
  for (std::size_t j = 0; j < info.input_names.size(); ++j)
    out.inputs.push_back({knowledge.common, info.input_names[j], info.input_units[j], {}});
  if (const double offset = instants.reference_offset(); offset != 0)
    out.inputs[0].reference_offset = offset * info.output_scale;
  if (scene.tilt)
    out.tilt = {scene.sensors[scene.tilt->gyroscope].name, scene.sensors[scene.tilt->accelerometer_x].name,
                scene.sensors[scene.tilt->accelerometer_z].name};
  const Eigen::MatrixXd h = plan.array.h();
  for (std::size_t i = 0; i < scene.sensors.size(); ++i) {
    out.sensors.push_back(learnt_sensor(scene, plan, instants, h, i));
    out.sensors[i].offset = knowledge.offsets[i];
    if (alignment == nullptr) continue;
    out.sensors[i].cross = scene.sensors[i].cross;
    out.sensors[i].alignment = learnt_alignment(*alignment, i);
  }
  if (alignment != nullptr)
    out.interpolation = alignment->alignment.interpolation == fusion::Interpolation::cubic ? "cubic" : "sinc";
  return out;
}

void note_step_noise(const std::vector<std::optional<StepNoise>>& noise, LearntFusion& learnt) {
  std::size_t next = 0;
  for (LearntSensor& sensor : learnt.sensors) {
    if (sensor.left_out || next == noise.size()) continue;
    if (const auto& one = noise[next++]; one && std::isfinite(std::exp(one->log_variance / 2))) {
      sensor.step_noise = std::exp(one->log_variance / 2);
      sensor.step_noise_error = one->error;
    }
  }
}

void note_readings(const std::vector<std::optional<LearntSensor::Reading>>& readings, LearntFusion& learnt) {
  std::size_t next = 0;
  for (LearntSensor& sensor : learnt.sensors)
    if (!sensor.left_out && next < readings.size()) sensor.reading = readings[next++];
}

fusion::Array array_of(const LearntFusion& learnt) {
  std::vector<const LearntSensor*> given;
  for (const LearntSensor& sensor : learnt.sensors)
    if (!sensor.left_out) given.push_back(&sensor);
  const auto all = [&](auto&& has) { return std::all_of(given.begin(), given.end(), has); };
  fusion::Array out;
  out.channels = static_cast<Eigen::Index>(given.size());
  const bool levels = all([](const auto* s) { return s->noise_variance.has_value(); });
  const bool models = levels && all([](const auto* s) { return s->flicker.has_value(); });
  if (levels) out.noise_levels.resize(out.channels);
  const bool tilt = !learnt.tilt.gyroscope.empty();
  Eigen::MatrixXd h(out.channels, static_cast<Eigen::Index>(learnt.inputs.size()));
  for (Eigen::Index i = 0; i < out.channels; ++i) {
    const LearntSensor& sensor = *given[static_cast<std::size_t>(i)];
    out.names.push_back(sensor.name);
    if (levels) out.noise_levels[i] = *sensor.noise_variance;
    if (models) out.noise_models.push_back(noise_model_of(sensor));
    for (Eigen::Index j = 0; j < h.cols() && !tilt; ++j) h(i, j) = sensor.h[static_cast<std::size_t>(j)];
  }
  if (!tilt && !(h.cols() == 1 && (h.array() == 1).all())) out.observation_matrix = h;
  out.learning_samples = static_cast<std::int64_t>(learnt.learning_instants);
  const auto place = [&](const std::string& name) {
    return std::find_if(given.begin(), given.end(), [&](const auto* s) { return s->name == name; }) - given.begin();
  };
  if (tilt)
    out.tilt = fusion::TiltChannels{place(learnt.tilt.gyroscope), place(learnt.tilt.accelerometer_x),
                                    place(learnt.tilt.accelerometer_z)};
  return out;
}

SceneAlignment alignment_of(const LearntFusion& learnt, const std::vector<std::size_t>& sensors, double rate_hz) {
  SceneAlignment out;
  out.alignment.interpolation =
      learnt.interpolation == "cubic" ? fusion::Interpolation::cubic : fusion::Interpolation::sinc;
  out.h.resize(static_cast<Eigen::Index>(sensors.size()));
  Eigen::Index row = 0;
  for (const std::size_t i : sensors) {
    const LearntSensor& sensor = learnt.sensors[i];
    fusion::ChannelAlignment channel;
    channel.delay = sensor.alignment.delay_samples * (rate_hz / learnt.rate_hz);
    channel.bias = sensor.alignment.bias;
    channel.gain = sensor.alignment.gain;
    channel.cross = sensor.alignment.cross;
    channel.cross.resize(sensor.cross.size(), 0);
    out.alignment.channels.push_back(channel);
    out.h[row++] = sensor.h[0];
  }
  // A row a sensor, then axis by axis.
  const std::size_t axes = learnt.sensors[0].cross.size();
  for (std::size_t axis = 0; axis <= axes; ++axis)
    for (const std::size_t i : sensors)
      out.alignment.limits.push_back(limits_of_row(learnt.sensors[i].alignment, axis));
  return out;
}

}  // namespace libchar
