#include "libchar/replay/view/ranking.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "libchar/core/numeric/interval.hpp"
#include "libchar/core/numeric/median.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/replay/detail/plan/sensor_words.hpp"

namespace libchar {
namespace {

// A number before none, a smaller one before a larger.
bool better(double x, double y) { return std::isfinite(x) && (!std::isfinite(y) || x < y); }

std::vector<bool> front(const ReplayResult& result, double (*cost)(const AlgorithmResult& algorithm)) {
  const auto& all = result.algorithms;
  const auto candidate = [&](const AlgorithmResult& a) {
    return a.ran && !a.bound && std::isfinite(a.rmse) && std::isfinite(cost(a));
  };
  std::vector<bool> out(all.size(), false);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!candidate(all[i])) continue;
    out[i] = std::none_of(all.begin(), all.end(), [&](const AlgorithmResult& other) {
      return candidate(other) && other.rmse <= all[i].rmse && cost(other) <= cost(all[i]) &&
             (other.rmse < all[i].rmse || cost(other) < cost(all[i]));
    });
  }
  return out;
}

}  // namespace

std::vector<const AlgorithmResult*> ranked(const ReplayResult& result) {
  std::vector<const AlgorithmResult*> out;
  for (const AlgorithmResult& a : result.algorithms)
    if (a.ran) out.push_back(&a);
  std::stable_sort(out.begin(), out.end(), [](const auto* a, const auto* b) { return better(a->rmse, b->rmse); });
  return out;
}

std::vector<const AlgorithmResult*> ranked_by_input(const ReplayResult& result, std::size_t input) {
  std::vector<const AlgorithmResult*> out = ranked(result);
  std::erase_if(out, [&](const AlgorithmResult* a) { return input >= a->inputs.size(); });
  std::stable_sort(out.begin(), out.end(), [&](const auto* a, const auto* b) {
    return better(a->inputs[input].error.rmse, b->inputs[input].error.rmse);
  });
  return out;
}

std::vector<SkippedAlgorithms> skipped_algorithms(const ReplayResult& result) {
  std::vector<SkippedAlgorithms> out;
  for (const AlgorithmResult& a : result.algorithms) {
    if (a.ran) continue;
    const auto known = std::find_if(out.begin(), out.end(), [&](const auto& s) { return s.reason == a.why; });
    if (known == out.end())
      out.push_back({a.why, {a.label}});
    else
      known->labels.push_back(a.label);
  }
  return out;
}

ParetoFront pareto_front(const ReplayResult& result) {
  return {front(result, [](const AlgorithmResult& a) { return a.ns_per_sample; }),
          front(result, [](const AlgorithmResult& a) {
            return a.peak_bytes ? static_cast<double>(*a.peak_bytes) : std::numeric_limits<double>::quiet_NaN();
          })};
}

namespace {

/// Names of equals beyond so many are only counted.
constexpr std::size_t kMostEquals = 4;
constexpr double kClose = 1.05;  ///< times the best method's error

std::string list_of(const std::vector<std::string>& names) {
  if (names.size() == 1) return names[0];
  const std::vector<std::string> head(names.begin(), names.end() - 1);
  return fmt::format("{} and {}", fmt::join(head, ", "), names.back());
}

// The cheapest of those that cannot be told from the best; where the record tells little, not one
// whose error is clearly larger in it.
const AlgorithmResult* cheapest_equal(const ReplayResult& r) {
  const AlgorithmResult* out = nullptr;
  for (const AlgorithmResult& a : r.algorithms)
    if (a.ran && !a.bound && a.as_good_as_best && a.ns_per_sample > 0 &&
        a.rmse <= kClose * r.algorithms[*r.best].rmse && (out == nullptr || a.ns_per_sample < out->ns_per_sample))
      out = &a;
  return out;
}

std::string regret_text(const ReplayResult& r, double regret) {
  const std::string optimum = "the optimum of " + optimum_of(r);
  // The best of a few filters may be the optimum itself.
  if (std::abs(regret) < 1e-9) return optimum;
  if (regret > 1) return fmt::format("{} times {}", brief_text(1 + regret), optimum);
  return fmt::format("{} {} {}", percent_text(std::abs(regret)), regret >= 0 ? "above" : "below", optimum);
}

// "RMSE 0.0331 rad/s (95 %: 0.0329 to 0.0333), 0.1 % above the optimum of fixed weights"
std::string figures(const ReplayResult& r, const AlgorithmResult& a) {
  std::string out =
      fmt::format("{} {}{}", r.has_reference ? "RMSE" : "leave-one-out RMS",
                  r.inputs.size() > 1 ? "of " + r.inputs[0].name + " " : "", error_text(a.rmse, r.inputs[0].unit));
  if (std::isfinite(a.rmse_ci95.low) && std::isfinite(a.rmse_ci95.high))
    out += fmt::format(" (95 %: {} to {})", brief_text(a.rmse_ci95.low, 4), brief_text(a.rmse_ci95.high, 4));
  for (std::size_t j = 1; j < std::min(a.inputs.size(), r.inputs.size()); ++j)
    out += fmt::format(", of {} {}", r.inputs[j].name, error_text(a.inputs[j].error.rmse, r.inputs[j].unit));
  if (std::isfinite(a.regret)) out += ", " + regret_text(r, a.regret);
  return out;
}

std::string costs_of(const AlgorithmResult& a) {
  std::string out;
  if (std::isfinite(a.ns_per_sample)) out += ", " + duration_text(1e-9 * a.ns_per_sample) + " per sample";
  if (a.peak_bytes) out += ", " + bytes_text(a.peak_bytes) + " of memory";
  return out;
}

/// The first of them in words, and how many more there are.
std::string first_of(std::vector<std::string> names) {
  const std::size_t more = names.size() > kMostEquals ? names.size() - kMostEquals : 0;
  names.resize(names.size() - more);
  if (more > 0) names.push_back(fmt::format("{} more", more));
  return list_of(names);
}

std::string equals_sentence(const ReplayResult& r, const AlgorithmResult& best, bool costs) {
  std::vector<std::string> near, open;
  for (const AlgorithmResult* a : ranked(r))
    if (!a->bound && a->as_good_as_best && a->label != best.label)
      (a->rmse <= (1 + kPracticalTolerance) * best.rmse ? near : open)
          .push_back(a->label + (detail::learns(r, *a) ? " (learns from a reference)" : ""));
  if (near.empty() && open.empty()) {
    const auto others = std::count_if(r.algorithms.begin(), r.algorithms.end(), [&](const AlgorithmResult& a) {
      return a.ran && !a.bound && std::isfinite(a.rmse) && a.label != best.label;
    });
    const bool unscored = std::any_of(r.algorithms.begin(), r.algorithms.end(), [](const AlgorithmResult& a) {
      return a.ran && !a.bound && !std::isfinite(a.rmse);
    });
    if (others == 0) return "No other method has a score.";
    return fmt::format("Every other method{} is worse by more than 1 %, and the recording is long enough to show it.",
                       unscored ? " with a score" : "");
  }
  std::string out = near.empty() ? "" : fmt::format("Within 1 % of it: {}.", first_of(std::move(near)));
  if (!open.empty())
    out += fmt::format("{}Worse by more than 1 %, but not distinguished from it by this recording: {}.",
                       out.empty() ? "" : " ", first_of(std::move(open)));
  const AlgorithmResult* cheap = cheapest_equal(r);
  if (costs && cheap != nullptr && cheap->label != best.label && cheap->ns_per_sample < 0.8 * best.ns_per_sample)
    out += fmt::format(" Of these {} is the cheapest, {} per sample.", cheap->label,
                       duration_text(1e-9 * cheap->ns_per_sample));
  return out;
}

// The best that needs no reference, when the best of all learns from one.
std::string without_reference_sentence(const ReplayResult& r, const AlgorithmResult& best, bool costs) {
  if (!detail::learns(r, best)) return "";
  for (const AlgorithmResult* a : ranked(r))
    if (!a->bound && !detail::learns(r, *a) && std::isfinite(a->rmse))
      return fmt::format("{} learns from a reference; of the methods that need none {} is best: {}{}.", best.label,
                         a->label, figures(r, *a), costs ? costs_of(*a) : "");
  return best.label + " learns from a reference.";
}

// Which sensors needed it most.
std::string largest_parts(const ReplayResult& r) {
  if (!r.alignment->applied) return "";
  const std::vector<fusion::ChannelAlignment>& all = r.alignment->learnt.channels;
  const auto largest = [&](double fusion::ChannelAlignment::*part) {
    const auto less = [&](const auto& a, const auto& b) { return std::abs(a.*part) < std::abs(b.*part); };
    return static_cast<std::size_t>(std::max_element(all.begin(), all.end(), less) - all.begin());
  };
  const std::size_t bias = largest(&fusion::ChannelAlignment::bias), gain = largest(&fusion::ChannelAlignment::gain);
  std::string out;
  if (all[bias].bias != 0)
    out += fmt::format(" The largest bias is that of {}: {}.", r.sensors[bias].name,
                       error_text(all[bias].bias, r.inputs[0].unit));
  if (all[gain].gain != 0)
    out += fmt::format(" The gain of {} is furthest from one: {}.", r.sensors[gain].name,
                       brief_text(1 + all[gain].gain, 3));
  return out;
}

// What the learning window taught, and what each step of it brought.
std::string taught_sentence(const ReplayResult& r) {
  if (!r.alignment || r.alignment->trials.empty() || !r.learning) return "";
  const std::vector<AlignmentResult::Trial>& trials = r.alignment->trials;
  std::vector<std::string> kept, idle;
  for (std::size_t k = 1; k < trials.size(); ++k) {
    const AlignmentResult::Trial& trial = trials[k];
    if (trial.kept)
      kept.push_back(
          fmt::format("{} {} (mean {})", trial.term, brief_text(trial.rmse, 3), brief_text(trial.of_mean, 3)));
    else
      idle.push_back(trial.term);
  }
  std::string out = fmt::format(
      "{} ({} to {}) was used for learning. RMSE there, each half judged by the other: mean {}, learnt weights {}",
      r.scene.learning ? "The learning window" : "The first half of the recording", duration_text(r.learning->from_s),
      duration_text(r.learning->to_s), error_text(trials[0].of_mean, r.inputs[0].unit),
      error_text(trials[0].rmse, r.inputs[0].unit));
  if (!kept.empty()) out += fmt::format("; after correcting the sensors, in turn: {}", list_of(kept));
  if (!idle.empty()) out += fmt::format("; without benefit: {}", list_of(idle));
  return out + "." + largest_parts(r);
}

std::string bounds_sentence(const ReplayResult& r) {
  std::vector<std::string> bounds;
  for (const AlgorithmResult* a : ranked(r))
    if (a->bound && std::isfinite(a->rmse)) bounds.push_back(a->label + " " + error_text(a->rmse, r.inputs[0].unit));
  return bounds.empty() ? "" : "For comparison, bounds that use the reference of the run: " + list_of(bounds) + ".";
}

/// Whether the array is worth more than its best sensor.
struct SensorSentence {
  std::string text;
  bool against_fusion = false;  ///< that sensor alone is better
};

// The method that hands a single sensor on has nothing to do with whether fusion pays.
std::string alone_sentence(const ReplayResult& r, const AlgorithmResult& best) {
  if (best.label == r.best_fusion || best.weights.size() != 1) return "";
  const std::vector<double>& w = best.weights[0];
  const auto largest =
      std::max_element(w.begin(), w.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
  return fmt::format("{} takes {} alone.", best.label, r.sensors[static_cast<std::size_t>(largest - w.begin())].name);
}

SensorSentence sensor_sentence(const ReplayResult& r) {
  const AlgorithmResult* best = r.find(r.best_fusion);
  if (!r.best_sensor || !r.best_over_sensor || best == nullptr) return {};
  const SensorResult& sensor = r.sensors[*r.best_sensor];
  const double ratio = best->rmse / sensor.error.rmse;
  const Interval& interval = *r.best_over_sensor;
  const bool same = r.algorithms[*r.best].label == best->label;
  const std::string name = same ? best->label : best->label + ", the best fusion,";
  const std::string whose = same ? "its error" : "the error of " + name;
  const std::string alone =
      fmt::format("{}, the best single sensor ({})", sensor.name, error_text(sensor.error.rmse, r.inputs[0].unit));
  if (ratio > 1 + kPracticalTolerance && interval.low > 1)
    return {fmt::format("Fusion does not pay here: the error of {} is {} that of {}: use that sensor alone.", name,
                        ratio < 2 ? percent_text(ratio - 1) + " larger than" : brief_text(ratio) + " times", alone),
            true};
  if (ratio < 1 - kPracticalTolerance && interval.high < 1)
    return {fmt::format("Fusion pays: {} is {} (95 %: {} to {}) below that of {}.", whose, percent_text(1 - ratio),
                        percent_text(1 - interval.high), percent_text(1 - interval.low), alone)};
  return {fmt::format("The recording does not show whether fusion pays: {} is {} times that of {} (95 %: {} to {}).",
                      whose, brief_text(ratio), alone, brief_text(interval.low), brief_text(interval.high))};
}

std::string offsets_sentence(const ReplayResult& r) {
  double share = 0;
  for (const AlgorithmResult& a : r.algorithms)
    if (a.ran && a.blind) share = std::max(share, a.blind->offset_share);
  return fmt::format(
      "{} of the differences between the sensors (mean squares) are in their means, and offsets would decide. Give the "
      "scene a stretch at rest, a reference, or sensors without offsets.",
      percent_text(share, 3));
}

// Why no score decides, and what does.
std::vector<std::string> robust_sentences(const ReplayResult& r, bool costs) {
  const AlgorithmResult& best = r.algorithms[*r.best];
  std::vector<std::string> out = {fmt::format("Use {}: a failing or deviating sensor does not mislead it{}.",
                                              best.label, costs ? costs_of(best) : "")};
  if (r.offsets_decide) {
    out.push_back("Scores do not decide: " + offsets_sentence(r));
    return out;
  }
  std::vector<std::string> unscored;
  for (const AlgorithmResult& a : r.algorithms)
    if (a.ran && !a.bound && !std::isfinite(a.rmse)) unscored.push_back(a.label);
  out.push_back(unscored.empty()
                    ? "Scores do not decide: leave-one-out scores arrays of three sensors, and one of the four fails."
                    : fmt::format("Scores do not decide: leave-one-out leaves too few sensors for {}, and one failing "
                                  "sensor would decide between the others.",
                                  list_of(unscored)));
  return out;
}

std::string level_sentence(const ReplayResult& r) {
  if (!r.level_sd) return "";
  const std::string reach = error_text(kNormal95 * *r.level_sd, r.inputs[0].unit);
  if (std::all_of(r.sensors.begin(), r.sensors.end(), [](const SensorResult& s) { return s.offset == 0; }))
    return fmt::format("The level is known to ± {} (95 %), from the differences between the means of the sensors.",
                       reach);
  std::vector<std::string> apart;
  const SensorResult* furthest = &r.sensors[0];
  for (const SensorResult& sensor : r.sensors) {
    if (sensor.offset != 0) apart.push_back(sensor.name + " by " + error_text(sensor.offset, r.inputs[0].unit));
    if (std::abs(sensor.offset) > std::abs(furthest->offset)) furthest = &sensor;
  }
  if (apart.size() < r.sensors.size())
    return fmt::format(
        "The means of some sensors are far from those of the others ({}): this is taken out, and the level is the mean "
        "of the others (± {} with 95 %).",
        list_of(apart), reach);
  return fmt::format(
      "The means of the sensors differ, that of {} by {}: the level is their mean without those far from the others "
      "(± {} with 95 %), offsets from it are taken out, and the method is chosen for the variation.",
      furthest->name, error_text(furthest->offset, r.inputs[0].unit), reach);
}

std::string gain_sentence(const ReplayResult& r) {
  if (!r.gain_sd) return "";
  return fmt::format("The gain is known to ± {} (95 %), from the differences between the gains of the sensors.",
                     percent_text(kNormal95 * *r.gain_sd));
}

// Where the others have samples.
std::string missing_samples(const ReplayResult& r) {
  constexpr double kWorthSaying = 0.1;  // of the instants
  std::vector<double> all;
  for (const SensorResult& sensor : r.sensors) all.push_back(sensor.missing);
  const double usual = median_in_place(all);
  std::string out;
  for (const SensorResult& sensor : r.sensors)
    if (sensor.missing > usual + kWorthSaying && sensor.missing < 1)
      out += fmt::format("{}{} at {}", out.empty() ? "" : ", ", sensor.name, percent_text(sensor.missing, 3));
  return out.empty() ? out : fmt::format("Samples are missing: {} of the instants.", out);
}

// Of faults that nobody declared, for as long as is worth a word.
std::string detected_faults(const ReplayResult& r, const AlgorithmResult& best) {
  constexpr double kLeastShare = 0.05;  // of the run
  const std::vector<const AlgorithmResult*> all = ranked(r);
  const auto watches = [](const AlgorithmResult* a) { return a->watches_faults && !a->bound; };
  const auto first = std::find_if(all.begin(), all.end(), watches);
  if (!r.faults.empty() || first == all.end()) return "";
  const AlgorithmResult& watching = best.watches_faults ? best : **first;
  const double end_s = r.end_s();
  std::vector<std::string> out;
  for (const FoundFault& one : watching.faults) {
    const double to_s = one.to_s.value_or(end_s);
    if (to_s - one.from_s < kLeastShare * (end_s - r.start_s) || one.sensor >= r.sensors.size()) continue;
    out.push_back(fmt::format("{} ({} from {} to {})", r.sensors[detail::in_memory(one.sensor)].name, one.kind,
                              duration_text(one.from_s), to_s < end_s ? duration_text(to_s) : "the end"));
  }
  return out.empty() ? "" : fmt::format("While it runs {} doubts {}.", watching.label, list_of(out));
}

/// Of the samples, and of how the logs were read.
std::optional<Finding> worst_finding(const ReplayResult& r) {
  std::vector<Finding> all = r.warnings.list();
  for (const LogInfo& log : r.logs) all.insert(all.end(), log.warnings.list().begin(), log.warnings.list().end());
  const std::vector<Finding> sorted = worst_first(std::move(all));
  return sorted.empty() ? std::nullopt : std::optional(sorted.front());
}

// Sensors that fail or stand apart, as found.
std::string doubtful_sensors(const ReplayResult& r) {
  std::string out = missing_samples(r);
  for (const Finding& one : r.warnings.list()) {
    const bool unlike = one.code == "sensor_unlike";
    if (detail::doubts_sensors(one))
      out += (out.empty() ? "" : " ") + fmt::format("{}: {}.", unlike ? "Not decidable" : "Caution", sentence_of(one));
  }
  return out;
}

}  // namespace

std::string optimum_of(const ReplayResult& r) { return r.scene.tilt ? "tilt filters" : "fixed weights"; }

bool detail::learns(const ReplayResult& r, const AlgorithmResult& a) {
  return a.description->needs.reference || (a.description->needs.reference_helps && r.learning && r.has_reference);
}

std::vector<std::string> verdict_sentences(const ReplayResult& r, bool costs) {
  if (!r.best) {
    std::vector<std::string> out = {
        r.offsets_decide
            ? "No method is recommended: " + offsets_sentence(r)
            : "No algorithm has a score: without a reference and with these sensors nothing can be compared."};
    if (const std::string doubtful = doubtful_sensors(r); !doubtful.empty()) out.push_back(doubtful);
    return out;
  }
  const AlgorithmResult& best = r.algorithms[*r.best];
  std::vector<std::string> out =
      r.chosen_as_robust
          ? robust_sentences(r, costs)
          : std::vector{fmt::format("Use {}: {}{}.", best.label, figures(r, best), costs ? costs_of(best) : "")};
  if (best.availability < 0.9995)
    out[0] += fmt::format(" It has an estimate at {} of the instants.", percent_text(best.availability, 3));
  const auto add = [&](const std::string& sentence) {
    if (!sentence.empty()) out.push_back(sentence);
  };
  if (const auto bad = worst_finding(r); bad && bad->severity == Severity::bad)
    out.insert(out.begin(), fmt::format("Repair the samples first ({}): these figures describe them as they are.",
                                        find_finding_kind(bad->code)->title));
  SensorSentence single = sensor_sentence(r);
  if (single.against_fusion)
    out.insert(out.begin(), std::move(single.text));
  else
    add(single.text);
  add(level_sentence(r));
  add(gain_sentence(r));
  add(alone_sentence(r, best));
  add(doubtful_sensors(r));
  add(detected_faults(r, best));
  for (const Finding& one : best.remarks.list())
    if (one.severity != Severity::note) add("Caution: " + best.label + ": " + one.sentence + ".");
  add(without_reference_sentence(r, best, costs));
  add(taught_sentence(r));
  if (!r.chosen_as_robust) add(equals_sentence(r, best, costs));
  if (r.has_reference)
    add(bounds_sentence(r));
  else
    add("Without a reference, errors that all sensors share are invisible.");
  return out;
}

}  // namespace libchar
