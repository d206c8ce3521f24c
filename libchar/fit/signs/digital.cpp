// Rails: a tail falls outwards, so that fewer samples stand at the last value than just inside it.
// A rail has eight samples and twice as many as the neighbourhood (a thousandth of the range, or
// one and a half times the distance to the next value). Held values: runs of one value. Polled at r
// times the sensor's rate, runs are floor(r) or ceil(r) long; repeats of coarsely rounded noise
// come by chance, runs of one among them. Where r < 2, single values are there as well, and the
// repeats come evenly. Staircase: with s = sqrt(2) sigma / step, neighbours are equal with
// probability
//   P0 = 2 Phi(1/s) - 1 - s sqrt(2/pi) (1 - exp(-1/(2 s^2))),   .27 at sigma = step,
// averaged over where between two steps the value stands, which holds while the noise moves it
// there (sigma > .3 step).
#include "libchar/fit/signs/digital.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "libchar/core/numeric/present.hpp"
#include "libchar/core/text/readable.hpp"

namespace libchar {
namespace {

constexpr std::size_t kFewestRuns = 64, kLongestHold = 1024;
constexpr std::uint64_t kFewestAtRail = 8;
constexpr double kMostAtRail =
    0.5;  ///< share: beyond it the rail is the signal, and the rest are spikes

DigitalSums::AtRail rail_of(std::span<const double> record,
                            const ValueCensus& census,
                            bool high,
                            double present) {
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

/// The length that a share of the runs does not pass.
std::uint64_t quantile(const ValueRuns& runs, double share) {
  double sum = 0;
  for (std::size_t length = 1; length <= kLongestHold; ++length)
    if ((sum += runs.of_length[length]) >= share * runs.runs) return length;
  return kLongestHold;
}

double mean_length(const ValueRuns& runs) {
  return runs.samples / runs.runs;
}

/// Standard deviation over mean of the distance between repeats: near 1 by chance.
double unevenness(const ValueRuns& runs) {
  const double mean = runs.spacing / runs.repeats;
  return std::sqrt(std::max(0.0, runs.spacing2 / runs.repeats - mean * mean)) / mean;
}

ValueRuns runs_of_values(std::span<const double> record) {
  ValueRuns runs;
  runs.of_length.assign(kLongestHold + 1, 0.0);
  std::size_t length = 1;
  std::uint64_t since = 0;
  bool first = true;
  for (std::size_t t = 1; t < record.size(); ++t) {
    ++since;
    if (record[t] == record[t - 1]) {
      ++length;
      runs.repeats += 1;
      runs.spacing += static_cast<double>(since);
      runs.spacing2 += static_cast<double>(since * since);
      since = 0;
      continue;
    }
    if (!first) {
      runs.of_length[std::min(length, kLongestHold)] += 1;
      runs.runs += 1;
      runs.samples += static_cast<double>(length);
    }
    first = false;
    length = 1;
  }
  return runs;
}

std::optional<HeldValues> held_values(const ValueRuns& runs, double rate_hz) {
  if (static_cast<double>(kFewestRuns) > runs.runs ||
      static_cast<double>(kFewestRuns) > runs.repeats)
    return std::nullopt;
  const std::uint64_t shortest = quantile(runs, 0.01), longest = quantile(runs, 0.99);
  const bool every = shortest >= 2 && longest <= 2 * shortest + 1;
  const bool some = shortest == 1 && longest <= 2 && unevenness(runs) < 0.35;
  if (!every && !some) return std::nullopt;
  const double times = mean_length(runs);
  return HeldValues{times, rate_hz / times};
}

double chance_of_repeat(double noise_over_step) {
  const double s = std::numbers::sqrt2 * noise_over_step;
  return std::erf(1 / (s * std::numbers::sqrt2)) -
         s * std::sqrt(2 / std::numbers::pi) * -std::expm1(-1 / (2 * s * s));
}

std::optional<Staircase> staircase(const ValueRuns& runs, double step) {
  const double repeats = 1 - 1 / std::max(1.0, mean_length(runs));
  if (!(runs.runs > 0) || repeats <= chance_of_repeat(1)) return std::nullopt;
  double low = 0.3, high = 1;
  if (repeats >= chance_of_repeat(low)) return Staircase{step, low * step, true};
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    (chance_of_repeat(middle) > repeats ? low : high) = middle;
  }
  return Staircase{step, low * step, false};
}

std::string with_unit(double value, std::string_view unit) {
  return number_text(value, 3) + (unit.empty() ? "" : " ") + std::string(unit);
}

void describe_faults(DigitalFaults& faults, double rate_hz, std::string_view unit) {
  for (const Rail& rail : faults.rails)
    faults.findings.push_back(
        finding("rail",
                fmt::format("{} of the samples stand at the {} value, {}: clipped, and the noise "
                            "comes out too small.",
                            percent_text(rail.share),
                            rail.high ? "largest" : "smallest",
                            with_unit(rail.value, unit))));
  if (faults.held)
    faults.findings.push_back(finding(
        "held_values",
        fmt::format("Each value is recorded {} times on average: the sensor gives {} Hz where the "
                    "log has {} Hz.",
                    number_text(faults.held->times, 3),
                    number_text(faults.held->sensor_rate_hz, 4),
                    number_text(rate_hz, 4))));
  if (faults.staircase)
    faults.findings.push_back(finding(
        "staircase",
        fmt::format("The noise between samples, {}{}, is below the converter's step of {}: {}",
                    faults.staircase->bounded ? "at most " : "",
                    with_unit(faults.staircase->noise, unit),
                    with_unit(faults.staircase->step, unit),
                    faults.staircase->bounded ? "what is measured is the rounding."
                                              : "the rounding is part of what is measured.")));
}

}  // namespace

ValueCensus value_census(std::span<const double> record) {
  ValueCensus census;
  census.low = std::numeric_limits<double>::infinity();
  census.high = -std::numeric_limits<double>::infinity();
  for (const double x : record) {  // no comparison holds of a missing sample
    census.low = x < census.low ? x : census.low;
    census.high = x > census.high ? x : census.high;
  }
  double before = std::numeric_limits<double>::quiet_NaN();
  for (const double x : record) {
    census.at_low += x == census.low ? 1 : 0;
    census.at_high += x == census.high ? 1 : 0;
    census.repeats += x == before ? 1 : 0;
    before = x;
  }
  return census;
}

DigitalSums digital_sums(std::span<const double> samples,
                         const ValueCensus& census,
                         std::uint64_t missing) {
  DigitalSums sums;
  sums.present = static_cast<double>(samples.size() - missing);
  if (!(census.low < census.high)) return sums;
  if (census.repeats >= kFewestRuns) sums.runs = runs_of_values(samples);
  sums.low = rail_of(samples, census, false, sums.present);
  sums.high = rail_of(samples, census, true, sums.present);
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
  sums.present += later.present;
  ValueRuns& runs = sums.runs;
  const ValueRuns& more = later.runs;
  if (more.of_length.empty()) return;
  if (runs.of_length.empty()) runs.of_length.assign(kLongestHold + 1, 0.0);
  for (std::size_t length = 0; length < more.of_length.size(); ++length)
    runs.of_length[length] += more.of_length[length];
  runs.runs += more.runs;
  runs.samples += more.samples;
  runs.repeats += more.repeats;
  runs.spacing += more.spacing;
  runs.spacing2 += more.spacing2;
}

template <class Archive, class Sums>
static void digital_layout(Archive& at, Sums& sums) {
  auto& runs = sums.runs;
  at.group("the digital faults of a channel",
           sums.present,
           sums.low.value,
           sums.low.count,
           sums.high.value,
           sums.high.count,
           runs.runs,
           runs.samples,
           runs.repeats,
           runs.spacing,
           runs.spacing2);
  at(runs.of_length);
}

void write_state(const DigitalSums& sums, StateWriter& to) {
  digital_layout(to, sums);
}

DigitalSums read_digital_sums(StateReader& from) {
  DigitalSums sums;
  digital_layout(from, sums);
  const std::size_t lengths = sums.runs.of_length.size();
  if (lengths != 0 && lengths != kLongestHold + 1) from.refuse("the runs of a channel");
  return sums;
}

DigitalFaults find_digital_faults(std::span<const double> record,
                                  double rate_hz,
                                  std::optional<double> step,
                                  std::string_view unit) {
  const ValueCensus census = value_census(record);
  return find_digital_faults(
      digital_sums(record, census, count_missing(record)), census, rate_hz, step, unit);
}

DigitalFaults find_digital_faults(const DigitalSums& sums,
                                  const ValueCensus& census,
                                  double rate_hz,
                                  std::optional<double> step,
                                  std::string_view unit) {
  DigitalFaults faults;
  if (!(census.low < census.high)) return faults;
  if (!sums.runs.of_length.empty()) {
    faults.held = held_values(sums.runs, rate_hz);
    if (step && !faults.held) faults.staircase = staircase(sums.runs, *step);
  }
  // A staircase may stand on its last step for long.
  if (!faults.staircase) {
    if (sums.low.count > 0 && sums.low.value == census.low)
      faults.rails.push_back({census.low, false, sums.low.count / sums.present});
    if (sums.high.count > 0 && sums.high.value == census.high)
      faults.rails.push_back({census.high, true, sums.high.count / sums.present});
  }
  describe_faults(faults, rate_hz, unit);
  return faults;
}

void doubt_digital(const DigitalFaults& faults, NoiseFit& fit) {
  // A rail that less than one sample in a hundred reaches takes less than a hundredth of the
  // standard deviation.
  constexpr double kHarmless = 0.01;
  double clipped = 0;
  for (const Rail& rail : faults.rails) clipped += rail.share;
  const bool rounding = faults.staircase && faults.staircase->bounded;
  if (!rounding && !(clipped > kHarmless)) return;
  for (Coefficient& term : fit.term) {
    if (term.status == Status::detected || term.status == Status::undetermined)
      term.status = Status::misfit;
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
          "No coefficient can be trusted, however well the curves agree: they are those of the "
          "{}, not of the noise.",
          rounding ? "converter's rounding" : "clipped samples")));
}

}  // namespace libchar
