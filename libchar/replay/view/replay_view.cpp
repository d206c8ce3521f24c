#include "libchar/replay/view/replay_view.hpp"

#include <algorithm>
#include <cmath>

#include "libchar/core/file/sha256.hpp"
#include "libchar/core/not_known.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/fusion/fault_log.hpp"
#include "libchar/replay/detail/tracks/run_tracks.hpp"
#include "libchar/replay/view/words.hpp"
#include "libchar/scene/scene_file.hpp"

namespace libchar {
namespace {

// An algorithm that takes sensors out answers to each fault that the scene knows.
std::vector<const FaultAnswer*> answers_of(const AlgorithmResult& a, std::size_t known) {
  std::vector<const FaultAnswer*> out(known, nullptr);
  for (const FaultAnswer& answer : a.answers)
    if (answer.fault < known) out[detail::in_memory(answer.fault)] = &answer;
  return out;
}

// A noise fault gives a sensor less weight; it stays in use.
bool takes_out(const FoundFault& found) { return found.kind != fusion::name(fusion::FaultRule::noise); }

std::vector<double> out_share(const ReplayResult& r, const AlgorithmResult& a) {
  if (!a.watches_faults) return {};
  std::vector<double> out(r.sensors.size(), 0.0);
  const double run_s = static_cast<double>(r.instants) / r.rate_hz, end_s = r.start_s + run_s;
  for (const FoundFault& found : a.faults)
    if (takes_out(found) && found.sensor < out.size())
      out[detail::in_memory(found.sensor)] +=
          std::max(0.0, std::min(found.to_s.value_or(end_s), end_s) - std::max(found.from_s, r.start_s)) / run_s;
  return out;
}

AlgorithmView algorithm_view(const ReplayResult& r, const AlgorithmResult& a, std::size_t divisor) {
  AlgorithmView out;
  out.result = &a;
  out.best = r.best && &r.algorithms[*r.best] == &a;
  if (a.description != nullptr) {
    out.learns = detail::learns(r, a);
    out.needs = needs_in_words(*a.description);
  }
  out.settings = settings_in_words(a.settings);
  out.weight_track = merged_bins(a.weight_track, divisor);
  out.variance_track = merged_bins(a.variance_track, divisor);
  out.answers = answers_of(a, r.faults.size());
  out.alarms_without_fault = alarms_without_fault(r.faults, a.faults);
  out.out_share = out_share(r, a);
  out.core_share = 1e-9 * a.ns_per_sample * r.rate_hz;
  return out;
}

void add_algorithms(ReplayView& view, const ReplayResult& r) {
  const ParetoFront front = pareto_front(r);
  const std::size_t divisor = track_divisor(r);
  view.algorithms.reserve(r.algorithms.size());
  for (std::size_t i = 0; i < r.algorithms.size(); ++i) {
    AlgorithmView& added = view.algorithms.emplace_back(algorithm_view(r, r.algorithms[i], divisor));
    added.on_time_front = front.time[i];
    added.on_memory_front = front.memory[i];
    if (added.result->ran && added.result->watches_faults) view.watching.push_back(&added);
  }
}

std::vector<const AlgorithmView*> views_of(const ReplayView& view, const std::vector<const AlgorithmResult*>& results) {
  std::vector<const AlgorithmView*> out;
  out.reserve(results.size());
  for (const AlgorithmResult* a : results)
    out.push_back(&view.algorithms[static_cast<std::size_t>(a - view.result->algorithms.data())]);
  return out;
}

InputView input_view(const ReplayView& view, std::size_t input) {
  InputView out;
  out.result = &view.result->inputs[input];
  out.ranked = views_of(view, ranked_by_input(*view.result, input));
  for (const AlgorithmResult& a : view.result->algorithms) {
    if (input >= a.inputs.size()) continue;
    out.has_window_rms = out.has_window_rms || !a.inputs[input].window_rms.empty();
    out.has_allan = out.has_allan || !a.inputs[input].allan.points.empty();
  }
  return out;
}

void add_final_weights(std::vector<FinalRow>& out, const ReplayResult& r, const AlgorithmResult& a) {
  for (std::size_t j = 0; j < a.weights.size(); ++j) {
    const bool named = a.weights.size() > 1 && j < r.inputs.size();
    out.push_back({a.label + ": weights" + (named ? " of " + r.inputs[j].name : ""), a.weights[j],
                   j == 0 && a.weight_distance > 0 ? a.weight_distance : kNone});
  }
}

void add_final_variances(std::vector<FinalRow>& out, const AlgorithmResult& a) {
  FinalRow row{a.label + ": standard deviations", {}, a.variance_error > 0 ? a.variance_error : kNone};
  for (const double v : a.variances) row.values.push_back(v >= 0 ? std::sqrt(v) : kNone);
  out.push_back(std::move(row));
}

std::vector<FinalRow> final_rows(const ReplayView& view) {
  std::vector<FinalRow> out;
  for (const AlgorithmView* a : view.ranked) {
    add_final_weights(out, *view.result, *a->result);
    if (!a->result->variances.empty()) add_final_variances(out, *a->result);
  }
  return out;
}

std::vector<AlgorithmRemark> remarks_of(const ReplayResult& r) {
  std::vector<AlgorithmRemark> out;
  for (const AlgorithmResult& a : r.algorithms)
    for (const Finding& w : a.remarks.list()) out.push_back({a.label, w.sentence, w.count});
  return out;
}

Findings all_warnings(const ReplayResult& r) {
  Findings out = r.warnings;
  for (const LogInfo& log : r.logs) out.merge(log.warnings);
  return out;
}

std::vector<std::optional<double>> noise_sd(const ReplayResult& r) {
  std::vector<std::optional<double>> out;
  for (const SensorResult& s : r.sensors)
    out.push_back(s.noise_variance ? std::optional(std::sqrt(*s.noise_variance)) : std::nullopt);
  return out;
}

// Sensors in different units have no axis in common.
bool sensors_can_be_drawn(const std::vector<SensorResult>& sensors) {
  const auto scored = [](const SensorResult& s) { return s.error.rmse > 0; };
  const auto alike = [&](const SensorResult& s) { return s.unit == sensors[0].unit; };
  return std::any_of(sensors.begin(), sensors.end(), scored) && std::all_of(sensors.begin(), sensors.end(), alike);
}

/// Who has an estimate at so many of the instants lacks none that one would miss.
constexpr double kNearlyAlways = 0.999;

ReplayFigures figures_of(const ReplayResult& r) {
  const auto any = [&](auto has) {
    return std::any_of(r.algorithms.begin(), r.algorithms.end(),
                       [&](const AlgorithmResult& a) { return a.ran && has(a); });
  };
  ReplayFigures out;
  out.error_over_time = any([](const auto& a) { return a.rmse > 0 && a.ns_per_sample > 0; });
  out.error_over_memory = any([](const auto& a) { return a.rmse > 0 && a.peak_bytes.value_or(0) > 0; });
  out.weights = any([](const auto& a) { return a.weights.size() == 1; });
  out.variances = any([](const auto& a) { return !a.variances.empty(); });
  out.faults = !r.faults.empty() || any([](const auto& a) { return !a.faults.empty() || !a.leads.empty(); });
  out.detection = std::any_of(r.detection.begin(), r.detection.end(), [](const DetectionAt& at) {
    return std::any_of(at.answers.begin(), at.answers.end(), [](const auto& one) { return one.found_s.has_value(); });
  });
  out.sensors = sensors_can_be_drawn(r.sensors);
  out.ranking = any([](const auto& a) { return a.rmse > 0; });
  out.availability = any([](const auto& a) { return a.availability < kNearlyAlways; });
  out.bias = r.has_reference && any([](const auto& a) {
               return !a.bound && !a.inputs.empty() && std::abs(a.inputs[0].error.bias) > 0.5 * a.rmse;
             });
  out.run = !r.tracks.whole.inputs.empty();
  out.deviations = !r.tracks.whole.deviations.empty();
  out.time_matters = any([&](const auto& a) { return 1e-9 * a.ns_per_sample * r.rate_hz > kCoreThatMatters; });
  return out;
}

void add_mark(std::vector<RunMark>& out, RunMark mark, double start_s, double end_s) {
  mark.from_s = std::max(mark.from_s, start_s);
  mark.to_s = std::min(mark.to_s, end_s);
  if (mark.from_s < mark.to_s) out.push_back(std::move(mark));
}

std::string fault_label(const ReplayResult& r, const SensorFault& fault) {
  const bool valueless = fault.kind == FaultKind::stuck || fault.kind == FaultKind::dropout;
  return (fault.sensor < r.sensors.size() ? r.sensors[fault.sensor].name + ": " : "") +
         std::string(name_of(fault.kind)) + (valueless ? "" : " " + brief_text(fault.value, 4));
}

/// What a method found and nobody declared, as long as there are few.
void add_found(std::vector<RunMark>& out, const ReplayResult& r, const FoundFault& found, double end_s) {
  constexpr std::size_t kMostMarks = 24;
  if (found.sensor >= r.sensors.size() || out.size() >= kMostMarks) return;
  const std::string& name = r.sensors[detail::in_memory(found.sensor)].name;
  const double to_s = found.to_s.value_or(end_s);
  const bool declared = std::any_of(out.begin(), out.end(), [&](const RunMark& mark) {
    return mark.sensor == name && mark.from_s < to_s && found.from_s < mark.to_s;
  });
  if (declared) return;
  std::string kind = found.kind;
  std::replace(kind.begin(), kind.end(), '_', ' ');
  add_mark(out, {"found", name + ": " + kind + " found", name, found.from_s, to_s}, r.start_s, end_s);
}

std::vector<RunMark> marks_of(const ReplayResult& r, double end_s) {
  std::vector<RunMark> out;
  if (r.learning)
    add_mark(out, {"learning", "learning window", {}, r.learning->from_s, r.learning->to_s}, r.start_s, end_s);
  add_mark(out, {"warm-up", "warm-up, not scored", {}, r.start_s, r.scored_from_s}, r.start_s, end_s);
  for (const SensorFault& fault : r.faults)
    add_mark(out,
             {"fault", fault_label(r, fault), fault.sensor < r.sensors.size() ? r.sensors[fault.sensor].name : "",
              fault.from_s, fault.to_s},
             r.start_s, end_s);
  if (r.tracks.algorithm)
    for (const FoundFault& found : r.algorithms[*r.tracks.algorithm].faults) add_found(out, r, found, end_s);
  return out;
}

/// All sensors together: about 400 kB of a page.
constexpr std::size_t kMostDeviations = 40000;

RunView run_view(const ReplayResult& r, double end_s) {
  RunView out;
  if (r.tracks.algorithm) out.method = r.algorithms[*r.tracks.algorithm].label;
  if (r.best_sensor && !r.tracks.whole.sensor.empty()) out.sensor = r.sensors[*r.best_sensor].name;
  const Timeline& all = r.tracks.whole.deviations;
  const std::size_t numbers = all.time_s.size() * (1 + 2 * all.low.size());
  out.deviations = merged_bins(all, (numbers + kMostDeviations - 1) / kMostDeviations);
  out.marks = marks_of(r, end_s);
  for (const CloseUp& one : r.tracks.close_ups)
    out.close_ups.push_back(one.fault && *one.fault < r.faults.size() ? fault_label(r, r.faults[*one.fault])
                                                                      : duration_text(one.from_s));
  return out;
}

// What was simulated, whoever was asked to fuse it.
std::string identity_of(const Scene& scene) {
  if (!scene.simulate) return "";
  Scene identity = scene;
  identity.algorithms.clear();
  identity.learning.reset();
  identity.evaluation.reset();
  identity.name.clear();
  Sha256 hash;
  hash.update(scene_yaml(identity));
  return hash.finish();
}

}  // namespace

ReplayView replay_view(const ReplayResult& r) {
  ReplayView out;
  out.result = &r;
  out.title = r.scene.name.empty() ? r.scene.file : r.scene.name;
  out.optimum = optimum_of(r);
  out.verdict = verdict_sentences(r, true);
  out.steady_verdict = verdict_sentences(r, false);
  out.duration_s = static_cast<double>(r.instants) / r.rate_hz;
  out.end_s = r.start_s + out.duration_s;
  add_algorithms(out, r);
  out.ranked = views_of(out, ranked(r));
  out.skipped = skipped_algorithms(r);
  for (std::size_t j = 0; j < r.inputs.size(); ++j) out.inputs.push_back(input_view(out, j));
  out.run = run_view(r, out.end_s);
  out.noise_sd = noise_sd(r);
  out.final_rows = final_rows(out);
  out.remarks = remarks_of(r);
  out.warnings = all_warnings(r);
  out.figures = figures_of(r);
  out.shown_verdict = out.figures.time_matters ? out.verdict : out.steady_verdict;
  out.simulation_identity = identity_of(r.scene);
  return out;
}

}  // namespace libchar
