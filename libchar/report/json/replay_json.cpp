#include "libchar/report/json/replay_json.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "libchar/core/not_known.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/fusion/registry.hpp"
#include "libchar/log/recording_json.hpp"
#include "libchar/replay/view/algorithm_words.hpp"
#include "libchar/replay/view/preparation_words.hpp"
#include "libchar/report/detail/escape.hpp"
#include "libchar/report/detail/html/alignment_pieces.hpp"
#include "libchar/report/detail/json_pieces.hpp"
#include "libchar/report/text/allan_text.hpp"

namespace libchar {
namespace {

Json numbers(const std::vector<double>& values) {
  Json out = Json::array();
  for (const double value : values) out.push_back(json_number(value));
  return out;
}

Json texts(const std::vector<std::string>& values) {
  Json out = Json::array();
  for (const std::string& value : values) out.push_back(json_text(value));
  return out;
}

Json window(const TimeWindow& w) {
  return {{"from_s", json_number(w.from_s)}, {"to_s", json_number(w.to_s)}};
}

// One input: a flat list; several: a row a sensor.
Json weights_json(const std::vector<std::vector<double>>& weights) {
  if (weights.empty()) return nullptr;
  if (weights.size() == 1) return numbers(weights[0]);
  Json out = Json::array();
  for (std::size_t i = 0; i < weights[0].size(); ++i) {
    Json row = Json::array();
    for (const std::vector<double>& of_input : weights) row.push_back(json_number(of_input[i]));
    out.push_back(std::move(row));
  }
  return out;
}

// Tracks are looked at: six digits, or they would be most of the file.
Json drawn(const std::vector<double>& values) {
  Json out = Json::array();
  for (const double value : values)
    out.push_back(std::isfinite(value) ? Json(rounded(value, 6)) : Json(nullptr));
  return out;
}

Json timeline_json(const Timeline& track) {
  if (track.empty()) return nullptr;
  Json low = Json::array(), high = Json::array();
  for (const auto& series : track.low) low.push_back(drawn(series));
  for (const auto& series : track.high) high.push_back(drawn(series));
  return {{"time_s", drawn(track.time_s)}, {"low", std::move(low)}, {"high", std::move(high)}};
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
             ? std::clamp(
                   4 + static_cast<int>(std::ceil(std::log10(largest / (high - low)))), 4, 15)
             : 6;
}

Json drawn_to(const std::vector<double>& values, int digits) {
  Json out = Json::array();
  for (const double value : values)
    out.push_back(std::isfinite(value) ? Json(rounded(value, digits)) : Json(nullptr));
  return out;
}

// One series of a run: its times stand once beside all of them. Where each stretch is one instant,
// smallest and largest are the same.
Json track_json(const Timeline& track) {
  if (track.empty()) return nullptr;
  const int digits = digits_of(track);
  Json low = Json::array(), high = Json::array();
  for (const auto& series : track.low) low.push_back(drawn_to(series, digits));
  for (const auto& series : track.high) high.push_back(drawn_to(series, digits));
  if (low == high) return {{"value", std::move(low)}};
  return {{"low", std::move(low)}, {"high", std::move(high)}};
}

Json stretch_json(const RunStretch& run, const Timeline& deviations) {
  Json inputs = Json::array();
  for (const InputTracks& input : run.inputs)
    inputs.push_back({{"reference", track_json(input.reference)},
                      {"estimate", track_json(input.estimate)},
                      {"error", track_json(input.error)}});
  Json apart = track_json(deviations);
  if (!apart.is_null()) apart["time_s"] = drawn_to(deviations.time_s, 10);
  return {{"time_s", drawn_to(run.inputs[0].estimate.time_s, 10)},
          {"inputs", std::move(inputs)},
          {"sensor_value", track_json(run.sensor)},
          {"sensor_error", track_json(run.sensor_error)},
          {"deviations", std::move(apart)}};
}

Json run_json(const ReplayView& view) {
  if (!view.figures.run) return nullptr;
  const RunTracks& tracks = view.result->tracks;
  const auto text_or_null = [](const std::string& text) {
    return text.empty() ? Json(nullptr) : Json(json_text(text));
  };
  Json out = stretch_json(tracks.whole, view.run.deviations);
  out["method"] = text_or_null(view.run.method);
  out["sensor"] = text_or_null(view.run.sensor);
  out["close_ups"] = Json::array();
  for (std::size_t i = 0; i < tracks.close_ups.size(); ++i) {
    const CloseUp& one = tracks.close_ups[i];
    Json close = stretch_json(one.run, one.run.deviations);
    close["label"] = json_text(view.run.close_ups[i]);
    close["from_s"] = json_number(one.from_s);
    close["to_s"] = json_number(one.to_s);
    out["close_ups"].push_back(std::move(close));
  }
  return out;
}

Json marks_json(const ReplayView& view) {
  Json out = Json::array();
  for (const RunMark& mark : view.run.marks)
    out.push_back(
        {{"kind", mark.kind},
         {"label", json_text(mark.label)},
         {"sensor",
          mark.sensor ? Json(json_text(view.result->sensors[*mark.sensor].name)) : Json()},
         {"from_s", json_number(mark.from_s)},
         {"to_s", json_number(mark.to_s)}});
  return out;
}

Json error_json(const ErrorScore& e) {
  return {{"rmse", json_number(e.rmse)},
          {"rmse_ci95", interval_json(e.rmse_ci95)},
          {"bias", json_number(e.bias)},
          {"bias_ci95", interval_json(e.bias_ci95)},
          {"deviation", json_number(e.deviation)},
          {"maximum", json_number(e.maximum)},
          {"availability", json_number(e.availability)},
          {"samples", e.samples},
          {"stationary", e.stationary},
          {"converged_s", json_number(e.converged_s)}};
}

Json allan_json(const AllanCurve& curve) {
  if (curve.points.empty()) return nullptr;
  Json tau = Json::array(), deviation = Json::array();
  for (const AllanPoint& p : curve.points) {
    tau.push_back(json_number(p.tau_s));
    deviation.push_back(json_number(p.deviation));
  }
  return {{"type", name_of(curve.type)},
          {"tau_s", std::move(tau)},
          {"deviation", std::move(deviation)}};
}

Json inputs_json(const ReplayResult& result, const AlgorithmResult& algorithm) {
  Json out = Json::array();
  for (std::size_t j = 0; j < algorithm.inputs.size(); ++j) {
    const InputScore& input = algorithm.inputs[j];
    Json one = {{"name", json_text(result.inputs[j].name)},
                {"unit", json_text(result.inputs[j].unit)}};
    one.update(error_json(input.error));
    one["optimum_ratio"] = json_number(input.optimum_ratio);
    one["allan"] = allan_json(input.allan);
    one["window_rms"] = timeline_json(input.window_rms);
    out.push_back(std::move(one));
  }
  return out;
}

Json blind_json(const std::optional<BlindScore>& blind) {
  if (!blind) return nullptr;
  return {{"share", json_number(blind->share)},
          {"leave_one_out_rms", json_number(blind->leave_one_out_rms)},
          {"leave_one_out_ci95", interval_json(blind->leave_one_out_ci95)},
          {"leave_one_out", numbers(blind->leave_one_out)},
          {"predictive_rms", json_number(blind->predictive_rms)},
          {"predictive_ci95", interval_json(blind->predictive_ci95)},
          {"offset_share", json_number(blind->offset_share)},
          {"split_array_rms", json_number(blind->split_rms)}};
}

Json options_json(const fusion::Settings& settings) {
  Json out = Json::object();
  for (std::size_t k = 0; k < settings.table().size(); ++k)
    out[std::string(settings.table()[k].name)] = json_number(settings.values()[k]);
  return out;
}

std::string sensor_name(const ReplayResult& result, std::size_t sensor) {
  return sensor < result.sensors.size() ? json_text(result.sensors[sensor].name) : "";
}

Json faults_json(const ReplayResult& result, const AlgorithmResult& algorithm) {
  Json out = Json::array();
  for (const FoundFault& fault : algorithm.faults)
    out.push_back({{"sensor", sensor_name(result, fault.sensor)},
                   {"kind", json_text(fault.kind)},
                   {"from_s", json_number(fault.from_s)},
                   {"to_s", json_number(fault.to_s)}});
  return out;
}

Json answers_json(const std::vector<FaultAnswer>& answers) {
  Json out = Json::array();
  for (const FaultAnswer& answer : answers)
    out.push_back({{"fault", answer.fault},
                   {"found_after_s", json_number(answer.found_s)},
                   {"returned_after_s", json_number(answer.returned_s)}});
  return out;
}

Json algorithm_json(const ReplayResult& result, const AlgorithmView& view) {
  const AlgorithmResult& a = *view.result;
  // Without a reference there is no error to take the mean square of: see without_reference.
  const bool errors = result.has_reference;
  Json out = {
      {"name", std::string(a.description->name)},
      {"label", json_text(a.label)},
      {"status", a.ran ? "ran" : "skipped"},
      {"why", a.ran ? Json(nullptr) : Json(json_text(a.why))},
      {"bound", a.bound},
      {"rmse", errors ? json_number(a.rmse) : Json(nullptr)},
      {"rmse_ci95", errors ? interval_json(a.rmse_ci95) : Json(nullptr)},
      {"regret", json_number(a.regret)},
      {"as_good_as_best", a.as_good_as_best},
      {"ratio_to_best_ci95", a.ratio_to_best ? interval_json(*a.ratio_to_best) : Json(nullptr)},
      {"availability", a.ran ? json_number(a.availability) : Json(nullptr)},
      {"ns_per_sample", json_number(a.ns_per_sample)},
      {"learning_s", a.ran ? json_number(a.learning_s) : Json(nullptr)},
      {"peak_bytes", a.peak_bytes ? Json(*a.peak_bytes) : Json(nullptr)},
      {"weights", weights_json(a.weights)},
      {"variances", a.variances.empty() ? Json(nullptr) : numbers(a.variances)},
      {"faults", faults_json(result, a)},
      {"faults_not_kept", a.faults_not_kept},
      {"watches_faults", a.watches_faults},
      {"answers", a.watches_faults ? answers_json(a.answers) : Json(nullptr)},
      {"out_share", a.watches_faults ? numbers(view.out_share) : Json(nullptr)},
      {"weight_distance", json_number(a.weight_distance)},
      {"variance_error", json_number(a.variance_error)},
      {"inputs", inputs_json(result, a)},
      {"without_reference", blind_json(a.blind)},
      {"weight_track", timeline_json(view.weight_track)},
      {"variance_track", timeline_json(view.variance_track)},
      {"remarks", warnings_json(a.remarks)},
      {"options", options_json(a.settings)}};
  out["description"] = {{"title", std::string(a.description->title)},
                        {"source", std::string(a.description->source)},
                        {"needs", texts(view.needs)},
                        {"learns_from_reference", view.learns},
                        {"accepts_missing", a.description->needs.accepts_missing},
                        {"complexity", std::string(a.description->complexity)},
                        {"learning_complexity", std::string(a.description->learning_complexity)}};
  out["on_front"] = {{"time", view.on_time_front}, {"memory", view.on_memory_front}};
  return out;
}

Json sensors_json(const ReplayResult& result) {
  Json out = Json::array();
  for (const SensorResult& s : result.sensors) {
    Json one = {{"name", json_text(s.name)}, {"unit", json_text(s.unit)}};
    one.update(error_json(s.error));
    one.erase("availability");
    one.erase("converged_s");
    one["missing"] = json_number(s.missing);
    one["constant"] = s.constant;
    if (s.copy_of) one["copy_of"] = json_text(result.sensors[*s.copy_of].name);
    one["offset"] = json_number(s.offset);
    one["noise_variance"] = json_number(s.noise_variance);
    one["noise_source"] = s.noise_source.empty() ? Json(nullptr) : Json(json_text(s.noise_source));
    one["h"] = numbers(s.h);
    out.push_back(std::move(one));
  }
  return out;
}

Json scene_json(const ReplayView& view) {
  const Scene& scene = view.result->scene;
  Json out = {{"name", json_text(scene.name)},
              {"file", json_text(scene.file)},
              {"simulated", scene.simulate.has_value()}};
  if (scene.simulate) {
    out["seed"] = scene.simulate->seed;
    out["identity"] = view.simulation_identity;
  }
  return out;
}

Json paragraph(const std::vector<std::string>& sentences) {
  return json_text(fmt::format("{}", fmt::join(sentences, " ")));
}

Json known_faults_json(const ReplayResult& result) {
  Json out = Json::array();
  for (const SensorFault& fault : result.faults)
    out.push_back({{"sensor", sensor_name(result, fault.sensor)},
                   {"kind", std::string(name_of(fault.kind))},
                   {"value", json_number(fault.value)},
                   {"from_s", json_number(fault.from_s)},
                   {"to_s", json_number(fault.to_s)}});
  return out;
}

Json detection_json(const ReplayResult& result) {
  Json out = Json::array();
  for (const DetectionAt& at : result.detection)
    out.push_back({{"false_alarm_s", json_number(at.false_alarm_s)},
                   {"answers", answers_json(at.answers)},
                   {"alarms_without_fault", at.alarms_without_fault}});
  return out;
}

Json reference_json(const ReplayResult& result) {
  if (!result.has_reference) return nullptr;
  Json out = {{"use", json_text(result.reference_use)},
              {"channels", Json::array()},
              {"mean", false},
              {"lag_s", json_number(result.lag_s)},
              {"lag_estimated", result.lag_estimated},
              {"offset", 0.0},
              {"offset_estimated", result.reference_offset.has_value()}};
  if (result.reference_offset) {
    const FoundOffset& offset = *result.reference_offset;
    out["offset"] = json_number(offset.value);
    out["offset_ci95"] = interval_json(offset.ci95);
    out["offset_window"] = window(offset.window);
    out["offset_drifts"] = offset.drifts;
  } else if (result.scene.reference) {
    out["offset"] = json_number(result.scene.reference->offset);
  }
  if (result.scene.reference) {
    out["channels"] = texts(result.scene.reference->channels);
    out["mean"] = result.scene.reference->mean;
  }
  return out;
}

// null: nothing was done to the samples.
Json preparation_json(const ScenePreparation& p) {
  if (!p.filters() && p.detrend == "none") return nullptr;
  return {{"detrend", p.detrend},
          {"high_pass_hz", p.filters() ? json_number(p.from_hz) : Json(nullptr)},
          {"low_pass_hz", p.to_hz > 0 ? json_number(p.to_hz) : Json(nullptr)},
          {"order", p.filters() ? Json(2) : Json(nullptr)},
          {"settling_s", json_number(settling_s(p))}};
}

void add_run(Json& out, const ReplayResult& result) {
  out["rate_hz"] = json_number(result.rate_hz);
  out["instants"] = result.instants;
  out["start_s"] = json_number(result.start_s);
  out["scored_from_s"] = json_number(result.scored_from_s);
  out["learning"] = result.learning ? window(*result.learning) : Json(nullptr);
  out["evaluation"] = window(result.evaluation);
  out["window_s"] = json_number(result.window_s);
  out["reference"] = reference_json(result);
  out["score"] = result.has_reference ? "rmse" : "predictive_rms";
  out["optimum_rmse"] =
      result.inputs.empty() ? Json(nullptr) : json_number(result.inputs[0].optimum_rmse);
  out["inputs"] = Json::array();
  for (const InputResult& input : result.inputs)
    out["inputs"].push_back({{"name", json_text(input.name)},
                             {"unit", json_text(input.unit)},
                             {"optimum_rmse", json_number(input.optimum_rmse)}});
}

}  // namespace

Json replay_json_without_times(const ReplayView& view) {
  Json out = replay_json(view);
  out.erase("command");
  for (const char* key : kMeasuredKeys) {
    out.erase(key);
    for (Json& algorithm : out["algorithms"]) algorithm.erase(key);
  }
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
  Json out = document_head("replay-report", result.command, logs);
  for (const Json& warning : warnings_json(result.warnings)) out["warnings"].push_back(warning);
  out["config"] = json_of(result.settings);
  out["scene"] = scene_json(view);
  out["verdict"] = paragraph(view.steady_verdict);
  out["verdict_with_costs"] = paragraph(view.verdict);
  out["plan"] = texts(result.plan);
  add_run(out, result);
  out["sensors"] = sensors_json(result);
  out["preparation"] = preparation_json(result.scene.preparation);
  if (result.alignment) out["alignment"] = alignment_json(result);
  out["faults"] = known_faults_json(result);
  out["detection"] = detection_json(result);
  out["best"] =
      result.best ? Json(json_text(result.algorithms[*result.best].label)) : Json(nullptr);
  out["best_sensor"] = result.best_sensor
                           ? Json(json_text(result.sensors[*result.best_sensor].name))
                           : Json(nullptr);
  out["best_over_sensor_ci95"] =
      result.best_over_sensor ? interval_json(*result.best_over_sensor) : Json(nullptr);
  out["offsets_decide"] = result.offsets_decide;
  out["ranked"] = Json::array();
  for (const AlgorithmView* algorithm : view.ranked)
    out["ranked"].push_back(json_text(algorithm->result->label));
  out["marks"] = marks_json(view);
  out["run"] = run_json(view);
  out["algorithms"] = Json::array();
  for (const AlgorithmView& algorithm : view.algorithms)
    out["algorithms"].push_back(algorithm_json(result, algorithm));
  out["measured"] = {{"seconds", json_number(result.seconds)},
                     {"passes", result.work.passes},
                     {"instants_learnt", result.work.learnt},
                     {"instants_fused", result.work.steps},
                     {"instants_without_reference", result.work.blind_steps},
                     {"work", work_json(result.counted)}};
  return out;
}

Json replay_json(const ReplayResult& result) {
  return replay_json(replay_view(result));
}

Json replay_json_without_times(const ReplayResult& result) {
  return replay_json_without_times(replay_view(result));
}

Json algorithms_json() {
  Json out = Json::array();
  for (const fusion::Entry& entry : fusion::algorithms()) {
    const fusion::Description& d = *entry.description;
    Json one = {{"name", std::string(d.name)},
                {"title", std::string(d.title)},
                {"source", std::string(d.source)},
                {"complexity", std::string(d.complexity)},
                {"learning_complexity", std::string(d.learning_complexity)},
                {"needs", texts(needs_in_words(d))},
                {"accepts_missing", d.needs.accepts_missing},
                {"options", Json::array()}};
    for (const fusion::Option& option : entry.options)
      one["options"].push_back({{"name", std::string(option.name)},
                                {"unit", std::string(option.unit)},
                                {"standard", json_number(option.standard)},
                                {"low", json_number(option.low)},
                                {"high", json_number(option.high)},
                                {"whole", option.whole},
                                {"meaning", std::string(option.meaning)}});
    out.push_back(std::move(one));
  }
  return out;
}

}  // namespace libchar
