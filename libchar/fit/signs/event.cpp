#include "libchar/fit/signs/event.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "libchar/core/text/readable.hpp"

namespace libchar {

std::string_view event_name(EventKind kind) {
  static constexpr std::array<std::string_view, 3> kNames = {"step", "warm-up", "ramp"};
  return kNames[static_cast<std::size_t>(kind)];
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
    }
  }
}

double event_mean(std::span<const Event> events, double rate_hz, double first, double count) {
  double sum = 0;
  for (const Event& event : events) {
    const double at = std::round(event.at_s * rate_hz);
    if (event.kind == EventKind::step) sum += event.size * std::clamp((first + count - at) / count, 0.0, 1.0);
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

std::string event_sentence(const Event& event, std::string_view unit) {
  const double relative = event.sd / std::max(std::abs(event.size), 1e-300);
  const std::string size = fmt::format("{} ± {}{}{}", number_text(event.size, digits_for(relative)),
                                       number_text(kNormal95 * event.sd, 2), unit.empty() ? "" : " ", unit);
  std::string text;
  if (event.kind == EventKind::step)
    text = event.in_gap ? fmt::format("A step of {} while nothing was recorded, between {} and {} s", size,
                                      place_text(event.at_ci95.low), place_text(event.at_ci95.high))
                        : fmt::format("A step of {} at {} s (between {} and {} s)", size, place_text(event.at_s),
                                      place_text(event.at_ci95.low), place_text(event.at_ci95.high));
  if (event.kind == EventKind::warm_up)
    text = event.tau_ci95.high > 0 || !(event.tau_ci95.low > 0)
               ? fmt::format("A warm-up of {} with a time constant of {}", size, duration_text(event.tau_s))
               : fmt::format("A warm-up that is not over, with a time constant of at least {} ({} at {})",
                             duration_text(event.tau_ci95.low), size, duration_text(event.tau_s));
  if (event.kind == EventKind::ramp)
    text = fmt::format("A straight drift of {} over the record ({}{} /s)", size,
                       number_text(event.slope, digits_for(relative)), unit.empty() ? "" : " " + std::string(unit));
  for (std::size_t i = 0; i < event.not_told_from.size(); ++i)
    text += fmt::format("{} a {}", i == 0 ? ", not told from" : " or", event_name(event.not_told_from[i]));
  return text + ".";
}

}  // namespace libchar
