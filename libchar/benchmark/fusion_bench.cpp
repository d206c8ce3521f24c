#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "libchar/benchmark/bench_document.hpp"
#include "libchar/benchmark/detail/bench_scene_texts.hpp"
#include "libchar/benchmark/detail/estimators.hpp"
#include "libchar/benchmark/turns.hpp"
#include "libchar/core/error.hpp"
#include "libchar/fusion/registry.hpp"
#include "libchar/replay/replay.hpp"
#include "libchar/scene/scene_file.hpp"

namespace libchar {
namespace {

/// What one algorithm did in the runs of one scene.
struct Runs {
  std::vector<double> ratio, ns, learning_s;  // ratio: RMSE over the yardstick's
  std::optional<double> bytes;
  std::string why;
};

struct SceneRuns {
  std::map<std::string, Runs> of;
  std::string kind;  // scenes of one kind feed the same algorithms
  bool pooled = false;
};

/// The list of a run, rotated and reversed from run to run: nobody always goes first.
std::vector<SceneAlgorithm> in_turn(const std::vector<SceneAlgorithm>& all, std::size_t run) {
  std::vector<SceneAlgorithm> out;
  for (const std::size_t i : order_of_round(all.size(), run)) out.push_back(all[i]);
  return out;
}

std::vector<SceneAlgorithm> algorithms_of(const Scene& scene, const FusionBenchOptions& options) {
  std::vector<SceneAlgorithm> out;
  for (const std::string& name : options.algorithms) {
    fusion::algorithm(name);
    out.push_back({name, {}, 0, 0});
  }
  if (out.empty()) out = scene.algorithms;
  if (out.empty())
    for (const fusion::Entry& entry : fusion::algorithms())
      out.push_back({std::string(entry.description->name), {}, 0, 0});
  return swept(options.sweeps, out);
}

/// Error over the yardstick: the optimum where the reference makes one, else the best of the methods.
double ratio_of(const AlgorithmResult& algorithm, const ReplayResult& result) {
  if (!std::isnan(algorithm.regret)) return 1 + algorithm.regret;
  if (!result.best) return NAN;
  return algorithm.rmse / result.algorithms[*result.best].rmse;
}

void add(const ReplayResult& result, SceneRuns& runs, std::vector<FusionBenchRow>& rows) {
  for (const AlgorithmResult& algorithm : result.algorithms) {
    const auto same = [&](const FusionBenchRow& row) { return row.label == algorithm.label; };
    if (std::none_of(rows.begin(), rows.end(), same)) {
      FusionBenchRow row;
      row.label = algorithm.label;
      row.name = algorithm.description->name;
      row.bound = algorithm.bound;
      rows.push_back(std::move(row));
    }
    Runs& run = runs.of[algorithm.label];
    if (!algorithm.ran) {
      run.why = algorithm.why;
      continue;
    }
    run.ratio.push_back(ratio_of(algorithm, result));
    if (!std::isnan(algorithm.ns_per_sample)) run.ns.push_back(algorithm.ns_per_sample);
    run.learning_s.push_back(algorithm.learning_s);
    if (algorithm.peak_bytes) run.bytes = std::max(run.bytes.value_or(0), static_cast<double>(*algorithm.peak_bytes));
  }
}

FusionBenchScene described(const Scene& scene, const ReplayResult& first, std::size_t runs) {
  FusionBenchScene out;
  out.name = scene.name.empty() ? scene.file : scene.name;
  out.file = scene.file;
  out.simulated = scene.simulate.has_value();
  out.yardstick = first.has_reference ? "the smallest error that fixed weights, or the best filter, could have had"
                                      : "the best of the methods";
  out.instants = first.instants;
  out.sensors = first.sensors.size();
  out.inputs = first.inputs.size();
  out.runs = runs;
  return out;
}

Figure minus_one(Figure figure) {
  figure.value -= 1;
  figure.ci95.low -= 1;
  figure.ci95.high -= 1;
  return figure;
}

FusionBenchCell cell_of(const Runs& runs) {
  FusionBenchCell out;
  out.ran = !runs.ratio.empty();
  out.why = runs.why;
  out.excess = minus_one(mean_figure(runs.ratio));
  out.ns_per_sample = time_figure(runs.ns);
  out.learning_s = median_figure(runs.learning_s).value;
  out.bytes = runs.bytes;
  return out;
}

/// The scenes of the most frequent kind, the first of several.
void choose_pooled(std::vector<SceneRuns>& scenes) {
  std::map<std::string, std::size_t> count;
  for (const SceneRuns& scene : scenes) ++count[scene.kind];
  const auto most = std::max_element(scenes.begin(), scenes.end(),
                                     [&](const auto& a, const auto& b) { return count[a.kind] < count[b.kind]; });
  for (SceneRuns& scene : scenes) scene.pooled = scene.kind == most->kind;
}

/// Geometric means over the pooled scenes of run after run, where it ran in each.
void over_scenes(const std::vector<SceneRuns>& all, FusionBenchRow& row) {
  std::size_t runs = std::numeric_limits<std::size_t>::max(), timed = runs;
  std::vector<SceneRuns> scenes;
  std::copy_if(all.begin(), all.end(), std::back_inserter(scenes), [](const SceneRuns& scene) { return scene.pooled; });
  for (const SceneRuns& scene : scenes) {
    const auto found = scene.of.find(row.label);
    if (found == scene.of.end()) return;
    runs = std::min(runs, found->second.ratio.size());
    timed = std::min(timed, found->second.ns.size());
  }
  std::vector<double> ratio(runs), ns(timed);
  const auto share = 1 / static_cast<double>(scenes.size());
  for (const SceneRuns& scene : scenes) {
    const Runs& own = scene.of.at(row.label);
    for (std::size_t i = 0; i < runs; ++i) ratio[i] += share * std::log(own.ratio[i]);
    for (std::size_t i = 0; i < timed; ++i) ns[i] += share * std::log(own.ns[i]);
  }
  for (double& v : ratio) v = std::exp(v);
  for (double& v : ns) v = std::exp(v);
  row.excess = minus_one(mean_figure(ratio));
  row.ns_per_sample = time_figure(ns);
}

void add_fronts(FusionBench& bench) {
  std::vector<CostAndError> points;
  for (const FusionBenchRow& row : bench.rows)
    points.push_back(row.bound ? CostAndError{NAN, NAN} : CostAndError{row.ns_per_sample.value, 1 + row.excess.value});
  const std::vector<double> gaps = front_gaps(points);
  for (std::size_t i = 0; i < gaps.size(); ++i) bench.rows[i].front_gap = gaps[i];
  for (std::size_t s = 0; s < bench.scenes.size(); ++s) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const FusionBenchCell& cell = bench.rows[i].cells[s];
      points[i] = bench.rows[i].bound || !cell.ran ? CostAndError{NAN, NAN}
                                                   : CostAndError{cell.ns_per_sample.value, 1 + cell.excess.value};
    }
    const std::vector<double> of_scene = front_gaps(points);
    for (std::size_t i = 0; i < of_scene.size(); ++i) bench.rows[i].cells[s].front_gap = of_scene[i];
  }
}

void run_scene(Scene scene, const FusionBenchOptions& options, HeapMeter* heap,
               const std::function<void(double, const std::string&)>& progress, FusionBench& out,
               std::vector<SceneRuns>& runs) {
  const std::vector<SceneAlgorithm> all = algorithms_of(scene, options);
  for (std::size_t r = 0; r < options.seeds; ++r) {
    progress(static_cast<double>(r) / static_cast<double>(options.seeds),
             fmt::format("{}: run {} of {}", scene.name, r + 1, options.seeds));
    if (scene.simulate) scene.simulate->seed = options.seed + r;
    ReplayOptions run;
    run.algorithms = in_turn(all, r);
    run.allan = false;
    ReplayWorkspace workspace;
    workspace.heap = heap;
    const ReplayResult result = replay(scene, run, no_progress(), workspace);
    if (r == 0) {
      out.scenes.push_back(described(scene, result, options.seeds));
      runs.emplace_back();
      runs.back().kind = scene.tilt ? "tilt" : std::to_string(result.inputs.size());
    }
    add(result, runs.back(), out.rows);
  }
}

}  // namespace

std::vector<Scene> bench_scenes() {
  std::vector<Scene> out;
  const std::pair<const char*, std::string_view> texts[] = {{"rv-3.3-uncalibrated.yaml", scene_rv_3_3_uncalibrated()},
                                                            {"rv-3.3-calibrated.yaml", scene_rv_3_3_calibrated()},
                                                            {"rv-5.1-fault-free.yaml", scene_rv_5_1_fault_free()},
                                                            {"rv-5.1-faults.yaml", scene_rv_5_1_faults()},
                                                            {"lever-arm.yaml", scene_lever_arm()},
                                                            {"rv-2.5-tilt.yaml", scene_rv_2_5_tilt()}};
  for (const auto& [name, text] : texts) {
    out.push_back(parse_scene(text, name));
    out.back().file = name;
  }
  return out;
}

FusionBench bench_fusion(const std::vector<Scene>& scenes, const FusionBenchOptions& options, Progress& progress,
                         HeapMeter* heap) {
  FusionBench out;
  out.seed = options.seed;
  std::vector<SceneRuns> runs;
  for (std::size_t s = 0; s < scenes.size(); ++s) {
    const auto part = [&](double done, const std::string& text) {
      progress.update((static_cast<double>(s) + done) / static_cast<double>(scenes.size()), text);
    };
    try {
      run_scene(scenes[s], options, heap, part, out, runs);
    } catch (const Error& error) {
      const bool last = s + 1 == scenes.size() && out.scenes.empty();
      if (error.problem().code != "E0905" || last) throw;
      out.left_out.push_back({scenes[s].name, scenes[s].file, error.problem().what});
    }
  }
  choose_pooled(runs);
  for (std::size_t s = 0; s < runs.size(); ++s) out.scenes[s].pooled = runs[s].pooled;
  for (FusionBenchRow& row : out.rows) {
    for (const SceneRuns& scene : runs) {
      const auto found = scene.of.find(row.label);
      row.cells.push_back(found == scene.of.end() ? FusionBenchCell{} : cell_of(found->second));
    }
    row.swept = std::any_of(options.sweeps.begin(), options.sweeps.end(),
                            [&](const Sweep& sweep) { return sweep.algorithm == row.name; });
    over_scenes(runs, row);
  }
  std::stable_sort(out.rows.begin(), out.rows.end(), [](const auto& a, const auto& b) {
    const double x = a.excess.value, y = b.excess.value;
    return std::isnan(y) ? !std::isnan(x) : x < y;
  });
  add_fronts(out);
  return out;
}

}  // namespace libchar
