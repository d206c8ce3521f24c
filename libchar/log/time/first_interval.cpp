// Exact stamps of which rows are missing at random: all steps are whole multiples of the least one,
// and of 1, 2, 3… times it there are as many as where each row is missing with one probability p,
// (1 - p) p^(m-1). That lattice is the sampling, however many are missing. Else two estimates of
// the sampling interval: the common step (the median of the first differences), right in a log with
// gaps, and span / (rows - 1), right wherever each row is a sample. Where they differ by more than
// 2 % one of three things explains it, or the log is refused:
//   coarse   all steps are multiples of the clock's step q, and every stamp stands within
//            a band of 1.5 q (2 q in longer logs) about one line: rounding moves a stamp by at most
//            q, while rows missing at random lead away from every line like a random walk
//   packets  most of the samples would be missing, again and again after at most 40 rows
//   gaps     the longer steps are few, or multiples of the common step
#include "libchar/log/time/first_interval.hpp"

#include <algorithm>
#include <cmath>

#include "libchar/core/numeric/median.hpp"

namespace libchar {
namespace {

constexpr double kSameRate = 0.02;
constexpr std::size_t kLeastOdd = 8;   // steps that make a pattern
constexpr double kLongestPacket = 40;  // rows

double middle_of(std::vector<double> values) {
  return values.empty() ? 0 : median_in_place(values, Middle::lower);
}

/// The steps between stamps in file order; those back in time are left out.
struct FirstSteps {
  std::vector<double> rising;
  std::size_t equal = 0;
  bool back = false;
};

FirstSteps steps_of(const std::vector<std::int64_t>& stamps) {
  FirstSteps steps;
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    std::int64_t step = 0;
    if (__builtin_sub_overflow(stamps[i], stamps[i - 1], &step) || step < 0) {
      steps.back = true;
      continue;
    }
    steps.equal += step == 0;
    if (step > 0) steps.rising.push_back(static_cast<double>(step));
  }
  return steps;
}

/// What most of the stamps say by themselves.
struct CommonStep {
  double ns = 0, longest = 0;
  bool tidy = false;   ///< half of the steps lie within a tenth of it
  bool equal = false;  ///< a quarter of the stamps do not rise
};

CommonStep common_step(const std::vector<std::int64_t>& stamps, const FirstSteps& steps) {
  CommonStep result;
  result.equal = stamps.size() > 8 && steps.equal * 4 > stamps.size();
  const double middle = middle_of(steps.rising);
  std::vector<double> scatter;
  for (const double step : steps.rising) scatter.push_back(std::fabs(step - middle));
  const double deviation = kMadToSd * middle_of(std::move(scatter));
  double sum = 0;
  std::size_t close = 0;
  for (const double step : steps.rising) {
    if (std::fabs(step - middle) > 0.1 * middle) continue;
    sum += step;
    ++close;
  }
  result.tidy = close * 2 >= steps.rising.size();
  if (!result.equal && result.tidy) {
    result.ns = sum / static_cast<double>(close);
    result.longest = 1.5 * result.ns;
    return result;
  }
  // No common step (coarse or jittered stamps): long baselines average it out, unless gaps
  // dominate.
  std::vector<double> slopes;
  const std::size_t half = stamps.size() / 2;
  for (std::size_t i = 0; i + half < stamps.size(); ++i)
    slopes.push_back((static_cast<double>(stamps[i + half]) - static_cast<double>(stamps[i])) /
                     static_cast<double>(half));
  const double slope = middle_of(std::move(slopes));
  result.ns = result.equal || (slope > 0.6 * middle && slope < 1.45 * middle) ? slope : middle;
  if (!(result.ns > 0)) result.ns = middle;
  result.longest = std::max(1.5 * result.ns, result.ns + 3 * deviation);
  return result;
}

bool same_rate(double a, double b) {
  return std::fabs(a - b) <= kSameRate * std::max(a, b);
}

bool multiple_of(double value, double unit, double tolerance) {
  return std::fabs(value / unit - std::round(value / unit)) <= tolerance;
}

/// The clock's own step: the least difference between stamps, or between the steps themselves.
double tick_of(std::vector<double> steps) {
  std::sort(steps.begin(), steps.end());
  double tick = steps.front();
  for (std::size_t i = 1; i < steps.size(); ++i)
    if (steps[i] > steps[i - 1]) tick = std::min(tick, steps[i] - steps[i - 1]);
  return tick;
}

/// Steps on a lattice with rows missing at random: its interval, or 0. Few missing rows need no such care.
double lattice_of(const FirstSteps& steps) {
  constexpr double kFewest = 100, kOff = 0.01, kLeastMissing = 0.15, kMostMissing = 0.9;
  const auto count = static_cast<double>(steps.rising.size());
  if (count < kFewest || steps.equal > 0 || steps.back) return 0;
  const double least = *std::min_element(steps.rising.begin(), steps.rising.end());
  double time = 0, multiples = 0, once = 0, twice = 0;
  for (const double step : steps.rising) {
    const double multiple = std::round(step / least);
    if (std::fabs(step - multiple * least) > kOff * least) return 0;
    time += step;
    multiples += multiple;
    once += multiple == 1 ? 1 : 0;
    twice += multiple == 2 ? 1 : 0;
  }
  const double missing = 1 - count / multiples;
  if (missing < kLeastMissing || missing > kMostMissing) return 0;
  const auto as_expected = [&](double found, double share) {
    return std::fabs(found - count * share) <= 5 * std::sqrt(count * share) + 0.1 * count * share;
  };
  const bool at_random =
      as_expected(once, 1 - missing) && as_expected(twice, (1 - missing) * missing);
  return at_random ? time / multiples : 0;
}

/// The line through the stamps by least squares: ns a row, and how far they spread about it.
struct StampLine {
  double slope = 0, spread = 0;
};

StampLine line_through(const std::vector<std::int64_t>& stamps) {
  const double middle = 0.5 * static_cast<double>(stamps.size() - 1);
  double sum_ky = 0, sum_kk = 0;
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    const double k = static_cast<double>(i) - middle;
    sum_ky += k * static_cast<double>(stamps[i] - stamps[0]);
    sum_kk += k * k;
  }
  StampLine line{sum_ky / sum_kk, 0};
  double low = 0, high = 0;
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    const double off =
        static_cast<double>(stamps[i] - stamps[0]) - line.slope * static_cast<double>(i);
    low = std::min(low, off);
    high = std::max(high, off);
  }
  line.spread = high - low;
  return line;
}

bool on_one_line(const StampLine& line, const FirstSteps& steps, double common) {
  const double tick = tick_of(steps.rising);
  std::size_t odd = steps.equal;
  for (const double step : steps.rising) {
    if (!multiple_of(step, tick, 1e-3)) return false;
    odd += std::fabs(step - common) > 0.5 * tick;
  }
  return odd >= kLeastOdd && line.spread <= (odd >= 2 * kLeastOdd ? 2 : 1.5) * tick;
}

std::vector<double> longer_than(const FirstSteps& steps, double limit) {
  std::vector<double> longer;
  for (const double step : steps.rising)
    if (step > limit) longer.push_back(step);
  std::sort(longer.begin(), longer.end());
  return longer;
}

/// What explains that the span says another rate than the common step.
StampPattern explanation(const FirstSteps& steps,
                         const CommonStep& common,
                         double rows,
                         double span) {
  const std::vector<double> longer = longer_than(steps, 1.5 * common.ns);
  const auto gaps = static_cast<double>(longer.size());
  const bool often = longer.size() >= kLeastOdd && gaps * 50 > rows;
  if (span > 2 * common.ns && often && rows <= kLongestPacket * gaps) return StampPattern::packets;
  if (!common.tidy || !often || span < common.ns) return StampPattern::steps;
  // Of steps that are no multiples 40 % come as near to one by chance.
  const auto near = static_cast<double>(std::count_if(
      longer.begin(), longer.end(), [&](double s) { return multiple_of(s, common.ns, 0.2); }));
  return near > 0.55 * gaps ? StampPattern::steps : StampPattern::disputed;
}

}  // namespace

FirstInterval first_interval(const std::vector<std::int64_t>& stamps,
                             std::optional<double> rate_hz) {
  const FirstSteps steps = steps_of(stamps);
  if (steps.rising.empty()) return {};
  const CommonStep common = common_step(stamps, steps);
  const StampPattern as_it_is = common.equal ? StampPattern::equal : StampPattern::steps;
  FirstInterval result{common.ns, common.longest, as_it_is, common.ns, common.ns};
  if (steps.back || stamps.size() <= kLeastOdd) return result;
  const double lattice = lattice_of(steps);
  if (lattice > 0 && (!rate_hz || same_rate(1e9 / *rate_hz, lattice)) &&
      !on_one_line(line_through(stamps), steps, lattice))
    return {lattice, 1.5 * lattice, StampPattern::steps, lattice, lattice};

  const StampLine line = line_through(stamps);
  const auto rows = static_cast<double>(stamps.size());
  const double span =
      (static_cast<double>(stamps.back()) - static_cast<double>(stamps.front())) / (rows - 1);
  const bool same = same_rate(span, common.ns), equal_at_times = steps.equal * 50 > stamps.size();
  if (same && !equal_at_times) return result;
  StampPattern pattern = as_it_is;
  if (on_one_line(line, steps, common.ns))
    pattern = StampPattern::coarse;
  else if (same && !common.tidy)
    pattern = StampPattern::equal;  // stamps that scatter by more than a step
  else if (!same && !common.equal)
    pattern = explanation(steps, common, rows, span);
  if (pattern == as_it_is) return result;
  if (pattern == StampPattern::equal) {
    result.pattern = pattern;
    return result;
  }
  result.span_ns = line.slope;
  if (rate_hz && same_rate(1e9 / *rate_hz, common.ns)) return result;
  const bool told = rate_hz && same_rate(1e9 / *rate_hz, line.slope);
  result.pattern = pattern == StampPattern::disputed && told ? StampPattern::packets : pattern;
  if (result.pattern == StampPattern::disputed) return result;
  result.ns = line.slope;
  const std::vector<double> longer = longer_than(steps, 0);
  const bool coarse = pattern == StampPattern::coarse;
  const double usual = coarse ? longer.back() : 1.6 * longer[longer.size() * 98 / 100];
  result.longest_step = std::max(1.5 * result.ns, 1.25 * usual);
  // Two steps on either side of the rate, none of them a gap: nothing that needs a word.
  if (coarse && steps.equal == 0 && longer.back() <= 1.5 * common.ns)
    result.pattern = StampPattern::steps;
  return result;
}

}  // namespace libchar
