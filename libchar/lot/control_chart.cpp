// Individuals chart (Montgomery, Introduction to Statistical Quality Control, 6.4): sigma = mean |x_i - x_{i-1}| / d2,
// d2 = 2/sqrt(pi) = 1.128, limits at the mean ± 3 sigma. How often chance leaves them or stays on a side: the zone
// rules below.

#include "libchar/lot/control_chart.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "libchar/core/numeric/distributions.hpp"
#include "libchar/core/numeric/median.hpp"

namespace libchar {

// Western Electric, Statistical Quality Control Handbook (1956), 25; Nelson, J. Quality Technology 16 (1984) 237. With
// z = (x - centre) / sigma, on either side: z > 3; two of three > 2; four of five > 1; eight of eight > 0; the value
// that completes them is one of them. Each is expected as often as a window begins to hold it that did not one value
// before: with the probability b that a value is beyond, the sum over all patterns of the window and the value before
// it.
// Together they signal every 91.75 values of a process that stays where it is (Champ & Woodall, Technometrics 29 (1987)
// 393), so that nearly every chart of a few hundred has a signal: it is a hint. An alarm is what chance does not bring:
// more signals of a rule than expected (binomial), a value so far off that n of them do not let expect it (Student's t;
// a mean moving range has .62 (n - 1) degrees of freedom), or a stretch on one side longer than n values have, each
// rule with a quarter of 1 %.

namespace {

constexpr double kValuesToAnySignal = 91.75;
constexpr double kRangeDof = 0.62;

struct RuleShape {
  std::size_t need = 1, window = 1;
  double beyond = 3;  ///< sigma
};
constexpr std::array<RuleShape, kZoneRules> kShapes = {{{1, 1, 3}, {2, 3, 2}, {4, 5, 1}, {8, 8, 0}}};

/// Is the pattern's newest value (bit 0) beyond, and enough of the window with it?
bool holds_rule(unsigned pattern, const RuleShape& shape) {
  const unsigned window = pattern & ((1U << shape.window) - 1);
  std::size_t count = 0;
  for (unsigned rest = window; rest != 0; rest &= rest - 1) ++count;
  return (pattern & 1U) != 0 && count >= shape.need;
}

/// Signals a value, of both sides.
double rate_of(const RuleShape& shape) {
  const double beyond = std::erfc(shape.beyond / std::sqrt(2.0)) / 2;
  double rate = 0;
  for (unsigned pattern = 0; pattern < (1U << (shape.window + 1)); ++pattern) {
    if (!holds_rule(pattern, shape) || holds_rule(pattern >> 1U, shape)) continue;
    double p = 1;
    for (std::size_t k = 0; k <= shape.window; ++k) p *= (pattern >> k & 1U) != 0 ? beyond : 1 - beyond;
    rate += p;
  }
  return 2 * rate;
}

std::size_t count_signals(std::span<const double> values, double centre, double sigma, const RuleShape& shape) {
  std::size_t signals = 0;
  unsigned above = 0, below = 0;
  bool before = false;
  for (const double x : values) {
    const double z = (x - centre) / sigma;
    above = above << 1U | static_cast<unsigned>(z > shape.beyond);
    below = below << 1U | static_cast<unsigned>(-z > shape.beyond);
    const bool now = holds_rule(above, shape) || holds_rule(below, shape);
    signals += now && !before;
    before = now;
  }
  return signals;
}

std::size_t longest_on_one_side(std::span<const double> values, double centre) {
  std::size_t longest = 0, length = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const bool same = i > 0 && (values[i] > centre) == (values[i - 1] > centre);
    length = same ? length + 1 : 1;
    longest = std::max(longest, length);
  }
  return longest;
}

/// Of a value as far off among all of them.
double p_of_furthest(std::span<const double> values, double centre, double sigma) {
  double most = 0;
  for (const double x : values) most = std::max(most, std::abs(x - centre) / sigma);
  const double n = static_cast<double>(values.size());
  return std::min(1.0, 2 * n * student_tail(most, kRangeDof * (n - 1)));
}

double p_of_longest(std::span<const double> values, double centre) {
  const double n = static_cast<double>(values.size()),
               longest = static_cast<double>(longest_on_one_side(values, centre));
  return std::min(1.0, (n - longest + 2) * std::exp2(-longest));
}

}  // namespace

ZoneFindings zone_findings(std::span<const double> values, double centre, double sigma) {
  ZoneFindings out;
  const double n = static_cast<double>(values.size());
  for (std::size_t r = 0; r < kZoneRules; ++r) {
    const RuleShape& shape = kShapes[r];
    ZoneFinding& found = out.rule[r];
    const double rate = rate_of(shape), windows = std::max(0.0, n - static_cast<double>(shape.need) + 1);
    found.signals = count_signals(values, centre, sigma, shape);
    found.by_chance = windows * rate;
    found.p = found.signals == 0 ? 1 : binomial_tail(static_cast<double>(found.signals) - 1, windows, rate);
  }
  // Two ways to be improbable: twice the smaller.
  const auto either = [](double p, double other) { return std::min(1.0, 2 * std::min(p, other)); };
  ZoneFinding& furthest = out.rule[static_cast<std::size_t>(ZoneRule::beyond_3_sigma)];
  ZoneFinding& longest = out.rule[static_cast<std::size_t>(ZoneRule::eight_in_a_row)];
  furthest.p = either(furthest.p, p_of_furthest(values, centre, sigma));
  longest.p = either(longest.p, p_of_longest(values, centre));
  for (ZoneFinding& found : out.rule) {
    found.alarm = found.signals > 0 && found.p < detail::kChartAlarm / kZoneRules;
    out.alarm = out.alarm || found.alarm;
  }
  out.any_by_chance = -std::expm1(-n / kValuesToAnySignal);
  return out;
}

namespace {

std::vector<ChartPoint> chart_points(std::span<const double> values) {
  const std::size_t n = values.size(), points = std::min(n, kChartPoints);
  std::vector<ChartPoint> out;
  for (std::size_t k = 0; k < points; ++k) {
    const std::size_t first = k * n / points, end = (k + 1) * n / points;
    const auto part = values.subspan(first, end - first);
    const auto [low, high] = std::minmax_element(part.begin(), part.end());
    double sum = 0;
    for (const double x : part) sum += x;
    out.push_back({first, part.size(), sum / static_cast<double>(part.size()), *low, *high});
  }
  return out;
}

}  // namespace

ControlChart control_chart(std::span<const double> values) {
  ControlChart out;
  const double n = static_cast<double>(values.size());
  double sum = 0, ranges = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    sum += values[i] - values[0];
    if (i > 0) ranges += std::abs(values[i] - values[i - 1]);
  }
  out.centre = values[0] + sum / n;
  out.sigma = ranges / (n - 1) / (2 / std::sqrt(std::numbers::pi));
  out.limits = {out.centre - 3 * out.sigma, out.centre + 3 * out.sigma};
  out.points = chart_points(values);
  for (std::size_t i = 0; i < values.size(); ++i)
    if (values[i] < out.limits.low || values[i] > out.limits.high) out.beyond.push_back({i, values[i]});
  if (out.sigma > 0) out.zones = zone_findings(values, out.centre, out.sigma);
  return out;
}

// Freedman & Diaconis, Z. Wahrscheinlichkeitstheorie verw. Gebiete 57 (1981) 453.

// P_pk = (U - mean) / (3 s) of an upper limit U. Its variance, to first order, from the standard errors of mean and ln
// s (Bissell, Appl. Stat. 39 (1990) 331, has those of a sample without uncertainties: 1/(3 sqrt n) and 1/sqrt(2 (n -
// 1))):
//   var P = (se mean / (3 s))² + P² (se ln s)²
// Where a spread of zero is not excluded the interval is what its upper end and both ends of the mean give, and has no
// upper end.

void add_ppk(const RandomEffects& effects, double limit, Capability& out) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const Interval& mean = effects.mean_ci95;
  const Interval& spread = effects.spread_ci95;
  const double room = limit - effects.mean;
  const double ppk = effects.spread > 0 ? room / (3 * effects.spread) : room >= 0 ? kInfinity : -kInfinity;
  out.ppk = ppk;
  out.above = std::erfc(3 * ppk / std::sqrt(2.0)) / 2;
  if (spread.low > 0) {
    const double of_mean = (mean.high - mean.low) / 2 / (3 * effects.spread);
    const double of_spread = ppk * std::log(spread.high / spread.low) / 2;
    const double half = std::hypot(of_mean, of_spread);
    out.ppk_ci95 = {ppk - half, ppk + half};
    return;
  }
  const auto at_widest = [&](double from) { return (limit - from) / (3 * spread.high); };
  out.ppk_ci95 = {mean.high <= limit ? at_widest(mean.high) : -kInfinity,
                  mean.low <= limit ? kInfinity : at_widest(mean.low)};
}

namespace {

constexpr double kMostBins = 60, kFarOff = 8;

}  // namespace

Histogram histogram_of(std::span<const double> values) {
  Histogram out;
  if (values.empty()) return out;
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  const std::size_t n = sorted.size();
  const double median = sorted[n / 2], quarters = sorted[3 * n / 4] - sorted[n / 4];
  const double sd = quarters * kMadToSd / 2;
  double low = sorted.front(), high = sorted.back();
  if (sd > 0) {
    low = std::max(low, median - kFarOff * sd);
    high = std::min(high, median + kFarOff * sd);
  }
  const double width = 2 * quarters / std::cbrt(static_cast<double>(n));
  const double bins = width > 0 ? std::clamp(std::ceil((high - low) / width), 1.0, kMostBins) : 1;
  out.low = low;
  out.step = high > low ? (high - low) / bins : std::max(std::abs(low) * 1e-6, 1e-12);
  out.count.resize(static_cast<std::size_t>(bins));
  for (const double x : sorted) {
    if (x < low) {
      ++out.below;
    } else if (x > high) {
      ++out.above;
    } else {
      const auto k = static_cast<std::size_t>((x - low) / out.step);
      ++out.count[std::min(k, out.count.size() - 1)];
    }
  }
  return out;
}

}  // namespace libchar
