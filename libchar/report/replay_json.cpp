// report.json of a replay: everything that its page shows, and nothing that the page does not need
// to be believed.

#include "libchar/report/replay_json.hpp"

#include <cmath>

#include "libchar/core/sha256.hpp"
#include "libchar/core/text.hpp"
#include "libchar/report/escape.hpp"
#include "libchar/report/outputs.hpp"
#include "libchar/report/replay_timeline.hpp"
#include "libchar/report/replay_words.hpp"

namespace libchar {
namespace {

Json interval(const Interval& i) {
  if (!std::isfinite(i.low) || !std::isfinite(i.high)) return nullptr;
  return Json::array({i.low, i.high});
}

Json numbers(const std::vector<double>& values) {
  Json out = Json::array();
  for (const double v : values) out.push_back(json_number(v));
  return out;
}

// To an infinite end: null.
Json window(const TimeWindow& w) {
  return {{"from_s", json_number(w.from_s)}, {"to_s", json_number(w.to_s)}};
}

Json strings(const std::vector<std::string>& texts) {
  Json out = Json::array();
  for (const std::string& text : texts) out.push_back(json_text(text));
  return out;
}

void add_warnings(Json& list, const Warnings& warnings) {
  for (const Warning& w : warnings.list())
    list.push_back({{"code", json_text(w.code)},
                    {"message", json_text(w.message)},
                    {"count", w.count},
                    {"where", strings(w.places)}});
}

std::string sensor_name(const ReplayResult& r, std::size_t sensor) {
  return sensor < r.sensors.size() ? json_text(r.sensors[sensor].name) : "";
}

Json reference(const ReplayResult& r) {
  if (!r.has_reference) return nullptr;
  Json out = {{"use", json_text(r.reference_use)}, {"channels", Json::array()}, {"mean", false}};
  if (r.scene.reference) {
    out["channels"] = strings(r.scene.reference->channels);
    out["mean"] = r.scene.reference->mean;
  }
  return out;
}

// Two simulations are alike when everything that makes their samples is; which algorithms run on
// them and which stretch is looked at is not part of it.
Json simulation(const Scene& scene) {
  if (!scene.simulate) return nullptr;
  Scene bare = scene;
  bare.algorithms.clear();
  bare.learning.reset();
  bare.evaluation.reset();
  bare.name = bare.file = "scene";
  Sha256 hash;
  hash.update(scene_yaml(bare));
  return {{"seed", scene.simulate->seed}, {"sha256", hash.finish()}};
}

Json known_faults(const ReplayResult& r) {
  Json out = Json::array();
  for (const SensorFault& f : r.faults)
    out.push_back({{"sensor", sensor_name(r, f.sensor)},
                   {"kind", name_of(f.kind)},
                   {"value", json_number(f.value)},
                   {"from_s", json_number(f.from_s)},
                   {"to_s", json_number(f.to_s)}});
  return out;
}

Json scene_json(const ReplayResult& r) {
  Json out = {{"name", json_text(r.scene.name)}, {"file", json_text(r.scene.file)}};
  out["recording"] = r.scene.recording.empty() ? Json(nullptr) : Json(json_text(r.scene.recording));
  out["simulation"] = simulation(r.scene);
  out["rate_hz"] = json_number(r.rate_hz);
  out["instants"] = r.instants;
  out["start_s"] = json_number(r.start_s);
  out["learning"] = r.learning ? window(*r.learning) : Json(nullptr);
  out["evaluation"] = window(r.evaluation);
  out["window_s"] = json_number(r.window_s);
  out["reference"] = reference(r);
  out["lag_s"] = json_number(r.lag_s);
  out["lag_estimated"] = r.lag_estimated;
  out["tilt"] = r.scene.tilt.has_value();
  out["faults"] = known_faults(r);
  return out;
}

void add_error(Json& out, const ErrorScore& e) {
  const bool any = e.samples > 0;
  const auto number = [&](double v) { return any ? json_number(v) : Json(nullptr); };
  out["rmse"] = number(e.rmse);
  out["rmse_ci95"] = any ? interval(e.rmse_ci95) : Json(nullptr);
  out["bias"] = number(e.bias);
  out["bias_ci95"] = any ? interval(e.bias_ci95) : Json(nullptr);
  out["maximum"] = number(e.maximum);
  out["availability"] = json_number(e.availability);
  out["samples"] = e.samples;
  out["converged_s"] = number(e.converged_s);
}

Json sensor_json(const SensorResult& s) {
  Json out = {{"name", json_text(s.name)}, {"unit", json_text(s.unit)}};
  add_error(out, s.error);
  out["noise_variance"] = json_number(s.noise_variance);
  out["noise_source"] = json_text(s.noise_source);
  out["offset"] = json_number(s.offset);
  out["missing"] = json_number(s.missing);
  out["constant"] = s.constant;
  out["h"] = numbers(s.h);
  return out;
}

Json allan_json_of(const AllanCurve& curve) {
  if (curve.points.empty()) return nullptr;
  Json out = {
      {"type", name_of(curve.type)}, {"tau_s", Json::array()}, {"deviation", Json::array()}};
  for (const AllanPoint& p : curve.points) {
    out["tau_s"].push_back(json_number(p.tau_s));
    out["deviation"].push_back(json_number(p.deviation));
  }
  return out;
}

// Bins of a plot, not results: five digits are more than a line on paper holds.
Json thin_numbers(const std::vector<double>& values, int digits) {
  Json out = Json::array();
  for (const double v : values)
    out.push_back(std::isfinite(v) ? Json(*parse_double(significant(v, digits))) : Json(nullptr));
  return out;
}

Json timeline_json(const Timeline& t) {
  if (t.empty()) return nullptr;
  Json out = {
      {"time_s", thin_numbers(t.time_s, 9)}, {"low", Json::array()}, {"high", Json::array()}};
  for (const auto& series : t.low) out["low"].push_back(thin_numbers(series, 5));
  for (const auto& series : t.high) out["high"].push_back(thin_numbers(series, 5));
  return out;
}

Json input_score_json(const ReplayResult& r, const InputScore& score, std::size_t input) {
  Json out = {{"name", input < r.inputs.size() ? json_text(r.inputs[input].name) : ""},
              {"unit", input < r.inputs.size() ? json_text(r.inputs[input].unit) : ""}};
  add_error(out, score.error);
  out["optimum_ratio"] = json_number(score.optimum_ratio);
  out["allan"] = allan_json_of(score.allan);
  out["window_rms"] = timeline_json(score.window_rms);
  return out;
}

Json needs_json(const fusion::Needs& n) {
  return {{"min_channels", n.min_channels},
          {"more_than_inputs", n.more_than_inputs},
          {"learning_samples", n.learning_samples},
          {"reference", n.reference},
          {"reference_throughout", n.reference_throughout},
          {"noise_levels", n.noise_levels},
          {"observation_matrix", n.observation_matrix},
          {"accepts_missing", n.accepts_missing},
          {"fault_free_start", n.fault_free_start},
          {"rate", n.rate},
          {"tilt", n.tilt}};
}

// One input: a flat list, a weight a sensor; several: a list of rows.
Json weights_json(const std::optional<Eigen::MatrixXd>& weights) {
  Json out = Json::array();
  if (!weights) return out;
  for (Eigen::Index i = 0; i < weights->rows(); ++i) {
    Json row = Json::array();
    for (Eigen::Index j = 0; j < weights->cols(); ++j) row.push_back(json_number((*weights)(i, j)));
    out.push_back(weights->cols() == 1 ? row[0] : row);
  }
  return out;
}

Json variances_json(const std::optional<Eigen::VectorXd>& variances) {
  Json out = Json::array();
  if (variances)
    for (const double v : *variances) out.push_back(json_number(v));
  return out;
}

Json found_faults(const ReplayResult& r, const AlgorithmResult& a) {
  Json out = Json::array();
  for (const FoundFault& f : a.faults)
    out.push_back({{"sensor", sensor_name(r, f.sensor)},
                   {"kind", json_text(f.kind)},
                   {"from_s", json_number(f.from_s)},
                   {"to_s", json_number(f.to_s)}});
  return out;
}

Json blind_json(const BlindScore& b) {
  return {{"leave_one_out_rms", json_number(b.leave_one_out_rms)},
          {"leave_one_out_ci95", interval(b.leave_one_out_ci95)},
          {"leave_one_out", numbers(b.leave_one_out)},
          {"split_rms", json_number(b.split_rms)}};
}

void add_card(Json& out, const fusion::Card& card) {
  out["name"] = card.name;
  out["title"] = card.title;
  out["source"] = card.source;
  out["complexity"] = card.complexity;
  out["learning_complexity"] = card.learning_complexity;
  out["needs"] = needs_json(card.needs);
}

void add_tracks(Json& out, const ReplayResult& r, const AlgorithmResult& a, std::size_t divisor) {
  out["weights"] = weights_json(a.weights);
  out["variances"] = variances_json(a.variances);
  out["weight_distance"] = json_number(a.weight_distance);
  out["variance_error"] = json_number(a.variance_error);
  out["weight_track"] = timeline_json(merged_bins(a.weight_track, divisor));
  out["variance_track"] = timeline_json(merged_bins(a.variance_track, divisor));
  out["watches_faults"] = a.watches_faults;
  out["faults"] = found_faults(r, a);
  out["faults_not_kept"] = a.faults_not_kept;
  out["fault_answers"] = Json::array();
  for (const FaultAnswer& answer : a.answers)
    out["fault_answers"].push_back({{"fault", answer.fault},
                                    {"found_s", json_number(answer.found_s)},
                                    {"returned_s", json_number(answer.returned_s)}});
}

Json algorithm_json(const ReplayResult& r, std::size_t index, std::size_t divisor) {
  const AlgorithmResult& a = r.algorithms[index];
  Json out = {{"name", ""}, {"label", json_text(a.label)}};
  out["status"] = a.ran ? "ran" : "skipped";
  out["why"] = json_text(a.why);
  out["bound"] = a.bound;
  // Without a reference there is no error to take the mean square of: see without_reference.
  const bool scored = a.ran && r.has_reference;
  out["rmse"] = scored ? json_number(a.rmse) : Json(nullptr);
  out["rmse_ci95"] = scored ? interval(a.rmse_ci95) : Json(nullptr);
  out["regret"] = scored ? json_number(a.regret) : Json(nullptr);
  out["ratio_to_best_ci95"] = a.ratio_to_best ? interval(*a.ratio_to_best) : Json(nullptr);
  out["as_good_as_best"] = a.as_good_as_best;
  out["availability"] = a.ran ? json_number(a.availability) : Json(nullptr);
  out["ns_per_sample"] = a.ran ? json_number(a.ns_per_sample) : Json(nullptr);
  out["peak_bytes"] = a.ran && a.peak_bytes ? Json(*a.peak_bytes) : Json(nullptr);
  out["learning_s"] = a.ran ? json_number(a.learning_s) : Json(nullptr);
  out["options"] = Json::object();
  for (std::size_t i = 0; i < a.settings.table().size(); ++i)
    out["options"][std::string(a.settings.table()[i].name)] = json_number(a.settings.values()[i]);
  out["inputs"] = Json::array();
  for (std::size_t j = 0; j < a.inputs.size(); ++j)
    out["inputs"].push_back(input_score_json(r, a.inputs[j], j));
  out["without_reference"] = a.blind ? blind_json(*a.blind) : Json(nullptr);
  add_tracks(out, r, a, divisor);
  out["remarks"] = Json::array();
  add_warnings(out["remarks"], a.remarks);
  if (a.card != nullptr) add_card(out, *a.card);
  return out;
}

Json document(const ReplayResult& r) {
  Json out = {{"format", "replay-report"}, {"version", 1}};
  add_provenance(out, r.command, r.logs);
  add_warnings(out["warnings"], r.warnings);
  out["config"] = r.settings.is_null() ? Json::object() : r.settings;
  out["verdict"] = strings(replay_verdict(r, false));
  out["scene"] = scene_json(r);
  out["score"] = r.has_reference ? "rmse" : "leave_one_out_rms";
  out["optimum_rmse"] = r.inputs.empty() ? Json(nullptr) : json_number(r.inputs[0].optimum_rmse);
  out["true_inputs"] = Json::array();
  for (const InputResult& input : r.inputs)
    out["true_inputs"].push_back({{"name", json_text(input.name)},
                                  {"unit", json_text(input.unit)},
                                  {"optimum_rmse", json_number(input.optimum_rmse)}});
  out["sensors"] = Json::array();
  for (const SensorResult& s : r.sensors) out["sensors"].push_back(sensor_json(s));
  out["best"] = r.best ? Json(json_text(r.algorithms[*r.best].label)) : Json(nullptr);
  const std::size_t divisor = track_divisor(r);
  out["algorithms"] = Json::array();
  for (std::size_t i = 0; i < r.algorithms.size(); ++i)
    out["algorithms"].push_back(algorithm_json(r, i, divisor));
  out["plan"] = strings(r.plan);
  out["work"] = {{"passes", r.work.passes},
                 {"learnt", r.work.learnt},
                 {"steps", r.work.steps},
                 {"blind_steps", r.work.blind_steps}};
  return out;
}

}  // namespace

Json replay_json(const ReplayResult& result) {
  Json out = document(result);
  const ParetoFront front = pareto_front(result);
  for (std::size_t i = 0; i < result.algorithms.size(); ++i)
    out["algorithms"][i]["on_front"] = {{"time", bool(front.time[i])},
                                        {"memory", bool(front.memory[i])}};
  out["verdict_with_costs"] = strings(replay_verdict(result, true));
  out["measured"] = {{"seconds", json_number(result.seconds)}};
  return out;
}

Json replay_json_without_times(const ReplayResult& result) {
  Json out = document(result);
  out.erase("command");
  for (Json& algorithm : out["algorithms"])
    for (const char* key : {"ns_per_sample", "learning_s", "peak_bytes"}) algorithm.erase(key);
  return out;
}

}  // namespace libchar
