// A sensor that moves measures its motion above its own noise. Of motion that is the same throughout, the spectrum
// S(f) without flicker and walk tells:
//   own noise   the level that the two highest parts of the spectrum share: [.5, .7] and [.7, 1] of half the rate
//   signal      whatever is above it by a factor of kDoubtful (a low-pass and noise behind it are seldom so far apart)
//               or of kMoves (never)
// or a peak at the frequencies of bodies that is above both of its sides, within a factor of 20 in frequency, by a
// factor of kMoves: a filter of one pole falls by 400 there;
// or white noise beyond that of any sensor of its kind: 0.5 deg/s/√Hz one-sided (ADXRS649: 0.25), and
// 20 mg/√Hz (H3LIS331DL, ±400 g: 15); or slow noise whose Allan deviation at 10 s is larger than that of such white
// noise at 1 s, where a sensor's is a hundred times smaller.
// What turns moves the accelerometers beside it, whatever their own spectra look like: gravity turns with it. The
// opposite does not hold, since vibration and tables move without turning.
#include "libchar/characterize/detail/rest_doubt.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "libchar/allan/noise_curves.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/core/units.hpp"
#include "libchar/log/between_channels.hpp"

namespace libchar::detail {
namespace {

constexpr double kDoubtful = 50, kMoves = 1000;  ///< of densities

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
  constexpr double kFewestDof = 8;
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

/// Allan deviation of flicker and walk at 10 s, of what is detected: by the least of the interval.
double slow_deviation(const NoiseFit& fit) {
  double variance = 0;
  for (const Term term : {Term::flicker, Term::walk})
    if (const Coefficient& one = fit[term]; one.status == Status::detected && one.value)
      variance += one.ci95.low * one.ci95.low * allan_asymptote(term, 10);
  return std::sqrt(variance);
}

std::string density_text(double n, std::string_view unit) {
  return brief_text(n) + " " + shown_term_unit("white_noise", unit);
}

/// The highest part of the spectrum, where it is a peak of motion.
const FitResidual* peak_of_motion(const NoiseFit& fit) {
  constexpr double kFewestDof = 8, kSlowest = 0.03, kFastest = 10, kNear = 3, kFar = 20;  // Hz; in frequency
  const FitResidual* peak = nullptr;
  for (const FitResidual& one : fit.residuals)
    if (one.dof >= kFewestDof && (peak == nullptr || one.measured > peak->measured)) peak = &one;
  if (peak == nullptr || peak->frequency_hz < kSlowest || peak->frequency_hz > kFastest) return nullptr;
  double below = peak->measured, above = peak->measured;
  for (const FitResidual& one : fit.residuals) {
    const double times = one.frequency_hz / peak->frequency_hz;
    if (one.dof < kFewestDof || std::max(times, 1 / times) < kNear || std::max(times, 1 / times) > kFar) continue;
    double& side = times < 1 ? below : above;
    side = std::min(side, one.measured);
  }
  return peak->measured > kMoves * std::max(below, above) ? peak : nullptr;
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

std::optional<Finding> doubt_rest(const NoiseFit& fit, std::string_view unit, double rounding) {
  const auto known = find_unit(unit);
  const bool rate = known && known->quantity == Quantity::angular_rate;
  if (!rate && !(known && known->quantity == Quantity::acceleration)) return std::nullopt;
  const bool shaped = !fit.band.whole || fit.shape.kind != NoiseShape::Kind::none;
  const double own = shaped ? own_noise(fit, rounding) : 0, signal = own > 0 ? signal_density(fit) : 0;
  if (own > 0 && signal > kDoubtful * own) return signal_above(own, signal, unit);
  if (const FitResidual* peak = shaped ? peak_of_motion(fit) : nullptr; peak != nullptr)
    return finding("moves_throughout",
                   fmt::format("The spectrum has a peak at about {} Hz, far above both of its sides: a body that rocks "
                               "or swings.",
                               brief_text(peak->frequency_hz, 2)),
                   "it rocks or swings throughout");
  const char* const sensor = rate ? "gyroscope" : "accelerometer";
  const double most = (rate ? 0.5 * std::numbers::pi / 180 : 0.02 * 9.80665) / std::numbers::sqrt2 / known->to_si;
  const Coefficient& white = fit[Term::white];
  if (white.value && *white.value > most)
    return finding("moves_throughout",
                   fmt::format("N is {}, and no {} at rest has more than {}: it moves, or the unit is another.",
                               density_text(*white.value, unit), sensor, density_text(most, unit)),
                   "more noise than a sensor at rest has");
  if (!(slow_deviation(fit) > most)) return std::nullopt;
  return finding(
      "moves_throughout",
      fmt::format("Means of 10 s differ by {} {}, and no {} at rest wanders by more than {}: it moves, or the "
                  "unit is another.",
                  brief_text(slow_deviation(fit)), unit, sensor, brief_text(most)),
      "it wanders more than a sensor at rest does");
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
