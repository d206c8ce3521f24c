#include "libchar/replay/detail/algorithm_run.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <span>
#include <vector>

#include "libchar/core/error.hpp"
#include "libchar/core/not_known.hpp"
#include "libchar/core/numeric/median.hpp"
#include "libchar/fusion/tilt_angle.hpp"
#include "libchar/replay/error_meter.hpp"
#include "libchar/replay/replay_result.hpp"

namespace libchar {
namespace {

constexpr std::int64_t kNotes = 128;
/// Of the sum of weights: medians that share less of it are not those of one set of weights.
constexpr double kLeastSum = 0.1;

void add(std::vector<std::vector<double>>& series, const Eigen::VectorXd& values) {
  series.resize(static_cast<std::size_t>(values.size()));
  for (Eigen::Index i = 0; i < values.size(); ++i) series[static_cast<std::size_t>(i)].push_back(values(i));
}

void take_medians(std::vector<std::vector<double>> notes, std::vector<double>& values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    std::erase_if(notes[i], [](double v) { return !std::isfinite(v); });
    if (!notes[i].empty()) values[i] = median_in_place(notes[i]);
  }
}

double sum_of(const std::vector<double>& values) {
  double out = 0;
  for (const double value : values) out += value;
  return out;
}

}  // namespace

void RunMedians::set_length(std::int64_t instants) { every_ = std::max<std::int64_t>(1, instants / kNotes); }

void RunMedians::note(const std::optional<Eigen::MatrixXd>& weights, const std::optional<Eigen::VectorXd>& variances) {
  // Where nothing was fused the weights have no sum, and mean nothing.
  const bool fused = weights && weights->cols() == 1 && weights->allFinite() && weights->array().abs().sum() > 0;
  if (fused) add(weights_, weights->col(0));
  if (variances) add(variances_, *variances);
}

void RunMedians::take(std::vector<double>& weights, std::vector<double>& variances) const {
  if (variances_.size() == variances.size()) take_medians(variances_, variances);
  if (weights_.empty() || weights_.size() != weights.size()) return;
  std::vector<double> sums(weights_[0].size());
  for (std::size_t k = 0; k < sums.size(); ++k)
    for (const std::vector<double>& of_sensor : weights_) sums[k] += of_sensor[k];
  take_medians(weights_, weights);
  const double sum = sum_of(weights), wanted = median_in_place(sums, Middle::lower);
  if (sum == wanted || !(std::abs(sum) > kLeastSum * std::abs(wanted))) return;
  for (double& weight : weights) weight *= wanted / sum;
}

namespace {

// Values over time, thinned for reports: no extreme is lost.

inline constexpr std::size_t kTrackBins = 400;
inline constexpr std::size_t kWindowBins = 800;

bool still(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(),
                     [&](double v) { return v == values[0] || (std::isnan(v) && std::isnan(values[0])); });
}

/// Points (time_s rising) of several series in at most `bins` bins. Empty when no series ever changes.
Timeline thinned(std::span<const double> time_s, const std::vector<std::vector<double>>& series, std::size_t bins) {
  Timeline out;
  if (time_s.empty() || std::all_of(series.begin(), series.end(), still)) return out;
  bins = std::min(bins, time_s.size());
  out.low.resize(series.size());
  out.high.resize(series.size());
  for (std::size_t b = 0; b < bins; ++b) {
    const std::size_t from = b * time_s.size() / bins, to = (b + 1) * time_s.size() / bins;
    out.time_s.push_back(0.5 * (time_s[from] + time_s[to - 1]));
    for (std::size_t s = 0; s < series.size(); ++s) {
      double low = kNone, high = kNone;
      for (std::size_t k = from; k < to; ++k) {
        // Written so that a number beats NaN.
        if (!(series[s][k] >= low)) low = std::isnan(series[s][k]) ? low : series[s][k];
        if (!(series[s][k] <= high)) high = std::isnan(series[s][k]) ? high : series[s][k];
      }
      out.low[s].push_back(low);
      out.high[s].push_back(high);
    }
  }
  return out;
}

/// RMS of the error in a window of `window_s` centred on each instant, shorter at both ends. [RV] takes the same window
/// and loses the ends. Computed on the meter's cells: the window is rounded to a whole number of them.
Timeline window_rms(const ErrorMeter& meter, double rate_hz, double start_s, double window_s) {
  const std::vector<ErrorCell> cells = meter.cells();
  const double cell_s = static_cast<double>(meter.cell_samples()) / rate_hz;
  const auto half = static_cast<std::size_t>(std::max(0.0, std::round(window_s / cell_s / 2 - 0.5)));
  std::vector<double> times, rms;
  // Sums over each window of their own: a difference of running sums would keep the traces of a large error for ever.
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const std::size_t from = c > half ? c - half : 0, to = std::min(cells.size(), c + half + 1);
    double sum = 0, n = 0;
    for (std::size_t k = from; k < to; ++k) {
      sum += cells[k].squares;
      n += cells[k].n;
    }
    times.push_back(start_s + (static_cast<double>(c) + 0.5) * cell_s);
    rms.push_back(n > 0 ? std::sqrt(sum / n) : kNone);
  }
  return thinned(times, {rms}, kWindowBins);
}

using Clock = std::chrono::steady_clock;

// Learning takes long enough for the scheduler to come in between, and for this clock's cost.
double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// Errors with gaps at every turn have no curve, and everything else all the same.
AllanCurve curve_of(const AllanPyramid& pyramid, double dt_s) {
  try {
    return pyramid.finish(dt_s);
  } catch (const Error& error) {
    if (error.problem().kind != ErrorKind::numeric) throw;
    return {};
  }
}

}  // namespace

AlgorithmResult not_run(const PlannedAlgorithm& planned, const std::string& why) {
  AlgorithmResult out;
  out.label = planned.label;
  out.description = planned.entry->description;
  out.settings = planned.settings;
  out.bound = planned.learns_run();
  out.why = why;
  out.rmse = out.regret = out.weight_distance = out.variance_error = kNone;
  out.rmse_ci95 = {kNone, kNone};
  out.ns_per_sample = kNone;
  return out;
}

// What an algorithm refuses when it is made or learns is a result of the replay, not its end.
template <class Work>
void AlgorithmRun::guarded(const Work& work) {
  if (!failure_.empty()) return;
  try {
    const double start = thread_seconds();
    accounted(work);
    learning_s_ += thread_seconds() - start;
  } catch (const Error& error) {
    if (error.problem().kind != ErrorKind::numeric && error.problem().kind != ErrorKind::usage) throw;
    failure_ = error.problem().what;
    runner_.reset();
  }
}

template <class Work>
double AlgorithmRun::accounted(const Work& work) {
  if (frame_->heap != nullptr) frame_->heap->begin();
  const auto start = Clock::now();
  const auto account = [&] {
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    if (frame_->heap != nullptr) {
      const HeapUse use = frame_->heap->end();
      heap_.peak = std::max(heap_.peak, heap_.held + use.peak);
      heap_.held += use.held;
    }
    return seconds;
  };
  try {
    work();
  } catch (...) {
    account();
    throw;
  }
  return account();
}

AlgorithmRun::AlgorithmRun(const PlannedAlgorithm& planned, const RunFrame& frame)
    : planned_(&planned), frame_(&frame) {
  const auto inputs = static_cast<std::size_t>(frame.array->inputs());
  meters_.resize(inputs);
  seen_.coverage.resize(inputs);
  if (frame.allan) allan_.resize(inputs);
  medians_.set_length(frame.instants);
  seen_.usual.set_length(frame.instants);
  guarded([&] {
    runner_ = planned.entry->make(some_left_out() ? subset(*frame.array, *frame.live) : *frame.array, planned.settings);
  });
}

void AlgorithmRun::learn(const Eigen::MatrixXd& samples, const Eigen::MatrixXd& truth) {
  if (!alive()) return;
  learnt_ += static_cast<std::uint64_t>(samples.cols());
  guarded([&] {
    if (some_left_out())
      runner_->learn(samples(*frame_->live, Eigen::indexing::all).eval(), truth);
    else
      runner_->learn(samples, truth);
  });
}

void AlgorithmRun::look(const Eigen::MatrixXd& samples) {
  if (!alive()) return;
  looked_ += static_cast<std::uint64_t>(samples.cols());
  const double before = learning_s_;
  guarded([&] {
    if (some_left_out())
      runner_->look(samples(*frame_->live, Eigen::indexing::all).eval());
    else
      runner_->look(samples);
  });
  ahead_s_ += learning_s_ - before;
}

void AlgorithmRun::finish_learning() {
  if (!alive()) return;
  const double before = learning_s_;
  guarded([&] { runner_->finish_learning(); });
  if (looked_ > 0) ahead_s_ += learning_s_ - before;
}

LearntAlgorithm AlgorithmRun::hand_out() const {
  LearntAlgorithm out;
  out.label = planned_->label;
  out.name = planned_->entry->description->name;
  for (std::size_t i = 0; i < planned_->settings.table().size(); ++i)
    out.options.emplace_back(planned_->settings.table()[i].name, planned_->settings.values()[i]);
  fusion::LearntExchange with;
  if (!alive())
    out.refused = failure_;
  else if (planned_->learns_run())
    out.refused = out.label + " is a bound: it looks at the reference of the very run it is used on";
  else if (!runner_->exchange(with))
    out.refused = out.label + " has no way to hand out what it learnt";
  std::size_t numbers = 0;
  for (const fusion::LearntNumbers& part : with.learnt()) {
    numbers += part.values.size();
    if (out.refused.empty() &&
        !std::all_of(part.values.begin(), part.values.end(), [](double v) { return std::isfinite(v); }))
      out.refused = out.label + " learnt numbers that are not finite";
  }
  if (numbers > kMostLearnt)
    out.refused = out.label + " learnt more numbers than a file holds: " + std::to_string(numbers);
  if (out.refused.empty()) out.learnt = with.learnt();
  return out;
}

// In parts between the instants at which weights and variances are noted.
void AlgorithmRun::timed_run(const Eigen::MatrixXd& samples, bool noted) {
  x_.resize(frame_->array->inputs(), samples.cols());
  variance_.resize(x_.rows(), x_.cols());
  Eigen::MatrixXd given;
  if (some_left_out()) given = samples(*frame_->live, Eigen::indexing::all);
  const Eigen::MatrixXd& all = some_left_out() ? given : samples;
  double seconds = 0;
  for (Eigen::Index done = 0, part = 0; done < all.cols(); done += part) {
    const auto so_far = static_cast<std::int64_t>(steps_) + done;
    const std::int64_t due = noted ? medians_.until_next(so_far) : all.cols();
    part = static_cast<Eigen::Index>(std::min<std::int64_t>(due, all.cols() - done));
    seconds += accounted(
        [&] { runner_->run(all.middleCols(done, part), x_.middleCols(done, part), variance_.middleCols(done, part)); });
    if (noted && part == due) medians_.note(weights(), variances());
  }
  timed_s_ += seconds;
  if (blocks_ % stride_ == 0) ns_.push_back(1e9 * seconds / static_cast<double>(samples.cols()));
}

// Long runs keep the clock and the tracks of every second block, every fourth…
void AlgorithmRun::thin_notes() {
  constexpr std::size_t kMostNotes = 1024;
  const auto every_second = [](std::vector<double>& values) {
    for (std::size_t k = 0; 2 * k < values.size(); ++k) values[k] = values[2 * k];
    values.resize((values.size() + 1) / 2);
  };
  if (++blocks_ % stride_ != 0 || std::max(ns_.size(), track_times_.size()) < kMostNotes) return;
  stride_ *= 2;
  every_second(ns_);
  every_second(track_times_);
  for (auto* series : {&weight_samples_, &variance_samples_})
    for (std::vector<double>& values : *series) every_second(values);
}

void AlgorithmRun::run(const Eigen::MatrixXd& samples) {
  if (!alive()) return;
  timed_run(samples, true);
  steps_ += static_cast<std::uint64_t>(samples.cols());
}

void AlgorithmRun::repeat(const Eigen::MatrixXd& samples) {
  if (alive()) timed_run(samples, false);
}

double AlgorithmRun::median_ns() const {
  std::vector<double> blocks = ns_;
  const double median = median_in_place(blocks, Middle::upper);
  return looked_ > 0 ? median + 1e9 * ahead_s_ / static_cast<double>(looked_) : median;
}

void AlgorithmRun::score(std::int64_t first, const Eigen::MatrixXd& truth, Eigen::Index skip) {
  if (!alive()) return;
  const Eigen::Index scored = x_.cols() - skip;
  seen_.available += static_cast<double>((x_.row(0).tail(scored).array().isFinite()).count());
  seen_.scored += static_cast<double>(scored);
  for (Eigen::Index k = skip; k < x_.cols(); ++k)
    if (seen_.usual.notes(first + k)) seen_.usual.note(x_(0, k), variance_(0, k));
  for (Eigen::Index j = 0; j < truth.rows(); ++j) {
    error_.resize(static_cast<std::size_t>(scored));
    for (Eigen::Index k = skip; k < x_.cols(); ++k) {
      double error = x_(j, k) - truth(j, k);
      if (frame_->tilt) error = fusion::wrapped(error);
      // An estimate that overflowed is none.
      error_[static_cast<std::size_t>(k - skip)] = std::isfinite(error) ? error * frame_->output_scale : kNone;
      seen_.coverage[static_cast<std::size_t>(j)].add(error, std::sqrt(variance_(j, k)));
    }
    meters_[static_cast<std::size_t>(j)].push(error_);
    if (!allan_.empty()) allan_[static_cast<std::size_t>(j)].push(error_);
  }
  if (frame_->tracks && blocks_ % stride_ == 0)
    note_tracks(frame_->start_s + static_cast<double>(first + x_.cols()) / frame_->rate_hz);
  thin_notes();
  x_ *= frame_->output_scale;
}

void AlgorithmRun::note_tracks(double time_s) {
  const auto weights = this->weights();
  const auto variances = this->variances();
  const bool one_input = weights && weights->cols() == 1;
  if (!one_input && !variances) return;
  track_times_.push_back(time_s);
  const auto add = [](std::vector<std::vector<double>>& series, const auto& values) {
    series.resize(static_cast<std::size_t>(values.size()));
    for (Eigen::Index i = 0; i < values.size(); ++i) series[static_cast<std::size_t>(i)].push_back(values(i));
  };
  if (one_input) add(weight_samples_, weights->col(0));
  if (variances) add(variance_samples_, *variances);
}

std::vector<double> AlgorithmRun::sd_factor() const {
  std::vector<double> out;
  for (const detail::CoverageMeter& meter : seen_.coverage)
    if (const auto factor = meter.factor()) out.push_back(*factor);
  return out.size() == seen_.coverage.size() ? out : std::vector<double>();
}

std::optional<Eigen::MatrixXd> AlgorithmRun::weights() const {
  auto given = runner_->weights();
  if (!given || !some_left_out()) return given;
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(frame_->array->channels, given->cols());
  all(*frame_->live, Eigen::indexing::all) = *given;
  return all;
}

std::optional<Eigen::VectorXd> AlgorithmRun::variances() const {
  auto given = runner_->variances();
  if (!given || !some_left_out()) return given;
  Eigen::VectorXd all = Eigen::VectorXd::Constant(frame_->array->channels, kNone);
  all(*frame_->live) = *given;
  return all;
}

std::vector<FoundFault> AlgorithmRun::faults() const {
  const fusion::FaultLog* log = runner_->faults();
  if (log == nullptr) return {};
  std::vector<std::size_t> sensors;
  if (some_left_out()) sensors.assign(frame_->live->begin(), frame_->live->end());
  return found_faults(*log, sensors, frame_->start_s, frame_->rate_hz);
}

AlgorithmResult AlgorithmRun::result(const ScoreOptions& options, double window_s) const {
  AlgorithmResult out = not_run(*planned_, failure_);
  out.ran = alive();
  if (!out.ran) return out;
  for (std::size_t j = 0; j < meters_.size() && !meters_[j].cells().empty(); ++j) {
    InputScore input;
    input.error = libchar::score(meters_[j], frame_->rate_hz, options);
    input.optimum_ratio = kNone;
    input.window_rms = window_rms(meters_[j], frame_->rate_hz, frame_->scored_from_s, window_s);
    if (!allan_.empty()) input.allan = curve_of(allan_[j], 1 / frame_->rate_hz);
    out.inputs.push_back(std::move(input));
  }
  if (!out.inputs.empty()) {
    out.rmse = out.inputs[0].error.rmse;
    out.rmse_ci95 = out.inputs[0].error.rmse_ci95;
  }
  out.availability = seen_.scored > 0 ? seen_.available / seen_.scored : 0;
  out.ns_per_sample = median_ns();
  out.learning_s = learning_s_ - ahead_s_;
  if (frame_->heap != nullptr) out.peak_bytes = static_cast<std::uint64_t>(std::max<std::int64_t>(heap_.peak, 0));
  if (const auto found = weights())
    for (const auto& column : found->colwise()) out.weights.emplace_back(column.begin(), column.end());
  if (const auto found = variances()) out.variances.assign(found->begin(), found->end());
  std::vector<double> none;
  medians_.take(out.weights.size() == 1 ? out.weights[0] : none, out.variances);
  out.weight_track = thinned(track_times_, weight_samples_, kTrackBins);
  out.variance_track = thinned(track_times_, variance_samples_, kTrackBins);
  out.faults = faults();
  if (const fusion::FaultLog* log = runner_->faults()) {
    out.watches_faults = true;
    out.faults_not_kept = log->dropped();
  }
  if (const fusion::HandOverLog* log = runner_->hand_overs()) {
    out.leads = detail::lead_stretches(*log, frame_->start_s, frame_->rate_hz);
    out.hand_overs = log->events().size() + log->dropped();
  }
  runner_->remarks(out.remarks);
  return out;
}

}  // namespace libchar
