// Rails: a tail falls outwards, so that fewer samples stand at the last value than just inside it. A rail has eight
// samples and twice as many as the neighbourhood (a thousandth of the range, or one and a half times the distance to
// the next value). Staircase: with s = sqrt(2) sigma / step, neighbours are equal with probability
//   P0 = 2 Phi(1/s) - 1 - s sqrt(2/pi) (1 - exp(-1/(2 s^2))),   .27 at sigma = step,
// averaged over where between two steps the value stands, which holds while the noise moves it there (sigma > .3 step).
// Rounding to steps q of noise of that size adds white noise (B. Widrow and I. Kollar, "Quantization Noise", 2008,
// ch. 5): of the variance
//   q^2/12 + q^2 exp(-2 pi^2 sigma^2/q^2) (4 sigma^2/q^2 + 1/pi^2) cos(2 pi mean/q) + ...,
// and errors of neighbours share (6/pi^2) exp(-4 pi^2 sigma^2/q^2) of it, .017 at sigma = .3 step. A value that stands
// between two steps flips between them with half of that noise: what looks like less than half a step may be .25.
// Truncation towards zero (a conversion to an integer) has a step of twice the width there: of Gaussian noise n_k at k
// steps, ln n_0 = (4 ln n_1 - ln n_2) / 3, n_k the mean of both sides; twice as many are a dead band of two steps.
// Counts lie on a grid without being rounded, and are skewed as a rounded Gaussian is not: the mean cube of second
// differences over sd^3 has the variance 15 / n at most, a sixth of it for white Gaussian noise. Of white noise of the
// skewness g it is g / sqrt(6), and the sd sqrt(6) times as large: g > a q / sd is cube / sd^3 > a q / sd of both.
#include "libchar/fit/signs/digital.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libchar/core/numeric/present.hpp"
#include "libchar/core/text/readable.hpp"

namespace libchar {
namespace {

constexpr std::uint64_t kFewestAtRail = 8, kFewestRepeats = 64;
constexpr double kSame = 1e-6;       ///< of a step
constexpr double kSheppard = 0.5;    ///< steps: down to there rounding is white noise of a twelfth of its square
constexpr double kMostAtRail = 0.5;  ///< share: beyond it the rail is the signal, and the rest are spikes

DigitalSums::AtRail rail_of(std::span<const double> record, const ValueCensus& census, bool high, double present) {
  const double at = high ? census.high : census.low, range = census.high - census.low;
  const auto count = static_cast<double>(high ? census.at_high : census.at_low);
  if (count < static_cast<double>(kFewestAtRail) || count > kMostAtRail * present) return {at, 0};
  const auto inwards = [&](double x) { return high ? at - x : x - at; };
  double next = range;
  for (const double x : record)
    if (inwards(x) > 0 && inwards(x) < next) next = inwards(x);
  const double inside = std::max(1.5 * next, range / 1000);
  double near = 0;
  for (const double x : record) near += inwards(x) > 0 && inwards(x) <= inside ? 1 : 0;
  return {at, count <= 2 * near + static_cast<double>(kFewestAtRail) ? 0 : count};
}

DigitalSums::AtZero zero_of(std::span<const double> record, const ValueCensus& census) {
  DigitalSums::AtZero out;
  if (!(census.low < 0) || !(census.high > 0) || census.repeats == 0) return out;
  double least = std::max(-census.low, census.high);
  for (const double x : record) {
    const double size = std::abs(x);
    least = size > 0 && size < least ? size : least;
  }
  const auto at = [&](double size, int steps) { return std::abs(size - steps * least) < kSame * least ? 1.0 : 0.0; };
  for (const double x : record) {
    const double size = std::abs(x);
    out.zeros += size == 0 ? 1 : 0;
    out.nearest += at(size, 1);
    out.next += at(size, 2);
  }
  out.step = least;
  return out;
}

DigitalSums::Skew skew_of(std::span<const double> record, const ValueCensus& census) {
  constexpr double kCoarse = 0.01;  ///< share of repeats, as with a step of .035 standard deviations
  DigitalSums::Skew out;
  if (static_cast<double>(census.repeats) < kCoarse * static_cast<double>(record.size())) return out;
  for (std::size_t i = 2; i < record.size(); ++i) {
    const double d = (record[i] - record[i - 1]) - (record[i - 1] - record[i - 2]);
    if (!std::isfinite(d)) continue;
    out.count += 1;
    out.squares += d * d;
    out.cubes += d * d * d;
  }
  return out;
}

/// As counts of one step each are, whose skewness is the step over the standard deviation, or half as much.
bool is_skewed(const DigitalSums::Skew& skew, double step) {
  constexpr double kClear = 5, kVariance = 15, kLeast = 0.5;  ///< standard deviations; of a cube; of that of counts
  if (!(skew.squares > 0)) return false;
  const double sd = std::sqrt(skew.squares / skew.count), cube = std::abs(skew.cubes) / (sd * sd * sd);
  return cube > kClear * std::sqrt(kVariance * skew.count) && cube > kLeast * step / sd * skew.count;
}

/// zeros over what the steps next to them lead to expect, where that is the doubled one of truncation.
std::optional<double> truncated(const DigitalSums::AtZero& zero, std::optional<double> step) {
  constexpr double kFewest = 400, kLeast = 1.6, kMost = 2.5, kFlat = 0.48;
  if (!step || !(std::abs(zero.step - *step) < kSame * *step) || zero.next < kFewest) return std::nullopt;
  // A narrower peak, of 1.6 steps of a Gaussian, may be another distribution's.
  if (zero.next < kFlat * zero.nearest) return std::nullopt;
  const double expected = std::exp((4 * std::log(zero.nearest / 2) - std::log(zero.next / 2)) / 3);
  const double times = zero.zeros / expected;
  return times > kLeast && times < kMost ? std::optional(times) : std::nullopt;
}

double chance_of_repeat(double noise_over_step) {
  const double s = std::numbers::sqrt2 * noise_over_step;
  return std::erf(1 / (s * std::numbers::sqrt2)) - s * std::sqrt(2 / std::numbers::pi) * -std::expm1(-1 / (2 * s * s));
}

std::optional<Staircase> staircase(double repeats, double step) {
  if (!(repeats > chance_of_repeat(1))) return std::nullopt;
  double low = 0.3, high = 1;
  if (repeats >= chance_of_repeat(low)) return Staircase{step, low * step, true};
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    (chance_of_repeat(middle) > repeats ? low : high) = middle;
  }
  return Staircase{step, low * step, false};
}

/// None where the samples change by so little that the rounding of one is that of the next.
std::optional<DigitalFaults::Rounding> rounding_noise(const ValueCensus& census, double present,
                                                      const std::optional<Staircase>& staircase, double step) {
  if (staircase ? staircase->bounded : static_cast<double>(census.repeats) > chance_of_repeat(1) * present)
    return std::nullopt;
  constexpr double kLeast = 0.25;
  const double noise = !staircase ? 1 : staircase->noise < kSheppard * step ? kLeast : staircase->noise / step;
  const double pi = std::numbers::pi;
  const double ripple = std::exp(-2 * pi * pi * noise * noise) * (4 * noise * noise + 1 / (pi * pi));
  return DigitalFaults::Rounding{step, step * step / 12, step * step * ripple / std::numbers::sqrt2, false};
}

std::string with_unit(double value, std::string_view unit) {
  return number_text(value, 3) + (unit.empty() ? "" : " ") + std::string(unit);
}

Finding truncation_finding(double times, const DigitalSums::AtZero& zero, std::string_view unit) {
  Finding found = finding(
      "dead_band",
      fmt::format(
          "0 occurs {:.1f} times as often as the values next to it lead to expect: values were truncated towards "
          "zero, a dead band of two steps of {}, and the noise comes out too small. Round to the nearest value.",
          times, with_unit(zero.step, unit)),
      "values were truncated towards zero");
  found.severity = Severity::caution;
  return found;
}

void describe_faults(DigitalFaults& faults, std::string_view unit) {
  for (const Rail& rail : faults.rails)
    faults.findings.push_back(finding(
        "rail",
        fmt::format("{} of the samples are at the {} value, {}: clipped, and the noise comes out too small.",
                    percent_text(rail.share), rail.high ? "largest" : "smallest", with_unit(rail.value, unit))));
  if (!faults.staircase) return;
  const Staircase& stairs = *faults.staircase;
  faults.findings.push_back(finding(
      "staircase",
      fmt::format("The noise between samples, {}{}, is below the converter's step of {}: {}",
                  stairs.bounded ? "at most " : "", with_unit(stairs.noise, unit), with_unit(stairs.step, unit),
                  stairs.bounded ? "what is measured is the rounding." : "the rounding is part of what is measured.")));
  // N is without its rounding (rounding_noise).
  if (stairs.noise >= kSheppard * stairs.step) faults.findings.back().severity = Severity::note;
}

}  // namespace

std::optional<Finding> detail::find_coarse_counter(const ValueCensus& census, std::uint64_t samples,
                                                   std::optional<double> resolution, std::string_view unit) {
  constexpr double kRepeats = 0.3;
  const double share = static_cast<double>(census.repeats) / static_cast<double>(samples);
  if (!resolution || !(share > kRepeats)) return std::nullopt;
  return finding("staircase",
                 fmt::format("{} of the readings repeat the one before: the counter's step of {} hides what the clock "
                             "does between samples, and short averaging times show its rounding.",
                             percent_text(share), with_unit(*resolution, unit)),
                 "the counter's step hides the noise");
}

DigitalSums digital_sums(std::span<const double> samples, const ValueCensus& census, std::uint64_t missing) {
  DigitalSums sums;
  sums.present = static_cast<double>(samples.size() - missing);
  if (!(census.low < census.high)) return sums;
  sums.low = rail_of(samples, census, false, sums.present);
  sums.high = rail_of(samples, census, true, sums.present);
  sums.zero = zero_of(samples, census);
  sums.skew = skew_of(samples, census);
  return sums;
}

void join(DigitalSums& sums, const DigitalSums& later) {
  const auto add_rail = [](DigitalSums::AtRail& rail, const DigitalSums::AtRail& other, bool high) {
    if (other.count == 0) return;
    const bool beyond = high ? other.value > rail.value : other.value < rail.value;
    if (rail.count == 0 || beyond) rail = {other.value, 0};
    if (rail.value == other.value) rail.count += other.count;
  };
  add_rail(sums.low, later.low, false);
  add_rail(sums.high, later.high, true);
  // A leaf that does not come near zero has another least distance from it.
  DigitalSums::AtZero& zero = sums.zero;
  const DigitalSums::AtZero& other = later.zero;
  if (other.step > 0 && (zero.step == 0 || other.step < zero.step)) {
    zero = other;
  } else if (other.step > 0 && other.step == zero.step) {
    zero.zeros += other.zeros;
    zero.nearest += other.nearest;
    zero.next += other.next;
  }
  sums.skew.count += later.skew.count;
  sums.skew.squares += later.skew.squares;
  sums.skew.cubes += later.skew.cubes;
  sums.present += later.present;
}

template <class Archive, class Sums>
static void digital_layout(Archive& at, Sums& sums) {
  at.group("the digital faults of a channel", sums.present, sums.low.value, sums.low.count, sums.high.value,
           sums.high.count, sums.zero.step, sums.zero.zeros, sums.zero.nearest, sums.zero.next, sums.skew.count,
           sums.skew.squares, sums.skew.cubes);
}

void write_state(const DigitalSums& sums, StateWriter& to) { digital_layout(to, sums); }

DigitalSums read_digital_sums(StateReader& from) {
  DigitalSums sums;
  digital_layout(from, sums);
  return sums;
}

DigitalFaults find_digital_faults(const DigitalSums& sums, const ValueCensus& census, double rate_hz,
                                  std::optional<double> step, std::string_view unit) {
  DigitalFaults faults;
  if (!(census.low < census.high)) return faults;
  if (census.held_times > 1) faults.held = {census.held_times, rate_hz / census.held_times};
  if (step && !faults.held && census.repeats >= kFewestRepeats)
    faults.staircase = staircase(static_cast<double>(census.repeats) / sums.present, *step);
  if (step && !faults.held) faults.rounding = rounding_noise(census, sums.present, faults.staircase, *step);
  if (faults.rounding) faults.rounding->of_counts = is_skewed(sums.skew, *step);
  // A staircase may stand on its last step for long.
  if (!faults.staircase) {
    if (sums.low.count > 0 && sums.low.value == census.low)
      faults.rails.push_back({census.low, false, sums.low.count / sums.present});
    if (sums.high.count > 0 && sums.high.value == census.high)
      faults.rails.push_back({census.high, true, sums.high.count / sums.present});
  }
  describe_faults(faults, unit);
  if (const auto times = faults.held ? std::nullopt : truncated(sums.zero, step))
    faults.findings.push_back(truncation_finding(*times, sums.zero, unit));
  return faults;
}

void doubt_digital(const DigitalFaults& faults, NoiseFit& fit) {
  // A rail that less than one sample in a hundred reaches takes less than a hundredth of the standard deviation.
  constexpr double kHarmless = 0.01;
  double clipped = 0;
  for (const Rail& rail : faults.rails) clipped += rail.share;
  const bool rounding = faults.staircase && faults.staircase->bounded;
  if (!rounding && !(clipped > kHarmless)) return;
  for (Coefficient& term : fit.term) {
    if (term.status == Status::detected || term.status == Status::undetermined) term.status = Status::misfit;
  }
  Coefficient& white = fit.term[static_cast<std::size_t>(Term::white)];
  if (rounding && fit.rate_hz > 0) {
    // Noise of less than .3 steps: not more is known of it.
    const double most = faults.staircase->noise / std::sqrt(fit.rate_hz);
    if (white.value) white.ci95 = {0, std::max(white.ci95.high, most)};
    if (white.upper95) white.upper95 = std::max(*white.upper95, most);
  }
  fit.findings.push_back(finding(
      "digital_misfit",
      fmt::format(
          "No coefficient can be trusted, however well the curves agree: they are those of the {}, not of the noise.",
          rounding ? "converter's rounding" : "clipped samples")));
}

}  // namespace libchar
