#include "libchar/fit/signs/event.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "libchar/core/numeric/present.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/shown.hpp"
#include "libchar/core/units.hpp"

namespace libchar {

std::string_view event_name(EventKind kind) {
  static constexpr std::array<std::string_view, 4> kNames = {"step", "warm-up", "ramp", "cycle"};
  return kNames[static_cast<std::size_t>(kind)];
}

/// Mean over `count` samples from `first` on.
static double cycle_mean(const Event& event, double rate_hz, double first, double count) {
  const double middle_s = (first + 0.5 * count) / rate_hz - event.from_s;
  const double half = std::numbers::pi * count / (event.period_s * rate_hz);
  return event.size * std::sin(half) / half * std::cos(2 * std::numbers::pi * middle_s / event.period_s - event.phase);
}

void subtract_events(std::span<const Event> events, double rate_hz, std::span<double> record) {
  for (const Event& event : events) {
    const double first = std::round(event.at_s * rate_hz);
    for (std::size_t i = 0; i < record.size(); ++i) {
      const double t = static_cast<double>(i) / rate_hz;
      if (event.kind == EventKind::step) record[i] -= static_cast<double>(i) >= first ? event.size : 0;
      if (event.kind == EventKind::warm_up)
        record[i] -= event.size * std::exp(-std::max(0.0, t - event.from_s) / event.tau_s);
      if (event.kind == EventKind::ramp) record[i] -= event.slope * t;
      if (event.kind == EventKind::cycle) record[i] -= cycle_mean(event, rate_hz, static_cast<double>(i), 1);
    }
  }
}

double event_mean(std::span<const Event> events, double rate_hz, double first, double count) {
  double sum = 0;
  for (const Event& event : events) {
    const double at = std::round(event.at_s * rate_hz);
    if (event.kind == EventKind::step) sum += event.size * std::clamp((first + count - at) / count, 0.0, 1.0);
    if (event.kind == EventKind::cycle) sum += cycle_mean(event, rate_hz, first, count);
    if (event.kind == EventKind::ramp) sum += event.slope / rate_hz * (first + 0.5 * (count - 1));
    if (event.kind == EventKind::warm_up) {
      // of the decay e^(-t/tau): q^k for k = 0 … count - 1, q = e^(-1/tau)
      const double tau = event.tau_s * rate_hz;
      const double since = std::max(0.0, first - event.from_s * rate_hz);
      sum += event.size * std::exp(-since / tau) * std::expm1(-count / tau) / (count * std::expm1(-1 / tau));
    }
  }
  return sum;
}

std::string detail::place_and_interval(double at_s, const Interval& ci95) {
  const std::string low = place_text(ci95.low), high = place_text(ci95.high);
  return fmt::format("{} s{}", place_text(at_s), low == high ? "" : fmt::format(" (between {} and {} s)", low, high));
}

std::string event_sentence(const Event& event, std::string_view unit) {
  const double relative = event.sd / std::max(std::abs(event.size), 1e-300);
  const std::string size = fmt::format("{}{}{}", detail::plus_minus_text(event.size, kNormal95 * event.sd),
                                       unit.empty() ? "" : " ", detail::usual_unit(std::string(unit)));
  std::string text;
  if (event.kind == EventKind::step)
    text = event.in_gap
               ? fmt::format("A step of {} while nothing was recorded, between {} and {} s", size,
                             place_text(event.at_ci95.low), place_text(event.at_ci95.high))
               : fmt::format("A step of {} at {}", size, detail::place_and_interval(event.at_s, event.at_ci95));
  if (event.kind == EventKind::warm_up)
    text = event.tau_ci95.high > 0 || !(event.tau_ci95.low > 0)
               ? fmt::format("A warm-up of {} with a time constant of {}", size, duration_text(event.tau_s))
               : fmt::format("A warm-up that is not over, with a time constant of at least {} ({} at {})",
                             duration_text(event.tau_ci95.low), size, duration_text(event.tau_s));
  if (event.kind == EventKind::ramp)
    text = fmt::format("A straight drift of {} over the record ({}{}/s)", size,
                       number_text(event.slope, digits_for(relative)), unit.empty() ? "" : " " + std::string(unit));
  if (event.kind == EventKind::cycle)
    text = event.tau_ci95.low > 0
               ? fmt::format("A bend, like the part of a cycle of at least {}", duration_text(event.tau_ci95.low))
               : fmt::format("A cycle of {} (amplitude {})", duration_text(event.period_s), size);
  for (std::size_t i = 0; i < event.not_told_from.size(); ++i)
    text += fmt::format("{} a {}", i == 0 ? ", not distinguished from" : " or", event_name(event.not_told_from[i]));
  return text + ".";
}

// Means of m samples over what is present of them, from the first present sample to the last. A stretch without any is
// bridged by a straight line between the means of as many values before and after it (of fewer where another stretch is
// near): single values would put their own noise into the lowest frequencies. Bridged stretches are remembered: it is
// not known where in them something happened. The number of means has no prime factor above 7, for the transforms'
// sake: at most one per cent of the record's end is not looked at.

namespace {

constexpr std::size_t kFewest = 64;
constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

bool transforms_fast(std::uint64_t n) {
  for (const std::uint64_t prime : {2U, 3U, 5U, 7U})
    while (n % prime == 0) n /= prime;
  return n == 1;
}

/// Mean of at most `count` values that are present in turn, from `begin` on in steps of `step`.
double mean_beside(const std::vector<double>& value, std::size_t begin, int step, std::size_t count) {
  double sum = 0;
  std::size_t used = 0;
  const auto n = static_cast<std::ptrdiff_t>(value.size());
  for (auto t = static_cast<std::ptrdiff_t>(begin); t >= 0 && t < n && used < count; t += step) {
    const double x = value[static_cast<std::size_t>(t)];
    if (std::isnan(x)) break;
    sum += x - value[begin];
    ++used;
  }
  return value[begin] + sum / static_cast<double>(used);
}

/// The first and the last value are present.
void bridge(std::vector<double>& value, double start_s, double step_s, std::vector<Interval>& unseen) {
  std::vector<double> bridged = value;
  for (std::size_t t = 1; t < value.size(); ++t) {
    if (!std::isnan(value[t])) continue;
    std::size_t end = t;
    while (std::isnan(value[end])) ++end;
    const double before = mean_beside(value, t - 1, -1, end - t);
    const double after = mean_beside(value, end, 1, end - t);
    for (std::size_t i = t; i < end; ++i)
      bridged[i] = before + (after - before) * static_cast<double>(i - t + 1) / static_cast<double>(end - t + 1);
    unseen.push_back({start_s + static_cast<double>(t) * step_s, start_s + static_cast<double>(end) * step_s});
    t = end;
  }
  value = std::move(bridged);
}

std::span<const double> from_first_to_last(std::span<const double> record, double& start) {
  const auto is_present = [](double x) { return std::isfinite(x); };
  const auto first = std::find_if(record.begin(), record.end(), is_present);
  const auto last = std::find_if(record.rbegin(), record.rend(), is_present);
  start = static_cast<double>(first - record.begin());
  return first == record.end() ? std::span<const double>() : std::span<const double>(first, last.base());
}

}  // namespace

EventSeries event_series(std::span<const double> whole, double rate_hz, std::size_t points) {
  EventSeries series;
  double start = 0;
  const std::span<const double> record = from_first_to_last(whole, start);
  const std::size_t most = std::max(points, kFewest);
  series.per_point = std::max<std::size_t>(1, (record.size() + most - 1) / most);
  series.step_s = static_cast<double>(series.per_point) / rate_hz;
  series.start_s = start / rate_hz;
  std::size_t n = record.size() / series.per_point;
  while (n > kFewest && !transforms_fast(n)) --n;
  for (std::size_t i = 0; i < n; ++i)
    series.value.push_back(mean_present(record.subspan(i * series.per_point, series.per_point)));
  while (!series.value.empty() && std::isnan(series.value.back())) series.value.pop_back();
  if (series.value.size() < kFewest)
    throw numeric_error("E0401")
        .says("too few samples to look for steps and drifts")
        .got(std::to_string(record.size()) + " samples")
        .hint("use a record of at least 64 samples");
  bridge(series.value, series.start_s, series.step_s, series.unseen_s);
  return series;
}

EventSeries detail::means_of(const EventSeries& series, std::size_t each) {
  EventSeries out;
  out.start_s = series.start_s;
  out.step_s = series.step_s * static_cast<double>(each);
  out.per_point = series.per_point * each;
  for (std::size_t i = 0; i < series.value.size() / each; ++i) {
    double sum = 0;
    for (std::size_t t = i * each; t < (i + 1) * each; ++t) sum += series.value[t];
    out.value.push_back(sum / static_cast<double>(each));
  }
  return out;
}

std::vector<detail::Pause> detail::leave_out_pauses(EventSeries& series) {
  constexpr double kShare = 0.1;  // of the recorded values; shorter ones are bridged
  constexpr double kShortest = 16;
  const auto point = [&](double at_s) { return std::round((at_s - series.start_s) / series.step_s); };
  double present = static_cast<double>(series.value.size());
  for (const Interval& gap : series.unseen_s) present -= point(gap.high) - point(gap.low);
  std::vector<Pause> pauses;
  EventSeries joined = series;
  joined.value.clear();
  joined.unseen_s.clear();
  double begin = 0, left_out = 0;
  const auto session_until = [&](double end) {
    joined.value.insert(joined.value.end(), series.value.begin() + static_cast<std::ptrdiff_t>(begin),
                        series.value.begin() + static_cast<std::ptrdiff_t>(end));
  };
  for (const Interval& gap : series.unseen_s) {
    const double low = point(gap.low), high = point(gap.high);
    if (high - low < std::max(kShortest, kShare * present)) {
      joined.unseen_s.push_back({gap.low - left_out, gap.high - left_out});
      continue;
    }
    session_until(low);
    pauses.push_back({gap.low - left_out, gap.high - gap.low});
    left_out += gap.high - gap.low;
    begin = high;
  }
  if (pauses.empty()) return pauses;
  session_until(static_cast<double>(series.value.size()));
  std::size_t n = joined.value.size();
  if (n < kFewest) return {};
  while (n > kFewest && !transforms_fast(n)) --n;
  joined.value.resize(n);
  series = std::move(joined);
  return pauses;
}

double detail::with_pauses(std::span<const Pause> pauses, double at_s) {
  double out = at_s;
  for (const Pause& pause : pauses)
    if (pause.at_s <= at_s) out += pause.length_s;
  return out;
}

}  // namespace libchar
