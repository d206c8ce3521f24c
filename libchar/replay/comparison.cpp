// Intervals that do not overlap: for two independent estimates with 95 % intervals of like width, a difference that
// large comes by chance in about 0.6 % of cases (Schenker & Gentleman, Am. Stat. 55 (2001) 182). Two replays of one
// recording share its noise, so it is rarer still: "not resolved" is said too often rather than too seldom.

#include "libchar/replay/comparison.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "libchar/core/not_known.hpp"
#include "libchar/core/numeric/median.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/shown.hpp"
#include "libchar/core/text/spelling.hpp"

namespace libchar {
namespace {

// Are two reports replays of one scene, and what else differs?

/// Names beyond so many are only counted.
inline constexpr std::size_t kMostNamed = 4;

/// Same samples, same reference: other rounding is the most that may differ.
constexpr double kRounding = 1e-6;

bool same_number(double a, double b) {
  return (std::isnan(a) && std::isnan(b)) || a == b ||
         std::abs(a - b) <= kRounding * std::max(std::abs(a), std::abs(b));
}

std::string or_nothing(const std::string& text) { return text.empty() ? "nothing" : text; }

std::string words(const TimeWindow& w) {
  return std::isfinite(w.to_s) ? fmt::format("{} s to {} s", brief_text(w.from_s, 7), brief_text(w.to_s, 7))
                               : fmt::format("{} s to the end", brief_text(w.from_s, 7));
}

bool same_window(const TimeWindow& a, const TimeWindow& b) {
  return same_number(a.from_s, b.from_s) && same_number(a.to_s, b.to_s);
}

// Collects "WHAT: X in A, Y in B".
class Differences {
 public:
  explicit Differences(std::vector<std::string>& out) : out_(&out) {}
  void add(const std::string& what, const std::string& a, const std::string& b) {
    out_->push_back(fmt::format("{}: {} in A, {} in B", what, a, b));
  }
  void say(std::string sentence) { out_->push_back(std::move(sentence)); }

 private:
  std::vector<std::string>* out_;
};

void compare_sources(const ReplayReport& a, const ReplayReport& b, Differences& found) {
  if (a.scene.simulated != b.scene.simulated)
    return found.add("the scene is", a.scene.simulated ? "a simulation" : "a recording",
                     b.scene.simulated ? "a simulation" : "a recording");
  if (a.scene.simulated && a.scene.seed != b.scene.seed)
    return found.add("seed of the simulation", std::to_string(a.scene.seed), std::to_string(b.scene.seed));
  if (a.scene.simulated && a.scene.identity != b.scene.identity)
    return found.say("the same seed, but another simulation: its sensors, models, truth or faults differ");
  const std::vector<DocumentHead::File>&in_a = a.head.input, &in_b = b.head.input;
  if (in_a.size() != in_b.size())
    return found.add("number of logs", std::to_string(in_a.size()), std::to_string(in_b.size()));
  for (std::size_t i = 0; i < in_a.size(); ++i) {
    const DocumentHead::File &left = in_a[i], &right = in_b[i];
    if (left.sha256.empty() || right.sha256.empty())
      found.say(fmt::format("the sha256 of {} is not in both reports", left.sha256.empty() ? left.path : right.path));
    else if (left.sha256 != right.sha256)
      found.add("contents of the log", fmt::format("{} (sha256 {}…)", left.path, left.sha256.substr(0, 12)),
                fmt::format("{} (sha256 {}…)", right.path, right.sha256.substr(0, 12)));
  }
}

std::string named(const std::vector<std::string>& names) {
  const std::size_t shown = std::min(names.size(), kMostNamed);
  std::string out =
      fmt::format("{}", fmt::join(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(shown), ", "));
  if (names.size() > shown) out += fmt::format(" and {} more", names.size() - shown);
  return or_nothing(out);
}

template <class Named>
std::vector<std::string> names_of(const std::vector<Named>& list) {
  std::vector<std::string> out;
  out.reserve(list.size());
  for (const Named& one : list) out.push_back(one.name);
  return out;
}

// Names that the other side does not have, in order; where both have all, the order differs.
template <class Named>
bool same_names(const std::string& what, const std::vector<Named>& a, const std::vector<Named>& b, Differences& found) {
  const auto left = names_of(a), right = names_of(b);
  if (left == right) return true;
  const auto without = [](const auto& all, const auto& others) {
    std::vector<std::string> out;
    for (const std::string& name : all)
      if (std::find(others.begin(), others.end(), name) == others.end()) out.push_back(name);
    return out;
  };
  const auto only_a = without(left, right), only_b = without(right, left);
  if (only_a.empty() && only_b.empty() && left.size() == right.size())
    found.say(what + "s are in another order");
  else
    found.add(what + "s that the other does not have", named(only_a), named(only_b));
  return false;
}

void compare_sensors(const ReplayReport& a, const ReplayReport& b, Differences& found) {
  if (!same_names("sensor", a.sensors, b.sensors, found)) return;
  for (std::size_t i = 0; i < a.sensors.size(); ++i) {
    const SensorResult &left = a.sensors[i], &right = b.sensors[i];
    if (left.unit != right.unit)
      found.add("unit of sensor " + left.name, or_nothing(left.unit), or_nothing(right.unit));
    if (left.h != right.h)
      found.add("row h of sensor " + left.name, fmt::format("{}", left.h), fmt::format("{}", right.h));
  }
}

// The sensors' own errors do not depend on any algorithm: they tell samples and truth apart where
// nothing else does (scale, rest, resampling, lag).
void compare_own_errors(const ReplayReport& a, const ReplayReport& b, Differences& found) {
  std::vector<std::string> names;
  std::size_t first = 0;
  for (std::size_t i = 0; i < a.sensors.size(); ++i)
    if (!same_number(a.sensors[i].error.rmse, b.sensors[i].error.rmse)) {
      if (names.empty()) first = i;
      names.push_back(a.sensors[i].name);
    }
  if (names.empty()) return;
  found.say(
      fmt::format("the samples or their reference differ (scale, rest, lag or resampling): sensor {} alone has an RMSE "
                  "of {} in A, {} in B{}",
                  names[0], brief_text(a.sensors[first].error.rmse, 7), brief_text(b.sensors[first].error.rmse, 7),
                  names.size() > 1 ? fmt::format("; so do {} others", names.size() - 1) : ""));
}

void compare_references(const ReplayReport& a, const ReplayReport& b, Differences& found) {
  if (a.reference.has_value() != b.reference.has_value())
    return found.add("reference", a.reference ? "one" : "none", b.reference ? "one" : "none");
  if (!a.reference) return;
  if (a.reference->use != b.reference->use) found.add("use of the reference", a.reference->use, b.reference->use);
  const double left = a.reference->lag_s, right = b.reference->lag_s;
  if (!same_number(left, right))
    found.add("lag behind the reference", brief_text(left, 6) + " s", brief_text(right, 6) + " s");
  if (!same_names("true input", a.inputs, b.inputs, found)) return;
  for (std::size_t j = 0; j < a.inputs.size(); ++j)
    if (a.inputs[j].unit != b.inputs[j].unit)
      found.add("unit of the true input " + a.inputs[j].name, or_nothing(a.inputs[j].unit),
                or_nothing(b.inputs[j].unit));
}

std::string words(const ReplayReport::Fault& f) {
  return fmt::format("{} {}{} from {} s", f.sensor, f.kind, std::isfinite(f.value) ? " " + brief_text(f.value, 6) : "",
                     brief_text(f.from_s, 7));
}

void compare_faults(const ReplayReport& a, const ReplayReport& b, Differences& found) {
  if (a.faults.size() != b.faults.size())
    return found.add("number of faults", std::to_string(a.faults.size()), std::to_string(b.faults.size()));
  for (std::size_t i = 0; i < a.faults.size(); ++i) {
    const ReplayReport::Fault &left = a.faults[i], &right = b.faults[i];
    if (left.sensor != right.sensor || left.kind != right.kind || !same_number(left.value, right.value) ||
        !same_number(left.from_s, right.from_s) || !same_number(left.to_s, right.to_s))
      return found.add(fmt::format("fault {}", i + 1), words(left), words(right));
  }
}

void compare_options(const ReplayReport::Algorithm& a, const ReplayReport::Algorithm& b, Differences& found) {
  for (const auto& [name, value] : a.options)
    for (const auto& [other, its] : b.options)
      if (name == other && !same_number(value, its)) found.add(a.label + "." + name, shortest(value), shortest(its));
}

/// Why these are not two replays of one scene, a sentence each; empty: they are.
std::vector<std::string> unlike(const ReplayReport& a, const ReplayReport& b) {
  std::vector<std::string> out;
  Differences found(out);
  compare_sources(a, b, found);
  compare_sensors(a, b, found);
  compare_references(a, b, found);
  if (!same_number(a.rate_hz, b.rate_hz))
    found.add("rate", detail::frequency_text(a.rate_hz, 7), detail::frequency_text(b.rate_hz, 7));
  if (!same_window(a.evaluation, b.evaluation))
    found.add("evaluation", words(a.evaluation), words(b.evaluation));
  else if (a.instants != b.instants)
    found.add("instants of the evaluation", std::to_string(a.instants), std::to_string(b.instants));
  compare_faults(a, b, found);
  if (out.empty()) compare_own_errors(a, b, found);
  return out;
}

/// Differences that do not make it another scene: learning window, options, noise levels, program.
std::vector<std::string> remarks(const Comparison& c) {
  std::vector<std::string> out;
  Differences found(out);
  if (c.a.head.program != c.b.head.program)
    found.add("program", or_nothing(c.a.head.program), or_nothing(c.b.head.program));
  const auto learning = [](const ReplayReport& r) { return r.learning ? words(*r.learning) : std::string("none"); };
  if (learning(c.a) != learning(c.b)) found.add("learning window", learning(c.a), learning(c.b));
  std::vector<std::string> names;
  for (const SensorResult& left : c.a.sensors)
    for (const SensorResult& right : c.b.sensors)
      if (left.name == right.name &&
          !same_number(left.noise_variance.value_or(kNone), right.noise_variance.value_or(kNone)))
        names.push_back(left.name);
  if (!names.empty()) found.say("algorithms were given other noise levels of " + named(names));
  for (const ComparedAlgorithm& row : c.algorithms)
    if (row.a != nullptr && row.b != nullptr) compare_options(*row.a, *row.b, found);
  return out;
}

Difference difference(const ReplayReport::Algorithm& a, const ReplayReport::Algorithm& b) {
  if (std::isnan(a.rmse) || std::isnan(b.rmse)) return Difference::unknown;
  if (a.rmse == b.rmse) return Difference::equal;
  if (std::isnan(a.rmse_ci95.low) || std::isnan(b.rmse_ci95.low)) return Difference::unknown;
  if (b.rmse_ci95.high < a.rmse_ci95.low) return Difference::better;
  if (b.rmse_ci95.low > a.rmse_ci95.high) return Difference::worse;
  return Difference::not_resolved;
}

double change(double a, double b) { return a > 0 ? b / a - 1 : a == b ? 0 : kNone; }

ComparedAlgorithm row(const ReplayReport::Algorithm* a, const ReplayReport::Algorithm* b) {
  ComparedAlgorithm out;
  out.label = a != nullptr ? a->label : b->label;
  out.a = a;
  out.b = b;
  out.rmse_change = out.ns_change = out.bytes_change = kNone;
  if (!out.both_ran()) return out;
  out.difference = difference(*a, *b);
  out.rmse_change = change(a->rmse, b->rmse);
  out.ns_change = change(a->ns_per_sample, b->ns_per_sample);
  out.bytes_change = change(a->bytes(), b->bytes());
  return out;
}

// Those without a number behind all others.
double order(const ReplayReport::Algorithm* one) {
  return one != nullptr && one->ran && !std::isnan(one->rmse) ? one->rmse : std::numeric_limits<double>::infinity();
}

std::string best_of(const ReplayReport& r) {
  const ReplayReport::Algorithm* best = r.find(r.best);
  return best == nullptr ? "none" : fmt::format("{} ({})", best->label, brief_text(best->rmse, 5));
}

std::string comparison_verdict(const Comparison& c) {
  std::size_t counts[5] = {};
  std::vector<double> ns;
  std::size_t both = 0;
  for (const ComparedAlgorithm& one : c.algorithms) {
    if (!one.both_ran()) continue;
    ++both;
    ++counts[static_cast<std::size_t>(one.difference)];
    if (std::isfinite(one.ns_change)) ns.push_back(one.ns_change);
  }
  if (both == 0) return "No algorithm ran in both.";
  std::string out = fmt::format("{} of {} algorithms that ran in both:", c.a.score_words(), both);
  const char* comma = " ";
  for (const Difference d :
       {Difference::better, Difference::worse, Difference::not_resolved, Difference::equal, Difference::unknown})
    if (const std::size_t count = counts[static_cast<std::size_t>(d)]; count > 0) {
      out += fmt::format("{}{} {}", comma, count, name_of(d));
      comma = ", ";
    }
  out += ".";
  if (const double typical = median_in_place(ns); std::isfinite(typical))
    out += fmt::format(" Time a sample: {:+.1f} % (median).", 100 * typical);
  return out + fmt::format(" Best: {} in A, {} in B.", best_of(c.a), best_of(c.b));
}

}  // namespace

Comparison compare_replays(ReplayReport a, ReplayReport b) {
  Comparison out;
  out.a = std::move(a);
  out.b = std::move(b);
  out.unlike = unlike(out.a, out.b);
  for (const ReplayReport::Algorithm& one : out.a.algorithms)
    out.algorithms.push_back(row(&one, out.b.find(one.label)));
  for (const ReplayReport::Algorithm& one : out.b.algorithms)
    if (out.a.find(one.label) == nullptr) out.algorithms.push_back(row(nullptr, &one));
  std::stable_sort(out.algorithms.begin(), out.algorithms.end(),
                   [](const ComparedAlgorithm& left, const ComparedAlgorithm& right) {
                     return std::pair(order(left.b), order(left.a)) < std::pair(order(right.b), order(right.a));
                   });
  out.remarks = remarks(out);
  out.verdict = comparison_verdict(out);
  return out;
}

void refuse_unlike(const Comparison& comparison) {
  if (comparison.unlike.empty()) return;
  const std::size_t shown = std::min(comparison.unlike.size(), kMostNamed);
  std::string what = "not two replays of one scene";
  for (std::size_t i = 0; i < shown; ++i) what += "; " + comparison.unlike[i];
  if (comparison.unlike.size() > shown)
    what += fmt::format("; and {} more differences", comparison.unlike.size() - shown);
  throw input_error("E0921", comparison.a.file + " and " + comparison.b.file)
      .says(what)
      .hint("`compare_replays` compares them all the same");
}

namespace {

struct Metric {
  const char* name;
  double (*value)(const ReplayReport::Algorithm& algorithm);
  double slack;  ///< smaller differences fail no check
};
// The same algorithm holds some ten bytes more or less by where the allocator finds room.
constexpr Metric kMetrics[] = {{"rmse", [](const auto& a) { return a.rmse; }, 0},
                               {"regret", [](const auto& a) { return a.regret; }, 0},
                               {"ns_per_sample", [](const auto& a) { return a.ns_per_sample; }, 0},
                               {"peak_bytes", [](const auto& a) { return a.bytes(); }, 1024}};

const Metric& metric_of(std::string_view name) {
  return *std::find_if(std::begin(kMetrics), std::end(kMetrics),
                       [&](const Metric& metric) { return name == metric.name; });
}

double value_of(const ReplayReport::Algorithm* one, const Metric& metric) {
  return one != nullptr && one->ran ? metric.value(*one) : std::nan("");
}

std::string number(double value, bool share) {
  return share ? fmt::format("{} %", brief_text(100 * value, 4)) : brief_text(value, 5);
}

// Empty: it holds.
std::string failure(const ComparedAlgorithm& row, const Metric& metric, const ComparisonCheck& check) {
  const bool regret = check.metric == "regret";
  const double a = value_of(row.a, metric), b = value_of(row.b, metric);
  if (std::isnan(b))
    return fmt::format("{}: {} is {} in A, and there is none in B{}", row.label, metric.name, number(a, regret),
                       row.b != nullptr && !row.b->why.empty() ? ": " + row.b->why : "");
  const double limit = regret ? a + check.share : a * (1 + check.share);
  if (b <= limit || b - a <= metric.slack) return "";
  const std::string allowed = shortest(100 * check.share);
  return regret ? fmt::format("{}: regret {} in A, {} in B: {} points more, {} are allowed", row.label, number(a, true),
                              number(b, true), brief_text(100 * (b - a), 3), allowed)
                : fmt::format("{}: {} {} in A, {} in B: {} more, {} % is allowed", row.label, metric.name,
                              number(a, false), number(b, false),
                              a > 0 ? brief_text(100 * (b / a - 1), 3) + " %" : "from nothing", allowed);
}

}  // namespace

ComparisonCheck parse_comparison_check(std::string_view text) {
  GrowthWords words{{}, "algorithm", "such as rmse+5%, or minque:regret+0.5%"};
  for (const Metric& metric : kMetrics) words.metrics.emplace_back(metric.name);
  return parse_growth_check(text, words);
}

std::vector<std::string> failures(const Comparison& comparison, const ComparisonCheck& check) {
  const Metric& metric = metric_of(check.metric);
  std::vector<std::string> out, labels;
  std::size_t checked = 0;
  bool found = false;
  for (const ComparedAlgorithm& row : comparison.algorithms) {
    labels.push_back(row.label);
    if (!check.label.empty() && row.label != check.label) continue;
    found = true;
    if (std::isnan(value_of(row.a, metric))) continue;
    // Not asked for in B, unless by name: nothing was lost.
    if (row.b == nullptr && check.label.empty()) continue;
    ++checked;
    if (const std::string sentence = failure(row, metric, check); !sentence.empty()) out.push_back(sentence);
  }
  if (!found && !check.label.empty()) {
    const auto near = nearest(check.label, labels);
    refuse_check(check.text, "neither report has this algorithm", did_you_mean(near, "labels are those of the table"));
  }
  if (checked == 0)
    throw Refusal(ErrorKind::check, "E0923", "`check`")
        .says("A has no {} that B could be held against", metric.name)
        .got(check.text);
  return out;
}

}  // namespace libchar
