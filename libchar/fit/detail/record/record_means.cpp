// Temperature first: a warm-up is mostly the temperature's doing, and an event search would take it
// for itself. Where events are found in what is left, temperature is fitted once more without them:
// a step is loud at the frequencies of the temperature.
#include "libchar/fit/detail/record/record_means.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "libchar/core/error.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/fit/noise_fit.hpp"

namespace libchar {
namespace {

constexpr std::size_t kFewestForEvents = 1024;  ///< samples
constexpr std::size_t kFewestPoints = 64;       ///< of a series of means
constexpr double kToldApart = 6;                ///< of 2 ln L: odds of twenty to one
constexpr double kLeastDof = 0.1;               ///< of a bin: what is all but explained weighs next to nothing

bool take_events(const EventSearch& search) { return !search.events.empty() && !search.more && !search.telegraph; }

/// `series` makes the series. What cannot be searched is fitted as it is; the fit says itself what it cannot do.
template <class Series>
EventSearch search_events(const FitOptions& options, const Series& series) {
  if (!options.events || !options.remedies) return {};
  try {
    const EventSeries& searched = series();
    if (searched.value.size() < kFewestPoints) return {};
    // Phase noise is not among the powers of the search: where it stands, a clock would step all the time.
    EventOptions how;
    how.steps = !options.clock;
    how.cycle = options.slow_cycles;
    EventSearch found = find_events(searched, fitted_powers(), how, options.unit);
    if (!options.clock && !found.more && !found.telegraph) found.bursts = detail::find_bursts(searched, found.events);
    return found;
  } catch (const Error& error) {
    if (error.problem().kind != ErrorKind::numeric) throw;
    return {};
  }
}

EventSearch search_record(std::span<const double> record, double rate_hz, const FitOptions& options,
                          const EventSeries* known) {
  if (record.size() < kFewestForEvents) return {};
  EventSeries own;
  return search_events(options, [&]() -> const EventSeries& {
    if (known == nullptr) own = event_series(record, rate_hz);
    return known != nullptr ? *known : own;
  });
}

std::vector<double> less(std::span<const double> record, double rate_hz, const EventSearch* search,
                         const std::optional<TemperatureEffect>& temperature) {
  std::vector<double> left(record.begin(), record.end());
  if (search != nullptr) subtract_events(search->events, rate_hz, left);
  if (temperature) add_temperature_effect(*temperature, -1, left);
  return left;
}

bool moves(const std::optional<TemperatureEffect>& effect) { return effect && effect->order > 0; }

void report_temperature(const TemperatureEffect& effect, const FitOptions& options, NoiseFit& fit) {
  fit.temperature = effect;
  fit.findings.push_back(finding("temperature", temperature_sentence(effect, options.unit)));
  if (effect.order == 0) return;
  fit.remedies.push_back(
      {"temperature",
       fmt::format("2 ln L rises by {:.1f}, by chance with probability {}; asked for", effect.gain,
                   brief_text(effect.p, 2)),
       fmt::format("a polynomial of order {} taken out of the record before the noise was fitted", effect.order), 1});
  for (const Term term : {Term::flicker, Term::walk}) {
    const auto i = static_cast<std::size_t>(term);
    if (fit.term[i].status == Status::not_fitted) continue;
    fit.findings.push_back(
        finding("temperature", fmt::format("With temperature left in, {} would be {}; it is {}.", kTermNames[i].letter,
                                           coefficient_text(effect.without[i]), coefficient_text(fit.term[i]))));
  }
}

/// Eight steps are one remedy with eight places.
void add_event_remedy(EventKind kind, NoiseFit& fit) {
  const Event* weakest = nullptr;
  std::uint64_t count = 0;
  std::vector<double> at;
  for (const Event& event : fit.events) {
    if (event.kind != kind) continue;
    if (weakest == nullptr || event.score / event.threshold < weakest->score / weakest->threshold) weakest = &event;
    if (kind == EventKind::step) at.push_back(event.at_s);
    ++count;
  }
  if (count == 0) return;
  std::sort(at.begin(), at.end());
  std::string places;
  for (const double place : at) places += (places.empty() ? ", at " : ", ") + place_text(place);
  if (!places.empty()) places += " s";
  fit.remedies.push_back({std::string(event_name(kind)),
                          fmt::format("{}score {}, above {} by chance in 0.3 % of records", count > 1 ? "lowest " : "",
                                      brief_text(weakest->score), brief_text(weakest->threshold)),
                          "taken out of the record before the noise was fitted" + places, count});
}

/// `gain`: 2 ln L of what is in the place of a random walk; 0: nothing is.
void doubt_walk(const char* rival, double gain, NoiseFit& fit) {
  Coefficient& walk = fit.term[static_cast<std::size_t>(Term::walk)];
  if (!(gain > 0) || walk.status != Status::detected) return;
  walk.status = Status::undetermined;
  fit.findings.push_back(finding(
      "drift_or_walk", fmt::format("A {} is likelier than the random walk K (2 ln L {}), but too weak to be taken out: "
                                   "the record cannot tell them apart.",
                                   rival, brief_text(gain, 2))));
}

/// Their share of the record is not known: N may be that of the undisturbed part.
void report_bursts(const detail::Bursts& bursts, NoiseFit& fit) {
  constexpr double kSaid = 0.98;
  constexpr double kLonger = 0.8;  // bursts weigh most at times at which the median holds some of them
  Coefficient& white = fit.term[static_cast<std::size_t>(Term::white)];
  if (!white.value) return;
  white.ci95.low *= bursts.core > kSaid ? bursts.core : kLonger * bursts.core;
  const bool known = std::any_of(fit.findings.begin(), fit.findings.end(),
                                 [](const Finding& one) { return one.code == "heavy_tails"; });
  if (known || bursts.core > kSaid) return;
  fit.findings.push_back(finding(
      "heavy_tails",
      fmt::format(
          "At an averaging time of {} the record has heavier tails than Gaussian noise (kurtosis of differences "
          "{} instead of 3), as bursts cause: N of the undisturbed part may be {} times as large.",
          duration_text(bursts.tau_s), brief_text(bursts.kurtosis, 3), brief_text(bursts.core, 2)),
      "the noise comes in bursts"));
  fit.findings.back().severity = Severity::caution;
}

void report_events(const RecordMeans& means, NoiseFit& fit) {
  const EventSearch& search = means.search;
  if (search.bursts) report_bursts(*search.bursts, fit);
  fit.findings.insert(fit.findings.end(), search.findings.begin(), search.findings.end());
  // What stayed in is not noise, and the coefficients hold it.
  if (search.more || search.telegraph)
    for (Coefficient& term : fit.term)
      if (term.status == Status::detected) term.status = Status::undetermined;
  doubt_walk("straight drift", search.drift_gain, fit);
  doubt_walk("slow cycle", search.cycle_gain, fit);
  if (!means.events_taken) return;
  // A cycle is the surroundings', and no part of the model.
  for (const Event& event : search.events) {
    if (event.kind != EventKind::cycle) {
      fit.events.push_back(event);
      continue;
    }
    Event& cycle = fit.cycles.emplace_back(event);
    constexpr double kTurn = 2 * std::numbers::pi;
    cycle.phase = std::remainder(cycle.phase + kTurn * std::exchange(cycle.from_s, 0) / cycle.period_s, kTurn);
  }
  for (const EventKind kind : {EventKind::step, EventKind::warm_up, EventKind::ramp}) add_event_remedy(kind, fit);
}

}  // namespace

RecordMeans without_means(std::span<const double> record, double rate_hz, const FitOptions& options,
                          const TemperatureRecord* temperature, const EventSeries* series) {
  RecordMeans out;
  if (temperature != nullptr) out.temperature = find_temperature_effect(record, rate_hz, *temperature);
  const std::vector<double> warm =
      moves(out.temperature) ? less(record, rate_hz, nullptr, out.temperature) : std::vector<double>{};
  out.search =
      warm.empty() ? search_record(record, rate_hz, options, series) : search_record(warm, rate_hz, options, nullptr);
  out.events_taken = take_events(out.search);
  const EventSearch* events = out.events_taken ? &out.search : nullptr;
  if (temperature != nullptr && events != nullptr) {
    TemperatureEffect again =
        find_temperature_effect(less(record, rate_hz, events, std::nullopt), rate_hz, *temperature);
    if (again.order > 0) out.temperature = std::move(again);
  }
  if (events != nullptr || moves(out.temperature)) out.samples = less(record, rate_hz, events, out.temperature);
  if (!moves(out.temperature)) return out;
  FitOptions without = options;
  without.second_opinion = false;
  without.slow_cycles = false;  // the temperature's own are to be seen in the walk
  const NoiseFit left_in = fit_record(record, rate_hz, nullptr, without);
  out.temperature->without = left_in.term;
  for (const Event& event : left_in.events)
    if (event.kind != EventKind::step && event.score * event.score > out.temperature->gain - kToldApart)
      out.temperature->like_drift = true;
  return out;
}

RecordMeans means_in(const EventSeries& series, const FitOptions& options) {
  RecordMeans out;
  out.search = search_events(options, [&]() -> const EventSeries& { return series; });
  out.events_taken = take_events(out.search);
  return out;
}

std::vector<double> spent_on(const RecordMeans& means) {
  std::vector<double> spent;
  const auto add = [&](const std::vector<double>& leverage) {
    if (spent.size() < leverage.size()) spent.resize(leverage.size());
    for (std::size_t k = 0; k < leverage.size(); ++k) spent[k] += leverage[k];
  };
  if (means.temperature) add(means.temperature->leverage);
  if (means.events_taken) add(means.search.leverage);
  return spent;
}

void count_spent(std::span<const double> leverage, double duration_s, std::vector<PowerBin>& bins) {
  std::vector<double> sum(leverage.size() + 1, 0.0);
  for (std::size_t k = 0; k < leverage.size(); ++k) sum[k + 1] = sum[k] + leverage[k];
  // Coefficient k = 1.. stands for frequencies from k - 1/2 to k + 1/2 over twice the duration.
  const auto below = [&](double frequency_hz) {
    const double at = std::clamp(2 * duration_s * frequency_hz - 0.5, 0.0, static_cast<double>(leverage.size()));
    const auto i = static_cast<std::size_t>(at);
    return sum[i] + (i + 1 < sum.size() ? (at - std::floor(at)) * (sum[i + 1] - sum[i]) : 0);
  };
  for (PowerBin& bin : bins) {
    const double left = std::max(kLeastDof, bin.dof - (below(bin.high_hz) - below(bin.low_hz)));
    bin.energy *= bin.dof / left;
    bin.dof = left;
  }
}

void report_means(const RecordMeans& means, const FitOptions& options, NoiseFit& fit) {
  if (means.temperature) report_temperature(*means.temperature, options, fit);
  report_events(means, fit);
}

}  // namespace libchar
