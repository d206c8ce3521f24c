#include "libchar/replay/detail/plan/plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/fusion/why_not.hpp"
#include "libchar/replay/detail/plan/plan_sentences.hpp"

namespace libchar {
namespace {

// Enough blocks that their median time means something, and that tracks over time have points;
// blocks large enough that reading the clock costs nothing.
constexpr std::int64_t kBlocks = 512;
constexpr std::int64_t kSmallestBlock = 256, kLargestBlock = 4096;
/// A shorter recording has no half to spare.
constexpr std::int64_t kFewestTaught = 512;

Eigen::MatrixXd observation_matrix(const Scene& scene, std::size_t inputs) {
  if (scene.tilt) return {};
  // A simulation's rows weigh all its truth signals, a reference may name some of them.
  std::vector<std::size_t> columns;
  for (std::size_t j = 0; j < inputs; ++j) columns.push_back(j);
  if (scene.simulate && scene.reference) {
    const auto& names = scene.simulate->truth_names;
    for (std::size_t j = 0; j < inputs; ++j)
      columns[j] =
          static_cast<std::size_t>(std::find(names.begin(), names.end(), scene.reference->channels[j]) - names.begin());
  }
  Eigen::MatrixXd h(scene.sensors.size(), inputs);
  for (std::size_t i = 0; i < scene.sensors.size(); ++i)
    for (std::size_t j = 0; j < inputs; ++j)
      h(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = scene.sensors[i].h[columns[j]];
  if (inputs == 1 && (h.array() == 1).all()) return {};
  return h;
}

// Up to where no sensor is known to fail; 0 where it is not known.
std::int64_t fault_free(const Scene& scene, const Instants& instants, std::int64_t run_from, std::int64_t run_to) {
  if (scene.fault_free_s)
    return std::clamp<std::int64_t>(static_cast<std::int64_t>(*scene.fault_free_s * instants.info().rate_hz), 0,
                                    run_to - run_from);
  const auto& faults = instants.source().known_faults();
  if (faults.empty() && !scene.simulate && !scene.simulated) return 0;
  std::int64_t first = run_to;
  for (const SensorFault& fault : faults)
    if (instants.instant_at(fault.to_s) > run_from) first = std::min(first, instants.instant_at(fault.from_s));
  return std::max<std::int64_t>(0, first - run_from);
}

std::vector<std::int64_t> section_starts(const Instants& instants, std::int64_t run_from, std::int64_t run_to) {
  std::set<std::int64_t> starts;
  for (const SensorFault& fault : instants.source().known_faults())
    for (const double t : {fault.from_s, fault.to_s}) {
      const std::int64_t instant = instants.instant_at(t);
      if (instant > run_from && instant < run_to) starts.insert(instant - run_from);
    }
  return {starts.begin(), starts.end()};
}

// In the unit of the fused samples; `level` is the variance of one.
fusion::NoiseModel noise_model(const SensorModel& model, double scale, double level) {
  const double size = std::abs(scale * model.sensitivity.gain);
  fusion::NoiseModel out;
  out.white = level;
  out.flicker = size * simulated_value(model[Term::flicker]);
  out.walk = size * simulated_value(model[Term::walk]);
  if (model.gauss_markov.sigma > 0)
    out.gauss_markov.push_back({size * model.gauss_markov.sigma, model.gauss_markov.tau_s});
  return out;
}

fusion::Array describe_array(const Scene& scene, const Instants& instants, const SensorKnowledge& knowledge,
                             const ReplayPlan& plan) {
  fusion::Array array;
  const InstantsInfo& info = instants.info();
  array.channels = static_cast<Eigen::Index>(scene.sensors.size());
  for (const SceneSensor& sensor : scene.sensors) array.names.push_back(sensor.name);
  array.observation_matrix = observation_matrix(scene, info.input_names.size());
  const Eigen::Map<const Eigen::VectorXd> levels(knowledge.noise_variances.data(), array.channels);
  const bool known = plan.live.empty() ? (levels.array() > 0).all() : (levels(plan.live).array() > 0).all();
  if (known) array.noise_levels = levels;
  // A filter takes out the drifts that the models describe.
  if (known && !scene.preparation.filters() &&
      std::all_of(scene.sensors.begin(), scene.sensors.end(), [](const SceneSensor& s) { return s.model.has_value(); }))
    for (std::size_t i = 0; i < scene.sensors.size(); ++i)
      array.noise_models.push_back(noise_model(
          *scene.sensors[i].model, scene.sensors[i].scale * model_factor(scene, instants, i) * instants.factor(i),
          levels[static_cast<Eigen::Index>(i)]));
  array.rate_hz = info.rate_hz;
  array.learning_samples = info.has_reference ? plan.learn_to - plan.learn_from : 0;
  array.reference_throughout = info.has_reference;
  array.fault_free_samples = fault_free(scene, instants, plan.run_from, plan.run_to);
  array.section_starts = section_starts(instants, plan.run_from, plan.run_to);
  if (scene.tilt)
    array.tilt = fusion::TiltChannels{static_cast<Eigen::Index>(scene.tilt->gyroscope),
                                      static_cast<Eigen::Index>(scene.tilt->accelerometer_x),
                                      static_cast<Eigen::Index>(scene.tilt->accelerometer_z)};
  return array;
}

/// A sensor with samples at fewer instants than this share of the run measures nothing.
constexpr double kLeastPresent = 1e-3;
/// One that stands still for more than this share of it is left out: many methods need all sensors at each instant.
constexpr double kMostFrozen = 0.5;

// A dead sensor must not leave every instant of the others incomplete.
std::vector<Eigen::Index> live_sensors(const Scene& scene, const Instants& instants, ReplayPlan& plan) {
  std::vector<Eigen::Index> live;
  const SourceInfo& source = instants.source().info();
  say_copies(source, scene, plan.warnings);
  if (scene.tilt || source.presence.empty()) return live;
  const auto sample = [&](std::int64_t instant) {
    return (instants.info().start_s + static_cast<double>(instant) / instants.info().rate_hz) * source.rate_hz;
  };
  const double from = sample(plan.run_from), to = sample(plan.run_to);
  for (std::size_t i = 0; i < source.presence.size(); ++i) {
    const Presence& at = source.presence[i];
    if (source.copies_missing && source.copies[i]) continue;
    if (i < source.frozen.size() && !source.frozen[i].empty()) {
      double inside = 0;
      for (const Presence::Run& run : source.frozen[i]) {
        const auto begin = static_cast<double>(run.from), end = static_cast<double>(run.from + run.count);
        inside += std::max(0.0, std::min(to, end) - std::max(from, begin));
      }
      const bool whole = inside >= kMostFrozen * (to - from);
      plan.warnings.add(
          "frozen_sensor",
          whole ? "sensors that are frozen while the others move were left out of everything" : kFrozenMissing,
          frozen_words(scene.sensors[i].name, source.frozen[i], source));
      if (whole) continue;
    }
    const double overlap =
        std::min(to, static_cast<double>(at.last) + 1) - std::max(from, static_cast<double>(at.first));
    if (at.samples > 0 && std::min(static_cast<double>(at.samples), overlap) > kLeastPresent * (to - from))
      live.push_back(static_cast<Eigen::Index>(i));
    else
      plan.warnings.add("sensor_without_samples",
                        "sensors without samples in the evaluation were left out of everything", scene.sensors[i].name);
  }
  if (live.size() == source.presence.size())
    live.clear();
  else if (live.empty())
    throw input_error("E0909", scene.file).says("no sensor has samples in the evaluation");
  return live;
}

// What is run and not scored, or not learnt from: what the scene says, and what a filter needs to settle.
void place_warm_up(const Scene& scene, const Instants& instants, ReplayPlan& plan) {
  const std::int64_t settled = instants.settled();
  const bool learning = plan.learn_to > plan.learn_from;
  plan.learn_from = std::min(std::max(plan.learn_from, settled), plan.learn_to);
  if (learning && plan.learn_from == plan.learn_to)
    plan.warnings.add(
        "learning_before_settled", "the learning window ends before the filter has settled: nothing is learnt there",
        fmt::format("settled after {}", duration_text(static_cast<double>(settled) / instants.info().rate_hz)));
  plan.warm_up = std::max<std::int64_t>(
      clamped_whole<std::int64_t>(std::round(scene.warm_up_s.value_or(0) * instants.info().rate_hz)),
      settled - plan.run_from);
  if (plan.warm_up > plan.run_to - plan.run_from - 2)
    throw input_error("E0903", scene.file)
        .says(settled > plan.run_from ? "the evaluation ends before the filter has settled"
                                      : "warm_up_s: it leaves fewer than two instants of the evaluation to score")
        .got(duration_text(static_cast<double>(plan.warm_up) / instants.info().rate_hz));
}

TimeWindow first_half(const Instants& instants) {
  const InstantsInfo& info = instants.info();
  return {0, info.start_s + static_cast<double>(info.count / 2) / info.rate_hz};
}

// Seconds from the recording's first sample to instants.
void place_windows(const Scene& scene, const ReplayOptions& options, const Instants& instants, ReplayPlan& plan) {
  auto learning = options.learning ? options.learning : scene.learning;
  if (!learning && scene.align && scene.align->choose && instants.info().count >= kFewestTaught)
    learning = first_half(instants);
  const auto evaluation = options.evaluation ? options.evaluation : scene.evaluation;
  const double end_s = instants.info().start_s + static_cast<double>(instants.info().count) / instants.info().rate_hz;
  const auto check = [&](const TimeWindow& window, const char* key) {
    if (window.from_s >= end_s)
      throw input_error("E0903", scene.file)
          .says("{}: the window begins after the end of the recording, which is at {} s", key, brief_text(end_s, 6))
          .got(brief_text(window.from_s, 6));
    if (std::isfinite(window.to_s) && window.to_s > end_s + 1 / instants.info().rate_hz)
      plan.warnings.add(
          "window_beyond_end", "a window reaches beyond the end of the recording and ends with it",
          fmt::format("{} to {} s, the end is at {} s", key, brief_text(window.to_s, 6), brief_text(end_s, 6)));
  };
  if (learning) {
    check(*learning, "learning");
    plan.learning = {learning->from_s, std::min(learning->to_s, end_s)};
    plan.learn_from = instants.instant_at(learning->from_s);
    plan.learn_to = instants.instant_at(learning->to_s);
  }
  plan.evaluation = evaluation.value_or(TimeWindow{learning ? learning->to_s : 0, end_s});
  // What was learnt from the whole recording can only be tried on the same.
  if (!evaluation && learning && instants.instant_at(learning->to_s) >= instants.info().count)
    plan.evaluation = {0, end_s};
  check(plan.evaluation, "evaluation");
  plan.evaluation.to_s = std::min(plan.evaluation.to_s, end_s);
  plan.run_from = instants.instant_at(plan.evaluation.from_s);
  plan.run_to = instants.instant_at(plan.evaluation.to_s);
  if (plan.run_to - plan.run_from < 2)
    throw input_error("E0903", scene.file).says("evaluation: the window holds fewer than two instants");
  place_warm_up(scene, instants, plan);
  for (const SensorFault& fault : instants.source().known_faults())
    if (fault.from_s >= end_s)
      plan.warnings.add("fault_after_end", "a fault begins after the end of the recording and changes nothing",
                        fmt::format("{} from {} s", scene.sensors[fault.sensor].name, brief_text(fault.from_s, 6)));
  if (plan.learn_to > plan.run_from && plan.learn_from < plan.run_to)
    plan.warnings.add(
        "learning_in_evaluation",
        "the evaluation holds instants of the learning window: methods that learn there look better than they are", "");
}

std::string label_of(const SceneAlgorithm& algorithm, bool repeated) {
  std::string label = algorithm.name;
  if (!repeated || algorithm.options.empty()) return label;
  std::string options;
  for (const auto& [name, value] : algorithm.options)
    options += (options.empty() ? "" : ", ") + name + "=" + shortest(value);
  return label + " (" + options + ")";
}

PlannedAlgorithm planned(const SceneAlgorithm& asked, bool repeated, const Scene& scene) {
  try {
    const fusion::Entry& entry = fusion::algorithm(asked.name);
    PlannedAlgorithm out{label_of(asked, repeated), &entry, fusion::Settings(entry.options), "", true};
    for (const auto& [name, value] : asked.options) out.settings.set(name, value);
    return out;
  } catch (const Error& error) {
    if (asked.line == 0) throw;
    Problem problem = error.problem();
    problem.kind = ErrorKind::input;
    problem.where = fmt::format("{}:{}:{}", scene.file, asked.line, asked.column);
    throw Error(problem);
  }
}

std::vector<PlannedAlgorithm> choose(const Scene& scene, const ReplayOptions& options) {
  const auto& asked = options.algorithms.empty() ? scene.algorithms : options.algorithms;
  std::vector<PlannedAlgorithm> out;
  std::map<std::string, int> times;
  for (const SceneAlgorithm& algorithm : asked) ++times[algorithm.name];
  std::set<std::string> labels;
  for (const SceneAlgorithm& algorithm : asked) {
    out.push_back(planned(algorithm, times[algorithm.name] > 1, scene));
    if (!labels.insert(out.back().label).second)
      throw input_error("E0904", scene.file)
          .says("an algorithm is listed twice with the same options")
          .got(out.back().label);
  }
  if (asked.empty() || options.no_skip)
    for (const fusion::Entry& entry : fusion::algorithms())
      if (const std::string name(entry.description->name); !times.contains(name))
        out.push_back({name, &entry, fusion::Settings(entry.options),
                       asked.empty() && entry.description->as_published && !options.published
                           ? "is the form as published: runs by name or with `published`"
                           : "",
                       asked.empty()});
  return out;
}

// The smallest error that fixed weights can have, learnt on the run itself: with and without
// calibration, of the sensors that are healthy at each instant. For a tilt: the best filter,
// as it stands or tuned on the run, and either sensor alone.
std::vector<PlannedAlgorithm> optimum(const fusion::Array& array) {
  std::vector<PlannedAlgorithm> out;
  const auto add = [&](const char* name, std::vector<std::pair<std::string, double>> options) {
    const fusion::Entry& entry = fusion::algorithm(name);
    PlannedAlgorithm bound{name, &entry, fusion::Settings(entry.options), "", false};
    for (const auto& [option, value] : options) bound.settings.set(option, value);
    fusion::Array on_run = array;
    if (array.tilt) on_run.learning_samples = std::numeric_limits<std::int64_t>::max();
    bound.why = fusion::why_not(*entry.description, on_run);
    if (bound.runs()) out.push_back(std::move(bound));
  };
  if (array.tilt) {
    for (const char* name : {"tilt-kalman-tuned", "tilt-complementary-tuned", "tilt-kalman", "tilt-complementary",
                             "tilt-gyroscope", "tilt-accelerometer"})
      add(name, {});
    return out;
  }
  add("optimal-weights", {});
  add("optimal-weights", {{"calibrate", 1}});
  return out;
}

// What is shown where there is no reference, and what `no_skip` does where there is one.
void keep_budget(const ReplayOptions& options, const fusion::Array& live, ReplayPlan& plan) {
  if (!(options.budget_s > 0))
    throw usage_error("E0917")
        .says("the budget of an algorithm (`budget_s`) must be above zero")
        .got(duration_text(options.budget_s))
        .hint("10 s is the default");
  for (PlannedAlgorithm& a : plan.algorithms)
    if (a.runs() && !a.learns_before() && !a.learns_run()) {
      a.blind = blind_share(*a.entry, a.settings, live, plan.run_to - plan.run_from, plan.warm_up, options.budget_s);
      if (a.blind.whole || !a.asked || live.reference_throughout) continue;
      plan.warnings.add(
          "leave_one_out_budget",
          "leave-one-out that costs more than its budget ran on a part of the evaluation or was left out (`budget_s`)",
          blind_share_text(a));
    }
}

}  // namespace

Scene taught(const Scene& scene, const ReplayOptions& options) {
  Scene out = scene;
  const auto& asked = options.algorithms.empty() ? scene.algorithms : options.algorithms;
  const bool learns =
      asked.empty() || std::any_of(asked.begin(), asked.end(), [](const SceneAlgorithm& a) {
        const fusion::Entry* entry = fusion::find_algorithm(a.name);
        return entry != nullptr && (entry->description->needs.reference || entry->description->needs.reference_helps);
      });
  const bool said = scene.learning || scene.evaluation || options.learning || options.evaluation || scene.align ||
                    scene.fault_free_s || !scene.faults.empty() ||
                    (scene.simulated && !scene.simulated->faults.empty());
  const bool one = scene.reference && (scene.reference->mean || scene.reference->channels.size() == 1);
  if (!learns || said || !one || !scene.reference->teach || scene.simulate || scene.tilt || scene.sensors.size() < 2)
    return out;
  out.align = SceneAlign{};
  out.align->learn = "learning";
  out.align->choose = true;
  return out;
}

ReplayPlan make_plan(const Scene& scene, const ReplayOptions& options, const Instants& instants,
                     const SensorKnowledge& knowledge) {
  ReplayPlan plan;
  place_windows(scene, options, instants, plan);
  if (scene.reference && !scene.reference->recording && !scene.simulate)
    for (const SceneSensor& sensor : scene.sensors) {
      const auto& channels = scene.reference->channels;
      if (std::find(channels.begin(), channels.end(), sensor.channel) != channels.end())
        plan.warnings.add("reference_is_a_sensor",
                          "a sensor is part of the reference: its error is hidden in every score", sensor.name);
    }
  plan.live = live_sensors(scene, instants, plan);
  plan.array = describe_array(scene, instants, knowledge, plan);
  const fusion::Array live = subset(plan.array, plan.live);
  plan.algorithms = choose(scene, options);
  for (PlannedAlgorithm& algorithm : plan.algorithms)
    if (algorithm.runs()) {
      const fusion::Description& description = *algorithm.entry->description;
      algorithm.why = fusion::why_not(description, live);
      algorithm.helped = description.needs.reference_helps && live.learning_samples > 0;
    }
  if (instants.info().has_reference) plan.optimum = optimum(live);
  const auto any = [&](auto&& wanted) {
    return std::any_of(plan.algorithms.begin(), plan.algorithms.end(),
                       [&](const auto& a) { return a.runs() && wanted(a); });
  };
  plan.learning_pass =
      any([](const auto& a) { return a.learns_before(); }) || (options.no_skip && plan.learn_to > plan.learn_from);
  plan.run_learning_pass = !plan.optimum.empty() || any([](const auto& a) { return a.learns_run(); });
  plan.looking_pass = any([](const auto& a) { return a.looks_ahead(); });
  plan.without_reference = (!instants.info().has_reference || options.no_skip) && !scene.tilt;
  if (plan.without_reference) keep_budget(options, live, plan);
  if (!any([](const auto&) { return true; }))
    throw numeric_error("E0905", scene.file)
        .says("no algorithm can run on this scene: " + (plan.algorithms.empty()
                                                            ? std::string("none was asked for")
                                                            : plan.algorithms[0].label + " " + plan.algorithms[0].why))
        .hint("`explain_replay` says what each of them needs");
  const std::int64_t run = plan.run_to - plan.run_from;
  plan.block = options.block > 0 ? options.block
                                 : static_cast<std::size_t>(std::clamp(run / kBlocks, kSmallestBlock, kLargestBlock));
  return plan;
}

Eigen::MatrixXd observations(const Scene& scene, std::size_t inputs) { return observation_matrix(scene, inputs); }

fusion::Array subset(const fusion::Array& array, const std::vector<Eigen::Index>& channels) {
  fusion::Array part = array;
  if (channels.empty()) return part;
  part.channels = static_cast<Eigen::Index>(channels.size());
  part.names.clear();
  for (const Eigen::Index i : channels)
    part.names.push_back(fusion::channel_name(array.names, static_cast<std::size_t>(i)));
  if (array.observation_matrix.size() > 0)
    part.observation_matrix = array.observation_matrix(channels, Eigen::indexing::all);
  if (array.noise_levels.size() > 0) part.noise_levels = array.noise_levels(channels);
  if (!array.noise_models.empty()) {
    part.noise_models.clear();
    for (const Eigen::Index i : channels) part.noise_models.push_back(array.noise_models[static_cast<std::size_t>(i)]);
  }
  return part;
}

}  // namespace libchar
