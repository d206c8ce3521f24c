#include "tests/report/synthetic_replay.hpp"

#include <cmath>
#include <stdexcept>

#include "libchar/fusion/registry.hpp"

namespace test {

using namespace libchar;

ErrorScore synthetic_score(double rmse, double bias) {
  ErrorScore e;
  e.rmse = rmse;
  e.rmse_ci95 = {0.99 * rmse, 1.01 * rmse};
  e.bias = bias;
  e.bias_ci95 = {bias - 0.01 * rmse, bias + 0.01 * rmse};
  e.maximum = 4.4 * rmse;
  e.availability = 1;
  e.samples = 100000;
  e.converged_s = 2;
  return e;
}

Timeline synthetic_track(std::size_t series, std::size_t bins, double level, double duration_s,
                         std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  Timeline t;
  for (std::size_t k = 0; k < bins; ++k)
    t.time_s.push_back(duration_s * (static_cast<double>(k) + 0.5) / static_cast<double>(bins));
  t.low.resize(series);
  t.high.resize(series);
  for (std::size_t s = 0; s < series; ++s)
    for (std::size_t k = 0; k < bins; ++k) {
      const double v = level * (1 + 0.3 * static_cast<double>(s)) * std::exp(0.05 * normal(random));
      t.low[s].push_back(0.97 * v);
      t.high[s].push_back(1.03 * v);
    }
  return t;
}

InputScore synthetic_input(double rmse, double optimum, std::mt19937_64& random) {
  InputScore input;
  input.error = synthetic_score(rmse, 0.02 * rmse);
  input.optimum_ratio = rmse / optimum;
  for (std::uint64_t m = 1; m < 40000; m *= 2) {
    AllanPoint p;
    p.m = m;
    p.tau_s = 1e-3 * static_cast<double>(m);
    p.deviation = rmse / std::sqrt(static_cast<double>(m)) + 0.02 * rmse;
    input.allan.points.push_back(p);
  }
  input.window_rms = synthetic_track(1, 800, rmse, 100, random);
  return input;
}

AlgorithmResult synthetic_algorithm(const ReplayResult& r, std::size_t index, std::mt19937_64& random) {
  const fusion::Entry& entry = fusion::algorithms()[index];
  AlgorithmResult a;
  a.label = std::string(entry.description->name);
  a.description = entry.description;
  a.settings = fusion::Settings(entry.options);
  a.ran = true;
  a.bound = entry.description->needs.reference_throughout;
  a.availability = 1;
  const double rmse = 0.033 * (1 + 0.02 * static_cast<double>((index * 7) % 24));
  for (const InputResult& input : r.inputs) a.inputs.push_back(synthetic_input(rmse, input.optimum_rmse, random));
  a.rmse = rmse;
  a.rmse_ci95 = {0.99 * rmse, 1.01 * rmse};
  a.regret = rmse / 0.033 - 1;
  a.ns_per_sample = 3 * std::pow(1.6, static_cast<double>((index * 5) % 24));
  a.peak_bytes = 200 + 900 * ((index * 11) % 24);
  a.learning_s = entry.description->needs.reference ? 0.8 : 2e-6;
  const std::size_t n = r.sensors.size();
  // A network has no weights; it can be chosen on the page by what it finds.
  a.watches_faults = a.label == "neural-simplex";
  if (!a.watches_faults) a.weights.assign(r.inputs.size(), std::vector<double>(n, 1 / static_cast<double>(n)));
  a.weight_distance = a.variance_error = kNan;
  return a;
}

// As a replay keeps it: 1000 stretches, or every instant of a short one.
RunStretch synthetic_stretch(const ReplayResult& r, std::size_t bins, double duration_s, std::mt19937_64& random) {
  RunStretch out;
  for (std::size_t j = 0; j < r.inputs.size(); ++j)
    out.inputs.push_back({synthetic_track(1, bins, 1, duration_s, random),
                          synthetic_track(1, bins, 1, duration_s, random),
                          synthetic_track(1, bins, 0.03, duration_s, random)});
  if (r.inputs.size() > 1) return out;
  out.sensor = synthetic_track(1, bins, 1, duration_s, random);
  out.sensor_error = synthetic_track(1, bins, 0.05, duration_s, random);
  return out;
}

RunTracks synthetic_run(const ReplayResult& r, std::mt19937_64& random) {
  RunTracks out;
  out.algorithm = r.best.value_or(0);
  out.whole = synthetic_stretch(r, 1000, 100, random);
  out.close_ups.push_back({{}, 0, 0.4, synthetic_stretch(r, 400, 0.4, random)});
  return out;
}

void judge(ReplayResult& r) {
  r.best.reset();
  for (std::size_t i = 0; i < r.algorithms.size(); ++i) {
    const AlgorithmResult& a = r.algorithms[i];
    if (a.ran && !a.bound && a.rmse > 0 && (!r.best || a.rmse < r.algorithms[*r.best].rmse)) r.best = i;
  }
  if (!r.best) return;
  const double best = r.algorithms[*r.best].rmse;
  for (std::size_t i = 0; i < r.algorithms.size(); ++i) {
    AlgorithmResult& a = r.algorithms[i];
    a.as_good_as_best = i == *r.best;
    if (i == *r.best || !(a.rmse > 0)) continue;
    a.ratio_to_best = Interval{0.97 * a.rmse / best, 1.03 * a.rmse / best};
    a.as_good_as_best = a.ratio_to_best->low <= 1;
  }
}

ReplayResult synthetic_replay(std::size_t sensors, std::size_t inputs) {
  std::mt19937_64 random(20201);
  ReplayResult r;
  r.scene.name = "gyroscopes on a table";
  r.scene.file = "scenes/table.yaml";
  r.scene.recording = "scenes/table.csv";
  r.scene.reference = SceneReference{};
  r.scene.reference->channels = {"golden"};
  LogInfo log;
  log.file = "scenes/table.csv";
  log.format = "csv";
  log.sha256 = "6b86b273ff34fce19d6b804eff5a3f5747ada4eaa22f1d49c01e52ddb7875b4b";
  log.bytes = 12345678;
  log.rows = log.samples = 100000;
  log.warnings.add("gap", "grid points without a row are kept as missing", "line 4211", 37);
  r.logs = {log};
  r.command = {"sensorchar", "replay", "scenes/table.yaml", "-o", "out dir"};
  r.settings = {{"seed", std::uint64_t{1}}};
  r.plan = {"reads 6 channels", "learning on 10000 instants", "runs everything"};
  r.rate_hz = 1000;
  r.instants = 100000;
  r.learning = TimeWindow{0, 10};
  r.evaluation = {0, 100};
  r.window_s = 2;
  r.has_reference = true;
  r.reference_use = "each instant";
  for (std::size_t i = 0; i < sensors; ++i) {
    SensorResult s;
    s.name = "gyr_" + std::to_string(i);
    s.unit = "rad/s";
    s.error = synthetic_score(0.05 + 0.02 * static_cast<double>(i), 1e-3);
    s.noise_variance = s.error.rmse * s.error.rmse;
    s.noise_source = "model";
    s.h.assign(inputs, 1);
    r.sensors.push_back(s);
  }
  for (std::size_t j = 0; j < inputs; ++j)
    r.inputs.push_back({inputs == 1 ? "golden" : "axis_" + std::to_string(j), "rad/s", 0.033});
  r.faults = {{1, FaultKind::bias, 0.5, 40, 50},
              {2, FaultKind::scale, 1.2, 60, 62.5},
              {0, FaultKind::dropout, 0, 90, std::numeric_limits<double>::infinity()}};
  std::size_t skipped = 0;
  for (std::size_t i = 0; i < fusion::algorithms().size(); ++i) {
    AlgorithmResult a = synthetic_algorithm(r, i, random);
    if (i % 3 == 0 && inputs == 1) {
      a.weight_track = synthetic_track(sensors, 400, 0.1, 100, random);
      a.variance_track = synthetic_track(sensors, 400, 0.004, 100, random);
      a.variances.assign(sensors, 0.004);
    }
    if (i % 6 == 0) {
      a.watches_faults = true;
      a.faults = {{1, "variance", 40.02, 50.5}, {0, "variance", 90.1, {}}, {2, "variance", 10, 10.5}};
      a.answers = {{0, 0.02, 0.5}, {1, {}, {}}, {2, 0.1, {}}};
    }
    if (fusion::algorithms()[i].description->needs.tilt && skipped++ < 3) {
      a = AlgorithmResult();
      a.label = std::string(fusion::algorithms()[i].description->name);
      a.description = fusion::algorithms()[i].description;
      a.why = "needs one gyroscope axis and two accelerometer axes";
      a.rmse = a.regret = a.ns_per_sample = kNan;
      a.rmse_ci95 = {kNan, kNan};
    }
    r.algorithms.push_back(std::move(a));
  }
  judge(r);
  r.warnings.add("clock_change", "the rest is shorter than a second", "", 1);
  r.work = {3, 10000, 2400000, 0};
  r.seconds = 4.2;
  if (inputs == 1) r.best_sensor = 0;
  r.tracks = synthetic_run(r, random);
  return r;
}

ReplayResult without_reference() {
  ReplayResult r = synthetic_replay();
  r.has_reference = false;
  r.scene.reference.reset();
  r.learning.reset();
  r.reference_use.clear();
  r.inputs[0].optimum_rmse = kNan;
  r.best_sensor.reset();
  std::mt19937_64 random(20202);
  r.tracks.whole.sensor = r.tracks.whole.sensor_error = {};
  r.tracks.close_ups.clear();
  r.tracks.whole.inputs[0].reference = r.tracks.whole.inputs[0].error = {};
  r.tracks.whole.deviations = synthetic_track(r.sensors.size(), 1000, 0.05, 100, random);
  for (SensorResult& s : r.sensors) {
    s.error = ErrorScore{};
    s.error.rmse = kNan;
  }
  for (AlgorithmResult& a : r.algorithms) {
    a.inputs.clear();
    a.regret = kNan;
    if (!a.ran) continue;
    a.blind = BlindScore{};
    a.blind->leave_one_out_rms = a.rmse;
    a.blind->leave_one_out.assign(r.sensors.size(), a.rmse);
    a.blind->leave_one_out[1] = kNan;
    a.blind->split_rms = 0.7 * a.rmse;
    a.blind->leave_one_out_ci95 = a.rmse_ci95;
    a.blind->predictive_rms = a.rmse;
    a.blind->predictive_ci95 = a.rmse_ci95;
  }
  return r;
}

ReplayResult nothing_scored() {
  ReplayResult r = synthetic_replay();
  for (AlgorithmResult& a : r.algorithms) {
    a.rmse = a.regret = a.ns_per_sample = a.learning_s = kNan;
    a.rmse_ci95 = {kNan, kNan};
    a.peak_bytes.reset();
    a.ratio_to_best.reset();
    a.as_good_as_best = false;
    for (InputScore& input : a.inputs) {
      input.error = ErrorScore{};
      input.error.rmse = input.error.bias = input.error.maximum = input.error.converged_s = kNan;
      input.error.rmse_ci95 = input.error.bias_ci95 = {kNan, kNan};
      input.optimum_ratio = kNan;
      input.window_rms = {};
      input.allan.points.clear();
    }
    a.weights.clear();
    a.variances.clear();
    a.weight_track = a.variance_track = {};
    a.watches_faults = false;
    a.faults.clear();
    a.answers.clear();
  }
  r.faults.clear();
  r.best.reset();
  r.best_sensor.reset();
  r.tracks = {};
  return r;
}

ReplayResult hostile_replay() {
  ReplayResult r = synthetic_replay(hostile_names().size());
  for (std::size_t i = 0; i < hostile_names().size(); ++i) {
    const std::string& name = hostile_names()[i];
    r.sensors[i].name = r.sensors[i].unit = r.sensors[i].noise_source = name;
    r.plan.push_back(name);
    r.command.push_back(name);
    r.warnings.add("clock_change", name, name);
    r.logs[0].warnings.add("clock_change", name, name);
    if (i < r.algorithms.size()) r.algorithms[i].remarks.add("clock_change", name, name);
  }
  r.scene.name = hostile_names()[1] + hostile_names()[0];
  r.scene.file = r.logs[0].file = hostile_names()[0];
  r.inputs[0].name = r.inputs[0].unit = r.reference_use = hostile_names()[2];
  r.settings.push_back({"note", hostile_names()[1]});
  for (AlgorithmResult& a : r.algorithms)
    if (!a.ran) a.why = hostile_names()[0];
  r.algorithms[0].label = hostile_names()[1];
  r.algorithms[0].faults = {{0, hostile_names()[0], 3, {}}};
  return r;
}

ReplayResult synthetic_replay_of_kind(const std::string& kind) {
  if (kind == "plain") return synthetic_replay();
  if (kind == "large") return synthetic_replay(12);
  if (kind == "array") return synthetic_replay(200);
  if (kind == "inputs") return synthetic_replay(6, 2);
  if (kind == "blind") return without_reference();
  if (kind == "nothing") return nothing_scored();
  if (kind == "hostile") return hostile_replay();
  throw std::runtime_error("no such kind: " + kind);
}

}  // namespace test
