// Steps, warm-up and ramp by generalised least squares in the metric of the noise that is fitted
// beside them. In each round the best place of each kind joins the model by itself, the noise is
// fitted again without it, and its likelihood ratio
//   LR = 2 ln L(with it, noise refitted) - 2 ln L(without, noise refitted)
// is held against the square of the threshold that the look-elsewhere effect of its kind sets (scans.hpp): the kind
// with the largest LR - threshold^2 is taken, if that is positive. Kinds within kNotTold of it are named: steps,
// warm-ups and ramps imitate one another. Then the round is repeated on what is left.
#include "libchar/fit/signs/events.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "libchar/core/text/readable.hpp"
#include "libchar/fit/detail/events/regression.hpp"
#include "libchar/fit/detail/events/scans.hpp"
#include "libchar/fit/detail/events/series_powers.hpp"
#include "libchar/spectrum/fft.hpp"

namespace libchar {
namespace {

constexpr double kNotTold = 6;  ///< of LR: odds of twenty to one
constexpr double kGate = 0.7;   ///< share of a threshold that a score must reach to be looked at again
/// The same of a ramp beside a random walk, which may be fitted to it and hides it then: where the slowest power is so
/// many times the next (2 of flicker, 4 of a walk).
constexpr double kRampGate = 0.45, kLikeWalk = 2.4;
/// Of the score of a cycle. It has three parameters, and few coefficients know a walk that looks like one: of LR above
/// its square it is one (measured in docs/theory/events.md).
constexpr double kCycleThreshold = 5.5;
constexpr double kHiddenMore = 4;  ///< of LR, for such a ramp: few coefficients know the walk
/// From this LR on a ramp is likelier than what the walk made of it, if the slowest power falls to this share.
constexpr double kFavoured = 3, kWalkGone = 0.5;
constexpr double kCycleFavoured = 12;  ///< the same of a cycle, which has two parameters more
constexpr double kMostOfEnds = 1e-3;   ///< of EventSeries::Noise: beyond, the first and the last value are free
constexpr int kRounds = 4;
constexpr std::size_t kMostPauses = 16;  ///< beyond, sessions are too many for offsets of their own
constexpr double kTauDrop = 3.8415;      ///< chi-square of one degree of freedom, 95 %
/// A first look takes means of the series, this many at least. What comes within so much of LR of an event there, more
/// than means can hide of one, is looked for in the series itself.
constexpr std::size_t kFirstLook = 3072;
constexpr double kNearly = 6;
constexpr double kNearlyGate = 0.85;  ///< a first look's gates, as shares of the others

/// What a search has in hand.
struct Hypothesis {
  Regression fit;
  std::vector<double> threshold;  ///< of each shape
  std::vector<double> gained;     ///< LR of each shape when it joined
  std::vector<std::vector<EventKind>> not_told;
  std::vector<double> power, weight;
  double deviance = 0;
  double ends = 0;  ///< of EventSeries::Noise
};

struct Search {
  EventSeries& series;
  const NoisePowers& powers;
  const EventOptions& options;
  SeriesGrid grid;
  std::size_t margin = 0;
  std::vector<double> coefficients;       ///< k = 1..n-1 at [k-1]
  std::vector<EventShape> gaps;           ///< the longest missing stretches, as steps
  std::span<const detail::Pause> pauses;  ///< that are left out of the series
  /// Steps between the sessions: what a sensor reads when it is switched on again is an offset, and no event. They
  /// stand in front of the events in every regression.
  std::vector<EventShape> offset{};
  std::size_t offsets() const { return offset.size(); }
  double instant(double at_s) const { return detail::with_pauses(pauses, at_s); }
  double nearly = 0;  ///< of a first look: it ends where LR lacks less than this
};

/// The share of a step that a point has.
double step_share(const EventShape& shape, double point) {
  if (shape.bridged > 0) return std::clamp((point - shape.at + 1) / (shape.bridged + 1), 0.0, 1.0);
  return std::clamp(point + 1 - shape.at, 0.0, 1.0);
}

/// The series without the shapes.
EventSeries without(const EventSeries& series, const SeriesGrid& grid, const Regression& fit) {
  EventSeries left = series;
  const double per = static_cast<double>(grid.per_point);
  const double samples = static_cast<double>(grid.points) * per;
  for (std::size_t i = 0; i < fit.shape.size(); ++i) {
    const EventShape& shape = fit.shape[i];
    const double size = fit.size(static_cast<Eigen::Index>(i)), r = std::exp(-1 / shape.tau);
    double decaying = size;
    for (std::size_t t = 0; t < left.value.size(); ++t) {
      const double at = static_cast<double>(t);
      if (shape.kind == EventKind::step) left.value[t] -= size * step_share(shape, at);
      if (shape.kind == EventKind::ramp) left.value[t] -= size * at * per / (samples - 1);
      if (shape.kind == EventKind::warm_up) left.value[t] -= decaying;
      if (shape.kind == EventKind::cycle)
        left.value[t] -=
            size * std::cos(std::numbers::pi * shape.at * (at + 0.5) / static_cast<double>(grid.points) - shape.tau);
      decaying *= r;
    }
  }
  return left;
}

void weigh(const Search& search, Hypothesis& now) {
  EventSeries::Noise noise = search.powers(without(search.series, search.grid, now.fit));
  now.power = std::move(noise.power);
  now.ends = noise.ends;
  raise_to_measured(now.fit.rest, now.power);
  now.weight.resize(now.power.size());
  for (std::size_t k = 0; k < now.power.size(); ++k) now.weight[k] = 1 / now.power[k];
}

/// Shapes fitted by the weights at hand, noise fitted to what is left, shapes fitted again.
void fit_both(const Search& search, std::vector<EventShape> shapes, Hypothesis& now) {
  if (!shapes.empty() || now.weight.empty()) now.fit = regress(shapes, search.grid, search.coefficients, now.weight);
  weigh(search, now);
  now.fit = regress(std::move(shapes), search.grid, search.coefficients, now.weight);
  now.deviance = deviance_of(now.fit.rest, now.power);
}

/// Most likely place of an event of one kind, given the regression; its score and threshold.
struct Candidate {
  EventShape shape;
  double score = 0, threshold = 0;
};

/// A step beside which its neighbour wants a share is within the point between them.
double place_within(double at, const Search& search, const Regression& beside, std::span<const double> weight) {
  double best = at, best_gain = 0;
  for (const double low : {at - 1, at}) {
    std::vector<EventShape> shapes = beside.shape;
    shapes.push_back({EventKind::step, low});
    shapes.push_back({EventKind::step, low + 1});
    const Regression both = regress(shapes, search.grid, search.coefficients, weight);
    const Eigen::Index last = both.size.size() - 1;
    const double share = both.size(last) / (both.size(last) + both.size(last - 1));
    if (!(share > 0 && share < 1)) continue;
    const double gain = std::abs(both.size(last) + both.size(last - 1)) * std::min(share, 1 - share);
    if (gain <= best_gain) continue;
    best_gain = gain;
    best = low + share;
  }
  return best;
}

/// Within the margin of a border between sessions a step is its offset.
void leave_out_borders(const Search& search, StepScan& scan) {
  if (search.offset.empty()) return;
  for (const EventShape& offset : search.offset) {
    const auto at = static_cast<std::size_t>(offset.at);
    const std::size_t from = at - std::min(at, search.margin);
    for (std::size_t t = from; t < std::min(scan.score.size(), at + search.margin + 1); ++t) scan.score[t] = 0;
  }
  scan.best = 0;
  for (std::size_t t = 0; t < scan.score.size(); ++t)
    if (std::abs(scan.score[t]) > std::abs(scan.score[scan.best])) scan.best = t;
}

/// The best step: between two points, or in a stretch that was missing.
Candidate best_step(const Search& search, const Regression& beside, std::span<const double> weight) {
  StepScan scan = scan_steps(beside, weight, search.grid.points, search.margin);
  leave_out_borders(search, scan);
  Candidate best{{EventKind::step, static_cast<double>(scan.best)},
                 scan.best_score(),
                 rough_threshold(scan.distance, search.options.false_alarm / 2, StepScan::kEvery)};
  std::vector<double> column(search.grid.points - 1);
  for (const EventShape& gap : search.gaps) {
    fill_column(gap, search.grid, column);
    const double score = score_of(beside, column, weight).value();
    if (std::abs(score) > std::abs(best.score)) {
      best.shape = gap;
      best.score = score;
    }
  }
  if (search.grid.per_point > 1 && best.shape.bridged == 0 && std::abs(best.score) > best.threshold)
    best.shape.at = place_within(best.shape.at, search, beside, weight);
  return best;
}

/// Placed exactly from `least` of its threshold on.
Candidate best_of(EventKind kind, const Search& search, const Regression& beside, std::span<const double> weight,
                  double least = 0) {
  const double alpha = search.options.false_alarm;
  if (kind == EventKind::step) return best_step(search, beside, weight);
  if (kind == EventKind::ramp)
    return {{kind}, ramp_score(beside, search.grid, weight).value(), rough_threshold({}, alpha / 4)};
  if (kind == EventKind::cycle) {
    const CycleScan cycle = scan_cycles(beside, search.grid, weight, least * kCycleThreshold);
    return {{kind, cycle.place, 0, cycle.phase}, cycle.score, kCycleThreshold};
  }
  const WarmUpScan scan = scan_warm_ups(beside, search.grid, weight);
  Candidate best{{kind, 0, 0, scan.tau[scan.best]}, scan.score[scan.best], smooth_threshold(scan.distance, alpha / 4)};
  if (std::abs(best.score) >= least * best.threshold) best.shape.tau = refined_tau(scan, beside, search.grid, weight);
  return best;
}

/// A hypothesis with a candidate more, placed once more when the noise is fitted without it.
struct Trial {
  Candidate candidate;
  Hypothesis with;
  double gain = 0;  ///< LR, at most the score squared
  double worth() const { return gain - candidate.threshold * candidate.threshold; }
};

bool has(const Hypothesis& now, EventKind kind) {
  return std::any_of(now.fit.shape.begin(), now.fit.shape.end(),
                     [&](const EventShape& shape) { return shape.kind == kind; });
}

/// Beside a straight line a warm-up has another time constant: alone it had to bend for both.
void place_warm_up(const Search& search, std::vector<EventShape>& shapes, Hypothesis& with) {
  for (EventShape& shape : shapes) {
    if (shape.kind != EventKind::warm_up) continue;
    std::vector<EventShape> others = shapes;
    others.erase(others.begin() + (&shape - shapes.data()));
    const Regression beside = regress(others, search.grid, search.coefficients, with.weight);
    shape = best_of(EventKind::warm_up, search, beside, with.weight).shape;
  }
  fit_both(search, shapes, with);
}

Trial try_candidate(const Search& search, const Hypothesis& now, Candidate candidate) {
  Trial trial{candidate, now, 0};
  std::vector<EventShape> shapes = now.fit.shape;
  shapes.push_back(candidate.shape);
  if (candidate.shape.kind == EventKind::ramp) place_warm_up(search, shapes, trial.with);
  fit_both(search, shapes, trial.with);
  const Regression others = regress(now.fit.shape, search.grid, search.coefficients, trial.with.weight);
  trial.candidate = best_of(candidate.shape.kind, search, others, trial.with.weight);
  shapes.back() = trial.candidate.shape;
  fit_both(search, shapes, trial.with);
  // What the refitted noise alone would gain is no event.
  const double score = trial.with.fit.size(trial.with.fit.size.size() - 1) / trial.with.fit.sd(shapes.size() - 1);
  trial.gain = std::min(now.deviance - trial.with.deviance, score * score);
  return trial;
}

std::vector<EventKind> offered(const Search& search, const Hypothesis& now) {
  std::vector<EventKind> kinds;
  if (search.options.steps) kinds.push_back(EventKind::step);
  if (search.options.warm_up && !has(now, EventKind::warm_up)) kinds.push_back(EventKind::warm_up);
  if (search.options.ramp && !has(now, EventKind::ramp)) kinds.push_back(EventKind::ramp);
  if (search.options.cycle && !has(now, EventKind::cycle)) kinds.push_back(EventKind::cycle);
  return kinds;
}

/// LR of a ramp, or of a cycle, that is no event and yet likelier than the walk in its place; 0: there is none. In a
/// first look also what comes near that.
double walk_like_drift(const Search& search, const Hypothesis& now, const Trial& drift, double favoured) {
  constexpr double kNear = 0.5, kNearlyGone = 0.7;
  const bool looks = search.nearly > 0;
  const double gone = drift.with.power.front() / now.power.front();
  return drift.gain > (looks ? kNear : 1) * favoured && gone < (looks ? kNearlyGone : kWalkGone) ? drift.gain : 0;
}

/// The next event, if there is one; otherwise what the ramp is worth.
std::optional<Trial> next_event(const Search& search, const Hypothesis& now, EventSearch& found) {
  std::vector<Trial> trials;
  for (const EventKind kind : offered(search, now)) {
    const bool bends_another = kind == EventKind::ramp && has(now, EventKind::warm_up);
    const bool hidden = kind == EventKind::ramp && now.power[0] > kLikeWalk * now.power[1];
    const double gate =
        (hidden || kind == EventKind::cycle ? kRampGate : kGate) * (search.nearly > 0 ? kNearlyGate : 1);
    const Candidate candidate = best_of(kind, search, now.fit, now.weight, gate);
    if (!bends_another && std::abs(candidate.score) < gate * candidate.threshold) continue;
    trials.push_back(try_candidate(search, now, candidate));
    double& threshold = trials.back().candidate.threshold;
    if (kind == EventKind::ramp && std::abs(candidate.score) < kGate * candidate.threshold)
      threshold = std::sqrt(threshold * threshold + kHiddenMore);
  }
  const auto best = std::max_element(trials.begin(), trials.end(),
                                     [](const Trial& a, const Trial& b) { return a.worth() < b.worth(); });
  if (best == trials.end() || best->worth() <= -search.nearly) {
    for (const Trial& trial : trials)
      if (trial.candidate.shape.kind == EventKind::ramp)
        found.drift_gain = walk_like_drift(search, now, trial, kFavoured);
      else if (trial.candidate.shape.kind == EventKind::cycle)
        found.cycle_gain = walk_like_drift(search, now, trial, kCycleFavoured);
    return std::nullopt;
  }
  std::vector<EventKind> not_told;
  for (const Trial& other : trials)
    if (&other != &*best && other.candidate.shape.kind != EventKind::cycle && other.worth() > best->worth() - kNotTold)
      not_told.push_back(other.candidate.shape.kind);
  best->with.threshold.push_back(best->candidate.threshold);
  best->with.gained.push_back(best->gain);
  best->with.not_told.push_back(std::move(not_told));
  return std::move(*best);
}

/// Whether shape i may have leaned on what the newest shape explains: of steps only the nearest on either side.
bool beside_newest(const std::vector<EventShape>& shapes, std::size_t i) {
  const EventShape &newest = shapes.back(), &shape = shapes[i];
  if (shape.kind != EventKind::step || newest.kind != EventKind::step) return true;
  return std::none_of(shapes.begin(), shapes.end() - 1, [&](const EventShape& other) {
    const bool same_side = (other.at - newest.at) * (shape.at - newest.at) > 0;
    return other.kind == EventKind::step && same_side &&
           std::abs(other.at - newest.at) < std::abs(shape.at - newest.at);
  });
}

/// What was found before is placed once more beside the newest, and that beside them.
void place_again(const Search& search, Hypothesis& now) {
  if (now.fit.shape.size() < search.offsets() + 2) return;
  std::vector<EventShape> shapes = now.fit.shape;
  for (std::size_t i = search.offsets(); i < shapes.size(); ++i) {
    if (shapes[i].kind == EventKind::ramp || !beside_newest(shapes, i)) continue;
    std::vector<EventShape> others = shapes;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    const Regression beside = regress(others, search.grid, search.coefficients, now.weight);
    shapes[i] = best_of(shapes[i].kind, search, beside, now.weight).shape;
  }
  fit_both(search, std::move(shapes), now);
}

/// What has become less than its threshold beside the others goes.
void drop_weak(const Search& search, Hypothesis& now) {
  for (std::size_t i = search.offsets(); i + 1 < now.fit.shape.size();) {
    const double score = now.fit.size(static_cast<Eigen::Index>(i)) / now.fit.sd(i);
    if (std::abs(score) >= kGate * now.threshold[i]) {
      ++i;
      continue;
    }
    const auto at = static_cast<std::ptrdiff_t>(i);
    std::vector<EventShape> shapes = now.fit.shape;
    shapes.erase(shapes.begin() + at);
    now.threshold.erase(now.threshold.begin() + at);
    now.gained.erase(now.gained.begin() + at);
    now.not_told.erase(now.not_told.begin() + at);
    fit_both(search, std::move(shapes), now);
  }
}

Interval step_interval(const Search& search, const Regression& others, const Hypothesis& now, const EventShape& step) {
  // It is not known where in a missing stretch, or in a mean, it was.
  if (step.bridged > 0) return {step.at, step.at + step.bridged};
  const StepScan scan = scan_steps(others, now.weight, search.grid.points, search.margin);
  const Interval place = step_place(scan, step.at, search.margin);
  const double within = search.grid.per_point > 1 ? 1 : 0;
  return {std::min(place.low - within, step.at), std::max(place.high + within, step.at)};
}

void bound_tau(const Search& search, const Regression& others, const Hypothesis& now, Event& event) {
  const double step_s = search.series.step_s;
  const WarmUpScan scan = scan_warm_ups(others, search.grid, now.weight);
  const double limit = std::pow(std::abs(scan.score[scan.best]), 2) - kTauDrop;
  const auto in = [&](std::size_t i) {
    return scan.score[i] * scan.score[scan.best] > 0 && scan.score[i] * scan.score[i] >= limit;
  };
  std::size_t low = scan.best, high = scan.best;
  while (low > 0 && in(low)) --low;
  while (high + 1 < scan.tau.size() && in(high)) ++high;
  event.tau_ci95 = {scan.tau[low] * step_s, high + 1 == scan.tau.size() && in(high) ? 0 : scan.tau[high] * step_s};
}

/// Of a warm-up the time constant is not known either: a second one beside it spans what it may be. So do two of a
/// cycle for its phase and its period.
Regression with_free_taus(const Search& search, const Hypothesis& now) {
  constexpr double kOtherTau = 1.2, kOtherPlace = 1.05;
  std::vector<EventShape> shapes = now.fit.shape;
  for (const EventShape& shape : now.fit.shape) {
    if (shape.kind != EventKind::cycle) continue;
    shapes.push_back(shape);
    shapes.back().tau += std::numbers::pi / 2;
    shapes.push_back(shape);
    shapes.back().at *= kOtherPlace;
  }
  for (const EventShape& shape : now.fit.shape) {
    if (shape.kind != EventKind::warm_up) continue;
    shapes.push_back(shape);
    shapes.back().tau *= kOtherTau;
  }
  return regress(std::move(shapes), search.grid, search.coefficients, now.weight);
}

/// Standard deviations of the sizes: that of a warm-up is the sum of both, as each begins at one.
std::vector<double> sds_of(const Regression& fit, const Hypothesis& now) {
  const Eigen::Index other = fit.covariance.rows() - 1;
  std::vector<double> sd;
  for (std::size_t i = 0; i < now.fit.shape.size(); ++i) {
    const auto j = static_cast<Eigen::Index>(i);
    double variance = fit.covariance(j, j);
    if (fit.shape[i].kind == EventKind::warm_up)
      variance += fit.covariance(other, other) + 2 * fit.covariance(j, other);
    sd.push_back(std::sqrt(std::max(variance, now.fit.covariance(j, j))));
  }
  return sd;
}

/// The sixteen longest missing stretches of at least two points, but at the ends.
std::vector<EventShape> gaps_of(const EventSeries& series) {
  std::vector<EventShape> gaps;
  for (const Interval& gap : series.unseen_s) {
    const double from = std::round((gap.low - series.start_s) / series.step_s),
                 to = std::round((gap.high - series.start_s) / series.step_s);
    if (from > 0 && to < static_cast<double>(series.value.size()) && to - from >= 2)
      gaps.push_back({EventKind::step, from, to - from});
  }
  std::sort(gaps.begin(), gaps.end(), [](const EventShape& a, const EventShape& b) { return a.bridged > b.bridged; });
  if (gaps.size() > 16) gaps.resize(16);
  return gaps;
}

Event event_of(const Search& search, const Hypothesis& now, std::size_t i, double sd) {
  const EventShape& shape = now.fit.shape[i];
  const double step_s = search.series.step_s;
  Event event;
  event.kind = shape.kind;
  event.size = now.fit.size(static_cast<Eigen::Index>(i));
  event.sd = sd;
  event.score = std::min(std::abs(event.size) / now.fit.sd(i), std::sqrt(now.gained[i]));
  event.threshold = now.threshold[i];
  event.not_told_from = now.not_told[i];
  std::vector<EventShape> others = now.fit.shape;
  others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
  const Regression beside = regress(std::move(others), search.grid, search.coefficients, now.weight);
  if (shape.kind == EventKind::step) {
    const Interval place = step_interval(search, beside, now, shape);
    const double start_s = search.series.start_s;
    event.at_s = search.instant(start_s + (shape.bridged > 0 ? place.high : shape.at) * step_s);
    event.at_ci95 = {search.instant(start_s + place.low * step_s), search.instant(start_s + place.high * step_s)};
    event.in_gap = shape.bridged > 0;
  }
  if (shape.kind == EventKind::warm_up) {
    event.from_s = search.series.start_s;
    event.tau_s = shape.tau * step_s;
    bound_tau(search, beside, now, event);
  }
  if (shape.kind == EventKind::cycle) {
    event.from_s = search.series.start_s;
    event.period_s = 2 * static_cast<double>(search.grid.points) * step_s / shape.at;
    event.phase = shape.tau;
    constexpr double kPartOfOne = 1.3;  // half periods: the record does not tell it from longer ones
    if (shape.at < kPartOfOne) event.tau_ci95.low = event.period_s;
    event.not_told_from.clear();  // all of them are seen in its sentence
  }
  if (shape.kind == EventKind::ramp) {
    const double samples = static_cast<double>(search.grid.points) * static_cast<double>(search.grid.per_point);
    event.slope = event.size / ((samples - 1) * step_s / static_cast<double>(search.grid.per_point));
  }
  return event;
}

/// Where beside the events the scores of steps still pass their threshold: stretches between
/// changes of sign count as one.
int further_steps(const Search& search, const Hypothesis& now) {
  const StepScan scan = scan_steps(now.fit, now.weight, search.grid.points, search.margin);
  const double limit = rough_threshold(scan.distance, search.options.false_alarm / 2, StepScan::kEvery);
  int places = 0;
  double last = 0;
  for (const double score : scan.score) {
    if (std::abs(score) < limit) continue;
    places += score * last <= 0 ? 1 : 0;
    last = score;
  }
  return places;
}

Interval longest_without_steps(const std::vector<Event>& events, double start_s, double duration_s) {
  std::vector<double> at = {start_s, start_s + duration_s};
  for (const Event& event : events)
    if (event.kind == EventKind::step) at.push_back(event.at_s);
  std::sort(at.begin(), at.end());
  Interval longest{at[0], at[1]};
  for (std::size_t i = 1; i < at.size(); ++i)
    if (at[i] - at[i - 1] > longest.high - longest.low) longest = {at[i - 1], at[i]};
  return longest;
}

/// What many steps are.
void judge_many(const Search& search, const Hypothesis& now, std::string_view unit, EventSearch& found) {
  if (!found.more && found.events.size() < 6) return;
  const double duration_s = static_cast<double>(search.grid.points) * search.series.step_s;
  found.telegraph = telegraph_of(found.events, found.more ? further_steps(search, now) : 0, duration_s);
  if (found.telegraph) {
    const Telegraph& telegraph = *found.telegraph;
    found.findings.push_back(finding(
        "events_left_in", fmt::format("The record jumps between two levels about {}{}{} apart, {} times at least: "
                                      "random telegraph noise. Statements about slow noise describe these jumps.",
                                      number_text(telegraph.size, digits_for(telegraph.sd / telegraph.size)),
                                      unit.empty() ? "" : " ", unit, telegraph.jumps)));
  } else if (found.more) {
    const Interval quiet =
        longest_without_steps(found.events, search.series.start_s,
                              search.instant(search.series.start_s + duration_s) - search.series.start_s);
    Finding many = finding("events_left_in",
                           fmt::format("There are more than {} steps and drifts: the sensor was moved or shaken; they "
                                       "were not removed. The longest stretch found without a step is from {} to {} s.",
                                       search.options.most, place_text(quiet.low), place_text(quiet.high)));
    many.help.push_back({"Use the longest stretch without a step.",
                         {{"from_s", place_text(quiet.low)}, {"to_s", place_text(quiet.high)}}});
    found.findings.push_back(std::move(many));
  }
}

Finding slow_cycle_finding(const Event& event, std::string_view unit) {
  const double frequency_hz = 1 / event.period_s;
  Finding found = finding("cycle",
                          fmt::format("{} It was removed before the noise was fitted: the recording contains too "
                                      "little of it to identify it, and a random walk looks like it in a shorter one.",
                                      event_sentence(event, unit)),
                          "a slow cycle was taken out");
  found.where.frequency_hz.push_back({frequency_hz, frequency_hz});
  return found;
}

/// What phase noise puts into the first and the last value moves all slow coefficients at once, as an event does: both
/// are free, as steps behind and in front of them are.
void free_ends(Search& search) {
  search.series.ends_free = true;
  search.offset.insert(search.offset.begin(), {EventKind::step, 1});
  search.offset.push_back({EventKind::step, static_cast<double>(search.grid.points - 1)});
}

/// The search of a series whose points are means of `each` of another.
EventSearch search_series(const EventSeries& whole, std::size_t each, const NoisePowers& powers,
                          const EventOptions& asked, std::string_view unit, double nearly) {
  EventSeries series = whole;
  const std::vector<detail::Pause> pauses = detail::leave_out_pauses(series);
  EventOptions options = asked;
  // They go through the sessions, whose means are gone.
  options.ramp = options.ramp && pauses.empty();
  options.cycle = options.cycle && pauses.empty();
  const std::size_t n = series.value.size();
  Dct dct(n);
  const std::span<const double> c = dct.transform(series.value);
  const std::size_t margin = std::max<std::size_t>(2, std::max<std::size_t>(8, n * each / 500) / each);
  Search search{series, powers, options, {n, series.per_point}, margin, {}, gaps_of(series), pauses};
  search.nearly = nearly;
  search.coefficients.assign(c.begin() + 1, c.end());

  Hypothesis now;
  now.fit.rest = search.coefficients;
  for (const detail::Pause& pause : pauses) {
    const double at = std::round((pause.at_s - series.start_s) / series.step_s);
    const double last = search.offset.empty() ? 0 : search.offset.back().at;
    if (at > last && at < static_cast<double>(n)) search.offset.push_back({EventKind::step, at});
  }
  fit_both(search, {}, now);
  if (now.ends > kMostOfEnds) free_ends(search);
  now.threshold.assign(search.offsets(), 0.0);
  now.gained.assign(search.offsets(), 0.0);
  now.not_told.resize(search.offsets());
  // Offsets look like slow noise at first, which hides them.
  for (int i = 0; i < kRounds && !search.offset.empty(); ++i) fit_both(search, search.offset, now);
  EventSearch found;
  for (int round = 0; round <= options.most; ++round) {
    std::optional<Trial> next = next_event(search, now, found);
    found.looks_like_one = nearly > 0 && (next || found.drift_gain > 0 || found.cycle_gain > 0);
    if (!next || found.looks_like_one) break;
    found.more = round == options.most;
    if (found.more) break;
    now = std::move(next->with);
    place_again(search, now);
    drop_weak(search, now);
  }
  const Regression free_taus = with_free_taus(search, now);
  const std::vector<double> sd = sds_of(free_taus, now);
  for (std::size_t i = search.offsets(); i < now.fit.shape.size(); ++i) {
    found.events.push_back(event_of(search, now, i, sd[i]));
    if (found.events.back().kind == EventKind::cycle) {
      found.findings.push_back(slow_cycle_finding(found.events.back(), unit));
      continue;
    }
    found.findings.push_back(finding("event", event_sentence(found.events.back(), unit)));
    if (found.events.back().kind == EventKind::step)
      found.findings.back().where.time_s.push_back({found.events.back().at_s, found.events.back().at_s});
  }
  judge_many(search, now, unit, found);
  if (!found.events.empty()) found.leverage = leverage_of(free_taus.column, free_taus.covariance, now.weight);
  found.power = std::move(now.power);
  return found;
}

}  // namespace

EventSearch find_events(const EventSeries& series, const NoisePowers& powers, const EventOptions& options,
                        std::string_view unit) {
  std::size_t each = series.unseen_s.empty() ? series.value.size() / kFirstLook : 0;
  while (each > 1 && series.value.size() % each != 0) --each;  // no point is lost, and the length transforms fast
  if (each > 1) {
    const EventSearch look = search_series(detail::means_of(series, each), each, powers, options, unit, kNearly);
    if (!look.looks_like_one) return look;
  }
  return search_series(series, 1, powers, options, unit, 0);
}

}  // namespace libchar
