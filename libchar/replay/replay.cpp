// The order of a replay: what the scene holds (length, rate, rest, lag), the plan, one pass that learns in the learning
// window, one in which the bounds learn on the evaluation and smoothers look at it, one that runs everything on it
// block by block, algorithm after algorithm, so that all see the same machine.

#include "libchar/replay/replay.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "libchar/core/process/work.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/fusion/algorithm.hpp"
#include "libchar/replay/detail/algorithm_run.hpp"
#include "libchar/replay/detail/align/alignment_stage.hpp"
#include "libchar/replay/detail/align/lag.hpp"
#include "libchar/replay/detail/blind_run.hpp"
#include "libchar/replay/detail/judge/judgement.hpp"
#include "libchar/replay/detail/learnt_fusion.hpp"
#include "libchar/replay/detail/pass_progress.hpp"
#include "libchar/replay/detail/plan/plan.hpp"
#include "libchar/replay/detail/plan/plan_sentences.hpp"
#include "libchar/replay/detail/plan/reading_meter.hpp"
#include "libchar/replay/detail/plan/sensor_knowledge.hpp"
#include "libchar/replay/detail/plan/sensor_words.hpp"
#include "libchar/replay/detail/plan/step_noise.hpp"
#include "libchar/replay/detail/plan/tilt_check.hpp"
#include "libchar/replay/detail/sensor_doubt.hpp"
#include "libchar/replay/detail/tracks/run_tracks.hpp"
#include "libchar/replay/view/ranking.hpp"

namespace libchar {
namespace {

constexpr std::size_t kLearningBlock = 4096;
constexpr double kWindowShare = 0.02;

struct SensorMeter {
  ErrorMeter error;
  double healthy_squares = 0, healthy_samples = 0;  // of the error, known faults left out
  double first = kMissing;
  bool constant = true;
  std::uint64_t missing = 0;
};

class Replay {
 public:
  Replay(Scene& scene, const ReplayOptions& options, Progress& progress, const ReplayWorkspace& workspace)
      : scene_(scene), options_(options), workspace_(workspace), progress_(progress), instants_(scene, progress) {
    if (scene.reference && scene.reference->estimate_lag) estimate_lag();
    PassProgress at_rest(progress, "measuring the rest");
    knowledge_ = know_sensors(scene, instants_, at_rest);
    passes_ += scene.rest ? 1 : 0;
    instants_.set_offsets(knowledge_.offsets);
    plan_ = make_plan(scene, options, instants_, knowledge_);
    // Too short to teach and to be judged.
    if (scene.align && scene.align->choose && plan_.learn_to <= plan_.learn_from) scene.align.reset();
    if (scene.reference && scene.reference->estimate_offset) estimate_offset();
  }

  std::vector<std::string> explain() const { return sentences(plan_, scene_, instants_, knowledge_); }

  ReplayResult run() {
    if (scene_.align) align();
    level();
    prepare();
    if (plan_.learning_pass) learn_before_run();
    if (plan_.run_learning_pass || plan_.looking_pass) learn_on_run();
    for (AlgorithmRun& run : runs_) run.finish_learning();
    for (AlgorithmRun& run : optimum_) run.finish_learning();
    for (const auto& blind : blind_)
      if (blind) blind->finish_looking();
    note_learnt();
    run_all();
    ReplayResult result = collect();
    time_again(result);
    return result;
  }

 private:
  void estimate_lag() {
    if (instants_.info().slow_reference) {  // with what its values stand for
      lag_s_ = instants_.lag_s();
      return;
    }
    PassProgress passing(progress_, "estimating the lag");
    const TimeWindow all;
    lag_s_ = find_lag(scene_, instants_, options_.evaluation ? *options_.evaluation : scene_.evaluation.value_or(all),
                      passing);
    instants_.set_lag(lag_s_, progress_);
    ++passes_;
  }

  // Where methods may learn, else on what is scored.
  void estimate_offset() {
    PassProgress passing(progress_, "estimating the offset");
    const bool learning = plan_.learn_to > plan_.learn_from;
    const std::int64_t from = learning ? plan_.learn_from : plan_.run_from + plan_.warm_up;
    const OffsetEstimate found =
        find_reference_offset(scene_, instants_, from, learning ? plan_.learn_to : plan_.run_to, passing);
    instants_.set_reference_offset(found.offset);
    const double unit = instants_.info().output_scale;
    offset_ = FoundOffset{found.offset * unit,
                          {(found.offset - found.reach95) * unit, (found.offset + found.reach95) * unit},
                          learning ? plan_.learning : plan_.evaluation,
                          learning,
                          found.long_memory};
    ++passes_;
  }

  // Before anything is learnt or fused.
  void align() {
    PassProgress passing(progress_, "aligning");
    std::vector<AlignmentResult::Trial> trials;
    if (scene_.align->choose) {
      ++passes_;
      trials = choose_scene_terms(scene_, plan_, instants_, passing);
    }
    try {
      alignment_ = learn_scene_alignment(scene_, plan_, instants_, passing);
    } catch (const Error& error) {
      // Nobody asked for terms that cannot be learnt here.
      if (!scene_.align->choose || error.problem().kind != ErrorKind::numeric) throw;
      return scene_.align.reset();
    }
    aligned_ = measure_alignment(scene_, plan_, instants_, *alignment_, plan_.warnings, passing);
    aligned_->trials = std::move(trials);
    passes_ += 2;
    if (scene_.align->apply) instants_.set_alignment(&*alignment_);
  }

  // Where nothing says which sensor is right, what they read on average and what they do about it are two questions.
  // The first is answered by the mean of their means, and no score sees the second through their offsets.
  void level() {
    if (instants_.info().has_reference || scene_.rest) return;
    PassProgress passing(progress_, "comparing the means");
    std::optional<detail::ReadingMeter> meter;
    ++passes_;
    instants_.pass(plan_.run_from, plan_.run_to, kLearningBlock, passing,
                   [&](const InstantBlock& b) { push_reading(b.samples, plan_.run_from, meter); });
    const auto found = meter ? meter->level(taken_out()) : std::nullopt;
    if (!found) return;
    knowledge_.common = found->common;
    if (!found->matters || scene_.align) return;  // what is reported only is fused as recorded
    for (std::size_t k = 0; k < found->offsets.size(); ++k) knowledge_.offsets[live(k)] = found->offsets[k];
    instants_.set_offsets(knowledge_.offsets);
  }

  // From each sensor that is not left out.
  std::vector<detail::TakenOut> taken_out() const {
    std::vector<detail::TakenOut> out;
    const std::size_t sensors = plan_.live.empty() ? scene_.sensors.size() : plan_.live.size();
    for (std::size_t k = 0; k < sensors; ++k) {
      out.push_back({knowledge_.common.level_sd ? knowledge_.offsets[live(k)] : 0, 0});
      if (!alignment_ || !scene_.align->apply) continue;
      const fusion::ChannelAlignment& aligned = alignment_->alignment.channels[live(k)];
      out.back() = {aligned.bias, aligned.gain};
    }
    return out;
  }

  // Place of a sensor that is not left out.
  std::size_t live(std::size_t k) const { return plan_.live.empty() ? k : static_cast<std::size_t>(plan_.live[k]); }

  void prepare() {
    frame_.array = &plan_.array;
    frame_.live = &plan_.live;
    frame_.heap = workspace_.heap;
    frame_.rate_hz = instants_.info().rate_hz;
    frame_.start_s = instants_.info().start_s + static_cast<double>(plan_.run_from) / frame_.rate_hz;
    frame_.scored_from_s = frame_.start_s + static_cast<double>(plan_.warm_up) / frame_.rate_hz;
    frame_.instants = plan_.run_to - plan_.run_from;
    frame_.output_scale = instants_.info().output_scale;
    frame_.tilt = scene_.tilt.has_value();
    frame_.allan = (options_.allan || options_.no_skip) && instants_.info().has_reference;
    frame_.tracks = true;
    runs_.reserve(plan_.algorithms.size());
    for (const PlannedAlgorithm& algorithm : plan_.algorithms)
      if (algorithm.runs()) {
        runs_.emplace_back(algorithm, frame_);
        const bool left_out = !algorithm.blind.whole && algorithm.blind.stretches.empty();
        if (plan_.without_reference && !algorithm.learns_before() && !algorithm.learns_run() && !left_out)
          blind_.push_back(std::make_unique<BlindRun>(algorithm, plan_.array, plan_.live));
        else
          blind_.push_back(nullptr);
      }
    array_on_run_ = plan_.array;
    array_on_run_.learning_samples = plan_.run_to - plan_.run_from;
    optimum_frame_ = frame_;
    optimum_frame_.array = &array_on_run_;
    optimum_frame_.heap = nullptr;
    optimum_frame_.allan = optimum_frame_.tracks = false;
    optimum_.reserve(plan_.optimum.size());
    for (const PlannedAlgorithm& algorithm : plan_.optimum) optimum_.emplace_back(algorithm, optimum_frame_);
    sensors_.resize(scene_.sensors.size());
    tracker_ =
        RunTracker(frame_, plan_.run_to - plan_.run_from, runs_.size(), sensors_are_comparable(), fault_starts());
  }

  std::vector<std::int64_t> fault_starts() const {
    std::vector<std::int64_t> out;
    for (const SensorFault& fault : instants_.source().known_faults())
      out.push_back(instants_.instant_at(fault.from_s) - plan_.run_from);
    return out;
  }

  // They see one input in one unit.
  bool sensors_are_comparable() const {
    const std::vector<std::string>& units = instants_.info().units;
    return !scene_.tilt && plan_.array.inputs() == 1 && (plan_.array.h().array() != 0).all() &&
           std::all_of(units.begin(), units.end(), [&](const auto& u) { return u == units[0]; });
  }

  void learn_before_run() {
    PassProgress passing(progress_, "learning");
    ++passes_;
    instants_.pass(plan_.learn_from, plan_.learn_to, kLearningBlock, passing, [&](const InstantBlock& b) {
      for (AlgorithmRun& run : runs_)
        if (run.planned().learns_before()) run.learn(b.samples, b.truth);
      if (watched_from() < plan_.run_from) watch_readings(b.samples, b.truth);
    });
  }

  // A sensor is judged by most of what is known of it: the run, and what directly precedes it.
  std::int64_t watched_from() const {
    const bool learns = plan_.learn_to > plan_.learn_from && plan_.learn_to == plan_.run_from;
    return learns ? plan_.learn_from : plan_.run_from;
  }

  void learn_on_run() {
    PassProgress passing(progress_, plan_.run_learning_pass ? "learning the bounds" : "looking ahead");
    ++passes_;
    instants_.pass(plan_.run_from, plan_.run_to, kLearningBlock, passing, [&](const InstantBlock& b) {
      for (AlgorithmRun& run : runs_)
        if (run.planned().learns_run()) run.learn(b.samples, b.truth);
      for (AlgorithmRun& run : runs_)
        if (run.planned().looks_ahead()) run.look(b.samples);
      for (const auto& blind : blind_)
        if (blind && blind->looks_ahead()) blind->look(b.first - plan_.run_from, b.samples);
      if (!plan_.run_learning_pass) return;
      const Eigen::MatrixXd& healthy = without_faults(b.first, b.samples);
      for (AlgorithmRun& run : optimum_) run.learn(healthy, b.truth);
    });
  }

  // The optimum knows which samples are those of a failed sensor, and leaves them out.
  const Eigen::MatrixXd& without_faults(std::int64_t first, const Eigen::MatrixXd& samples) {
    const auto& faults = instants_.source().known_faults();
    if (faults.empty() || scene_.tilt) return samples;
    healthy_ = samples;
    for (const SensorFault& fault : faults) {
      const std::int64_t from = std::max(instants_.instant_at(fault.from_s), first);
      const std::int64_t to = std::min<std::int64_t>(instants_.instant_at(fault.to_s), first + samples.cols());
      if (from < to)
        healthy_.row(static_cast<Eigen::Index>(fault.sensor))
            .segment(static_cast<Eigen::Index>(from - first), static_cast<Eigen::Index>(to - from))
            .setConstant(kMissing);
    }
    return healthy_;
  }

  void watch_sensors(const Eigen::MatrixXd& samples, const Eigen::MatrixXd& truth) {
    if (watch_.tilt) watch_.tilt->push(samples, truth);
    if (watch_.steps) with_live(samples, [this](const auto& live) { watch_.steps->push(live); });
    watch_readings(samples, truth);
  }

  // Of two sensors a reference tells which of them it is that reads otherwise; of more it shows what is lost in the
  // noise of the others.
  void watch_readings(const Eigen::MatrixXd& samples, const Eigen::MatrixXd& truth) {
    push_reading(samples, watched_from(), watch_.readings);
    if (!watch_.readings || truth.rows() != 1) return;
    with_live(samples, [&](const auto& rows) {
      if (watch_.readings->sensors() > 2) {
        if (!watch_.beside_truth) watch_.beside_truth.emplace(rows.rows(), plan_.run_to - watched_from());
        return watch_.beside_truth->push(rows, truth.row(0));
      }
      Eigen::MatrixXd all(3, rows.cols());
      all << rows, truth;
      if (!watch_.with_truth) watch_.with_truth.emplace(3, plan_.run_to - watched_from());
      watch_.with_truth->push(all);
    });
  }

  void push_reading(const Eigen::MatrixXd& samples, std::int64_t from,
                    std::optional<detail::ReadingMeter>& meter) const {
    const fusion::Array live = subset(plan_.array, plan_.live);
    if (!meter && !scene_.tilt && live.one_common_input() && live.channels >= 2)
      meter.emplace(live.channels, plan_.run_to - from);
    if (meter) with_live(samples, [&](const auto& rows) { meter->push(rows); });
  }

  template <class Work>
  void with_live(const Eigen::MatrixXd& samples, const Work& work) const {
    if (plan_.live.empty()) return work(samples);
    work(Eigen::MatrixXd(samples(plan_.live, Eigen::indexing::all)));
  }

  // What another log can be fused with.
  void note_learnt() {
    learnt_ =
        learnt_of(scene_, plan_, instants_, knowledge_, scene_.align && scene_.align->apply ? &*alignment_ : nullptr);
    for (const AlgorithmRun& run : runs_)
      if (run.planned().asked) learnt_.algorithms.push_back(run.hand_out());
  }

  void run_all() {
    PassProgress passing(progress_, "replaying");
    ++passes_;
    if (workspace_.estimates != nullptr) begin_estimates();
    const fusion::Array live = subset(plan_.array, plan_.live);
    if (plan_.array.tilt) watch_.tilt.emplace(*plan_.array.tilt, instants_.info().rate_hz);
    watch_.when.set_length(frame_.instants);
    if (!scene_.tilt) watch_.steps.emplace(live.h(), plan_.run_to - plan_.run_from);
    if (!scene_.tilt) detection_.emplace(plan_, instants_.source().known_faults());
    const auto blocks = static_cast<std::size_t>(plan_.run_to - plan_.run_from) / plan_.block + 1;
    instants_.pass(plan_.run_from, plan_.run_to, plan_.block, passing, [&](const InstantBlock& b) {
      for (AlgorithmRun& run : runs_) run.run(b.samples);
      const Eigen::MatrixXd& healthy = without_faults(b.first, b.samples);
      for (AlgorithmRun& run : optimum_) run.run(healthy);
      const std::int64_t done = b.first - plan_.run_from;
      const auto skip = static_cast<Eigen::Index>(std::clamp<std::int64_t>(plan_.warm_up - done, 0, b.samples.cols()));
      for (AlgorithmRun& run : runs_) run.score(done, b.truth, skip);
      for (AlgorithmRun& run : optimum_) run.score(done, b.truth, skip);
      for (const auto& blind : blind_)
        if (blind) blind->run(done, b.samples, skip);
      judge_sensors(b.samples, healthy, b.truth, skip);
      tracker_.push(done, b.samples, b.truth, runs_);
      if (detection_) detection_->push(b.samples);
      watch_sensors(b.samples, b.truth);
      if (watch_.readings) note_samples(done, b.samples, skip);
      if (workspace_.estimates != nullptr) give_estimates(b);
      if (blocks < kLeastTimed) kept_.push_back(b.samples);
    });
  }

  // Where the runs note their estimates.
  void note_samples(std::int64_t done, const Eigen::MatrixXd& samples, Eigen::Index skip) {
    with_live(samples, [&](const auto& live) {
      for (Eigen::Index k = skip; k < live.cols(); ++k)
        if (watch_.when.notes(done + k)) watch_.noted.emplace_back(live.col(k));
    });
  }

  void judge_sensors(const Eigen::MatrixXd& samples, const Eigen::MatrixXd& healthy, const Eigen::MatrixXd& truth,
                     Eigen::Index skip) {
    const bool errors = truth.rows() > 0 && !scene_.tilt;
    if (truth.rows() > 0) truths_ += truth.row(0).array().isFinite().count();
    if (errors) expected_ = plan_.array.h() * truth;
    std::vector<double> error(static_cast<std::size_t>(samples.cols()));
    for (std::size_t i = 0; i < sensors_.size(); ++i) {
      SensorMeter& meter = sensors_[i];
      const auto row = static_cast<Eigen::Index>(i);
      for (Eigen::Index k = 0; k < samples.cols(); ++k) {
        const double y = samples(row, k);
        if (!std::isfinite(y)) {
          ++meter.missing;
        } else if (std::isnan(meter.first)) {
          meter.first = y;
        } else if (y != meter.first) {
          meter.constant = false;
        }
        if (fusion::usable(y))
          largest_ = std::max(largest_, std::abs(y));
        else
          beyond_ = beyond_ || !std::isnan(y);
        if (errors) {
          const double e = y - expected_(row, k);
          error[static_cast<std::size_t>(k)] = std::isfinite(e) ? e : kMissing;
          if (k >= skip && std::isfinite(e) && std::isfinite(healthy(row, k))) {
            meter.healthy_squares += e * e;
            meter.healthy_samples += 1;
          }
        }
      }
      if (errors) meter.error.push(std::span(error).subspan(static_cast<std::size_t>(skip)));
    }
  }

  void begin_estimates() {
    LogInfo info;
    info.samples = info.rows = static_cast<std::uint64_t>(plan_.run_to - plan_.run_from);
    info.time.rate_hz = frame_.rate_hz;
    // Seconds from the recording's first sample, as everything else in the report.
    info.channels.push_back({"t", "s", false});
    const std::vector<InputResult> all = inputs();
    for (const InputResult& input : all) info.channels.push_back({input.name, input.unit, false});
    for (const AlgorithmRun& run : runs_)
      if (run.alive() && run.planned().asked)
        for (const InputResult& input : all)
          info.channels.push_back(
              {all.size() == 1 ? run.planned().label : run.planned().label + " " + input.name, input.unit, false});
    workspace_.estimates->begin(info);
  }

  void give_estimates(const InstantBlock& b) {
    std::vector<std::vector<double>> columns(1);
    for (Eigen::Index k = 0; k < b.samples.cols(); ++k)
      columns[0].push_back(frame_.start_s + static_cast<double>(b.first - plan_.run_from + k) / frame_.rate_hz);
    const auto add = [&](const auto& row) { columns.emplace_back(row.begin(), row.end()); };
    if (b.truth.rows() == 0) columns.resize(1 + inputs().size(), std::vector<double>(columns[0].size(), kMissing));
    for (Eigen::Index j = 0; j < b.truth.rows(); ++j) add((b.truth.row(j) * frame_.output_scale).eval());
    for (const AlgorithmRun& run : runs_)
      if (run.alive() && run.planned().asked)
        for (Eigen::Index j = 0; j < run.estimates().rows(); ++j) add(run.estimates().row(j));
    const std::vector<std::span<const double>> spans(columns.begin(), columns.end());
    workspace_.estimates->block(spans);
  }

  // After everything else: what the algorithms hold then is of no interest.
  void time_again(ReplayResult& result) {
    if (kept_.empty() || !options_.timing) return;
    const auto timed_enough = [](const AlgorithmRun& run) { return run.timed_enough(); };
    while (!std::all_of(runs_.begin(), runs_.end(), timed_enough))
      for (const Eigen::MatrixXd& samples : kept_)
        for (AlgorithmRun& run : runs_)
          if (!run.timed_enough()) run.repeat(samples);
    for (const AlgorithmRun& run : runs_)
      for (AlgorithmResult& algorithm : result.algorithms)
        if (run.alive() && algorithm.label == run.planned().label) algorithm.ns_per_sample = run.median_ns();
  }

  std::vector<InputResult> inputs() const {
    std::vector<InputResult> out;
    for (std::size_t j = 0; j < instants_.info().input_names.size(); ++j)
      out.push_back({instants_.info().input_names[j], instants_.info().input_units[j], kMissing});
    return out;
  }

  /// A result, and the errors by which it is compared with others; empty: by none.
  struct Scored {
    AlgorithmResult result;
    Meters meters;
  };
  void tell_readings(ReplayResult& out) const;
  void note_deviations(const ReplayResult& out);
  ReplayResult collect();
  void refuse_sizes() const;
  void add_facts(ReplayResult& out) const;
  void add_sensors(ReplayResult& out, const ScoreOptions& scoring) const;
  Scored scored(const AlgorithmRun& run, const BlindRun* blind, const ReplayResult& so_far,
                const ScoreOptions& scoring) const;
  std::vector<Meters> add_algorithms(ReplayResult& out, const ScoreOptions& scoring) const;
  std::vector<double> costs() const;
  void add_tracks(ReplayResult& out) const;
  SensorResult sensor_result(std::size_t i, const ScoreOptions& scoring) const;

  Scene& scene_;  // its alignment is chosen here
  const ReplayOptions& options_;
  const ReplayWorkspace workspace_;
  Progress& progress_;
  Instants instants_;
  SensorKnowledge knowledge_;
  ReplayPlan plan_;
  std::optional<SceneAlignment> alignment_;
  std::optional<AlignmentResult> aligned_;
  LearntFusion learnt_;
  struct {
    std::optional<StepNoiseMeter> steps;
    std::optional<detail::ReadingMeter> readings, beside_truth;
    std::optional<detail::ReadingMeter> with_truth;  // of two sensors and the reference
    std::optional<detail::TiltCheck> tilt;
    detail::UsualEstimates when;
    std::vector<Eigen::VectorXd> noted;  // samples at its instants
  } watch_;
  std::optional<DetectionSweep> detection_;
  RunFrame frame_, optimum_frame_;
  fusion::Array array_on_run_;
  std::vector<AlgorithmRun> runs_, optimum_;
  std::vector<std::unique_ptr<BlindRun>> blind_;  // one a run, none where there is a reference
  std::vector<SensorMeter> sensors_;
  RunTracker tracker_;
  double largest_ = 0;   // magnitude of the sensors' usable samples
  bool beyond_ = false;  // there are larger ones
  std::vector<Eigen::MatrixXd> kept_;
  Eigen::MatrixXd expected_, healthy_;
  Eigen::Index truths_ = 0;  // instants of the run with a truth
  double lag_s_ = 0;
  std::optional<FoundOffset> offset_;
  std::uint64_t passes_ = 0;
};

SensorResult Replay::sensor_result(std::size_t i, const ScoreOptions& scoring) const {
  SensorResult out;
  out.name = scene_.sensors[i].name;
  out.unit = instants_.info().units[i];
  out.error = score(sensors_[i].error, frame_.rate_hz, scoring);
  if (knowledge_.noise_variances[i] > 0) out.noise_variance = knowledge_.noise_variances[i];
  out.noise_source = knowledge_.noise_sources[i];
  out.offset = knowledge_.offsets[i];
  out.missing = static_cast<double>(sensors_[i].missing) / static_cast<double>(plan_.run_to - plan_.run_from);
  const SourceInfo& source = instants_.source().info();
  if (i < source.copies.size() && source.copies[i]) out.copy_of = scene_.sensors[source.copies[i]->original].name;
  out.constant = sensors_[i].constant && out.copy_of.empty();
  out.h = scene_.sensors[i].h;
  return out;
}

// What the scene is, as far as the reports tell it.
void Replay::add_facts(ReplayResult& out) const {
  const InstantsInfo& info = instants_.info();
  out.scene = scene_;
  out.logs = info.logs;
  out.plan = explain();
  out.rate_hz = info.rate_hz;
  out.instants = static_cast<std::uint64_t>(plan_.run_to - plan_.run_from);
  out.start_s = frame_.start_s;
  out.scored_from_s = frame_.scored_from_s;
  if (plan_.learn_to > plan_.learn_from) out.learning = plan_.learning;
  out.evaluation = plan_.evaluation;
  out.window_s =
      options_.window_s > 0 ? options_.window_s : kWindowShare * static_cast<double>(out.instants) / info.rate_hz;
  out.lag_s = scene_.reference && scene_.reference->estimate_lag ? lag_s_
              : scene_.reference                                 ? scene_.reference->lag_s
                                                                 : 0;
  out.lag_estimated = scene_.reference && scene_.reference->estimate_lag;
  out.reference_offset = offset_;
  out.has_reference = info.has_reference;
  out.reference_use = info.reference_use;
  out.faults = instants_.source().known_faults();
  out.warnings = scene_.warnings;
  out.warnings.merge(instants_.source().info().samples_say);
  out.warnings.merge(plan_.warnings);
  out.inputs = inputs();
  out.alignment = aligned_;
  static_cast<detail::CommonErrors&>(out) = knowledge_.common;
}

void Replay::add_sensors(ReplayResult& out, const ScoreOptions& scoring) const {
  for (std::size_t i = 0; i < sensors_.size(); ++i) out.sensors.push_back(sensor_result(i, scoring));
  for (const SensorResult& sensor : out.sensors)
    if (sensor.constant) out.warnings.add("constant_sensor", "sensors that never change during the run", sensor.name);
  for (const SceneSensor& sensor : scene_.sensors)
    for (const Finding& one : sensor.model ? sensor.model->findings : std::vector<Finding>{})
      if (one.severity != Severity::note)
        out.warnings.add(one.code, "the model of a sensor: " + as_part(one.sentence), sensor.name).severity =
            one.severity;
}

// One that ran, and by which of its errors it is compared with others; empty: by none.
Replay::Scored Replay::scored(const AlgorithmRun& run, const BlindRun* blind, const ReplayResult& so_far,
                              const ScoreOptions& scoring) const {
  Scored out{run.result(scoring, so_far.window_s), {}};
  AlgorithmResult& result = out.result;
  if (result.ran && !result.inputs.empty()) out.meters = {&run.meters()[0]};
  if (result.ran && blind != nullptr && !so_far.has_reference) {
    result.blind = blind->result(so_far.rate_hz, scoring);
    result.rmse = result.blind->predictive_rms;
    result.rmse_ci95 = result.blind->predictive_ci95;
    out.meters = blind->meters();
  }
  if (!options_.allan)
    for (InputScore& input : result.inputs) input.allan = {};
  judge_tracking(result, run, optimum_, so_far, plan_.array);
  return out;
}

// All that were asked for. Returns by which error each is compared.
std::vector<Meters> Replay::add_algorithms(ReplayResult& out, const ScoreOptions& scoring) const {
  std::vector<Meters> meters;
  std::size_t next = 0;
  for (const PlannedAlgorithm& algorithm : plan_.algorithms) {
    Scored one;
    if (algorithm.runs()) {
      const AlgorithmRun& run = runs_[next];
      const BlindRun* blind = blind_[next++].get();
      out.work.learnt += run.learnt();
      out.work.steps += run.steps();
      if (blind != nullptr) out.work.blind_steps += blind->steps();
      if (!algorithm.asked) continue;
      one = scored(run, blind, out, scoring);
    } else {
      if (!algorithm.asked) continue;
      one.result = not_run(algorithm, algorithm.why);
    }
    meters.push_back(one.meters);
    answer_faults(one.result, out);
    out.algorithms.push_back(std::move(one.result));
  }
  return meters;
}

// Declared, never measured: what is recommended does not depend on a clock.
std::vector<double> Replay::costs() const {
  const fusion::Array live = subset(plan_.array, plan_.live);
  std::vector<double> out;
  for (const PlannedAlgorithm& algorithm : plan_.algorithms)
    if (algorithm.asked) out.push_back(algorithm.entry->cost_ns(live, algorithm.settings));
  return out;
}

// Of the method that one would use: the best, or else the first in the order.
void Replay::add_tracks(ReplayResult& out) const {
  const AlgorithmResult* shown = out.best ? &out.algorithms[*out.best] : nullptr;
  for (const AlgorithmResult* a : ranked(out))
    if (shown == nullptr && !a->bound) shown = a;
  for (std::size_t i = 0; i < runs_.size() && shown != nullptr; ++i) {
    if (!runs_[i].planned().asked || runs_[i].planned().label != shown->label) continue;
    out.tracks = tracker_.result(i, out.best_sensor);
    out.tracks.algorithm = static_cast<std::size_t>(shown - out.algorithms.data());
  }
}

// Beyond, squares of samples are infinite or zero, and every score is made of them.
void Replay::refuse_sizes() const {
  if (!beyond_ && (largest_ == 0 || largest_ >= 1 / fusion::kLargestSample)) return;
  if (beyond_ && largest_ > 0) return;
  throw input_error("E0909", scene_.file)
      .says(
          "all samples of the sensors are beyond 10¹⁰⁰ or below 10⁻¹⁰⁰ in magnitude: errors of that size cannot be "
          "squared")
      .got(beyond_ ? "beyond 10¹⁰⁰" : brief_text(largest_, 3))
      .hint("give the sensors a `scale` and a `unit`");
}

// A constant that all sensors share against the reference: a mounting, a zero.
void doubt_offset(ReplayResult& out) {
  constexpr double kShare = 0.5, kTimes = 3;
  if (!out.has_reference || !out.best || out.reference_offset) return;
  AlgorithmResult& best = out.algorithms[*out.best];
  if (best.inputs.empty()) return;
  const InputScore& score = best.inputs.front();
  const double bias = std::abs(score.error.bias), rmse = score.error.rmse,
               width = 0.5 * (score.error.bias_ci95.high - score.error.bias_ci95.low);
  if (!(bias * bias > kShare * rmse * rmse) || !(bias > kTimes * width)) return;
  Finding& found = best.remarks.add(
      "constant_error",
      fmt::format("{} of the mean square error is a constant, {}{}: an offset of the reference or of the sensors",
                  percent_text(bias * bias / (rmse * rmse)), number_text(score.error.bias, 3),
                  out.inputs.empty() || out.inputs[0].unit.empty() ? "" : " " + out.inputs[0].unit));
  found.help.push_back({"Take it out of the reference.", {{"reference_offset", "estimate"}}});
}

// Of each input; empty: of one it is not known.
std::vector<double> rms_errors(const AlgorithmResult& algorithm) {
  std::vector<double> out;
  for (const InputScore& input : algorithm.inputs)
    if (std::isfinite(input.error.rmse)) out.push_back(input.error.rmse);
  return out.size() == algorithm.inputs.size() ? out : std::vector<double>();
}

// What each method's estimates are off, and what they usually are beside the sensors.
void Replay::note_deviations(const ReplayResult& out) {
  const detail::ReadingMeter::Readings readings =
      watch_.readings ? watch_.readings->learnt() : detail::ReadingMeter::Readings();
  for (const AlgorithmRun& run : runs_)
    for (LearntAlgorithm& algorithm : learnt_.algorithms) {
      if (!run.planned().asked || algorithm.label != run.planned().label) continue;
      algorithm.sd_factor = run.sd_factor();
      if (algorithm.sd_factor.empty()) algorithm.sd = rms_errors(*out.find(algorithm.label));
      const double factor = algorithm.sd_factor.empty() ? 1 : algorithm.sd_factor[0];
      if (readings.size() > 2) algorithm.usual = run.usual().result(readings, watch_.noted, factor);
      if (algorithm.usual && algorithm.usual->sd == 0 && !algorithm.sd.empty()) algorithm.usual->sd = algorithm.sd[0];
    }
}

// What the methods that are recommended say of themselves is about the verdict.
void add_doubts_of_chosen(ReplayResult& out) {
  for (std::size_t i = 0; i < out.algorithms.size(); ++i) {
    const AlgorithmResult& a = out.algorithms[i];
    if (!(out.best && *out.best == i) && a.label != out.best_fusion) continue;
    for (const Finding& one : a.remarks.list())
      if (one.severity != Severity::note) {
        Finding& added = out.warnings.add(one.code, a.label + ": " + one.sentence, {}, one.count);
        added.subject = a.label;
        added.help = one.help;
      }
  }
}

// Faults that the scene knows are answered elsewhere.
void Replay::tell_readings(ReplayResult& out) const {
  if (!out.faults.empty()) return;
  std::vector<std::string> names, units;
  std::vector<detail::TakenOut> taken = taken_out();
  for (std::size_t k = 0; k < taken.size(); ++k) {
    names.push_back(out.sensors[live(k)].name);
    units.push_back(out.sensors[live(k)].unit);
  }
  if (watch_.with_truth) {
    names.push_back(out.inputs[0].name);
    units.push_back(out.inputs[0].unit);
    taken.emplace_back();
  }
  const detail::ReadingMeter& meter = watch_.with_truth ? *watch_.with_truth : *watch_.readings;
  const double start_s = instants_.info().start_s + static_cast<double>(watched_from()) / out.rate_hz;
  const std::int64_t before = plan_.run_from - watched_from();
  const detail::RunReadings run{meter, watch_.beside_truth ? &*watch_.beside_truth : nullptr,
                                watch_.steps ? watch_.steps->changes() : std::vector<StepNoiseMeter::Change>{},
                                start_s + static_cast<double>(before) / out.rate_hz};
  detail::warn_of_readings(run, names, units, {start_s, out.rate_hz}, taken, watch_.with_truth.has_value(),
                           out.warnings);
  if (!aligned_) detail::warn_of_delays(watch_.readings->delays(), names, out.warnings);
}

ReplayResult Replay::collect() {
  ScoreOptions scoring;
  for (const std::int64_t start : plan_.array.section_starts)
    scoring.sections.push_back(start - plan_.warm_up);  // scores begin behind it
  if (instants_.info().has_reference && truths_ == 0)
    throw input_error("E0902", scene_.file)
        .says("the reference has no value within the evaluation")
        .hint("its stamps, its lag or its gaps put it elsewhere");
  refuse_sizes();
  ReplayResult out;
  add_facts(out);
  add_sensors(out, scoring);
  const std::vector<Meters> meters = add_algorithms(out, scoring);
  if (!out.has_reference) extend_partial_scores(out, meters, scoring);
  std::vector<double> healthy_rms;
  for (const SensorMeter& meter : sensors_)
    healthy_rms.push_back(std::sqrt(meter.healthy_squares / meter.healthy_samples));
  judge_optimum(out, optimum_, healthy_rms, plan_.array);
  if (watch_.tilt) watch_.tilt->tell(out.warnings);
  if (watch_.readings) {
    note_readings(watch_.readings->learnt(), learnt_);
    tell_readings(out);
  }
  judge_best(out, meters, costs(), scoring);
  Meters single;
  for (const SensorMeter& meter : sensors_) single.push_back(&meter.error);
  judge_best_sensor(out, meters, single, scoring);
  add_tracks(out);
  if (detection_) out.detection = detection_->result(out.start_s, out.rate_hz, out.end_s());
  if (watch_.steps) note_step_noise(watch_.steps->result(), learnt_);
  note_deviations(out);
  out.learnt = learnt_;
  doubt_offset(out);
  add_doubts_of_chosen(out);
  out.learnt.findings = out.warnings.list();
  if (out.best) out.learnt.recommended = out.algorithms[*out.best].label;
  out.work.passes = passes_ + (scene_.simulate ? 0 : 1);
  for (const AlgorithmRun& bound : optimum_) {
    out.work.learnt += bound.learnt();
    out.work.steps += bound.steps();
  }
  return out;
}

}  // namespace

std::vector<std::string> explain_replay(const Scene& scene, const ReplayOptions& options, Progress& progress) {
  Scene own = taught(scene, options);
  return Replay(own, options, progress, {}).explain();
}

namespace {

void forget_timing(ReplayResult& result) {
  result.seconds = kMissing;
  for (AlgorithmResult& algorithm : result.algorithms) {
    algorithm.ns_per_sample = algorithm.learning_s = kMissing;
    algorithm.peak_bytes.reset();
  }
}

}  // namespace

ReplayResult replay(const Scene& scene, const ReplayOptions& options, Progress& progress,
                    const ReplayWorkspace& workspace) {
  const auto start = std::chrono::steady_clock::now();
  const WorkMeter work;
  Scene own = taught(scene, options);
  ReplayResult out = Replay(own, options, progress, workspace).run();
  count_work(WorkKind::learnt_instants, out.work.learnt);
  count_work(WorkKind::fused_instants, out.work.steps);
  count_work(WorkKind::blind_instants, out.work.blind_steps);
  out.counted = work.done();
  out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!options.timing) forget_timing(out);
  return out;
}

}  // namespace libchar
