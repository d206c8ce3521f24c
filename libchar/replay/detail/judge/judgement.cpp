#include "libchar/replay/detail/judge/judgement.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "libchar/core/not_known.hpp"
#include "libchar/core/numeric/dense.hpp"

namespace libchar {
namespace {

/// Ends of an interval whose ratio is more: the record does not tell how good the method is.
constexpr double kDecade = 10;
/// Share of the weights in one sensor beyond which the others have no part.
constexpr double kAlone = 0.99;
/// Scores that differ by rounding only.
constexpr double kEqual = 1e-9;

bool spans_decades(const AlgorithmResult& a) {
  return std::isfinite(a.rmse_ci95.low) && a.rmse_ci95.high > kDecade * a.rmse_ci95.low;
}

bool runs_as_often(const AlgorithmResult& a, double most_available) {
  return a.ran && !a.bound && a.availability >= kLeastAvailable * most_available;
}

double most_available(const ReplayResult& result) {
  double most = 0;
  for (const AlgorithmResult& a : result.algorithms)
    if (a.ran && !a.bound) most = std::max(most, a.availability);
  return most;
}

}  // namespace

bool combines_sensors(const AlgorithmResult& algorithm) {
  if (algorithm.weights.size() != 1) return true;
  double sum = 0, largest = 0;
  for (const double weight : algorithm.weights[0]) {
    sum += std::abs(weight);
    largest = std::max(largest, std::abs(weight));
  }
  return !(largest > kAlone * sum);
}

std::optional<std::size_t> choose_method(const ReplayResult& result, const std::vector<double>& costs, bool fusions) {
  const double most = most_available(result);
  std::vector<std::size_t> all, known;
  for (std::size_t k = 0; k < result.algorithms.size(); ++k) {
    const AlgorithmResult& a = result.algorithms[k];
    if (!std::isfinite(a.rmse) || !runs_as_often(a, most)) continue;
    if (fusions && !combines_sensors(a)) continue;
    all.push_back(k);
    if (!spans_decades(a)) known.push_back(k);
  }
  if (known.empty()) known = all;
  double smallest = std::numeric_limits<double>::infinity();
  for (const std::size_t k : known) smallest = std::min(smallest, result.algorithms[k].rmse);
  const double limit = smallest * (1 + (result.has_reference ? kPracticalTolerance : kEqual));
  std::optional<std::size_t> out;
  const auto order = [&](std::size_t k) {
    const AlgorithmResult& a = result.algorithms[k];
    return std::tuple(a.description->as_published, costs[k], k);
  };
  for (const std::size_t k : known)
    if (result.algorithms[k].rmse <= limit && (!out || order(k) < order(*out))) out = k;
  return out;
}

std::optional<std::size_t> choose_robust(const ReplayResult& result) {
  const double most = most_available(result);
  std::optional<std::size_t> out;
  int highest = 0;
  for (std::size_t k = 0; k < result.algorithms.size(); ++k) {
    const AlgorithmResult& a = result.algorithms[k];
    if (!runs_as_often(a, most) || a.description->withstands <= highest) continue;
    highest = a.description->withstands;
    out = k;
  }
  return out;
}

namespace {

// The diagonal of (H' R^-1 H)^-1, R the sensors' mean square errors: by QR of R^-1/2 H.
Eigen::VectorXd gauss_markov(const std::vector<double>& rms, const fusion::Array& array) {
  Eigen::MatrixXd scaled = array.h();
  for (std::size_t i = 0; i < rms.size(); ++i) {
    // A sensor that was never healthy tells nothing.
    const double information = rms[i] > 0 ? 1 / rms[i] : 0;
    scaled.row(static_cast<Eigen::Index>(i)) *= information;
  }
  const Eigen::Index r = scaled.cols();
  // R^-1 is the transpose of what its transpose, a lower triangle, gives.
  const Eigen::MatrixXd lower = qr_triangle(scaled).transpose();
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(r, r);
  return solve_lower(lower, identity).colwise().norm().transpose();
}

double regret_of(const AlgorithmResult& algorithm) {
  double squares = 0;
  for (const InputScore& input : algorithm.inputs) squares += input.optimum_ratio * input.optimum_ratio;
  return algorithm.inputs.empty() ? kNone : std::sqrt(squares / static_cast<double>(algorithm.inputs.size())) - 1;
}

}  // namespace

void judge_optimum(ReplayResult& result, const std::vector<AlgorithmRun>& optimum,
                   const std::vector<double>& healthy_rms, const fusion::Array& array) {
  if (!result.has_reference) return;
  ScoreOptions quick;
  quick.intervals = false;
  if (array.one_common_input() || array.tilt) {
    for (const AlgorithmRun& bound : optimum)
      if (bound.alive())
        result.inputs[0].optimum_rmse =
            std::fmin(result.inputs[0].optimum_rmse, score(bound.meters()[0], result.rate_hz, quick).rmse);
  } else {
    const Eigen::VectorXd best = gauss_markov(healthy_rms, array);
    for (std::size_t j = 0; j < result.inputs.size(); ++j)
      result.inputs[j].optimum_rmse = best[static_cast<Eigen::Index>(j)];
  }
  for (AlgorithmResult& algorithm : result.algorithms) {
    for (std::size_t j = 0; j < algorithm.inputs.size(); ++j)
      algorithm.inputs[j].optimum_ratio = algorithm.inputs[j].error.rmse / result.inputs[j].optimum_rmse;
    algorithm.regret = regret_of(algorithm);
  }
}

void judge_tracking(AlgorithmResult& algorithm, const AlgorithmRun& run, const std::vector<AlgorithmRun>& optimum,
                    const ReplayResult& result, const fusion::Array& array) {
  if (!algorithm.ran || !result.has_reference || !array.one_common_input() || !array.section_starts.empty()) return;
  const auto& weights = run.weight_samples();
  if (!weights.empty() && !optimum.empty() && optimum[0].alive())
    if (const auto best = optimum[0].weights()) {
      double squares = 0;
      for (std::size_t i = 0; i < weights.size(); ++i)
        for (const double w : weights[i]) squares += std::pow(w - (*best)(static_cast<Eigen::Index>(i), 0), 2);
      algorithm.weight_distance = std::sqrt(squares / static_cast<double>(weights[0].size()));
    }
  double squares = 0, count = 0;
  for (std::size_t i = 0; i < run.variance_samples().size(); ++i) {
    const double rmse = result.sensors[i].error.rmse;
    for (const double v : run.variance_samples()[i])
      if (v > 0 && rmse > 0) {
        squares += std::pow(std::log(v / (rmse * rmse)), 2);
        count += 1;
      }
  }
  if (count > 0) algorithm.variance_error = std::sqrt(squares / count);
}

void answer_faults(AlgorithmResult& algorithm, const ReplayResult& result) {
  if (!algorithm.ran || !algorithm.watches_faults) return;
  algorithm.answers = answers_to(result.faults, algorithm.faults, result.start_s, result.end_s());
}

namespace {

/// Of a mean square difference from the others, in the means: beyond it nothing else is compared.
constexpr double kMostOffsets = 0.9;

/// Where leave-one-out does not decide: one failing sensor is in all scores, and what would withstand
/// it has none (of three sensors two are left), or, of four, is scored by arrays of three, one of which
/// fails; or the scores are those of the offsets.
std::optional<std::size_t> robust_instead(const ReplayResult& result, const AlgorithmResult& best) {
  if (result.has_reference || result.inputs.size() != 1 || !best.blind) return std::nullopt;
  const std::vector<double>& left = best.blind->leave_one_out;
  const auto scored = std::count_if(left.begin(), left.end(), [](double rms) { return std::isfinite(rms); });
  const std::optional<std::size_t> robust = choose_robust(result);
  if (scored < 3 || !robust) return std::nullopt;
  const bool fails =
      result.warnings.find("sensor_failing") != nullptr || result.warnings.find("sensor_apart") != nullptr;
  if (result.offsets_decide || !std::isfinite(result.algorithms[*robust].rmse) || (scored == 4 && fails)) return robust;
  return std::nullopt;
}

}  // namespace

void judge_best(ReplayResult& result, const std::vector<Meters>& meters, const std::vector<double>& costs,
                const ScoreOptions& scoring) {
  result.best = choose_method(result, costs);
  const auto fusion = choose_method(result, costs, true);
  if (fusion) result.best_fusion = result.algorithms[*fusion].label;
  if (!result.best) return;
  const std::size_t best = *result.best;
  const auto& blind = result.algorithms[best].blind;
  result.offsets_decide = !result.has_reference && blind && blind->offset_share > kMostOffsets;
  if (const auto robust = robust_instead(result, result.algorithms[best])) {
    result.chosen_as_robust = true;
    result.best = robust;
    result.best_fusion = result.algorithms[*robust].label;
    for (AlgorithmResult& a : result.algorithms) a.as_good_as_best = a.ran && !a.bound;
    return;  // no score tells them apart
  }
  if (result.offsets_decide) {
    result.best_fusion.clear();
    return result.best.reset();
  }
  result.algorithms[best].as_good_as_best = true;
  // As many chances to look worse as there are others (Bonferroni).
  double others = 0;
  for (std::size_t k = 0; k < meters.size(); ++k) others += k != best && !meters[k].empty();
  const double level = 0.05 / others;
  for (std::size_t k = 0; k < result.algorithms.size(); ++k) {
    AlgorithmResult& a = result.algorithms[k];
    if (k == best || meters[k].empty() || !std::isfinite(a.rmse)) continue;
    CommonMeters pair;
    if (on_stretches(a) || on_stretches(result.algorithms[best])) pair = in_common(meters[k], meters[best]);
    const Meters &ours = pair.a.empty() ? meters[k] : pair.a, &its = pair.b.empty() ? meters[best] : pair.b;
    a.ratio_to_best = rms_ratio_interval(ours, its, scoring);
    const Interval corrected = rms_ratio_interval(ours, its, scoring, level);
    const double smallest = result.algorithms[best].rmse;
    // No ratio: a record of a few instants tells nothing apart, but an error of zero is smaller than any other.
    const bool apart = std::isnan(corrected.low) ? smallest == 0 : corrected.low > 1;
    const bool resolved = apart || larger_throughout(ours, its) < level;
    a.as_good_as_best = a.rmse <= (1 + kPracticalTolerance) * smallest || !resolved;
  }
}

void judge_best_sensor(ReplayResult& result, const std::vector<Meters>& meters, const Meters& sensors,
                       const ScoreOptions& scoring) {
  if (!result.best || !result.has_reference || result.scene.tilt || result.inputs.size() != 1) return;
  double most_available = 0;
  for (const SensorResult& sensor : result.sensors)
    most_available = std::max(most_available, sensor.error.availability);
  for (std::size_t i = 0; i < result.sensors.size(); ++i) {
    const double rmse = result.sensors[i].error.rmse;
    const bool most = result.sensors[i].error.availability >= kLeastAvailable * most_available;
    if (std::isfinite(rmse) && most && !result.sensors[i].constant &&
        (!result.best_sensor || rmse < result.sensors[*result.best_sensor].error.rmse))
      result.best_sensor = i;
  }
  const AlgorithmResult* fusion = result.find(result.best_fusion);
  if (!result.best_sensor || fusion == nullptr) return;
  const Meters& errors = meters[static_cast<std::size_t>(fusion - result.algorithms.data())];
  if (!errors.empty()) result.best_over_sensor = rms_ratio_interval(errors, {sensors[*result.best_sensor]}, scoring);
}

namespace {

/// Mean time between two false alarms of the array, seconds.
constexpr double kFalseAlarmsEvery_s[] = {1e2, 1e3, 1e4, 1e5, 1e6, 1e7};

/// It has the detector, and it is on.
bool detects(const PlannedAlgorithm& planned) {
  const auto on = [&](std::string_view option) {
    const auto table = planned.settings.table();
    return std::any_of(table.begin(), table.end(), [&](const auto& one) { return one.name == option; });
  };
  return planned.runs() && on("false_alarm_s") && (!on("fault_detection") || planned.settings["fault_detection"] == 1);
}

}  // namespace

DetectionSweep::DetectionSweep(const ReplayPlan& plan, const std::vector<SensorFault>& known)
    : known_(known), inputs_(plan.array.inputs()) {
  const auto with = std::find_if(plan.algorithms.begin(), plan.algorithms.end(), detects);
  const fusion::Array array = subset(plan.array, plan.live);
  if (known.empty() || with == plan.algorithms.end() || array.channels <= 2 * array.inputs() ||
      array.channels > fusion::kMostPaired)
    return;
  for (Eigen::Index i = 0; i < array.channels; ++i)
    sensors_.push_back(static_cast<std::size_t>(plan.live.empty() ? i : plan.live[static_cast<std::size_t>(i)]));
  const fusion::Entry& mean = fusion::algorithm("mean");
  for (const double false_alarm_s : kFalseAlarmsEvery_s) {
    fusion::Settings settings(mean.options);
    settings.set("fault_detection", 1);
    settings.set("false_alarm_s", false_alarm_s);
    settings.set("recovery_window", with->settings["recovery_window"]);
    settings_.push_back({false_alarm_s, mean.make(array, settings)});
  }
}

void DetectionSweep::push(const Eigen::MatrixXd& samples) {
  if (settings_.empty()) return;
  Eigen::MatrixXd live;
  const bool all = static_cast<Eigen::Index>(sensors_.size()) == samples.rows();
  if (!all) live = samples(sensors_, Eigen::indexing::all);
  for (const Setting& setting : settings_) {
    x_.resize(inputs_, samples.cols());
    variance_.resize(inputs_, samples.cols());
    setting.watched->run(all ? samples : live, x_, variance_);
  }
}

std::vector<DetectionAt> DetectionSweep::result(double start_s, double rate_hz, double end_s) const {
  std::vector<DetectionAt> out;
  for (const Setting& setting : settings_) {
    const auto found = found_faults(*setting.watched->faults(), sensors_, start_s, rate_hz);
    out.push_back(
        {setting.false_alarm_s, answers_to(known_, found, start_s, end_s), alarms_without_fault(known_, found)});
  }
  return out;
}

namespace {

/// Half the length of an interval of a logarithm.
double log_reach(const Interval& interval) { return std::log(interval.high / interval.low) / 2; }

}  // namespace

bool on_stretches(const AlgorithmResult& a) { return a.blind && a.blind->share < 1; }

CommonMeters in_common(const Meters& a, const Meters& b) {
  CommonMeters out;
  out.copies.reserve(a.size() + b.size());
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    out.a.push_back(&out.copies.emplace_back(a[i]->where_known(*b[i])));
    out.b.push_back(&out.copies.emplace_back(b[i]->where_known(*a[i])));
  }
  return out;
}

void extend_partial_scores(ReplayResult& result, const std::vector<Meters>& meters, const ScoreOptions& scoring) {
  std::size_t whole = 0;
  while (whole < meters.size() && (meters[whole].empty() || on_stretches(result.algorithms[whole]))) ++whole;
  if (whole == meters.size()) return;
  const BlindScore& control = *result.algorithms[whole].blind;
  for (std::size_t k = 0; k < meters.size(); ++k) {
    AlgorithmResult& a = result.algorithms[k];
    if (!on_stretches(a) || meters[k].size() != meters[whole].size()) continue;
    const CommonMeters common = in_common(meters[k], meters[whole]);
    const double ratio = geometric_rms(common.a, scoring).rms / geometric_rms(common.b, scoring).rms;
    const double reach =
        std::hypot(log_reach(rms_ratio_interval(common.a, common.b, scoring)), log_reach(control.predictive_ci95));
    a.rmse = a.blind->predictive_rms = ratio * control.predictive_rms;
    a.rmse_ci95 = a.blind->predictive_ci95 = {a.rmse * std::exp(-reach), a.rmse * std::exp(reach)};
  }
}

}  // namespace libchar
