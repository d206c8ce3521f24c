#include "libchar/characterize/model_from_fit.hpp"

#include <algorithm>
#include <cmath>

#include "libchar/characterize/judgement.hpp"

namespace libchar {
namespace {

// The recording reached an end of its range when runs of samples stand there; which end, its extremes say.
void set_saturation(SensorModel& model, const ChannelQuality& quality) {
  if (quality.saturated == 0 || quality.samples == 0) return;
  model.saturation_low = quality.minimum;
  model.saturation_high = quality.maximum;
}

void set_tau_range(SensorModel& model, const AllanCurve& allan) {
  for (const AllanPoint& point : allan.points) {
    if (!point.reliable) continue;
    if (model.tau_min_s == 0) model.tau_min_s = point.tau_s;
    model.tau_max_s = std::max(model.tau_max_s, point.tau_s);
  }
}

GaussMarkovNoise process_of(const NoiseFit& fit) {
  if (!fit.gauss_markov || !fit.gauss_markov->in_model) return {};
  const Coefficient &sigma = fit.gauss_markov->sigma, &tau = fit.gauss_markov->tau_s;
  GaussMarkovNoise out{*sigma.value, *tau.value, {sigma.ci95.low, sigma.ci95.high}, {tau.ci95.low}, sigma.status};
  if (std::isfinite(tau.ci95.high)) out.tau_ci95_s.push_back(tau.ci95.high);
  return out;
}

DeterministicTerm deterministic_of(const Event& event) {
  using Kind = DeterministicTerm::Kind;
  DeterministicTerm term;
  term.kind = event.kind == EventKind::step      ? Kind::step
              : event.kind == EventKind::warm_up ? Kind::warm_up
                                                 : Kind::ramp;
  term.size = event.size;
  term.sd = event.sd;
  if (event.kind == EventKind::step) term.at_s = event.at_s;
  if (event.kind == EventKind::warm_up) term.tau_s = event.tau_s;
  if (event.kind == EventKind::ramp) term.per_s = event.slope;
  return term;
}

// About the mean temperature of the recording, so that the bias there is the recording's mean.
void set_temperature_terms(SensorModel& model, const TemperatureEffect& effect) {
  constexpr double kZeroCelsius = 273.15;
  model.bias.tc1_per_k = effect.coefficient[0];
  model.bias.tc2_per_k2 = effect.coefficient[1];
  model.bias.tc3_per_k3 = effect.coefficient[2];
  model.bias.lag_s = effect.lag_s;
  model.reference_temperature_degc = effect.mean - (effect.unit == "K" ? kZeroCelsius : 0);
}

void set_means(SensorModel& model, const NoiseFit& fit) {
  for (const Event& event : fit.events) model.deterministic.push_back(deterministic_of(event));
  if (fit.temperature && fit.temperature->order > 0) set_temperature_terms(model, *fit.temperature);
}

void add_findings_of(const LogInfo& log, SensorModel& model) {
  detail::add_findings_of(log.warnings, model.findings);
  model.findings = worst_first(std::move(model.findings));
}

}  // namespace

SensorModel sensor_model_from_curve(const Channel& channel, const NoiseFit& fit, const std::string& obtained,
                                    const LogInfo& source) {
  SensorModel model;
  model.channel = channel.name;
  model.unit = channel.unit;
  model.rate_hz = fit.rate_hz;
  model.noise = fit.term;
  model.gauss_markov = process_of(fit);
  model.flicker_phase = fit.flicker_phase ? fit.flicker_phase->value.value_or(0) : 0;
  model.noise_shape = fit.shape;
  model.bandwidth_hz = fit.bandwidth_hz;
  model.obtained = obtained;
  model.method = fit.search.method;
  model.recording.file = source.file;
  model.recording.sha256 = source.sha256;
  if (source.topic.starts_with('/')) model.recording.topic = source.topic;
  model.duration_s = fit.duration_s;
  model.stretch_s = source.stretch_s;
  set_means(model, fit);
  model.findings = fit.findings;
  add_findings_of(source, model);
  return model;
}

SensorModel sensor_model_from(const ChannelResult& channel, const LogInfo& log) {
  const NoiseFit& fit = channel.fit.value();
  SensorModel model = sensor_model_from_curve(channel.channel, fit, "fit of a recording", log);
  if (const double rate_hz = log.rate_hz_of(channel.channel); rate_hz > 0) model.rate_hz = rate_hz;
  model.resolution = channel.quality.resolution;
  set_saturation(model, channel.quality);
  model.mean = channel.quality.mean;
  set_tau_range(model, channel.allan);
  for (const Remedy& remedy : fit.remedies) {
    const std::string remark = remedy.kind + ": " + remedy.action;
    if (std::find(model.remarks.begin(), model.remarks.end(), remark) == model.remarks.end())
      model.remarks.push_back(remark);
  }
  model.findings = judge(channel).findings;
  add_findings_of(log, model);
  return model;
}

}  // namespace libchar
