// The activity of a block is the mean |difference| of neighbouring values, that of means of four over four blocks, both
// but for the two largest, and the median |difference| of means of sixteen over sixteen blocks. Differences see neither
// slow noise nor where the sensor
// points, absolute values mind heavy tails little, and a step is one or two of them. In a sensor at rest the logarithms
// of the activities agree but for sampling; the shortest interval that holds half of them (a quarter, an eighth) says
// where and how closely (the shorth: P. Rousseeuw and A. Leroy, Statistica Neerlandica 42, 1988).
//   in motion throughout   not even an eighth of the blocks agrees within kAgree, nor sixteen quiet ones in turn
//                          where the agreeing ones are the loud ones, rest is what is quieter by more than any change
//                          of strength
//   moving                 two and more blocks in turn above the agreeing ones by a factor of two and by six of their
//                          spreads
//   a change of strength   a step, warm-up or ramp in the logarithms, by find_events against their own noise: noise
//                          whose strength itself wanders has to change by more than that
#include "libchar/fit/signs/motion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "libchar/core/numeric/median.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/fit/record/noise_powers.hpp"
#include "libchar/fit/signs/events.hpp"

namespace libchar {
namespace {

constexpr std::size_t kFewestValues = 2048, kShortestBlock = 32, kMostBlocks = 512;
constexpr double kAgree = 0.35;  ///< standard deviation of a logarithm: sampling gives .1 to .2
constexpr double kFactor = 2;    ///< by which motion is louder than rest
constexpr double kSpreads = 6;
constexpr double kLasting = 0.1;   ///< share of a record from which on a louder stretch may be a change
constexpr double kLoudest = 4;     ///< factor up to which it is
constexpr double kSlower = 1.3;    ///< and its slow differences by no more than this beyond the fast ones
constexpr double kFaintest = 1e4;  ///< quieter by more than this: a link that hung, filled gaps
constexpr double kRepeats = 0.3;   ///< share of repeated values: a staircase, whose steps come and go
constexpr std::size_t kFewestBlocks = 64;
constexpr double kHarmless = 1.01;  ///< motion that adds less to the scatter stays inside most intervals

/// Logarithms of the activities, a block each.
struct Activity {
  std::size_t block = 0;     ///< values
  std::vector<char> unseen;  ///< blocks that were missing for the most part
  std::vector<double> fine;
  std::vector<std::vector<double>> coarse;  ///< of means of four and of sixteen
};

/// |Differences| of neighbouring means of `width` values.
std::vector<double> differences(std::span<const double> value, std::size_t width) {
  std::vector<double> difference;
  difference.reserve(value.size() / width);
  double before = 0;
  for (std::size_t i = 0; i + width <= value.size(); i += width) {
    double mean = 0;
    for (std::size_t j = i; j < i + width; ++j) mean += value[j] - value[0];
    mean /= static_cast<double>(width);
    if (i > 0) difference.push_back(std::abs(mean - before));
    before = mean;
  }
  return difference;
}

/// Their mean but for the two largest, which a step takes.
double mean_of_most(std::span<const double> difference) {
  double largest = std::max(difference[0], difference[1]), second = std::min(difference[0], difference[1]), sum = 0;
  for (const double d : difference.subspan(2)) {
    sum += std::min(d, second);  // which of the two is no longer among the largest
    second = std::clamp(d, second, largest);
    largest = std::max(d, largest);
  }
  return sum / static_cast<double>(difference.size() - 2);
}

/// `blocks` blocks around the one that begins at `from`.
std::span<const double> around(std::span<const double> value, std::size_t from, std::size_t block, std::size_t blocks) {
  const std::size_t before = std::min(from, block * blocks / 2);
  const std::size_t to = std::min(value.size(), from - before + block * blocks);
  return value.subspan(to - block * blocks, block * blocks);
}

double share_of_repeats(std::span<const double> value) {
  std::size_t repeats = 0;
  for (std::size_t i = 1; i < value.size(); ++i) repeats += value[i] == value[i - 1] ? 1 : 0;
  return static_cast<double>(repeats) / static_cast<double>(value.size());
}

/// Logarithms; a block that stands quite still (bridged, or a stuck sensor) has some activity all the same.
void take_logarithms(std::vector<double>& activity) {
  const double floor = std::max(*std::max_element(activity.begin(), activity.end()) * 1e-6, 1e-300);
  for (double& a : activity) a = std::log(std::max(a, floor));
}

Activity activity_of(std::span<const double> value) {
  Activity activity;
  activity.block = std::max(kShortestBlock, value.size() / kMostBlocks);
  activity.coarse.resize(2);
  const std::size_t block = activity.block;
  for (std::size_t i = 0; i + block <= value.size(); i += block) {
    activity.fine.push_back(mean_of_most(differences(value.subspan(i, block), 1)));
    activity.coarse[0].push_back(mean_of_most(differences(around(value, i, block, 4), 4)));
    std::vector<double> slow = differences(around(value, i, block, 16), 16);
    activity.coarse[1].push_back(median_in_place(slow, Middle::upper));
  }
  take_logarithms(activity.fine);
  for (std::vector<double>& coarse : activity.coarse) take_logarithms(coarse);
  return activity;
}

struct Agreeing {
  double centre = 0, spread = 0;
};

/// The shortest interval that holds a share of the values, as centre and standard deviation of a normal distribution.
Agreeing shortest_half(const std::vector<double>& sorted, double share, double width_of_normal) {
  const auto count = static_cast<std::size_t>(share * static_cast<double>(sorted.size()));
  Agreeing best{0, std::numeric_limits<double>::infinity()};
  for (std::size_t i = 0; i + count < sorted.size(); ++i) {
    const double width = sorted[i + count] - sorted[i];
    if (width / width_of_normal < best.spread) best = {0.5 * (sorted[i + count] + sorted[i]), width / width_of_normal};
  }
  return best;
}

/// Where less than half of a record is still: the quietest sixteen blocks in turn that agree and are no `filled` ones,
/// if they are quieter than most by a factor.
std::optional<Agreeing> quiet_window(std::span<const double> values, const std::vector<char>& filled, double median,
                                     double factor) {
  constexpr std::ptrdiff_t kWindow = 16;
  constexpr double kSteady = 0.2;
  std::optional<Agreeing> quietest;
  for (std::size_t i = 0; i + kWindow <= values.size(); ++i) {
    const auto first = filled.begin() + static_cast<std::ptrdiff_t>(i);
    if (std::find(first, first + kWindow, 1) != first + kWindow) continue;
    double sum = 0, squares = 0;
    for (const double a : values.subspan(i, kWindow)) {
      sum += a - median;
      squares += (a - median) * (a - median);
    }
    const double mean = sum / kWindow, spread = std::sqrt(std::max(0.0, squares / kWindow - mean * mean));
    if (spread > kSteady || mean > -std::log(factor)) continue;
    if (!quietest || median + mean < quietest->centre) quietest = {median + mean, spread};
  }
  return quietest;
}

std::optional<Agreeing> agreeing(const std::vector<double>& values, const std::vector<char>& filled,
                                 const std::vector<char>& unseen) {
  std::vector<double> sorted;
  for (std::size_t b = 0; b < values.size(); ++b)
    if (unseen[b] == 0) sorted.push_back(values[b]);
  if (sorted.size() < 8) return std::nullopt;
  std::sort(sorted.begin(), sorted.end());
  // 2 z((1 + share) / 2)
  for (const auto& [share, width] : {std::pair{0.5, 1.349}, {0.25, 0.6373}, {0.125, 0.3145}}) {
    const Agreeing half = shortest_half(sorted, share, width);
    if (half.spread > kAgree) continue;
    const auto quieter = quiet_window(values, filled, half.centre, kLoudest);
    return quieter && quieter->centre > half.centre - std::log(kFaintest) ? quieter : half;
  }
  return quiet_window(values, filled, sorted[sorted.size() / 2], kFactor);
}

/// Blocks above the agreeing ones, and those beside them that are half as far above.
std::vector<char> louder(const std::vector<double>& values, const Agreeing& rest) {
  constexpr int kBeside = 1;  // coarse activities reach farther than what they are of
  const double far = std::max(std::log(kFactor), kSpreads * rest.spread);
  const auto above = [&](std::size_t b, double by) { return values[b] > rest.centre + by; };
  std::vector<char> out(values.size());
  for (std::size_t b = 0; b < out.size(); ++b) out[b] = above(b, far) ? 1 : 0;
  for (int round = 0; round < kBeside; ++round) {
    const std::vector<char> before = out;
    for (std::size_t b = 0; b < out.size(); ++b) {
      const bool beside = (b > 0 && before[b - 1] != 0) || (b + 1 < out.size() && before[b + 1] != 0);
      if (beside && above(b, far / 2)) out[b] = 1;
    }
  }
  return out;
}

struct Run {
  std::size_t from = 0, to = 0;  ///< blocks from..to-1
  std::size_t length() const { return to - from; }
};

std::vector<Run> runs_of(const std::vector<char>& in, char which) {
  std::vector<Run> runs;
  for (std::size_t b = 0; b < in.size(); ++b) {
    if (in[b] != which) continue;
    Run run{b, b};
    while (run.to < in.size() && in[run.to] == which) ++run.to;
    runs.push_back(run);
    b = run.to;
  }
  return runs;
}

/// A stretch that is louder by a little and steadily so, and not the slower the louder: noise that grows does so at
/// every width, a hand moves the means of many values most.
bool lasting(const Activity& activity, const Run& run, const std::vector<double>& centre) {
  if (static_cast<double>(run.length()) < kLasting * static_cast<double>(activity.fine.size())) return false;
  double fine = 0;
  for (std::size_t a = 0; a < centre.size(); ++a) {
    const std::vector<double>& logs = a == 0 ? activity.fine : activity.coarse[a - 1];
    const auto first = logs.begin() + static_cast<std::ptrdiff_t>(run.from);
    std::vector<double> sorted(first, first + static_cast<std::ptrdiff_t>(run.length()));
    std::sort(sorted.begin(), sorted.end());
    const double above = sorted[sorted.size() / 2] - centre[a];
    if (a == 0) fine = above;
    if (above > std::min(std::log(kLoudest), fine + std::log(kSlower))) return false;
    if (a == 0 && shortest_half(sorted, 0.8, 2.563).spread > kAgree) return false;
  }
  return true;
}

/// Moving blocks: a single quiet one between two is one, a single loud one is none, and what is louder throughout a
/// long stretch is a change of strength.
void tidy(const Activity& activity, const std::vector<double>& centre, std::vector<char>& moving) {
  for (const Run& run : runs_of(moving, 0))
    if (run.length() == 1 && run.from > 0 && run.to < moving.size()) moving[run.from] = 1;
  for (const Run& run : runs_of(moving, 1)) {
    if (run.length() < 2 || lasting(activity, run, centre))
      std::fill_n(moving.begin() + static_cast<std::ptrdiff_t>(run.from), run.length(), 0);
  }
  // The blocks beside hold the beginning and the end.
  for (const Run& run : runs_of(moving, 1)) {
    if (run.from > 0) moving[run.from - 1] = 1;
    if (run.to < moving.size()) moving[run.to] = 1;
  }
}

/// Blocks that are smoother than noise: lines drawn through gaps, whose differences are all alike.
std::vector<char> filled_blocks(const Activity& activity) {
  std::vector<char> filled(activity.fine.size());
  for (std::size_t b = 0; b < filled.size(); ++b)
    filled[b] = activity.unseen[b] != 0 || activity.coarse[0][b] > activity.fine[b] + std::log(kFactor) ? 1 : 0;
  return filled;
}

/// Blocks that move, by any of the activities; none where no activity agrees with itself.
std::optional<std::vector<char>> moving_blocks(const Activity& activity) {
  const std::vector<char> filled = filled_blocks(activity);
  const std::optional<Agreeing> fine = agreeing(activity.fine, filled, activity.unseen);
  if (!fine) return std::nullopt;
  std::vector<char> moving = louder(activity.fine, *fine);
  std::vector<double> centre = {fine->centre};
  for (const std::vector<double>& coarse : activity.coarse) {
    const std::optional<Agreeing> rest = agreeing(coarse, filled, activity.unseen);
    if (!rest) return std::nullopt;
    const std::vector<char> slowly = louder(coarse, *rest);
    centre.push_back(rest->centre);
    for (std::size_t b = 0; b < moving.size(); ++b) moving[b] |= slowly[b];
  }
  tidy(activity, centre, moving);
  return moving;
}

/// Steps and drifts of the logarithms of what does not move.
std::vector<StrengthChange> changes_of(const Activity& activity, const std::vector<char>& moving, double start_s,
                                       double block_s) {
  // Without scatter there is nothing to judge a change by: a counter, a signal from a formula.
  std::vector<double> sorted = activity.fine;
  std::sort(sorted.begin(), sorted.end());
  if (shortest_half(sorted, 0.5, 1.349).spread < 1e-6) return {};
  EventSeries logarithms{activity.fine, start_s, block_s, 1, {}};
  std::vector<char> left_out = moving;
  for (std::size_t b = 0; b < left_out.size(); ++b) left_out[b] |= activity.unseen[b];
  for (const Run& run : runs_of(left_out, 1)) {
    const double before = run.from > 0 ? activity.fine[run.from - 1] : activity.fine[run.to % left_out.size()];
    const double after = run.to < left_out.size() ? activity.fine[run.to] : before;
    for (std::size_t b = run.from; b < run.to; ++b)
      logarithms.value[b] =
          before + (after - before) * static_cast<double>(b - run.from + 1) / static_cast<double>(run.length() + 1);
    logarithms.unseen_s.push_back(
        {start_s + static_cast<double>(run.from) * block_s, start_s + static_cast<double>(run.to) * block_s});
  }
  std::vector<StrengthChange> changes;
  EventOptions how;
  how.cycle = false;
  for (const Event& event : find_events(logarithms, fitted_powers(), how).events)
    changes.push_back({event.kind,
                       event.at_s,
                       {event.at_ci95.low - block_s, event.at_ci95.high + block_s},
                       std::exp(event.size),
                       {std::exp(event.size - kNormal95 * event.sd), std::exp(event.size + kNormal95 * event.sd)},
                       event.score,
                       event.threshold});
  return changes;
}

std::string change_sentence(const StrengthChange& change) {
  const std::string factor =
      fmt::format("{} times as strong ({} to {})", number_text(change.factor, 3),
                  number_text(change.factor_ci95.low, 3), number_text(change.factor_ci95.high, 3));
  if (change.kind == EventKind::step)
    return fmt::format("The noise is {} from {} on.", factor, detail::place_and_interval(change.at_s, change.at_ci95));
  if (change.kind == EventKind::ramp)
    return fmt::format("The noise changes little by little: at the end it is {}.", factor);
  return fmt::format("The noise settles: at the beginning it is {}.", factor);
}

void describe(Motion& motion, double duration_s) {
  if (motion.whole) {
    motion.findings.push_back(
        finding("moves_throughout",
                "The recording changes throughout (motion, if the sensor is inertial): it is a signal, not noise."));
    return;
  }
  if (!motion.moving_s.empty()) {
    double moving = 0;
    for (const Interval& stretch : motion.moving_s) moving += stretch.high - stretch.low;
    const std::size_t count = motion.moving_s.size();
    Finding moved =
        finding("motion",
                fmt::format("The sensor was moved or shaken in {} stretch{} ({} of {}), the first from {} to {} s; the "
                            "longest still stretch is {} to {} s.",
                            motion.moving_s.size(), motion.moving_s.size() == 1 ? "" : "es", duration_text(moving),
                            duration_text(duration_s), place_text(motion.moving_s[0].low),
                            place_text(motion.moving_s[0].high), place_text(motion.still_s ? motion.still_s->low : 0),
                            place_text(motion.still_s ? motion.still_s->high : 0)),
                fmt::format("moved or shaken in {}", count == 1 ? "a stretch" : fmt::format("{} stretches", count)));
    moved.count = count;
    moved.where.time_s = motion.moving_s;
    if (motion.louder > kHarmless) {
      moved.severity = Severity::bad;
      moved.effects = {{Affected::mean}, {Affected::noise, Direction::too_large, motion.louder}};
    }
    moved.help.push_back({"Use the longest still stretch.", {{"still", "auto"}}});
    motion.findings.push_back(std::move(moved));
  }
  if (motion.changes.empty()) return;
  const StrengthChange& first = motion.changes[0];
  Finding changed = finding("strength_change", "",
                            motion.changes.size() == 1
                                ? fmt::format("the noise is {} times as strong from {} s on", brief_text(first.factor),
                                              place_text(first.at_s))
                                : fmt::format("the noise changes its strength {} times", motion.changes.size()));
  for (const StrengthChange& change : motion.changes) {
    changed.sentence += (changed.sentence.empty() ? "" : " ") + change_sentence(change);
    changed.where.time_s.push_back(change.at_ci95);
  }
  changed.count = motion.changes.size();
  motion.findings.push_back(std::move(changed));
}

/// Blocks that were missing for more than half.
std::vector<char> unseen_blocks(const EventSeries& series, std::size_t blocks, double block_s) {
  std::vector<double> missing_s(blocks, 0);
  for (const Interval& gap : series.unseen_s) {
    const double from = std::max(0.0, gap.low - series.start_s), to = gap.high - series.start_s;
    for (auto b = static_cast<std::size_t>(from / block_s); b < blocks; ++b) {
      const double begin = static_cast<double>(b) * block_s;
      if (begin >= to) break;
      missing_s[b] += std::min(to, begin + block_s) - std::max(from, begin);
    }
  }
  std::vector<char> unseen(blocks);
  for (std::size_t b = 0; b < blocks; ++b) unseen[b] = 2 * missing_s[b] > block_s ? 1 : 0;
  return unseen;
}

/// What motion adds to the scatter of all blocks, by what the still ones have.
double louder_by_motion(const Activity& activity, const std::vector<char>& moving) {
  double most = 1;
  for (const std::vector<double>* logs : {&activity.fine, &activity.coarse[0], &activity.coarse[1]}) {
    double all = 0, still = 0, count = 0;
    for (std::size_t b = 0; b < moving.size(); ++b) {
      const double power = std::exp(2 * (*logs)[b]);
      all += power;
      if (moving[b] != 0) continue;
      still += power;
      ++count;
    }
    if (count > 0 && still > 0)
      most = std::max(most, std::sqrt(all / static_cast<double>(moving.size()) * count / still));
  }
  return most;
}

/// Where the noise is stronger than where it is weakest, between its steps.
std::vector<Interval> louder_between(const std::vector<StrengthChange>& changes, double from_s, double to_s) {
  struct Piece {
    Interval at_s;
    double level = 0, half = 0;  ///< logarithms, against the first piece
  };
  std::vector<Piece> pieces = {{{from_s, to_s}}};
  std::vector<const StrengthChange*> steps;
  for (const StrengthChange& change : changes)
    if (change.kind == EventKind::step) steps.push_back(&change);
  std::sort(steps.begin(), steps.end(), [](const auto* a, const auto* b) { return a->at_s < b->at_s; });
  for (const StrengthChange* step : steps) {
    const Piece& before = pieces.back();
    const double half = std::log(step->factor_ci95.high / step->factor);
    const Piece after = {{step->at_s, to_s}, before.level + std::log(step->factor), std::hypot(before.half, half)};
    pieces.back().at_s.high = step->at_s;
    pieces.push_back(after);
  }
  const Piece* base = nullptr;
  for (const Piece& piece : pieces)
    if (piece.at_s.high - piece.at_s.low >= kLasting * (to_s - from_s) &&
        (base == nullptr || piece.level < base->level))
      base = &piece;
  std::vector<Interval> louder;
  for (std::size_t i = 0; base != nullptr && i < pieces.size(); ++i) {
    const double half = std::sqrt(std::abs(pieces[i].half * pieces[i].half - base->half * base->half));
    if (pieces[i].level - base->level <= half) continue;
    louder.push_back({i == 0 ? from_s : steps[i - 1]->at_ci95.low, i == steps.size() ? to_s : steps[i]->at_ci95.high});
  }
  return louder;
}

}  // namespace

Interval detail::longest_between(std::vector<Interval> restless, const Interval& all_s) {
  std::sort(restless.begin(), restless.end(), [](const Interval& a, const Interval& b) { return a.low < b.low; });
  Interval best{all_s.low, all_s.low};
  double from = all_s.low;
  const auto offer = [&](double to) {
    if (to - from > best.high - best.low) best = {from, to};
  };
  for (const Interval& stretch : restless) {
    offer(stretch.low);
    from = std::max(from, stretch.high);
  }
  offer(all_s.high);
  return best;
}

Motion find_motion(const EventSeries& series) {
  Motion motion;
  const double duration_s = static_cast<double>(series.value.size()) * series.step_s;
  if (series.value.size() < kFewestValues || share_of_repeats(series.value) > kRepeats) return motion;
  motion.tested = true;
  Activity activity = activity_of(series.value);
  const double block_s = static_cast<double>(activity.block) * series.step_s;
  activity.unseen = unseen_blocks(series, activity.fine.size(), block_s);
  const std::optional<std::vector<char>> moving = moving_blocks(activity);
  motion.whole = !moving;
  if (moving) {
    for (const Run& run : runs_of(*moving, 1))
      motion.moving_s.push_back({series.start_s + static_cast<double>(run.from) * block_s,
                                 series.start_s + static_cast<double>(run.to) * block_s});
    motion.louder = louder_by_motion(activity, *moving);
    const auto still = static_cast<std::size_t>(std::count(moving->begin(), moving->end(), 0));
    if (still >= std::max(kFewestBlocks, moving->size() / 4))
      motion.changes = changes_of(activity, *moving, series.start_s, block_s);
    const double end_s = series.start_s + duration_s;
    motion.louder_s = louder_between(motion.changes, series.start_s, end_s);
    std::vector<Interval> restless = motion.moving_s;
    restless.insert(restless.end(), motion.louder_s.begin(), motion.louder_s.end());
    const Interval longest = detail::longest_between(std::move(restless), {series.start_s, end_s});
    if (longest.high > longest.low) motion.still_s = longest;
  }
  describe(motion, duration_s);
  return motion;
}

}  // namespace libchar
