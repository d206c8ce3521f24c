#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "libchar/core/not_known.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/fusion/registry.hpp"
#include "libchar/replay/view/words.hpp"
#include "libchar/report/detail/report_rows.hpp"
#include "libchar/report/replay/replay_text.hpp"

namespace libchar {
namespace {

// Tracks are looked at: six digits, or they would be most of the file.
constexpr int kDigitsOfTrack = 6, kDigitsOfTime = 10;

void round_all(std::vector<double>& values, int digits) {
  for (double& value : values)
    if (std::isfinite(value)) value = rounded(value, digits);
}

// Four digits of the range that is drawn: pressures of 101325 Pa that differ by 1 Pa are told apart.
int digits_of(const Timeline& track) {
  double low = kNone, high = kNone;
  for (const auto* side : {&track.low, &track.high})
    for (const auto& series : *side)
      for (const double v : series) {
        low = std::fmin(low, v);
        high = std::fmax(high, v);
      }
  const double largest = std::fmax(std::fabs(low), std::fabs(high));
  return high > low && std::isfinite(largest / (high - low))
             ? 4 + clamped_whole(std::ceil(std::log10(largest / (high - low))), 0, 11)
             : kDigitsOfTrack;
}

Timeline rounded_track(Timeline track, int digits, int digits_of_time = kDigitsOfTime) {
  round_all(track.time_s, digits_of_time);
  for (auto* side : {&track.low, &track.high})
    for (auto& series : *side) round_all(series, digits);
  return track;
}

Timeline drawn(const Timeline& track) { return rounded_track(track, kDigitsOfTrack, kDigitsOfTrack); }

// One series of a run.
Timeline close(const Timeline& track) { return rounded_track(track, digits_of(track)); }

ReplayReport::Stretch stretch_of(const RunStretch& run, const Timeline& deviations) {
  ReplayReport::Stretch out;
  for (const InputTracks& input : run.inputs)
    out.inputs.push_back({close(input.reference), close(input.estimate), close(input.error)});
  out.time_s = out.inputs[0].estimate.time_s;
  out.sensor = close(run.sensor);
  out.sensor_error = close(run.sensor_error);
  out.deviations = close(deviations);
  return out;
}

ReplayReport::Stretch run_of(const ReplayView& view) {
  const RunTracks& tracks = view.result->tracks;
  ReplayReport::Stretch out = stretch_of(tracks.whole, view.run.deviations);
  out.method = view.run.method;
  out.sensor_name = view.run.sensor;
  for (std::size_t i = 0; i < tracks.close_ups.size(); ++i) {
    const CloseUp& one = tracks.close_ups[i];
    ReplayReport::Stretch& added = out.close_ups.emplace_back(stretch_of(one.run, one.run.deviations));
    added.label = view.run.close_ups[i];
    added.from_s = one.from_s;
    added.to_s = one.to_s;
  }
  return out;
}

std::string sensor_name(const ReplayResult& result, std::size_t sensor) {
  return sensor < result.sensors.size() ? result.sensors[sensor].name : "";
}

// Without a reference there is no error to take the mean square of: see without_reference.
void leave_out_unknown(ReplayReport::Algorithm& out, bool has_reference) {
  if (!has_reference) {
    out.rmse = kNone;
    out.rmse_ci95 = {kNone, kNone};
  }
  if (out.ran) out.why.clear();
  if (!out.ran) out.availability = out.learning_s = kNone;
}

ReplayReport::Algorithm algorithm_of(const ReplayResult& result, const AlgorithmView& view) {
  ReplayReport::Algorithm out(*view.result);
  leave_out_unknown(out, result.has_reference);
  const fusion::Description& description = *out.description;
  out.name = description.name;
  out.title = description.title;
  out.source = description.source;
  out.complexity = description.complexity;
  out.learning_complexity = description.learning_complexity;
  out.needs = view.needs;
  out.learns = view.learns;
  out.accepts_missing = description.needs.accepts_missing;
  for (const FoundFault& fault : out.faults)
    out.found.push_back({sensor_name(result, detail::in_memory(fault.sensor)), fault.kind, kNone, fault.from_s,
                         fault.to_s.value_or(kNone)});
  out.out_share = view.out_share;
  for (std::size_t k = 0; k < out.settings.table().size(); ++k)
    out.options.emplace_back(out.settings.table()[k].name, out.settings.values()[k]);
  out.on_time_front = view.on_time_front;
  out.on_memory_front = view.on_memory_front;
  for (std::size_t j = 0; j < out.inputs.size(); ++j) {
    out.inputs[j].name = result.inputs[j].name;
    out.inputs[j].unit = result.inputs[j].unit;
    out.inputs[j].window_rms = drawn(out.inputs[j].window_rms);
  }
  out.weight_track = drawn(view.weight_track);
  out.variance_track = drawn(view.variance_track);
  return out;
}

ReplayReport::Sensor channel_of(const ReplayResult& result, std::size_t i) {
  const fusion::ChannelAlignment& c = result.alignment->learnt.channels[i];
  ReplayReport::Sensor out{result.sensors[i].name,
                           c.used,
                           {c.delay / result.rate_hz, c.delay_se / result.rate_hz},
                           {c.bias, c.bias_se},
                           {c.gain, c.gain_se},
                           {},
                           result.alignment->learnt.limits[i],
                           {}};
  for (std::size_t k = 0; k < c.cross.size(); ++k) out.cross.push_back({c.cross[k], c.cross_se[k]});
  return out;
}

ReplayReport::Alignment alignment_of(const ReplayResult& result) {
  ReplayReport::Alignment out{*result.alignment, {}, {}};
  for (std::size_t i = 0; i < out.learnt.channels.size(); ++i) out.sensors.push_back(channel_of(result, i));
  for (std::size_t k = 0; k < out.budget.channels.size(); ++k) {
    ReplayReport::Sensor& sensor = out.budgeted_sensors.emplace_back();
    sensor.sensor = result.sensors[out.budgeted[k]].name;
    sensor.budget = out.budget.channels[k];
  }
  return out;
}

ReplayReport::Reference reference_of(const ReplayResult& result) {
  ReplayReport::Reference out;
  out.use = result.reference_use;
  out.lag_s = result.lag_s;
  out.lag_estimated = result.lag_estimated;
  if (const auto& reference = result.scene.reference) {
    out.channels = reference->channels;
    out.mean = reference->mean;
    out.offset = reference->offset;
  }
  if (const auto& found = result.reference_offset) {
    out.offset_estimated = true;
    out.offset = found->value;
    out.offset_ci95 = found->ci95;
    out.offset_window = found->window;
    out.offset_drifts = found->drifts;
  }
  return out;
}

std::string paragraph(const std::vector<std::string>& sentences) {
  return fmt::format("{}", fmt::join(sentences, " "));
}

void add_facts(ReplayReport& out, const ReplayView& view) {
  const ReplayResult& result = *view.result;
  const Scene& scene = result.scene;
  out.scene = {scene.name, scene.file, scene.simulate.has_value(), scene.simulate ? scene.simulate->seed : 0,
               view.simulation_identity};
  if (result.has_reference) out.reference = reference_of(result);
  out.preparation = scene.preparation;
  if (result.alignment) out.alignment = alignment_of(result);
  for (const SensorFault& fault : result.faults)
    out.faults.push_back({sensor_name(result, detail::in_memory(fault.sensor)), std::string(name_of(fault.kind)),
                          fault.value, fault.from_s, fault.to_s});
}

}  // namespace

ReplayReport replay_report(const ReplayView& view) {
  const ReplayResult& result = *view.result;
  ReplayReport out;
  static_cast<ReplayFacts&>(out) = result;
  out.verdict = paragraph(view.steady_verdict);
  out.verdict_with_costs = paragraph(view.verdict);
  add_facts(out, view);
  if (result.best) out.best = result.algorithms[*result.best].label;
  if (result.best_sensor) out.best_sensor = result.sensors[*result.best_sensor].name;
  for (const AlgorithmView* algorithm : view.ranked) out.ranked.push_back(algorithm->result->label);
  out.marks = view.run.marks;
  if (view.figures.run) out.run = run_of(view);
  for (const AlgorithmView& algorithm : view.algorithms) out.algorithms.push_back(algorithm_of(result, algorithm));
  return out;
}

Json replay_json(const ReplayView& view) {
  const ReplayResult& result = *view.result;
  std::vector<const LogInfo*> logs;
  for (const LogInfo& log : result.logs) logs.push_back(&log);
  LogInfo scene;
  scene.file = result.scene.file;
  scene.sha256 = result.scene.sha256;
  scene.bytes = result.scene.bytes;
  if (!scene.sha256.empty()) logs.push_back(&scene);
  Json out = document_head("replay-report", result.command, logs, result.warnings);
  out["config"] = json_of(result.settings);
  out.update(document_of(ReplayReport::fields(), replay_report(view)));
  out["measured"] = {{"seconds", json_number(result.seconds)},
                     {"passes", result.work.passes},
                     {"instants_learnt", result.work.learnt},
                     {"instants_fused", result.work.steps},
                     {"instants_without_reference", result.work.blind_steps},
                     {"work", work_json(result.counted)}};
  return out;
}

Json replay_json(const ReplayResult& result) { return replay_json(replay_view(result)); }

const Fields<fusion::Entry>& algorithm_entry_fields() {
  using T = fusion::Entry;
  using O = fusion::Option;
  static const Fields<O> options = always(Fields<O>{
      computed<[](const O& o) { return o.name; }>("name"),
      computed<[](const O& o) { return o.unit; }>("unit"),
      field<&O::standard>("standard"),
      field<&O::low>("low"),
      field<&O::high>("high"),
      field<&O::whole>("whole"),
      computed<[](const O& o) { return o.meaning; }>("meaning"),
  });
  static const Fields<T> rows = always(Fields<T>{
      computed<[](const T& e) { return e.description->name; }>("name"),
      computed<[](const T& e) { return e.description->title; }>("title"),
      computed<[](const T& e) { return e.description->source; }>("source"),
      computed<[](const T& e) { return e.description->complexity; }>("complexity"),
      computed<[](const T& e) { return e.description->learning_complexity; }>("learning_complexity"),
      computed<[](const T& e) { return needs_in_words(*e.description); }>("needs"),
      computed<[](const T& e) { return e.description->needs.accepts_missing; }>("accepts_missing"),
      computed_list<[](const T& e) { return e.options; }>("options", options),
  });
  return rows;
}

Json algorithms_json() {
  Json out = Json::array();
  for (const fusion::Entry& entry : fusion::algorithms()) out.push_back(document_of(algorithm_entry_fields(), entry));
  return out;
}

}  // namespace libchar
