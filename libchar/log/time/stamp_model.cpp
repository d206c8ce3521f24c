// Steps far longer than nearly all others are pauses, which say nothing of a rate: what follows looks
// at the stretches between them.
//
// 1. A change of rate: slopes of pieces of the log make two groups, one in front of the other. Then
//    the longer part is the log's.
// 2. Rows missing at random: all steps are whole multiples of the least one, and of 1, 2, 3… times
//    it there are as many as where each row is missing with one probability p, (1 - p) p^(m-1). That
//    lattice is the sampling, however many are missing.
// 3. The common step (the median of the steps) begins a walk along the stamps, which takes those
//    longer than 1.5 steps that no later row makes good as gaps; the mean of the other steps is the
//    next interval, until it stays. Where gaps are few that is the interval.
// 4. Where they are many, one of these explains it, or the log is refused:
//      missing  all steps are whole multiples of the common one, and the stamps lead away from every line
//      coarse   all steps are multiples of the clock's step q, and every stamp stands within a band
//               of 1.5 q (2 q in longer logs) about one line: rounding moves a stamp by at most q,
//               while rows missing at random lead away from every line like a random walk
//      gaps     they are a few whole steps long, as exactly as the steps are alike
//      packets, uneven   the stamps keep to one line, in long pieces no further than in short ones:
//               most steps are short again and again after at most 40 rows, or of unlike length
//      gaps     most are near multiples of the common step
#include "libchar/log/time/stamp_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libchar/core/numeric/median.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/log/time/recent_stamps.hpp"

namespace libchar {
namespace {

constexpr double kSameRate = 0.02;
constexpr std::size_t kLeastOdd = 8;   // steps that make a pattern
constexpr double kLongestPacket = 40;  // rows
constexpr double kFaster = 10;         // rows are written than they come, at least, where that says packets
constexpr double kEvenInside = 0.01;   // steps scatter inside a packet, of them
constexpr double kPause = 3;           // times the longest of the usual steps
constexpr double kNewPacket = 0.3;     // of the time from packet to packet
constexpr std::size_t kAhead = 16;     // rows looked at before a long step is called a gap

double middle_of(std::vector<double> values) { return values.empty() ? 0 : median_in_place(values, Middle::lower); }

/// The steps of the first stamps, pauses and steps back in time left out.
struct FirstSteps {
  std::vector<double> rising;
  std::size_t equal = 0;
  double pause = std::numeric_limits<double>::infinity();  ///< longer steps are pauses
  double back = 0;                                         ///< beyond it steps back are no scatter
  bool cut(double step) const { return step > pause || step < back; }
  double mean = 0;
  std::vector<double> line;  ///< where each stamp stands without pauses and steps back
};

FirstSteps steps_of(const std::vector<std::int64_t>& stamps, bool with_pauses = true) {
  FirstSteps steps;
  for (std::size_t i = 1; i < stamps.size(); ++i)
    if (const double step = step_between(stamps[i - 1], stamps[i]); step > 0) steps.rising.push_back(step);
  if (steps.rising.empty()) return steps;
  std::vector<double> sorted = steps.rising;
  std::sort(sorted.begin(), sorted.end());
  const double usual = sorted[(sorted.size() - 1) * 40 / 41];
  if (with_pauses) steps.pause = kPause * usual;
  steps.back = -usual;
  std::erase_if(steps.rising, [&](double step) { return step > steps.pause; });
  double time = 0, count = 0;
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    const double step = step_between(stamps[i - 1], stamps[i]);
    steps.equal += step == 0;
    if (steps.cut(step)) continue;
    time += step;
    count += 1;
  }
  steps.mean = time / count;
  steps.line.push_back(0);
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    const double step = step_between(stamps[i - 1], stamps[i]);
    steps.line.push_back(steps.line.back() + (steps.cut(step) ? steps.mean : step));
  }
  return steps;
}

/// What most of the stamps say by themselves.
struct CommonStep {
  double ns = 0, deviation = 0, spread = 0;  ///< spread: of those within a tenth, in steps
  bool tidy = false;                         ///< half of the steps lie within a tenth of it
  bool equal = false;                        ///< a quarter of the stamps do not rise, or longer steps make up for those
  double longest(double interval) const {
    return std::max(1.5 * interval, deviation > 0.45 * interval ? interval + 3 * deviation : 0);
  }
};

CommonStep common_step(const FirstSteps& steps, bool equal_are_samples) {
  CommonStep result;
  result.equal = equal_are_samples || (steps.line.size() > 8 && steps.equal * 4 > steps.line.size());
  result.ns = middle_of(steps.rising);
  std::vector<double> scatter;
  for (const double step : steps.rising) scatter.push_back(std::fabs(step - result.ns));
  double sum = 0;
  std::size_t close = 0;
  for (const double step : steps.rising) {
    if (std::fabs(step - result.ns) > 0.1 * result.ns) continue;
    sum += step;
    ++close;
  }
  result.tidy = close * 2 >= steps.rising.size();
  const double deviation = kMadToSd * middle_of(std::move(scatter));
  result.deviation = result.tidy ? 0 : deviation;
  result.spread = deviation / result.ns;
  if (!result.equal) {
    if (result.tidy) result.ns = sum / static_cast<double>(close);
    return result;
  }
  std::vector<double> slopes;
  const std::size_t half = steps.line.size() / 2;
  for (std::size_t i = 0; i + half < steps.line.size(); ++i)
    slopes.push_back((steps.line[i + half] - steps.line[i]) / static_cast<double>(half));
  if (const double slope = middle_of(std::move(slopes)); slope > 0) result.ns = slope;
  return result;
}

/// Along the stamps on a grid of one interval.
struct Walk {
  double time = 0, rows = 0;  ///< of the steps that are neither gaps nor pauses
  std::vector<double> gaps;   ///< steps, in intervals
};

Walk walk(const std::vector<std::int64_t>& stamps, const FirstSteps& steps, double ns, double longest) {
  Walk out;
  RecentStamps recent;
  recent.push(stamps[0]);
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    const double step = step_between(stamps[i - 1], stamps[i]);
    if (step == 0) continue;
    bool cut = steps.cut(step);
    if (!cut && step > longest) {
      const double late = recent.last_late(ns);
      std::vector<double> lags;
      for (std::size_t j = 0; j < kAhead && i + j < stamps.size(); ++j)
        lags.push_back((step_between(stamps[i - 1], stamps[i + j]) + late) / ns - static_cast<double>(j + 1));
      cut = common_lag(std::move(lags)) >= 0.5;
      if (cut) out.gaps.push_back(step / ns);
    }
    if (cut) recent.clear();
    recent.push(stamps[i]);
    if (cut) continue;
    out.time += step;
    out.rows += 1;
  }
  return out;
}

bool same_rate(double a, double b) { return std::fabs(a - b) <= kSameRate * std::max(a, b); }

bool multiple_of(double value, double unit, double tolerance) {
  return std::fabs(value / unit - std::round(value / unit)) <= tolerance;
}

/// The clock's own step: the least difference between stamps, or between the steps themselves.
double tick_of(std::vector<double> steps, double least = 0) {
  std::sort(steps.begin(), steps.end());
  double tick = steps.front();
  for (std::size_t i = 1; i < steps.size(); ++i)
    if (steps[i] - steps[i - 1] > least) tick = std::min(tick, steps[i] - steps[i - 1]);
  return tick;
}

/// The same of a clock of 32 bits, whose steps of 1/512 s six digits round.
double rounded_tick(const std::vector<double>& steps) {
  constexpr double kRounded = 1e-3;
  const double about = tick_of(steps, kRounded * *std::min_element(steps.begin(), steps.end()));
  double time = 0, ticks = 0;
  for (const double step : steps) {
    time += step;
    ticks += std::round(step / about);
  }
  return time / ticks;
}

/// Steps on a lattice with rows missing at random: its interval, or 0. Few missing rows need no such care.
double lattice_of(const FirstSteps& steps) {
  constexpr double kFewest = 100, kOff = 0.2, kLeastMissing = 0.15, kMostMissing = 0.9;
  const auto count = static_cast<double>(steps.rising.size());
  if (count < kFewest || steps.equal > 0) return 0;
  std::vector<double> sorted = steps.rising;
  std::sort(sorted.begin(), sorted.end());
  double interval = sorted[sorted.size() / 10];
  std::erase_if(sorted, [&](double step) { return std::fabs(step - interval) > 0.3 * interval; });
  interval = middle_of(std::move(sorted));
  double time = 0, multiples = 0, once = 0, twice = 0, off = 0;
  for (int i = 0; i < 3; ++i) {
    time = multiples = once = twice = off = 0;
    for (const double step : steps.rising) {
      const double multiple = std::max(1.0, std::round(step / interval));
      time += step;
      multiples += multiple;
      once += multiple == 1 ? 1 : 0;
      twice += multiple == 2 ? 1 : 0;
      const double rest = step / interval - multiple;
      off += rest * rest;
    }
    interval = time / multiples;
  }
  const double missing = 1 - count / multiples;
  if (missing < kLeastMissing || missing > kMostMissing || off > kOff * kOff * count) return 0;
  const auto as_expected = [&](double found, double share) {
    return std::fabs(found - count * share) <= 5 * std::sqrt(count * share) + 0.1 * count * share;
  };
  const bool at_random = as_expected(once, 1 - missing) && as_expected(twice, (1 - missing) * missing);
  return at_random ? interval : 0;
}

/// The line through places by least squares: ns a row, and how far they spread about it.
struct StampLine {
  double slope = 0, spread = 0;
};

StampLine line_through(std::span<const double> places) {
  const double middle = 0.5 * static_cast<double>(places.size() - 1);
  double sum_ky = 0, sum_kk = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double k = static_cast<double>(i) - middle;
    sum_ky += k * (places[i] - places[0]);
    sum_kk += k * k;
  }
  StampLine line{sum_ky / sum_kk, 0};
  double low = 0, high = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double off = places[i] - places[0] - line.slope * static_cast<double>(i);
    low = std::min(low, off);
    high = std::max(high, off);
  }
  line.spread = high - low;
  return line;
}

/// How far pieces of so many rows spread, each about its own line, from the quietest on.
std::vector<double> spreads_of_pieces(std::span<const double> line, std::size_t rows) {
  std::vector<double> spreads;
  for (std::size_t i = 0; i + rows <= line.size(); i += rows / 2)
    spreads.push_back(line_through(line.subspan(i, rows)).spread);
  std::sort(spreads.begin(), spreads.end());
  return spreads;
}

/// A random walk spreads twice as far in four times the rows, what is late once no further: in the middle of the pieces
/// or, where the log hung in some of them, in their quieter half.
bool keeps_to_a_line(const FirstSteps& steps) {
  constexpr std::size_t kLeast = 128;
  constexpr double kTwice = 1.55;
  const std::size_t n = steps.line.size();
  if (n < kLeast) return false;
  const std::vector<double> wide = spreads_of_pieces(steps.line, n / 4), narrow = spreads_of_pieces(steps.line, n / 16);
  const auto holds = [&](std::size_t part) {
    return wide[(wide.size() - 1) / part] < kTwice * narrow[(narrow.size() - 1) / part];
  };
  return holds(2) || holds(4);
}

/// Stamps that do not rise are those of samples, not of doubles, where longer steps make up for them.
bool equal_are_samples(const FirstSteps& steps) {
  constexpr double kFewest = 0.02;
  const double share = static_cast<double>(steps.equal) / static_cast<double>(steps.line.size());
  return share > kFewest && steps.mean > middle_of(steps.rising) * (1 - share / 2) && keeps_to_a_line(steps);
}

/// A clock that cannot tell rows apart passes no tick without some: where it does, packets are missing.
bool on_one_line(const StampLine& line, const FirstSteps& steps, double common, double tick) {
  constexpr double kSeveral = 0.6, kPassed = 1.5;
  std::size_t odd = steps.equal;
  for (const double step : steps.rising) {
    if (!multiple_of(step, tick, 1e-3) || (steps.mean < kSeveral * tick && step > kPassed * tick)) return false;
    odd += std::fabs(step - common) > 0.5 * tick;
  }
  return odd >= kLeastOdd && line.spread <= (odd >= 2 * kLeastOdd ? 2 : 1.5) * tick;
}

bool on_one_line(const StampLine& line, const FirstSteps& steps, double common) {
  return on_one_line(line, steps, common, tick_of(steps.rising)) ||
         on_one_line(line, steps, common, rounded_tick(steps.rising));
}

/// Samples a little slower or faster than a clock of whole seconds tells them apart: now and then a step more or
/// less, as evenly as no losses come (Kuiper's statistic of six at random stays as small once in 3,000, the stricter
/// one of four once in 500; of those that beat 99 and 95 % are known). Of finer steps a logger that loses each
/// hundredth row is as likely. An interval that drifts beats as evenly in pieces.
bool beats_with_clock(const StampLine& line, const FirstSteps& steps, double common) {
  constexpr std::size_t kFewest = 4, kMany = 6, kPieces = 4;
  constexpr double kSecond = 1e9;
  const double tick = tick_of(steps.rising);
  if (tick < kSecond) return false;
  std::size_t odd = steps.equal;
  for (const double step : steps.rising) {
    if (!multiple_of(step, tick, 1e-3)) return false;
    odd += std::fabs(step - common) > 0.5 * tick;
  }
  if (common >= 1.5 * tick || odd < kFewest) return false;
  if (line.spread <= (odd < kMany ? 1.1 : 1.25) * tick) return true;
  if (odd < kPieces * kMany) return false;
  const std::vector<double> spreads = spreads_of_pieces(steps.line, steps.line.size() * kMany / odd);
  return spreads[spreads.size() / 2] <= 1.25 * tick;
}

/// The step of which half of the time consists of longer ones: that from packet to packet, however many rows follow
/// each other at once in them.
double step_of_half_the_time(const FirstSteps& steps) {
  std::vector<double> sorted = steps.rising;
  std::sort(sorted.begin(), sorted.end());
  double all = 0, sum = 0;
  for (const double step : sorted) all += step;
  for (const double step : sorted)
    if ((sum += step) >= 0.5 * all) return step;
  return 0;
}

/// The mean of the steps near that one, which coarse stamps round: 9 and 10 ms of 104 Hz.
double regular_step(const FirstSteps& steps) {
  constexpr double kShortest = 0.5, kLongest = 1.6;
  const double usual = step_of_half_the_time(steps);
  double time = 0, count = 0;
  for (const double step : steps.rising) {
    if (step <= kShortest * usual || step >= kLongest * usual) continue;
    time += step;
    count += 1;
  }
  return count > 0 ? time / count : usual;
}

/// First rows of packets: those behind longer steps than that.
std::vector<std::size_t> packet_starts(const FirstSteps& steps, double least) {
  std::vector<std::size_t> out;
  for (std::size_t i = 1; i < steps.line.size(); ++i)
    if (steps.line[i] - steps.line[i - 1] > least) out.push_back(i);
  return out;
}
std::vector<std::size_t> packet_starts(const FirstSteps& steps) {
  return packet_starts(steps, kNewPacket * step_of_half_the_time(steps));
}

/// Rows of each packet.
double mean_rows(const std::vector<std::size_t>& starts) {
  return starts.size() < 2
             ? 0
             : static_cast<double>(starts.back() - starts.front()) / static_cast<double>(starts.size() - 1);
}

/// Rows of a packet, where nearly all have as many, or as many as several that came together; else 0.
std::size_t rows_of_packets(const std::vector<std::size_t>& starts, std::size_t fewest = 8, double share = 0.85) {
  if (starts.size() < fewest) return 0;
  std::vector<double> sizes;
  for (std::size_t i = 1; i < starts.size(); ++i) sizes.push_back(static_cast<double>(starts[i] - starts[i - 1]));
  const auto count = static_cast<double>(sizes.size());
  const double usual = middle_of(sizes);
  const auto alike = static_cast<double>(
      std::count_if(sizes.begin(), sizes.end(), [&](double size) { return std::fmod(size, usual) == 0; }));
  return usual > 1 && alike >= share * count ? static_cast<std::size_t>(usual) : 0;
}

/// First rows follow each other evenly.
bool come_evenly(const FirstSteps& steps, const std::vector<std::size_t>& starts) {
  constexpr double kEven = 0.1;
  std::vector<double> apart, off;
  for (std::size_t i = 1; i < starts.size(); ++i) apart.push_back(steps.line[starts[i]] - steps.line[starts[i - 1]]);
  const double usual = middle_of(apart);
  for (const double one : apart) off.push_back(std::fabs(one - usual));
  return middle_of(std::move(off)) < kEven * usual;
}

/// Rows between longer steps, as unlike as where each row is lost with one probability: then they scatter as much as
/// their mean, and those between beats with a coarse clock hardly at all.
bool lost_at_random(const FirstSteps& steps, double common) {
  constexpr double kScatter = 0.6;
  double rows = 0, count = 0, sum = 0, squares = 0;
  for (const double step : steps.rising) {
    ++rows;
    if (step < 1.5 * common) continue;
    ++count;
    sum += rows;
    squares += rows * rows;
    rows = 0;
  }
  return steps.equal == 0 && squares * count > (1 + kScatter * kScatter) * sum * sum;
}

/// Steps that are whole multiples of the common one and whose stamps lead away from every line: rows are missing,
/// however many. Stamps of packets are late against an even clock, by no more than a packet or two; where packets are
/// missing, those that are left are alike.
bool rows_are_missing(const FirstSteps& steps, const CommonStep& common) {
  constexpr double kFar = 2;  // longest steps: one walk in a hundred stays as near
  if (!common.tidy || rows_of_packets(packet_starts(steps)) > 0) return false;
  double longest = 0;
  for (const double step : steps.rising) {
    if (!multiple_of(step, common.ns, 1e-3)) return false;
    longest = std::max(longest, step);
  }
  return line_through(steps.line).spread > kFar * longest || lost_at_random(steps, common.ns);
}

/// Long and short steps by turns from end to end: two messages of one period. No loss is as regular.
bool takes_turns(const FirstSteps& steps) {
  constexpr double kMost = 0.98;
  double turns = 0;
  for (std::size_t i = 1; i < steps.rising.size(); ++i)
    turns += (steps.rising[i] > steps.mean) != (steps.rising[i - 1] > steps.mean) ? 1 : 0;
  return steps.equal == 0 && turns >= kMost * static_cast<double>(steps.rising.size() - 1);
}

/// What explains that many steps are longer than the common one.
StampPattern explanation(const FirstSteps& steps, const CommonStep& common, const std::vector<double>& gaps) {
  const auto share = [&](const auto& holds) {
    return static_cast<double>(std::count_if(gaps.begin(), gaps.end(), holds)) / static_cast<double>(gaps.size());
  };
  if (rows_are_missing(steps, common)) return StampPattern::steps;
  const bool to_a_line = keeps_to_a_line(steps);
  const double tick = tick_of(steps.rising);
  const bool coarse =
      to_a_line && tick > 0.2 * common.ns &&
      std::all_of(steps.rising.begin(), steps.rising.end(), [&](double step) { return multiple_of(step, tick, 1e-3); });
  // Where steps are alike to a percent, longer gaps are known as exactly.
  const double near = 0.02 + 2.5 * common.spread, longest = near <= 0.05 ? 20.5 : 3.5;
  const double exact = near <= 0.05 ? near - 0.01 : std::min(0.25, near);
  const auto whole = [&](double gap) { return gap < longest && multiple_of(gap, 1, exact); };
  const bool turns = to_a_line && !coarse && takes_turns(steps);
  const double rows_a_gap = static_cast<double>(steps.line.size()) / static_cast<double>(gaps.size());
  constexpr double kSurely = 5, kAwake = 2e9;  // steps; ns: nobody takes as long to write a packet
  const bool alike = rows_of_packets(packet_starts(steps)) > 0, even_inside = common.spread < kEvenInside;
  const bool in_packets = (rows_a_gap <= kLongestPacket || (to_a_line && alike)) &&
                          (steps.mean > 2 * common.ns || (steps.mean > 1.2 * common.ns && rows_a_gap > 2.5));
  if (!coarse && !turns && share(whole) > 0.9)  // nobody loses most of the rows as regularly as that
    return in_packets && alike && even_inside && steps.mean > 2 * common.ns && rows_a_gap * common.ns < kAwake &&
                   come_evenly(steps, packet_starts(steps))
               ? StampPattern::disputed
               : StampPattern::steps;
  // As even inside as a sensor that pauses: only rows that are written far faster than they come are surely packets.
  if (alike && even_inside && rows_a_gap * common.ns > kAwake && steps.mean > kSurely * common.ns)
    return StampPattern::steps;
  if (in_packets && alike && even_inside && steps.mean < kSurely * common.ns)
    return come_evenly(steps, packet_starts(steps)) ? StampPattern::disputed : StampPattern::steps;
  if (to_a_line) return in_packets ? StampPattern::packets : coarse ? StampPattern::coarse : StampPattern::uneven;
  if (steps.mean > 2 * common.ns && in_packets) return StampPattern::packets;
  if (!common.tidy) return StampPattern::steps;
  // Of steps that are no multiples 40 % come as near to one by chance.
  return share([](double gap) { return multiple_of(gap, 1, 0.2); }) > 0.55 ? StampPattern::steps
                                                                           : StampPattern::disputed;
}

/// Time over rows from one first row of a packet to another, the median: packets that are missing here and there do
/// not move it.
double packet_interval(const FirstSteps& steps, const std::vector<std::size_t>& starts) {
  constexpr std::size_t kApart = 64;
  std::vector<double> slopes;
  for (std::size_t i = 0, j = 0; i < starts.size(); ++i) {
    while (j < starts.size() && starts[j] < starts[i] + kApart) ++j;
    if (j < starts.size())
      slopes.push_back((steps.line[starts[j]] - steps.line[starts[i]]) / static_cast<double>(starts[j] - starts[i]));
  }
  return middle_of(std::move(slopes));
}

/// The same of packets of so many rows: from each to the next, the packets between them that are missing counted. Of
/// packets that are late by a good part of one nobody can: then the slope through all rows says more.
double interval_of_alike(const FirstSteps& steps, const std::vector<std::size_t>& starts, std::size_t rows,
                         double slope) {
  constexpr double kMostMissing = 20, kCounted = 0.15;  // packets; the rms deviation from whole ones
  double ns = slope;
  for (int round = 0; round < 3; ++round) {
    double time = 0, packets = 0, off = 0, count = 0;
    for (std::size_t i = 1; i < starts.size(); ++i) {
      const double apart = steps.line[starts[i]] - steps.line[starts[i - 1]];
      const double multiple = std::round(apart / (ns * static_cast<double>(rows)));
      if (starts[i] - starts[i - 1] != rows || multiple > kMostMissing) continue;
      time += apart;
      packets += multiple;
      off += std::pow(apart / (ns * static_cast<double>(rows)) - multiple, 2);
      count += 1;
    }
    if (off > kCounted * kCounted * count) return slope;
    if (packets > 0) ns = time / (packets * static_cast<double>(rows));
  }
  return ns;
}

/// The same of packets of any size: where the next ones are later than the last by most of a packet, and stay so, some
/// are missing, and another stretch begins.
double interval_of_unlike(const FirstSteps& steps, const std::vector<std::size_t>& starts, double slope) {
  constexpr std::size_t kBefore = 8, kBehind = 10;
  constexpr double kMissing = 0.5;  // of a packet
  constexpr int kRounds = 4;
  if (starts.size() < 2 * kBehind) return slope;
  const double rows = mean_rows(starts);
  double ns = slope;
  const auto line = [&](std::size_t i) { return steps.line[starts[i]]; };
  const auto late = [&](std::size_t i) { return line(i) - static_cast<double>(starts[i]) * ns; };
  const auto stays_late = [&](std::size_t i, std::size_t first) {
    if (i + kBehind > starts.size()) return false;
    std::vector<double> before, behind;
    for (std::size_t k = first; k < i; ++k) before.push_back(late(k));
    for (std::size_t k = i; k < i + kBehind; ++k) behind.push_back(late(k));
    return *std::min_element(behind.begin(), behind.end()) - middle_of(std::move(before)) >= kMissing * rows * ns;
  };
  for (int round = 0; round < kRounds; ++round) {
    std::vector<double> slopes;
    for (std::size_t from = 0, i = kBefore; from < starts.size(); ++i) {
      const std::size_t end = std::min(i, starts.size());
      if (end < starts.size() && !stays_late(i, std::max(from + kBefore, i) - kBefore)) continue;
      const std::size_t half = (end - from) / 2;  // a stall is as seldom among these as among the packets
      for (std::size_t k = from; half >= kBefore / 2 && k + half < end; ++k)
        slopes.push_back((line(k + half) - line(k)) / static_cast<double>(starts[k + half] - starts[k]));
      from = end;
      i = end + kBefore / 2;
    }
    if (slopes.empty()) break;
    ns = middle_of(std::move(slopes));
  }
  // Missing packets make the slope too long, by their share.
  constexpr double kMostLost = 0.2, kShorter = 0.02;
  return ns > (1 - kMostLost) * slope && ns < (1 + kShorter) * slope ? ns : slope;
}

/// Rows arrive in packets, or many share the stamp of a coarse clock. Those that are missing are told one by one.
StampModel in_packets(const std::vector<std::int64_t>& stamps, const FirstSteps& steps,
                      const std::vector<std::size_t>& starts, StampModel model) {
  if (const double interval = packet_interval(steps, starts); interval > 0) model.ns = interval;
  const std::size_t alike = rows_of_packets(starts);
  model.packets = {alike > 0 ? static_cast<double>(alike) : mean_rows(starts), alike > 0};
  if (alike > 0) {
    // However late they are, the line through all is that of their rate; where some are missing it is a start.
    // Of a link that stalls the line lacks the stalls, which were taken for pauses.
    constexpr double kStalls = 0.05;
    const double slope = line_through(steps.line).slope;
    if (keeps_to_a_line(steps) && std::fabs(slope - model.ns) < kStalls * model.ns) model.ns = slope;
    model.ns = interval_of_alike(steps, starts, alike, model.ns);
    model.longest_step = kNewPacket * model.packets.rows * model.ns;
    return model;
  }
  // Where the link stalls, the rows of the pause come at once behind it.
  model.ns = interval_of_unlike(steps_of(stamps, false), starts, model.ns);
  model.longest_step = std::max(model.ns, kNewPacket * step_of_half_the_time(steps));
  return model;
}

/// A host puts its time on the first row of a packet, and the rows behind it stand an interval apart: packets alike,
/// even inside, whose first rows scatter about one line by less than a packet, forth and back.
std::optional<StampModel> even_packets(const std::vector<std::int64_t>& stamps) {
  constexpr std::size_t kLeastRows = 4, kFew = 4;
  constexpr double kEven = 0.05, kFar = 0.5, kOther = 0.01, kEarly = 0.15, kScatter = 0.05, kWithin = 4;
  std::vector<double> steps;
  for (std::size_t i = 1; i < stamps.size(); ++i) steps.push_back(step_between(stamps[i - 1], stamps[i]));
  double ns = middle_of(steps);
  if (!(ns > 0)) return std::nullopt;
  double time = 0, count = 0;
  std::vector<std::size_t> starts;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (std::fabs(steps[i] - ns) > kEven * ns) {
      starts.push_back(i + 1);
      continue;
    }
    time += steps[i];
    ++count;
  }
  const std::size_t rows = std::max(rows_of_packets(starts), rows_of_packets(starts, kFew, 1));
  if (rows < kLeastRows) return std::nullopt;
  ns = time / count;
  const double inside = ns;
  std::vector<double> off;
  double early = 0, apart = 0, between = 0;
  for (int round = 0; round < 3; ++round) {
    apart = between = 0;
    off.clear();
    early = 0;
    for (std::size_t i = 1; i < starts.size(); ++i) {
      const auto n = static_cast<double>(starts[i] - starts[i - 1]);
      const double step = step_between(stamps[starts[i - 1]], stamps[starts[i]]);
      if (std::fabs(step - n * ns) > kFar * static_cast<double>(rows) * ns) continue;
      apart += step;
      between += n;
      off.push_back(std::fabs(step - n * ns));
      early += steps[starts[i] - 1] < inside ? 1 : 0;
    }
    if (2 * off.size() < starts.size()) return std::nullopt;
    ns = apart / between;
  }
  const auto packets = static_cast<double>(off.size());
  const double scatter = kMadToSd / std::sqrt(2) * middle_of(std::move(off));
  if (std::fabs(ns - inside) * between <= kWithin * scatter) ns = inside;  // which is known better
  if (std::fabs(ns / inside - 1) > kOther || early < kEarly * packets || scatter < kScatter * ns) return std::nullopt;
  return StampModel{
      ns, (1 + kEven) * ns, StampPattern::packets, inside, ns, {static_cast<double>(rows), true, scatter}};
}

/// Packets of so many rows that the step between them is too rare to be a usual one: alike, several a second, and
/// written much faster than they come, or unevenly. A sensor that sleeps between bursts has longer ones, or even rows.
std::optional<StampModel> long_packets(const std::vector<std::int64_t>& stamps, std::optional<double> rate_hz) {
  constexpr double kSlowest = 2.5e9, kApart = 3;  // ns; steps
  const FirstSteps steps = steps_of(stamps, false);
  if (steps.rising.empty() || step_of_half_the_time(steps) > kSlowest) return std::nullopt;
  const double inside = middle_of(steps.rising);
  const bool faster = steps.mean > kFaster * inside, uneven = common_step(steps, false).spread > kEvenInside;
  const std::vector<std::size_t> starts = faster ? packet_starts(steps) : packet_starts(steps, kApart * inside);
  const auto rows = static_cast<double>(rows_of_packets(starts));
  const bool told = rate_hz && same_rate(1e9 / *rate_hz, inside);
  if (rows <= kLongestPacket || told || !(faster || (uneven && come_evenly(steps, starts)))) return std::nullopt;
  StampModel model;
  model.pattern = StampPattern::packets;
  model.ns = model.span_ns = steps.mean;
  model.step_ns = inside;
  model = in_packets(stamps, steps, starts, model);
  model.span_ns = model.ns;
  return model;
}

/// The model of stamps in which rows stand evenly, whatever their steps.
StampModel evenly(const FirstSteps& steps, const CommonStep& common, StampPattern pattern, double slope,
                  std::optional<double> rate_hz) {
  StampModel out{common.ns, common.longest(common.ns), StampPattern::steps, common.ns, slope};
  if (rate_hz && same_rate(1e9 / *rate_hz, common.ns)) return out;
  const bool told = rate_hz && same_rate(1e9 / *rate_hz, slope);
  out.pattern = pattern == StampPattern::disputed && told ? StampPattern::packets : pattern;
  if (out.pattern == StampPattern::disputed) return out;
  out.ns = slope;
  std::vector<double> longer = steps.rising;
  std::sort(longer.begin(), longer.end());
  const bool coarse = pattern == StampPattern::coarse;
  const double usual = coarse ? longer.back() : 1.6 * longer[longer.size() * 98 / 100];
  out.longest_step = std::max(1.5 * out.ns, 1.25 * usual);
  // Two steps on either side of the rate, none of them a gap: nothing that needs a word.
  if (coarse && steps.equal == 0 && longer.back() <= 1.5 * common.ns) out.pattern = StampPattern::steps;
  return out;
}

/// Rows that come late together, in groups of any size, and keep the rate that is told: no room for missing ones.
std::optional<StampModel> as_told(const std::vector<std::int64_t>& stamps, const FirstSteps& steps, double rate_hz) {
  constexpr double kAsTold = 3e-3, kLate = 0.5;
  const bool equal_at_times = steps.equal * 50 > stamps.size();
  if (!equal_at_times || stamps.size() <= kLeastOdd) return std::nullopt;
  std::int64_t longest_step = 0;  // pauses too
  for (std::size_t i = 1; i < stamps.size(); ++i) longest_step = std::max(longest_step, stamps[i] - stamps[i - 1]);
  const auto span = static_cast<double>(stamps.back() - stamps.front()), longest = static_cast<double>(longest_step),
             rows = static_cast<double>(stamps.size() - 1);
  if (std::fabs(span - rows * 1e9 / rate_hz) > kAsTold * span + kLate * longest) return std::nullopt;
  const double mean = span / rows;
  return StampModel{mean, std::max(1.5 * mean, 2 * longest), StampPattern::equal, mean, mean};
}

/// Steps that are multiples of a told interval, and often it alone: rows are missing, in whatever order.
std::optional<StampModel> on_told_lattice(const FirstSteps& steps, double told_ns) {
  constexpr double kOff = 0.1, kMost = 20, kAlone = 0.1;
  double time = 0, multiples = 0, alone = 0;
  for (const double step : steps.rising) {
    const double multiple = std::round(step / told_ns);
    if (multiple < 1 || multiple > kMost || std::fabs(step / told_ns - multiple) > kOff) return std::nullopt;
    time += step;
    multiples += multiple;
    alone += multiple == 1 ? 1 : 0;
  }
  if (steps.equal > 0 || alone < kAlone * static_cast<double>(steps.rising.size())) return std::nullopt;
  const double ns = time / multiples;
  return StampModel{ns, 1.5 * ns, StampPattern::steps, ns, ns};
}

StampModel model_of_one_rate(const std::vector<std::int64_t>& stamps, const FirstSteps& steps,
                             std::optional<double> rate_hz) {
  const CommonStep common = common_step(steps, equal_are_samples(steps));
  StampModel out{common.ns, common.longest(common.ns), common.equal ? StampPattern::equal : StampPattern::steps,
                 common.ns, steps.mean};
  Walk found;
  for (int i = 0; i < 8 && !common.equal; ++i) {
    found = walk(stamps, steps, out.ns, common.longest(out.ns));
    const double before = out.ns;
    if (found.rows > 0) out.ns = found.time / found.rows;
    out.longest_step = common.longest(out.ns);
    if (std::fabs(out.ns - before) <= 1e-9 * before) break;
  }
  if (stamps.size() <= kLeastOdd) return out;
  if (rate_hz && !same_rate(1e9 / *rate_hz, out.ns))
    if (const auto told = on_told_lattice(steps, 1e9 / *rate_hz)) return *told;
  const StampLine line = line_through(steps.line);
  const double lattice = lattice_of(steps);
  if (lattice > 0 && (!rate_hz || same_rate(1e9 / *rate_hz, lattice)) && !on_one_line(line, steps, lattice))
    return {lattice, 1.5 * lattice, StampPattern::steps, lattice, lattice};
  const bool often = found.gaps.size() >= kLeastOdd && found.gaps.size() * 50 > steps.line.size();
  const bool equal_at_times = steps.equal * 50 > stamps.size();
  const bool beats = beats_with_clock(line, steps, common.ns);
  if (!often && !equal_at_times && !common.equal && !beats) return out;
  constexpr std::size_t kFewPackets = 8;
  constexpr double kAllAlike = 0.98;  // else two sizes by turns, as a coarse clock makes them
  if (common.equal && rows_of_packets(packet_starts(steps), kFewPackets, kAllAlike) > 0)
    return in_packets(stamps, steps, packet_starts(steps), out);
  if (beats || on_one_line(line, steps, common.ns))
    return evenly(steps, common, StampPattern::coarse, line.slope, rate_hz);
  if (common.equal) return in_packets(stamps, steps, packet_starts(steps), out);
  if (!often && !common.tidy) out.pattern = StampPattern::equal;  // stamps that scatter by more than a step
  if (!often) return out;
  const StampPattern pattern = explanation(steps, common, found.gaps);
  if (pattern == StampPattern::steps) return out;
  const StampModel even = evenly(steps, common, pattern, line.slope, rate_hz);
  if (even.pattern != StampPattern::packets) return even;
  const StampModel packets = in_packets(stamps, steps, packet_starts(steps), even);
  return packets.packets.rows > 1 ? packets : even;
}

}  // namespace

StampModel model_of_stamps(const std::vector<std::int64_t>& stamps, std::optional<double> rate_hz) {
  const FirstSteps steps = steps_of(stamps);
  if (steps.rising.empty()) return {};
  if (auto told = rate_hz ? as_told(stamps, steps, *rate_hz) : std::nullopt) return *told;
  if (auto packets = long_packets(stamps, rate_hz)) return *packets;
  if (auto packets = even_packets(stamps)) return *packets;
  const auto change = find_rate_change(stamps);
  if (!change) return model_of_one_rate(stamps, steps, rate_hz);
  const auto at = stamps.begin() + static_cast<std::ptrdiff_t>(change->row);
  const bool later = 2 * change->row < static_cast<double>(stamps.size());
  const std::vector<std::int64_t> part(later ? at + 1 : stamps.begin(), later ? stamps.end() : at);
  return model_of_one_rate(part, steps_of(part), rate_hz);
}

bool RowsAtOnce::add(std::int64_t stamp) {
  constexpr double kShort = 0.5, kLong = 1.6;  // intervals
  const double step = step_between(before, stamp) / interval;
  before = stamp;
  ++rows;
  regular = step > kShort && step < kLong ? regular + 1 : 0;
  shorter += step <= kShort ? 1 : 0;
  return regular < kRegular && rows < kMost;
}

std::vector<std::int64_t> caught_up(const std::vector<std::int64_t>& stamps) {
  constexpr double kHung = 2.5;   // intervals
  constexpr double kMost = 0.97;  // of the rows, as far as the usual step is known
  FirstSteps steps;
  for (std::size_t i = 1; i < stamps.size(); ++i)
    if (const double step = step_between(stamps[i - 1], stamps[i]); step > 0) steps.rising.push_back(step);
  const double usual = regular_step(steps);
  std::vector<std::int64_t> out = stamps;
  std::size_t moved = 0;
  for (std::size_t first = 1; first < stamps.size(); ++first) {
    if (!(step_between(stamps[first - 1], stamps[first]) > kHung * usual)) continue;
    RowsAtOnce ahead{usual, stamps[first]};
    std::size_t end = first + 1;
    while (end < stamps.size() && ahead.add(stamps[end])) ++end;
    if (end == stamps.size() && ahead.count() > 0 && 2 * first > end) {  // cut in the middle of such rows
      out.resize(first);
      break;
    }
    if (end == stamps.size() || ahead.count() == 0) continue;
    const std::size_t last = first + ahead.count();
    const auto rows = static_cast<double>(last - first + 1);
    const double passed = step_between(stamps[first - 1], stamps[last]);
    if (passed < (kMost * rows - 1.5) * usual) continue;
    const double interval = std::min(usual, passed / rows);
    for (std::size_t row = first; row < last; ++row)
      out[row] = stamps[last] - clamped_whole<std::int64_t>(std::round(interval * static_cast<double>(last - row)));
    moved += last - first;
    first = last;
  }
  return 2 * moved < out.size() ? out : stamps;
}

std::size_t at_once_in_front(const std::vector<std::int64_t>& stamps) {
  constexpr std::size_t kFewest = 8;
  const FirstSteps steps = steps_of(stamps, false);
  if (steps.rising.empty() || stamps.size() < 2 * kFewest) return 0;
  const double usual = regular_step(steps);
  RowsAtOnce front{usual, stamps.front()};
  std::size_t end = 1;
  while (end < stamps.size() && front.add(stamps[end])) ++end;
  const std::size_t rows = front.regular < RowsAtOnce::kRegular ? 0 : front.count();
  if (rows < kFewest || kFaster * step_between(stamps.front(), stamps[rows]) > usual * static_cast<double>(rows))
    return 0;
  return rows;
}

std::optional<RateChange> find_rate_change(const std::vector<std::int64_t>& stamps) {
  const FirstSteps steps = steps_of(stamps);
  std::vector<double> rows(steps.line.size());
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = static_cast<double>(i);
  return find_rate_change(rows, steps.line);
}

std::optional<RateChange> find_rate_change(std::span<const double> rows, std::span<const double> instants) {
  constexpr std::size_t kMost = 32, kFewest = 8, kSide = 3, kPiece = 16;
  constexpr double kLeast = 0.03, kOff = 0.25;
  const std::size_t n = rows.size(), pieces = std::min(kMost, n / kPiece);
  if (pieces < kFewest) return std::nullopt;
  const auto edge = [&](std::size_t piece) { return std::min(n - 1, piece * n / pieces); };
  const auto slope = [&](std::size_t from, std::size_t to) {
    return (instants[edge(to)] - instants[edge(from)]) / (rows[edge(to)] - rows[edge(from)]);
  };
  const auto off = [&](std::size_t from, std::size_t to, double from_slope) {
    double most = 0;
    for (std::size_t i = from; i < to; ++i) most = std::max(most, std::fabs(slope(i, i + 1) - from_slope));
    return most;
  };
  std::optional<RateChange> best;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = kSide; k + 1 + kSide <= pieces; ++k) {  // piece k holds the change
    const double before = slope(0, k), after = slope(k + 1, pieces);
    const double apart = std::fabs(after - before);
    const double most = std::max(off(0, k, before), off(k + 1, pieces, after));
    if (!(apart > kLeast * std::min(before, after)) || most > kOff * apart || most / apart >= least) continue;
    least = most / apart;
    const double row =
        (instants[edge(k + 1)] - after * rows[edge(k + 1)] - (instants[edge(0)] - before * rows[edge(0)])) /
        (before - after);
    best = {std::clamp(row, rows[edge(k)], rows[edge(k + 1)]), before, after};
  }
  return best;
}

double common_lag(std::vector<double> lags) {
  const double own = lags.front();
  const std::size_t quarter = lags.size() / 4;
  std::nth_element(lags.begin(), lags.begin() + static_cast<std::ptrdiff_t>(quarter), lags.end());
  return std::min(own, lags[quarter]);
}

}  // namespace libchar
