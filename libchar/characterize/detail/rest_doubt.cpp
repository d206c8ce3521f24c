// A sensor that moves measures its motion above its own noise. Of motion that is the same throughout, the spectrum
// S(f) without flicker and walk tells:
//   own noise   the level that the two highest parts of the spectrum share: [.5, .7] and [.7, 1] of half the rate
//   signal      whatever is above it by a factor of kDoubtful (a low-pass and noise behind it are seldom so far apart)
//               or of kMoves (never)
// or a density above that of any sensor of its kind, at any frequency from kSlowest on (flicker and walk are far below
// it there): 0.5 deg/s/√Hz one-sided (ADXRS649: 0.25), and 20 mg/√Hz (H3LIS331DL, ±400 g: 15).
// What turns moves the accelerometers beside it, whatever their own spectra look like: gravity turns with it. The
// opposite does not hold, since vibration and tables move without turning.
#include "libchar/characterize/detail/rest_doubt.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "libchar/core/numeric/distributions.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/shown.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/core/units.hpp"
#include "libchar/log/between_channels.hpp"

namespace libchar::detail {
namespace {

constexpr double kDoubtful = 50, kMoves = 1000;  ///< of densities
constexpr double kSlowest = 0.05;                ///< Hz
constexpr double kFewestDof = 8;                 ///< of a density, beside flicker and walk

struct Level {
  double density = 0, dof = 0;
};

/// Between two shares of half the rate.
Level level_between(const NoiseFit& fit, double from, double to) {
  Level out;
  for (const FitResidual& one : fit.residuals) {
    const double share = 2 * one.frequency_hz / fit.rate_hz;
    if (share < from || share > to) continue;
    out.density += one.dof * one.measured;
    out.dof += one.dof;
  }
  if (out.dof > 0) out.density /= out.dof;
  return out;
}

double square_of(const Coefficient& term) { return term.value ? *term.value * *term.value : 0; }

/// The level that the top of the spectrum keeps; 0: it falls or rises to its end, or is the converter's.
double own_noise(const NoiseFit& fit, double rounding) {
  constexpr double kAlike = 0.1, kChance = 4, kAboveRounding = 4;
  const Level below = level_between(fit, 0.5, 0.7), top = level_between(fit, 0.7, 1);
  if (!(below.dof > 0 && top.dof > 0)) return 0;
  const double by_chance = std::sqrt(2 / below.dof + 2 / top.dof);
  if (std::abs(top.density / below.density - 1) > std::max(kAlike, kChance * by_chance)) return 0;
  return top.density > kAboveRounding * rounding ? top.density : 0;
}

/// The highest density beside that of flicker and walk.
double signal_density(const NoiseFit& fit) {
  const double flicker = square_of(fit[Term::flicker]), walk = square_of(fit[Term::walk]);
  double highest = square_of(fit[Term::white]);
  for (const FitResidual& one : fit.residuals) {
    const double w = 2 * std::numbers::pi * one.frequency_hz;
    if (one.dof >= kFewestDof) highest = std::max(highest, one.measured - flicker / w - walk / (w * w));
  }
  return highest;
}

bool is_of(std::string_view unit, Quantity quantity) {
  const auto known = find_unit(unit);
  return known && known->quantity == quantity;
}

bool moves(const ChannelResult& channel) {
  return channel.motion.whole || std::any_of(channel.findings.begin(), channel.findings.end(), [](const Finding& one) {
           return one.code == "moves_throughout" && one.severity == Severity::bad;
         });
}

std::string density_text(double n, std::string_view unit) {
  return brief_text(n) + " " + shown_term_unit("white_noise", unit);
}

Finding signal_above(double own, double signal, std::string_view unit) {
  const double ratio = std::sqrt(signal / own);
  Finding found = finding(
      "moves_throughout",
      fmt::format("The spectrum rises to {} times the level that its fast end keeps, {}: the noise of the sensor is "
                  "that level, and above it is a signal (motion, vibration){}.",
                  brief_text(ratio, 2), density_text(std::sqrt(own), unit),
                  signal > kMoves * own ? "" : ", or a low-pass with other noise behind it"),
      "a signal throughout is above the noise of the sensor");
  if (!(signal > kMoves * own)) found.severity = Severity::caution;
  found.effects = {{Affected::noise, Direction::too_large, ratio}};
  return found;
}

}  // namespace

std::optional<AtRest> limit_at_rest(std::string_view unit) {
  const auto known = find_unit(unit);
  const bool rate = known && known->quantity == Quantity::angular_rate;
  if (!rate && !(known && known->quantity == Quantity::acceleration)) return std::nullopt;
  const double root = (rate ? 0.5 * std::numbers::pi / 180 : 0.02 * 9.80665) / std::numbers::sqrt2 / known->to_si;
  return AtRest{root * root, kSlowest};
}

std::optional<Finding> doubt_rest(const NoiseFit& fit, std::string_view unit, double rounding) {
  const auto limit = limit_at_rest(unit);
  if (!limit) return std::nullopt;
  const bool shaped = !fit.band.whole || fit.shape.kind != NoiseShape::Kind::none;
  const double own = shaped ? own_noise(fit, rounding) : 0, signal = own > 0 ? signal_density(fit) : 0;
  if (own > 0 && signal > kDoubtful * own) return signal_above(own, signal, unit);
  const FitResidual* highest = nullptr;
  double most = 1;
  for (const FitResidual& one : fit.residuals) {
    const double excess = limit->excess(one.frequency_hz, one.measured, one.dof);
    if (!(excess > most)) continue;
    most = excess;
    highest = &one;
  }
  if (highest == nullptr) return std::nullopt;
  const char* const sensor = is_of(unit, Quantity::angular_rate) ? "gyroscope" : "accelerometer";
  return finding("moves_throughout",
                 fmt::format("The density is {} at {}, and no {} at rest has more than {}: it moves, or the unit is "
                             "another.",
                             density_text(std::sqrt(highest->measured), unit), frequency_text(highest->frequency_hz),
                             sensor, density_text(std::sqrt(limit->most_density), unit)),
                 "more noise than a sensor at rest has");
}

void doubt_together(std::span<ChannelResult> channels) {
  std::vector<Channel> names;
  for (const ChannelResult& one : channels) names.push_back(one.channel);
  judge_together(names, [&](std::size_t c) -> ChannelQuality& { return channels[c].quality; });
  std::size_t rates = 0;
  std::vector<std::string> turning;
  for (const ChannelResult& one : channels) {
    if (!is_of(one.channel.unit, Quantity::angular_rate)) continue;
    ++rates;
    if (moves(one)) turning.push_back(one.channel.name);
  }
  if (turning.empty() || 2 * turning.size() < rates) return;
  const std::string which =
      turning.size() == 1 ? turning[0] + " turns"
                          : fmt::format("{} and {} turn", turning[0], plural(turning.size() - 1, "other gyroscope"));
  for (ChannelResult& one : channels) {
    const bool inertial =
        is_of(one.channel.unit, Quantity::angular_rate) || is_of(one.channel.unit, Quantity::acceleration);
    if (!inertial || moves(one)) continue;
    one.findings.push_back(
        finding("moves_with_others",
                which + " throughout, or the unit is another: whatever is fixed to the same body moves too, and its "
                        "noise at rest cannot be measured from this recording.",
                "gyroscopes of the recording turn throughout"));
    // Said, not offered as the next command: of one body it would only hide the motion.
    one.findings.back().help.push_back({fmt::format("Where it is fixed to another body, `channels` {} takes it alone.",
                                                    shell_word(one.channel.name))});
  }
}

}  // namespace libchar::detail
