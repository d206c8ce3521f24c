#include "libchar/replay/detail/plan/sensor_words.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "libchar/core/numeric/distributions.hpp"
#include "libchar/core/numeric/median.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/text.hpp"

namespace libchar::detail {
namespace {

constexpr double kFalseAlarm = 0.003;   // of each judgement in a sound array
constexpr double kSuspicion = 0.05;     // the same where a fault is not told
constexpr double kSuspected = 1.5;      // times the least, then
constexpr double kSuspectedOffset = 1;  // scatter of the offsets of three sound sensors, times the noise

// Of a sensor that stands apart from the others, at least:
constexpr double kLeastOffset = 3;  // times the noise
constexpr double kLeastGain = 0.05;
constexpr double kLeastLouder = 1;      // of the logarithm of the noise
constexpr double kLeastSlower = 0.3;    // of that of its slow part
constexpr double kLeastRepeated = 0.3;  // of its samples, more than of the others'
constexpr double kLeastOutliers = 0.1;  // of its blocks, more than of the others'
constexpr double kOutliersOver = 2.5;   // times as many as the others'
// Scatter of sound sensors of one kind.
constexpr double kUsualGain = 0.03, kUsualLevel = 0.3, kUsualSlow = 0.07;

using Values = std::vector<std::optional<double>>;

/// How far a value is from others that are as scattered as these, over what chance does in an array of `false_alarm`:
/// by their deviation (Student's t of one left out), and of many by their median deviation, so that several may
/// stand apart. `usual_sd`: what sound sensors scatter by counts as three more of them; 0: nothing is known of that.
double apart_from(std::vector<double> others, double value, double usual_sd, double false_alarm) {
  constexpr std::size_t kMany = 8;
  constexpr double kOfMedian = 10;
  const auto n = static_cast<double>(others.size());
  double mean = 0, squares = 0;
  for (const double other : others) mean += other / n;
  for (const double other : others) squares += (other - mean) * (other - mean);
  const double more = usual_sd > 0 ? 3 : 0, dof = n - 1 + more;
  const double sd = std::sqrt((squares + more * usual_sd * usual_sd) / dof * (1 + 1 / n));
  const double limit = student_quantile(1 - false_alarm / (2 * (n + 1)), dof);
  const double by_sd = (value - mean) / (limit * sd);
  if (others.size() < kMany) return by_sd;
  const double middle = median_in_place(others);
  for (double& other : others) other = std::abs(other - middle);
  const double by_median = (value - middle) / (kOfMedian * kMadToSd * median_in_place(others));
  return std::abs(by_median) > std::abs(by_sd) ? by_median : by_sd;
}

/// Of each value, beyond 1 in magnitude: it stands apart, and by `least` at least; 0: unknown.
std::vector<double> apart(const Values& values, double least, double usual_sd, double false_alarm) {
  std::vector<double> out(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    std::vector<double> others;
    for (std::size_t j = 0; j < values.size(); ++j)
      if (j != i && values[j]) others.push_back(*values[j]);
    if (!values[i] || others.size() < 2) continue;
    const double away = (*values[i] - median_in_place(others)) / least;
    const double by_chance = apart_from(std::move(others), *values[i], usual_sd, false_alarm);
    out[i] = std::abs(by_chance) < std::abs(away) ? by_chance : away;
  }
  return out;
}

double middle_of(std::vector<double> values) { return median_in_place(values); }

/// Everything that is said of a sensor has these.
struct Sensors {
  const std::vector<std::string>& names;
  const std::vector<std::string>& units;
  std::string name(std::size_t i) const { return printable(names[i], 40); }
  std::string amount(double value, std::size_t i) const {
    return brief_text(value, 2) + (units[i].empty() ? "" : " ") + units[i];
  }
};

/// By the shares of its blocks with outliers and of those of the middle sensor.
bool more_outliers(double share, double usual) {
  return share > std::max(usual + kLeastOutliers, kOutliersOver * usual);
}

std::string outliers_text(double share) {
  return fmt::format("outliers in {} of its stretches", percent_text(share, 2));
}

/// What sensors read on average: what is judged, and what is said of it.
struct Throughout {
  ReadingMeter::Readings steady;
  Values slow;
  std::vector<double> repeated, outliers;
  bool level = false;      // offsets were taken out
  bool reference = false;  // is the last of them: it has no noise and no steps, and only says what is right
  double noise = 0;        // of the middle sensor

  Values each(double (*value)(const LearntSensor::Reading& reading)) const {
    Values out;
    for (const auto& one : steady) out.push_back(one ? std::optional(value(*one)) : std::nullopt);
    return out;
  }

  /// Of each sensor; empty where it does not stand apart.
  std::vector<std::vector<std::string>> words(const Sensors& of, bool sure) const {
    const double by_chance = sure ? kFalseAlarm : kSuspicion, times = sure ? 1 : kSuspected;
    const bool few = !sure && !level && steady.size() == 3;
    Values slower = slow;
    for (auto& one : slower)
      if (one) one = std::log(*one);
    const auto offsets = apart(each([](const auto&one) { return one.offset; }), times * kLeastOffset * noise,
                               few ? kSuspectedOffset * noise : 0, by_chance),
               gains = apart(each([](const auto&one) { return one.gain; }), times * kLeastGain, kUsualGain, by_chance),
               levels = apart(each([](const auto&one) { return std::log(one.usual_rms); }), times * kLeastLouder,
                              kUsualLevel, by_chance),
               slowly = apart(slower, kLeastSlower, kUsualSlow, by_chance);
    const double repeats = middle_of(repeated), outlying = middle_of(outliers);
    std::vector<std::vector<std::string>> out(steady.size());
    for (std::size_t i = 0; i + (reference ? 1 : 0) < steady.size(); ++i) {
      if (std::abs(gains[i]) > 1) out[i].push_back("gain " + brief_text(1 + steady[i]->gain, 3));
      if (std::abs(offsets[i]) > 1) out[i].push_back("offset " + of.amount(steady[i]->offset, i));
      if (levels[i] > 1 && !(sure && reference)) out[i].push_back("noise " + of.amount(steady[i]->usual_rms, i));
      if (reference) continue;
      if (!sure && slowly[i] > 1)  // sound sensors drift, and are late, unlike each other
        out[i].push_back(fmt::format("scatter {} times that from sample to sample", brief_text(*slow[i], 2)));
      if (more_outliers(outliers[i], outlying)) out[i].push_back(outliers_text(outliers[i]));
      if (repeated[i] > repeats + kLeastRepeated)
        out[i].push_back(fmt::format("{} of its samples repeat the one before", percent_text(repeated[i], 2)));
    }
    return out;
  }
};

struct Said {
  std::string name, text;
};

/// All of them by name, also where a finding has no room for their texts.
void add(Findings& warnings, std::string_view code, std::string sentence, const std::vector<Said>& sensors) {
  constexpr std::size_t kMostTexts = 3;
  std::vector<std::string> names;
  for (const Said& one : sensors) names.push_back(one.name);
  if (names.size() > kMostTexts) sentence += fmt::format(": {}", fmt::join(names, ", "));
  for (const Said& one : sensors) warnings.add(code, sentence, one.name + ": " + one.text);
}

void warn_of_apart(const Throughout& all, const Sensors& of, const std::vector<Said>& failing, Findings& warnings) {
  const auto sure = all.words(of, true), suspected = all.words(of, false);
  std::vector<Said> apart, unlike;
  for (std::size_t i = 0; i < sure.size(); ++i) {
    std::vector<std::string> words = sure[i];
    for (const std::string& one : suspected[i])
      if (std::find(words.begin(), words.end(), one) == words.end()) words.push_back(one);
    const auto fails = [&](const Said& one) { return one.name == of.name(i); };
    if (sure[i].empty() && std::any_of(failing.begin(), failing.end(), fails)) continue;  // it is decided
    if (!words.empty())
      (sure[i].empty() ? unlike : apart).push_back({of.name(i), fmt::format("{}", fmt::join(words, ", "))});
  }
  add(warnings, "sensor_apart", "sensors read differently from all others, throughout", apart);
  add(warnings, "sensor_unlike",
      "sensors differ from the others throughout, by no more than sound ones may: a fault cannot be distinguished from "
      "their kind",
      unlike);
}

/// "up to 5 deg/s off, 12 times its scatter, from 4 min to the end"; "its scatter 20 times smaller"
std::string change_text(const ReadingMeter::Change& change, const Sensors& of, const Clock& clock) {
  const bool pair = of.names.size() == 2;  // each is half as far from their mean
  const auto at = [&](std::int64_t instant) {
    return duration_text(clock.start_s + static_cast<double>(instant) / clock.rate_hz);
  };
  const std::string scatter = change.scatter < 1 ? "its scatter " + brief_text(1 / change.scatter, 2) + " times smaller"
                                                 : brief_text(change.scatter, 2) + " times its scatter";
  return fmt::format("up to {} {}, {}, from {} to {}", of.amount((pair ? 2 : 1) * change.offset, change.sensor),
                     pair ? "apart" : "off", scatter, change.from == 0 ? std::string("the start") : at(change.from),
                     change.to_end ? std::string("the end") : at(change.to));
}

std::vector<Said> changes_said(const std::vector<ReadingMeter::Change>& changes, const Sensors& of,
                               const Clock& clock) {
  std::vector<Said> out;
  for (const ReadingMeter::Change& change : changes)
    out.push_back({of.names.size() == 2 ? of.name(0) + " or " + of.name(1) : of.name(change.sensor),
                   change_text(change, of, clock)});
  return out;
}

}  // namespace

namespace {

/// Sensors that `said` does not name yet.
void add_unsaid(const std::vector<Said>& more, std::vector<Said>& out, const std::vector<Said>& said) {
  for (const Said& one : more) {
    const auto same = [&](const Said& other) { return other.name == one.name; };
    if (std::none_of(said.begin(), said.end(), same) && std::none_of(out.begin(), out.end(), same)) out.push_back(one);
  }
}

/// What changes within a run, by the offset, the scatter or the gain.
std::vector<Said> failing_in_run(const ReadingMeter& meter, const Sensors& of, const Clock& clock,
                                 const std::vector<TakenOut>& taken_out) {
  std::vector<Said> out = changes_said(meter.changes(meter.steady(), true), of, clock), drifts;
  for (const ReadingMeter::GainDrift& drift : meter.gain_drifts(kFalseAlarm)) {
    const double before = 1 + taken_out[drift.sensor].gain;
    drifts.push_back(
        {of.name(drift.sensor), fmt::format("its gain drifts from {} to {}", brief_text(before + drift.from, 3),
                                            brief_text(before + drift.to, 3))});
  }
  add_unsaid(drifts, out, {});
  return out;
}

}  // namespace

void warn_of_readings(const RunReadings& run, const std::vector<std::string>& names,
                      const std::vector<std::string>& units, const Clock& clock, const std::vector<TakenOut>& taken_out,
                      bool reference, Findings& warnings) {
  const Sensors of{names, units};
  const ReadingMeter& meter = run.meter;
  ReadingMeter::Readings steady = meter.steady();
  Throughout all{{}, meter.slow_scatter(steady), meter.repeated(), meter.with_outliers(steady)};
  all.reference = reference;
  std::vector<Said> failing = failing_in_run(meter, of, clock, taken_out), beside, noisier;
  if (run.beside_truth != nullptr) add_unsaid(failing_in_run(*run.beside_truth, of, clock, taken_out), beside, failing);
  for (const StepNoiseMeter::Change& one : run.noise) {
    const bool less = one.times < 1;
    const double at_s = run.noise_from_s + static_cast<double>(one.at) / clock.rate_hz;
    noisier.push_back({of.name(one.sensor), fmt::format("{}{} times as noisy {} {}", one.least ? "at least " : "",
                                                        brief_text(less ? 1 / one.times : one.times, 2),
                                                        less ? "until" : "from", duration_text(at_s))});
  }
  add_unsaid(noisier, failing, beside);
  add(warnings, "sensor_failing", "sensors read otherwise, relative to the others, than for most of the run", failing);
  add(warnings, "sensor_failing", "sensors read otherwise, relative to the reference, than for most of the run",
      beside);
  std::vector<double> rms;
  for (std::size_t i = 0; i < steady.size(); ++i) {
    all.level = all.level || taken_out[i].offset != 0;
    if (!steady[i]) continue;
    steady[i]->offset += taken_out[i].offset;
    steady[i]->gain += taken_out[i].gain;
    rms.push_back(steady[i]->usual_rms);
  }
  if (rms.size() < 3) return;
  all.noise = median_in_place(rms);
  all.steady = std::move(steady);
  failing.insert(failing.end(), beside.begin(), beside.end());
  warn_of_apart(all, of, failing, warnings);
}

void warn_of_delays(const std::vector<ReadingMeter::Delay>& delays, const std::vector<std::string>& names,
                    Findings& warnings) {
  std::vector<Said> said;
  for (const ReadingMeter::Delay& one : delays)
    said.push_back({printable(names[one.sensor], 40),
                    fmt::format("{} of what it scatters, about {} samples {}", percent_text(one.share, 2),
                                brief_text(std::abs(one.samples), 2), one.samples > 0 ? "late" : "early")});
  const std::string sentence = "sensors are not in time with the others: they differ from them as the input moves";
  add(warnings, "sensors_out_of_time", sentence, said);
  if (!said.empty())
    warnings.add("sensors_out_of_time", sentence, {}, 0).help.push_back({"Take the delays out.", {{"align", "delay"}}});
}

bool doubts_sensors(const Finding& finding) {
  constexpr std::string_view kCodes[] = {
      "sensor_failing",  "sensors_out_of_time",    "sensor_apart",  "sensor_unlike", "frozen_sensor",
      "constant_sensor", "sensor_without_samples", "copied_sensor", "missing_mark",  "tilt_contradicts"};
  return std::find(std::begin(kCodes), std::end(kCodes), finding.code) != std::end(kCodes);
}

void warn_of_changes(const ReadingMeter& meter, const ReadingMeter::Readings& learnt,
                     const std::vector<std::string>& names, const std::vector<std::string>& units, const Clock& clock,
                     Findings& warnings) {
  const Sensors of{names, units};
  std::vector<Said> changed = changes_said(meter.changes(learnt), of, clock), gains, spiky;
  for (const ReadingMeter::GainDrift& one : meter.gain_drifts(kFalseAlarm, &learnt)) {
    const std::string from = brief_text(1 + one.from, 3), to = brief_text(1 + one.to, 3);
    gains.push_back(
        {of.name(one.sensor), fmt::format("its gain is {}{}, where this was learnt {}", from,
                                          from == to ? "" : " to " + to, brief_text(1 + learnt[one.sensor]->gain, 3))});
  }
  add_unsaid(gains, changed, {});
  add(warnings, "sensor_changed",
      "sensors read otherwise, relative to the others, than where this was learnt: weights and standard deviations of "
      "there do not fit",
      changed);
  const std::vector<double> outliers = meter.with_outliers(learnt);
  for (std::size_t i = 0; i < outliers.size(); ++i)
    if (more_outliers(outliers[i], middle_of(outliers))) spiky.push_back({of.name(i), outliers_text(outliers[i])});
  add(warnings, "sensor_apart", "sensors have more outliers than the others", spiky);
}

}  // namespace libchar::detail
