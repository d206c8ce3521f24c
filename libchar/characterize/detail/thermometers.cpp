// The search of `temperature` (fit/signs/temperature.cpp) by a few means of each channel, only where the fit shows
// something slow that noise may not be: nothing is taken out of the record, which is done where somebody asks for it.
#include "libchar/characterize/detail/thermometers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

#include "libchar/core/error.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/units.hpp"

namespace libchar {
namespace {

constexpr std::size_t kFewestMeans = 64;

bool in_degrees(const Channel& channel) {
  const auto unit = find_unit(channel.unit);
  return unit && unit->quantity == Quantity::temperature;
}

bool is_thermometer(const ChannelResult& channel) {
  return in_degrees(channel.channel) && channel.means.value.size() >= kFewestMeans;
}

bool has_slow_part(const NoiseFit& fit) {
  static constexpr std::array<std::string_view, 11> kSlow = {
      "cycle",           "hump",        "event",     "events_left_in", "drift",         "drift_or_walk",
      "lowest_left_out", "high_passed", "power_law", "misfit",         "not_stationary"};
  const Status walk = fit[Term::walk].status;
  if (walk == Status::detected || walk == Status::undetermined || walk == Status::misfit) return true;
  if (fit.bandwidth_hz || (fit.gauss_markov && fit.gauss_markov->in_model)) return true;
  return std::any_of(kSlow.begin(), kSlow.end(), [&](std::string_view code) { return has(fit.findings, code); });
}

/// What each channel owes to one thermometer.
struct Answer {
  std::vector<std::optional<TemperatureEffect>> effect;
  double gain = 0;
};

Answer answer_of(const ChannelResult& thermometer, const std::vector<ChannelResult>& channels) {
  Answer out;
  out.effect.resize(channels.size());
  for (std::size_t c = 0; c < channels.size(); ++c) {
    const ChannelResult& channel = channels[c];
    if (!channel.fit || is_thermometer(channel) || channel.means.value.size() != thermometer.means.value.size() ||
        channel.means.value.size() < kFewestMeans || !has_slow_part(*channel.fit))
      continue;
    try {
      TemperatureEffect effect = detail::temperature_effect_of_means(
          channel.means, thermometer.means, thermometer.channel.name, thermometer.channel.unit);
      if (effect.order == 0) continue;
      out.gain += effect.gain;
      out.effect[c] = std::move(effect);
    } catch (const Error& error) {
      if (error.problem().kind != ErrorKind::numeric) throw;
    }
  }
  return out;
}

void say(const TemperatureEffect& effect, ChannelResult& channel) {
  const std::string& unit = channel.channel.unit;
  Finding found = finding("temperature_left_in",
                          fmt::format("It moves with the temperature {} of the same log, by {} {}/{} (2 ln L {}): "
                                      "statements about its slow noise describe that.",
                                      effect.channel, number_text(effect.coefficient[0], 2), unit.empty() ? "U" : unit,
                                      effect.unit, brief_text(effect.gain, 2)),
                          "it moves with the temperature " + effect.channel);
  found.help.push_back({"Take out what temperature does.", {{"temperature", effect.channel}}});
  channel.findings.push_back(std::move(found));
  Coefficient& walk = channel.fit->term[static_cast<std::size_t>(Term::walk)];
  if (walk.status == Status::detected) walk.status = Status::undetermined;
}

}  // namespace

bool detail::has_thermometer(const LogInfo& log) {
  return std::any_of(log.channels.begin(), log.channels.end(), in_degrees);
}

void detail::ask_thermometers(std::vector<ChannelResult>& channels) {
  Answer best;
  for (const ChannelResult& channel : channels)
    if (is_thermometer(channel))
      if (Answer answer = answer_of(channel, channels); answer.gain > best.gain) best = std::move(answer);
  for (std::size_t c = 0; c < best.effect.size(); ++c)
    if (best.effect[c]) say(*best.effect[c], channels[c]);
}

}  // namespace libchar
