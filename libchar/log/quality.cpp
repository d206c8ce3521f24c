#include "libchar/log/quality.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <optional>
#include <tuple>

#include "libchar/core/numeric/lanes.hpp"
#include "libchar/core/numeric/median.hpp"
#include "libchar/core/numeric/present.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/detail/line_watch.hpp"
#include "libchar/log/detail/run_exits.hpp"

namespace libchar {
namespace {

constexpr std::size_t kBlock = 2048;  // stays in the first-level cache while it is looked at twice
constexpr std::size_t kDistinct = 4096;
constexpr std::uint64_t kSaturatedRun = 3;

// The first kDistinct different values, in a table of open addressing that grows with them (a log
// of many channels and few rows needs little); NaN marks an empty slot.
class DistinctValues {
 public:
  bool full() const { return values_.size() == kDistinct; }
  const std::vector<double>& values() const { return values_; }

  void add(double value) {
    value += 0.0;                                                       // -0 and +0 are one value
    if (!slots_.empty() && slots_[first_slot(value)] == value) return;  // nearly all of a coarse channel
    if (2 * values_.size() >= slots_.size()) grow();
    double& slot = slot_of(value);
    if (!std::isnan(slot)) return;
    slot = value;
    values_.push_back(value);
  }

  static void layout(StateWriter& to, const DistinctValues& values) { to.reals(values.values_); }
  static void layout(StateReader& from, DistinctValues& values) {
    const std::vector<double> distinct = from.reals();
    if (distinct.size() > kDistinct) from.refuse("more distinct values than are kept");
    for (const double value : distinct) {
      if (!std::isfinite(value)) from.refuse("a distinct value");
      values.add(value);
    }
  }

 private:
  static constexpr int kLeastBits = 4;

  std::size_t first_slot(double value) const {
    return detail::in_memory((std::bit_cast<std::uint64_t>(value) * 0x9E3779B97F4A7C15U) >> (64 - bits_));
  }
  double& slot_of(double value) {
    std::size_t slot = first_slot(value);
    while (slots_[slot] != value && !std::isnan(slots_[slot])) slot = (slot + 1) % slots_.size();
    return slots_[slot];
  }
  void grow() {
    bits_ = slots_.empty() ? kLeastBits : bits_ + 1;
    slots_.assign(std::size_t{1} << bits_, kMissing);
    for (const double value : values_) slot_of(value) = value;
  }

  int bits_ = 0;
  std::vector<double> slots_;
  std::vector<double> values_;
};

// Samples at one extreme (sign = +1: the maximum, -1: the minimum) and at the value next to it. It is an end of the
// range when three and more stand in a row, and it has more than twice as many as its neighbour, which the tail of a
// coarsely rounded signal has not: then all of them are saturated.
struct Extreme {
  static constexpr double kNines[] = {9, 99, 999, 9999, 99999, 999.9, 9999.9};
  double sign = 1, value = -__builtin_inf(), next = -__builtin_inf(), third = -__builtin_inf();
  std::uint64_t run = 0, count = 0, at_next = 0;
  bool runs = false;

  /// `slow`: changes by a step or so from sample to sample. The top of a smooth peak then has up to 2.4 times as many.
  std::uint64_t saturated(bool slow = false) const { return runs && count > (slow ? 6 : 2) * at_next ? count : 0; }
  /// -1 and numbers of nines alone: what loggers write for no reading; all bits of a word, read from a bus in error.
  bool is_usual_mark() const {
    const double written = sign * value;
    int bits = 0;
    const bool all_bits = written >= 32767 && std::frexp(written + 1, &bits) == 0.5;
    return written == -1 || all_bits ||
           std::any_of(std::begin(kNines), std::end(kNines), [&](double nines) { return std::fabs(written) == nines; });
  }
  /// Stands often, and further from the next value than all others are apart (`others`: their range): no tail of a
  /// noise gives one value again and again out there, nor does a range that ends. Half as far for a usual mark.
  bool is_mark(double others) const {
    constexpr std::uint64_t kFewest = 3, kOfUsual = 10;
    constexpr double kApart = 3, kUsual = 0.5;
    if (count < kFewest || !(others > 0)) return false;
    return value - next > (count >= kOfUsual && is_usual_mark() ? kUsual : kApart) * others;
  }
  /// Values of the last two steps lie on the way to it, again and again.
  bool is_reached(double step) const {
    constexpr std::uint64_t kAgain = 10;
    return at_next >= kAgain && value - next <= 2 * step;
  }
  /// The next value is nearer than chance brings one of so many samples: a signal without noise that rests there.
  bool is_rest(double difference_sd, double samples) const {
    constexpr double kNear = 1e-3;
    return value - next < kNear * difference_sd / samples;
  }
  /// Nothing lies on the way to it: a range that ends is reached through what is below.
  bool is_apart(double others) const { return saturated() > 0 && value - next > 0.5 * others; }
  /// Two marks side by side; `others`: the range of what is neither.
  bool are_marks(double others) const {
    constexpr std::uint64_t kFewest = 3;
    constexpr double kApart = 3;
    return count + at_next >= 2 * kFewest && count >= kFewest && at_next >= kFewest && others > 0 &&
           next - third > kApart * others;
  }
  void block(const double* x, std::size_t n, double block_extreme) {
    if (sign * block_extreme < third) {  // nothing here reaches it: nearly every block of noise
      run = 0;
      return;
    }
    for (std::size_t i = 0; i < n; ++i) step(sign * x[i]);
  }
  void step(double v) {
    if (v > value) {
      third = next;
      next = value;
      at_next = count;
      value = v;
      run = count = 0;
      runs = false;
    } else if (v > next && v < value) {
      third = next;
      next = v;
      at_next = 0;
    } else if (v > third && v < next) {
      third = v;
    }
    at_next += v == next ? 1 : 0;
    run = v == value ? run + 1 : 0;
    count += v == value ? 1 : 0;
    runs = runs || run >= kSaturatedRun;
  }
  /// `lead`: so many samples at the front of the later part are its extreme; `all`: it has no others.
  void join(const Extreme& later, std::uint64_t lead, bool all) {
    const Extreme before = *this;
    const auto of = [](const Extreme& e, double v) { return v == e.value ? e.count : v == e.next ? e.at_next : 0; };
    value = std::max(before.value, later.value);
    const auto largest_below = [&](double limit) {
      double found = -__builtin_inf();
      for (const Extreme* e : {&before, &later})
        for (const double v : {e->value, e->next, e->third})
          if (v < limit) found = std::max(found, v);
      return found;
    };
    next = largest_below(value);
    third = largest_below(next);
    count = of(before, value) + of(later, value);
    at_next = next > -__builtin_inf() ? of(before, next) + of(later, next) : 0;
    const std::uint64_t in_front = before.value == value ? before.run : 0;
    const std::uint64_t behind = later.value == value ? lead : 0;
    runs = (before.value == value && before.runs) || (later.value == value && later.runs) ||
           in_front + behind >= kSaturatedRun;
    run = later.value < value ? 0 : all ? in_front + later.run : later.run;
  }
  static void layout(auto& at, auto& end) {
    at(end.value, end.next);
    at(end.third);
    at.group("an end of the range", end.run, end.count, end.at_next);
    at(end.runs);
  }
};

double fold(const Four& lane) { return (lane[0] + lane[2]) + (lane[1] + lane[3]); }

/// What one look at a block gives.
struct BlockSums {
  double sum = 0, squares = 0;            // of x - shift
  double low = 0, high = 0;               // extremes
  double jump = 0;                        // largest |x - before|
  double s1 = 0, s2 = 0, s3 = 0, s4 = 0;  // sums of powers of x - before
  bool repeats = false;                   // some difference is zero
  double nearest = 0;                     // least |x|
  double bends = 0;                       // squares of differences of x - before
  std::uint32_t lines = 0;                // bits of stretches that may have two samples side by side on a line
};

constexpr std::size_t kStretch = detail::LineWatch::kStretch;
static_assert(kBlock <= 32 * kStretch);

LIBCHAR_LANES double least_of(Four lane) { return std::min({lane[0], lane[1], lane[2], lane[3]}); }
LIBCHAR_LANES double largest_of(Four lane) { return std::max({lane[0], lane[1], lane[2], lane[3]}); }

/// Sums over x[0..n) and over the differences x[i] - before[i]. Four lanes: the same bits at every vector width. All
/// that findings need of every sample is here as well: a second look would cost as much as this one.
LIBCHAR_LANES BlockSums sums_of_lanes(const double* x, const double* before, std::size_t n, double shift) {
  Four sum = {}, squares = {}, a1 = {}, a2 = {}, a3 = {}, a4 = {}, bends = {}, top = {}, last = {};
  Four low = {x[0], x[0], x[0], x[0]}, high = low;
  Four least = low * 0 + __builtin_inf(), near = least;
  auto straight = low != low;  // none yet
  std::uint32_t lines = 0;
  const std::size_t whole = n - n % 4;
  for (std::size_t from = 0; from < whole; from += kStretch) {
    auto pairs = low != low;
    for (std::size_t i = from; i < std::min(from + kStretch, whole); i += 4) {
      const Four v = LIBCHAR_FOUR(x + i), d = v - LIBCHAR_FOUR(before + i), q = d * d;
      const Four off = v - shift, size = v < 0.0 ? -v : v;
      sum += off;
      squares += off * off;
      low = v < low ? v : low;
      high = v > high ? v : high;
      near = size < near ? size : near;
      least = q < least ? q : least;
      top = q > top ? q : top;
      a1 += d;
      a2 += q;
      a3 += q * d;
      a4 += q * q;
      const Four ahead = __builtin_shufflevector(last, d, 3, 4, 5, 6), bend = d - ahead;
      const Four bend2 = bend * bend;
      bends += bend2;
      const auto flag = bend2 < detail::kAboutStraight * (ahead * ahead);
      pairs |= flag & __builtin_shufflevector(straight, flag, 3, 4, 5, 6);
      straight = flag;
      last = d;
    }
    lines |= ((pairs[0] | pairs[1] | pairs[2] | pairs[3]) != 0 ? 1U : 0U) << (from / kStretch);
  }
  double step = last[3];
  bool beside = straight[3] != 0;
  for (std::size_t i = whole; i < n; ++i) {
    const double v = x[i], d = v - before[i], q = d * d, bend = d - step;
    const std::size_t k = i % 4;
    const bool flag = bend * bend < detail::kAboutStraight * (step * step);
    lines |= (flag && beside ? 1U : 0U) << (i / kStretch);
    beside = flag;
    bends[k] += bend * bend;
    step = d;
    sum[k] += v - shift;
    squares[k] += (v - shift) * (v - shift);
    low[k] = std::min(low[k], v);
    high[k] = std::max(high[k], v);
    near[k] = std::min(near[k], std::fabs(v));
    least[k] = std::min(least[k], q);
    top[k] = std::max(top[k], q);
    a1[k] += d;
    a2[k] += q;
    a3[k] += q * d;
    a4[k] += q * q;
  }
  return {fold(sum),      fold(squares), least_of(low), largest_of(high), std::sqrt(largest_of(top)),
          fold(a1),       fold(a2),      fold(a3),      fold(a4),         least_of(least) == 0,
          least_of(near), fold(bends),   lines};
}
constexpr InLanes<sums_of_lanes> sums_of;

// Or beyond what is a measurement.
LIBCHAR_LANES bool any_missing_lanes(const double* x, std::size_t n) {
  Four sum = {};
  auto missing = sum != sum;
  const std::size_t whole = n - n % 4;
  for (std::size_t i = 0; i < whole; i += 4) {
    const Four v = LIBCHAR_FOUR(x + i);
    missing |= !(v <= kLargestSample && v >= -kLargestSample);
  }
  bool any = (missing[0] | missing[1] | missing[2] | missing[3]) != 0;
  for (std::size_t i = whole; i < n; ++i) any |= !(std::fabs(x[i]) <= kLargestSample);
  return any;
}
constexpr InLanes<any_missing_lanes> any_missing;

/// Bits of x[i] that equal before[i], 64 in each word.
LIBCHAR_LANES void equal_bits_lanes(const double* x, const double* before, std::size_t n, std::uint64_t* words) {
  const std::size_t whole = n - n % 64;
  for (std::size_t i = 0; i < whole; i += 64) {
    auto bit = LIBCHAR_FOUR(x) != LIBCHAR_FOUR(x), all = bit;
    bit = decltype(bit){1, 2, 4, 8};
    all = bit ^ bit;
    for (std::size_t k = 0; k < 64; k += 4) {
      all |= (LIBCHAR_FOUR(x + i + k) == LIBCHAR_FOUR(before + i + k)) & bit;
      bit <<= 4;
    }
    words[i / 64] = static_cast<std::uint64_t>(all[0] | all[1] | all[2] | all[3]);
  }
  if (whole < n) words[whole / 64] = 0;
  for (std::size_t i = whole; i < n; ++i) words[i / 64] |= std::uint64_t{x[i] == before[i]} << (i % 64);
}
constexpr InLanes<equal_bits_lanes> equal_bits;

struct Zeros {
  std::uint64_t count;
  double nearest;  ///< least |x| of the others
};

LIBCHAR_LANES Zeros zeros_of_lanes(const double* x, std::size_t n) {
  Four near = Four{} + __builtin_inf();
  auto zeros = near != near;  // counted down
  const std::size_t whole = n - n % 4;
  for (std::size_t i = 0; i < whole; i += 4) {
    const Four v = LIBCHAR_FOUR(x + i), size = v < 0.0 ? -v : v;
    zeros += v == 0.0;
    near = ((size < near) & (v != 0.0)) ? size : near;
  }
  for (std::size_t i = whole; i < n; ++i) {
    zeros[0] -= x[i] == 0 ? 1 : 0;
    near[0] = x[i] != 0 ? std::min(near[0], std::fabs(x[i])) : near[0];
  }
  return {static_cast<std::uint64_t>(-(zeros[0] + zeros[1] + zeros[2] + zeros[3])), least_of(near)};
}
constexpr InLanes<zeros_of_lanes> zeros_of;

LIBCHAR_LANES bool any_beyond_float_lanes(const double* x, std::size_t n) {
  using Singles = float __attribute__((vector_size(16)));
  auto wide = Four{} != Four{};
  const std::size_t whole = n - n % 4;
  for (std::size_t i = 0; i < whole; i += 4) {
    const Four v = LIBCHAR_FOUR(x + i);
    wide |= __builtin_convertvector(__builtin_convertvector(v, Singles), Four) != v;
  }
  bool any = (wide[0] | wide[1] | wide[2] | wide[3]) != 0;
  for (std::size_t i = whole; i < n; ++i) any |= static_cast<double>(static_cast<float>(x[i])) != x[i];
  return any;
}
constexpr InLanes<any_beyond_float_lanes> any_beyond_float;

// Mean and variance only: sums about the block's first value, blocks merged by Chan's formula (core/moments.hpp has all
// four moments at three times the cost, which a meter that runs on every sample need not pay).
struct MeanAndSpread {
  double origin = 0;  // the first value: the mean is kept less that, so that an offset costs no digits
  double n = 0, mean = 0, m2 = 0;

  // The first value is one of the block, so that its own deviation is at least 1/count of what cancels here.
  void block(double first, std::size_t count, const BlockSums& sums) {
    if (n == 0) origin = first;
    const double other = static_cast<double>(count), total = n + other, offset = sums.sum / other,
                 d = (first - origin) + offset - mean;
    m2 += std::max(0.0, sums.squares - offset * sums.sum) + d * d * n * other / total;
    mean += d * other / total;
    n = total;
  }
  void join(const MeanAndSpread& later) {
    const double total = n + later.n, d = (later.origin - origin) + (later.mean - mean);
    m2 += later.m2 + d * d * n * later.n / total;
    mean += d * later.n / total;
    n = total;
  }
};

// Raw moments of differences: their mean is next to nothing beside their spread, except for counters.
struct DifferenceMoments {
  double n = 0, s1 = 0, s2 = 0, s3 = 0, s4 = 0;
  double bends = 0;  // squares of their own differences

  void add(const BlockSums& block) {
    bends += block.bends;
    s1 += block.s1;
    s2 += block.s2;
    s3 += block.s3;
    s4 += block.s4;
  }
  void join(const DifferenceMoments& later) {
    n += later.n;
    bends += later.bends;
    s1 += later.s1;
    s2 += later.s2;
    s3 += later.s3;
    s4 += later.s4;
  }
  void add_one(double d) {
    const double q = d * d;
    join({1, d, q, q * d, q * q});
  }
  double standard_deviation() const {
    const double v = n > 1 ? (s2 - s1 * s1 / n) / (n - 1) : 0;
    return v > 0 ? std::sqrt(v) : 0;
  }
  /// Mean square of the bends over that of the steps: 3 for white noise, 0 for what moves smoothly.
  double roughness() const { return s2 > 0 ? bends / s2 : 0; }
  double kurtosis() const {
    if (n < 4 || !(s2 > 0)) return 3;
    const double m = s1 / n, v = s2 / n - m * m;
    const double fourth = s4 / n - 4 * m * s3 / n + 6 * m * m * s2 / n - 3 * m * m * m * m;
    // A ramp leaves only rounding here, and squares of huge or tiny values leave the range of a double.
    if (!(v > 1e-9 * (s2 / n)) || !std::isfinite(fourth) || !std::isnormal(v * v)) return 3;
    return fourth / (v * v);
  }
};

// Jumps of at least kJump of the range so far. A noise has next to none of them in any record of some length; a
// sawtooth's own jumps are nearly all there is to its differences.
class WrapWatch {
 public:
  static constexpr double kJump = 0.8;

  void block(const double* x, const double* before, std::size_t n, double range) {
    double last = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const double d = x[i] - before[i];
      if (!(std::fabs(d) >= kJump * range)) {
        last = 0;
        continue;
      }
      if (d * last < 0) ++(d < 0 ? peaks_ : dips_);
      last = d;
      follow(d);
      ++count_;
      sum_ += d;
      size_ += std::fabs(d);
      least_ = std::min(least_, std::fabs(d));
    }
  }
  void join(const WrapWatch& later) {
    count_ += later.count_;
    peaks_ += later.peaks_;
    dips_ += later.dips_;
    follows_ += later.follows_;
    if (later.first_ != 0) {
      if (latest_ * later.first_ > 0) ++follows_;
      if (first_ == 0) first_ = later.first_;
      latest_ = later.latest_;
    }
    sum_ += later.sum_;
    size_ += later.size_;
    least_ = std::min(least_, later.least_);
  }
  void read(const DifferenceMoments& all, double range, ChannelQuality::Signs& signs) const {
    constexpr std::uint64_t kFewest = 3;
    constexpr double kMost = 0.9;      // of the sum of squares of the differences
    constexpr double kFewSteps = 1.5;  // a heading about north wraps with every second sample
    const auto count = static_cast<double>(count_);
    if (count_ < kFewest || !(least_ >= kJump * range) || !(count * least_ * least_ > kMost * all.s2) ||
        !(all.n > kFewSteps * count) || are_spikes())
      return;
    const double usual = (all.s1 - sum_) / (all.n - count);
    // Jumps back over the end count against those over it.
    const double period = (size_ - usual * sum_ / size_ * count) / count;
    // A step of noise across the end is larger than others by up to their deviation.
    const double rest = std::max(0.0, all.s2 - size_ * size_ / count) / all.n;
    const double found = with_digits(period, (1 + 3 / std::sqrt(count)) * std::sqrt(rest) + 1e-9 * period);
    // A signal of two levels jumps as often, but not by a turn, and never twice in a row to the same side: a phase
    // travels the whole range between.
    const bool turn = found == 360 || found == 2 * std::numbers::pi;
    if (!turn && (!(all.n > 10 * count) || 20 * follows_ < count_)) return;
    signs.wraps = count_;
    signs.period = found;
  }
  static void layout(auto& at, auto& w) {
    at(w.count_, w.peaks_, w.dips_, w.follows_);
    at.group("jumps", w.sum_, w.size_, w.least_, w.first_, w.latest_);
  }

 private:
  void follow(double jump) {
    if (latest_ * jump > 0) ++follows_;
    latest_ = jump > 0 ? 1 : -1;
    if (first_ == 0) first_ = latest_;
  }
  /// All of them to one side and back at once: a heading about north is as often alone on either side.
  bool are_spikes() const {
    const std::uint64_t more = std::max(peaks_, dips_), fewer = std::min(peaks_, dips_);
    return 20 * more > 9 * count_ && 10 * fewer < more;
  }
  // A turn or a power of two, else the shortest decimal number within `off`.
  static double with_digits(double value, double off) {
    constexpr double kTurn = 2 * std::numbers::pi;
    // Steps that cross the end are larger than others: the jumps of a noisy heading are short of a turn by as much.
    for (const double natural : {kTurn, kTurn / 2, 360.0, std::exp2(std::round(std::log2(value)))})
      if (std::fabs(natural - value) <= 3 * off) return natural;
    for (int digits = 1; digits < 17; ++digits)
      if (const double short_one = rounded(value, digits); std::fabs(short_one - value) <= off) return short_one;
    return value;
  }

  std::uint64_t count_ = 0, peaks_ = 0, dips_ = 0;  ///< peaks_, dips_: single samples on the other side
  std::uint64_t follows_ = 0;                       ///< to the side of the one before
  double first_ = 0, latest_ = 0;                   ///< sides of jumps: 1, -1
  double sum_ = 0, size_ = 0, least_ = __builtin_inf();
};

// The value on which the channel rests, once it stands eight times in a row, and how often it stands from there on.
struct RestingValue {
  double value = 0;
  std::uint64_t count = 0;  // 0: none yet

  static constexpr std::uint64_t kRests = 8;

  void look(const double* x, std::size_t from, std::size_t n) {
    for (std::size_t i = from; i < n; ++i) count += x[i] == value ? 1 : 0;
  }
  void join(const RestingValue& later) {
    if (count > 0 && later.count > 0 && later.value == value)
      count += later.count;
    else if (later.count > count)
      *this = later;
  }
};

// Does the channel count? A clock, an index, a packet number: it moves one way with nearly every
// sample, by one step, or falls back at once and further than it ever rises (a modulo counter).
// Noise steps back every second time and is ruled out in the first block.
class CounterWatch {
 public:
  void block(const double* x, const double* before, const unsigned char* starts, std::size_t n) {
    if (!possible_) return;
    if (steps_ == 0) learn(x, before, starts, n);
    for (std::size_t i = 0; i < n; ++i)
      if (starts == nullptr || starts[i] == 0) step(x[i] - before[i], x[i]);
    judge();
  }

  /// `across`: the step between the two parts, where no sample is missing there; `value`: that it leads to.
  void join(const CounterWatch& later, std::optional<double> across, double value) {
    possible_ = possible_ && later.possible_;
    if (!possible_) return;
    if (steps_ == 0) usual_ = later.steps_ > 0 ? later.usual_ : across.value_or(0);
    if (across) step(*across, value);
    const double apart = std::fabs(later.usual_ - usual_);
    if (apart <= 1e-6 * std::fabs(usual_) + 0x1p-51 * std::fabs(value)) same_ += later.same_;
    steps_ += later.steps_;
    up_.join(later.up_);
    down_.join(later.down_);
    judge();
  }
  static void layout(auto& at, auto& c) {
    auto &up = c.up_, &down = c.down_;
    at(c.possible_);
    at.group("a counter", c.steps_, c.same_, up.count, down.count);
    at.group("a counter", c.usual_, up.least, up.largest, down.least, down.largest);
  }

  /// Nearly all steps are one.
  bool is_even() const {
    return possible_ && steps_ >= kLeastSteps && usual_ != 0 && static_cast<double>(same_) >= kMost * steps();
  }
  std::string sentence() const {
    if (!possible_ || steps_ < kLeastSteps) return "";
    if (is_even())
      return fmt::format("{} by {} with {} sample: a counter or a clock, not a measurement",
                         usual_ > 0 ? "rises" : "falls", brief_text(std::fabs(usual_), 4),
                         same_ == steps_ ? "every" : "nearly every");
    const bool rises = up_.count > down_.count;
    const Direction &there = rises ? up_ : down_, &back = rises ? down_ : up_;
    if (static_cast<double>(there.count) < 0.5 * steps()) return "";
    if (back.count == 0)
      return fmt::format("never {}: a clock, a counter or a drift, not noise", rises ? "falls" : "rises");
    const bool saw = back.least > 2 * there.largest && static_cast<double>(back.count) <= 0.125 * steps();
    return saw ? fmt::format(
                     "{} step by step and falls back {} times: a sawtooth, such as a counter that runs over, not noise",
                     rises ? "rises" : "sinks", back.count)
               : "";
  }

 private:
  struct Direction {
    std::uint64_t count = 0;
    double least = __builtin_inf(), largest = 0;
    void add(double size) {
      ++count;
      least = std::min(least, size);
      largest = std::max(largest, size);
    }
    void join(const Direction& later) {
      count += later.count;
      least = std::min(least, later.least);
      largest = std::max(largest, later.largest);
    }
  };
  static constexpr std::uint64_t kLeastSteps = 63;
  static constexpr double kMost = 0.9;

  double steps() const { return static_cast<double>(steps_); }
  void judge() {
    possible_ = static_cast<double>(std::min(up_.count, down_.count)) <= 0.25 * steps() ||
                static_cast<double>(same_) >= kMost * steps();
  }

  // The usual step is the median of the first block.
  void learn(const double* x, const double* before, const unsigned char* starts, std::size_t n) {
    std::vector<double> d;
    for (std::size_t i = 0; i < n; ++i)
      if (starts == nullptr || starts[i] == 0) d.push_back(x[i] - before[i]);
    if (d.empty()) return;
    usual_ = median_in_place(d, Middle::upper);
  }
  void step(double d, double value) {
    ++steps_;
    if (d > 0) up_.add(d);
    if (d < 0) down_.add(-d);
    same_ += std::fabs(d - usual_) <= 1e-6 * std::fabs(usual_) + 0x1p-51 * std::fabs(value);
  }

  bool possible_ = true;
  double usual_ = 0;
  std::uint64_t steps_ = 0, same_ = 0;
  Direction up_, down_;
};

// The common step of values that lie on a grid, by Euclid's algorithm with a tolerance; nothing when there is none.
std::optional<double> grid_step(std::vector<double> values) {
  if (values.size() < 2) return std::nullopt;
  std::sort(values.begin(), values.end());
  const double range = values.back() - values.front();
  const double largest = std::max(std::fabs(values.front()), std::fabs(values.back()));
  double least = range;
  for (std::size_t i = 1; i < values.size(); ++i) least = std::min(least, values[i] - values[i - 1]);
  // Values printed with few decimals stand up to a few percent of a step off their grid.
  const double tolerance = std::max(0.04 * least, 8 * largest * 0x1p-52);
  if (least <= 16 * largest * 0x1p-52) return std::nullopt;
  double step = least;
  for (std::size_t i = 1; i < values.size(); ++i) {
    double a = values[i] - values[i - 1], b = step;
    for (int round = 0; b > tolerance && round < 64; ++round) {
      double rest = a - std::floor(a / b) * b;  // as fmod, whose loop is long where a/b is large
      if (rest < 0 || b - rest < tolerance) rest = 0;
      a = b;
      b = rest;
    }
    step = a;
    if (step < 0.2 * least || step < 4 * tolerance) return std::nullopt;
  }
  // Refine by least squares through the origin of the grid, widening the stretch so that no step is miscounted.
  for (std::size_t used = 2; used <= values.size();
       used = used == values.size() ? used + 1 : std::min(used * 2, values.size())) {
    double kk = 0, kv = 0;
    for (std::size_t i = 1; i < used; ++i) {
      const double v = values[i] - values[0], k = std::round(v / step);
      kk += k * k;
      kv += k * v;
    }
    if (kk > 0) step = kv / kk;
  }
  for (const double v : values) {
    const double k = (v - values[0]) / step;
    if (std::fabs(k - std::round(k)) > 0.1) return std::nullopt;
  }
  return step;
}

// 0.05000000000000027 → 0.05: the least number of digits that stands within the grid's own uncertainty.
double tidy(double step) {
  for (int digits = 1; digits < 16; ++digits) {
    const double shorter = rounded(step, digits);
    if (std::fabs(shorter - step) <= 1e-7 * step) return shorter;
  }
  return step;
}

/// How the samples begin: what a part before them goes on with.
struct Beginning {
  double value = 0;         ///< the first one that is there
  bool at_once = false;     ///< it is the very first
  std::uint64_t equal = 0;  ///< so many have its value, over missing ones
  bool any = false, over = false;

  void push(std::span<const double> samples, bool from_first) {
    for (std::size_t i = 0; i < samples.size() && !over; ++i) {
      if (!(std::fabs(samples[i]) <= kLargestSample)) continue;
      if (!any) {
        value = samples[i];
        at_once = from_first && i == 0;
        any = true;
      }
      over = samples[i] != value;
      equal += over ? 0 : 1;
    }
  }
};

/// Samples that are exactly zero, and how near the others come to it.
struct ZeroWatch {
  std::uint64_t count = 0, repeats = 0;  // repeats: of a zero right before
  double nearest = __builtin_inf();

  void block(const double* x, std::size_t n, double near) {
    if (near > 0) return join(0, near);
    const Zeros zeros = zeros_of(x, n);
    join(zeros.count, zeros.nearest);
  }
  void join(std::uint64_t more, double near) {
    count += more;
    nearest = std::min(nearest, near);
  }
};

struct OddValues {
  CounterWatch counter;
  WrapWatch wraps;
  RestingValue resting;
  detail::FlagRuns same{kFrozenRun - 1};  // equal to the one before; the first sample has no flag
  detail::RunExits exits;
  detail::LineWatch lines;
  ZeroWatch zero;
};

}  // namespace

struct QualityMeter::State {
  MeanAndSpread values;
  DifferenceMoments differences;
  OddValues odd;
  DistinctValues distinct;
  Extreme top{1}, bottom{-1};
  std::uint64_t missing = 0, beyond = 0;
  std::uint64_t held_at = 0;  // place in the record of the first sample on hold
  double previous = 0, minimum = __builtin_inf(), maximum = -__builtin_inf();
  bool joined = false;  // previous is the sample right before
  Beginning beginning;
  std::uint64_t pushed = 0;
  bool float32 = true;
  // The sample before the block, then samples until the block is full; with it whether a sample does not follow the one
  // before directly (missing samples between). Room for as many as came so far.
  std::vector<double> held;
  std::vector<unsigned char> starts;
  std::size_t used = 0;
  bool any_start = false;

  void push(std::span<const double> samples);
  void make_room(std::size_t n);
  void hold(const double* x, std::size_t n);
  void process_held();
  void process(const double* x, const double* before, const BlockSums& sums, std::size_t n, std::size_t breaks);
  void runs(const double* x, const double* before, const BlockSums& sums, std::size_t n, const unsigned char* begins,
            std::uint64_t at);
  void equal_runs(const double* x, const double* before, std::size_t n, const unsigned char* begins, std::uint64_t at);
  bool may_saturate(std::uint64_t levels) const;
  void judge_exits(ChannelQuality& q) const;
  void join(const State& later);
  void join_runs(const State& later, bool direct);
  static void layout(auto& at, auto& s);
};

void QualityMeter::State::layout(auto& at, auto& s) {
  constexpr std::string_view kWhat = "the quality of a channel";
  auto& d = s.differences;
  auto& b = s.beginning;
  at.group(kWhat, s.values.origin, s.values.n, s.values.mean, s.values.m2);
  at.group(kWhat, d.n, d.s1, d.s2, d.s3, d.s4, d.bends);
  DistinctValues::layout(at, s.distinct);
  WrapWatch::layout(at, s.odd.wraps);
  at(s.odd.resting.value);
  at(s.odd.resting.count, s.odd.zero.count, s.odd.zero.repeats);
  at(s.odd.zero.nearest);
  CounterWatch::layout(at, s.odd.counter);
  Extreme::layout(at, s.top);
  Extreme::layout(at, s.bottom);
  at.group(kWhat, s.missing, s.beyond, s.pushed);
  detail::FlagRuns::layout(at, s.odd.same);
  detail::RunExits::layout(at, s.odd.exits);
  detail::LineWatch::layout(at, s.odd.lines);
  at.group(kWhat, s.previous, s.minimum, s.maximum);
  at.group(kWhat, s.joined, s.float32);
  at(b.value);
  at.group(kWhat, b.equal, b.at_once, b.any, b.over);
}

void QualityMeter::State::push(std::span<const double> samples) {
  if (!beginning.over) beginning.push(samples, pushed == 0);
  pushed += samples.size();
  const double* x = samples.data();
  const double* const end = x + samples.size();
  const auto place = [&] { return pushed - static_cast<std::uint64_t>(end - x); };
  while (x != end) {
    const std::size_t n = std::min<std::size_t>(kBlock - used, static_cast<std::size_t>(end - x));
    // A whole block is looked at where it lies, but for its first sample, whose neighbour may be
    // elsewhere. A missing sample makes its sum no number.
    if (n == kBlock && joined && x != samples.data()) {
      const BlockSums sums = sums_of(x, x - 1, n, x[0]);
      if (!std::isnan(sums.sum) && sums.low >= -kLargestSample && sums.high <= kLargestSample) {
        runs(x, x - 1, sums, n, nullptr, place());
        odd.counter.block(x, x - 1, nullptr, n);
        process(x, x - 1, sums, n, 0);
        x += n;
        continue;
      }
    }
    make_room(n);
    if (used == 0) held_at = place();
    if (!any_missing(x, n)) {
      std::memcpy(held.data() + 1 + used, x, n * sizeof(double));
      std::memset(starts.data() + used, 0, n);
      starts[used] = joined ? 0 : 1;
      any_start |= !joined;
      joined = true;
      used += n;
    } else {
      hold(x, n);
    }
    x += n;
    if (used == kBlock) process_held();
  }
}

void QualityMeter::State::make_room(std::size_t n) {
  if (starts.size() >= used + n) return;
  const std::size_t wanted = used + n, room = std::min(kBlock, wanted + wanted / 4);
  starts.resize(room);
  held.resize(1 + room);
}

void QualityMeter::State::hold(const double* x, std::size_t n) {
  for (std::size_t i = 0; i < n; ++i) {
    if (!(std::fabs(x[i]) <= kLargestSample)) {
      beyond += std::isnan(x[i]) ? 0 : 1;
      ++missing;
      joined = false;
      continue;
    }
    starts[used] = joined ? 0 : 1;
    any_start |= !joined;
    held[1 + used++] = x[i];
    joined = true;
  }
}

void QualityMeter::State::process_held() {
  if (used == 0) return;
  const std::size_t n = used;
  const double* const x = held.data() + 1;
  held[0] = previous;
  const double* before = held.data();
  std::size_t breaks = 0;
  double without_breaks[kBlock];
  if (any_start) {  // a difference across missing samples counts as zero
    std::copy_n(held.data(), n, without_breaks);
    for (std::size_t i = 0; i < n; ++i)
      if (starts[i] != 0) {
        without_breaks[i] = x[i];
        ++breaks;
      }
    before = without_breaks;
  }
  const BlockSums sums = sums_of(x, before, n, x[0]);
  runs(x, held.data(), sums, n, any_start ? starts.data() : nullptr, held_at);
  odd.counter.block(x, held.data(), starts.data(), n);
  process(x, before, sums, n, breaks);
  used = 0;
  any_start = false;
}

void QualityMeter::State::process(const double* x, const double* before, const BlockSums& sums, std::size_t n,
                                  std::size_t breaks) {
  values.block(x[0], n, sums);
  minimum = std::min(minimum, sums.low);
  maximum = std::max(maximum, sums.high);
  if (const double range = maximum - minimum; range > 0 && sums.jump >= WrapWatch::kJump * range)
    odd.wraps.block(x, before, n, range);
  odd.zero.block(x, n, sums.nearest);
  differences.add(sums);
  differences.n += static_cast<double>(n - breaks);
  top.block(x, n, sums.high);
  bottom.block(x, n, sums.low);
  float32 = float32 && !any_beyond_float(x, n);
  for (std::size_t i = 0; i < n && !distinct.full(); ++i) distinct.add(x[i]);
  previous = x[n - 1];
}

/// The first place from `at` on whose bit is `value`; n: there is none.
static std::size_t next_bit(const std::uint64_t* words, std::size_t at, std::size_t n, bool value) {
  while (at < n) {
    const std::uint64_t left = (value ? words[at / 64] : ~words[at / 64]) >> (at % 64);
    if (left != 0) return std::min(n, at + static_cast<std::size_t>(std::countr_zero(left)));
    at += 64 - at % 64;
  }
  return n;
}

// Differences of exactly zero in a row; a missing sample ends a run.
void QualityMeter::State::runs(const double* x, const double* before, const BlockSums& sums, std::size_t n,
                               const unsigned char* begins, std::uint64_t at) {
  odd.lines.block({x, n}, begins, at, sums.lines, odd.same.set());
  if (sums.repeats) return equal_runs(x, before, n, begins, at);
  const std::size_t first = values.n == 0 ? 1 : 0;
  const bool follows = begins == nullptr || begins[first] == 0;
  if (n > first) odd.exits.leave(odd.same.now() + 1, follows ? x[first] - before[first] : 0, odd.same.pauses() == 0);
  odd.same.push_without(n - first);
}

void QualityMeter::State::equal_runs(const double* x, const double* before, std::size_t n, const unsigned char* begins,
                                     std::uint64_t at) {
  std::uint64_t words[kBlock / 64];
  equal_bits(x, before, n, words);
  const auto follows = [&](std::size_t i) { return begins == nullptr || begins[i] == 0; };
  const std::size_t first = values.n == 0 ? 1 : 0;
  for (std::size_t i = 0; i < n && (begins != nullptr || i < first); ++i)
    if (i < first || begins[i] != 0) words[i / 64] &= ~(std::uint64_t{1} << (i % 64));
  std::size_t rests_from = odd.resting.count > 0 ? 0 : n;
  for (std::size_t i = first, from = first; i < n; from = i) {
    i = next_bit(words, from, n, true);
    if (i > from)
      odd.exits.leave(odd.same.now() + 1, follows(from) ? x[from] - before[from] : 0, odd.same.pauses() == 0);
    odd.same.push_without(i - from);
    from = i;
    i = next_bit(words, from, n, false);
    const std::uint64_t run = odd.same.now() + 1;  // of one value, before these
    if (odd.resting.count == 0 && run < RestingValue::kRests && run + (i - from) >= RestingValue::kRests) {
      odd.resting = {x[from], RestingValue::kRests};
      rests_from = from + static_cast<std::size_t>(RestingValue::kRests - run);
    }
    if (i > from && x[from] == 0) odd.zero.repeats += i - from;
    odd.same.push_run(i - from, at + from);
  }
  odd.resting.look(x, rests_from, n);
}

/// How often each value is recorded, 1: once. Polled at r times the sensor's rate, runs are floor(r) or ceil(r) long;
/// repeats of coarsely rounded noise come by chance, runs of one among them. Where r < 2, single values are there as
/// well, and the repeats come evenly.
static double held_times(const detail::FlagRuns& same) {
  constexpr double kFewest = 64, kUneven = 0.35, kSingle = 0.9;
  const double runs = static_cast<double>(same.pauses()) - 1;  // between pauses, with both ends
  if (runs < kFewest || static_cast<double>(same.set()) < kFewest || same.closed().empty()) return 1;
  double longer = 0, samples = runs;
  for (std::size_t flags = 1; flags < same.closed().size(); ++flags) {
    longer += same.closed()[flags];
    samples += same.closed()[flags] * static_cast<double>(flags);
  }
  const auto quantile = [&](double share) {
    double sum = runs - longer;
    std::size_t flags = 0;
    while (sum < share * runs && flags + 1 < same.closed().size()) sum += same.closed()[++flags];
    return flags + 1;
  };
  const std::size_t shortest = quantile(0.01), longest = quantile(0.99);
  const bool every = shortest >= 2 && longest <= 2 * shortest + 1;
  const bool some = shortest == 1 && longest <= 2 && same.closed()[1] > kSingle * longer && same.unevenness() < kUneven;
  return every || some ? samples / runs : 1;
}

QualityMeter::QualityMeter() : state_(detail::hidden<State>()) {}

void QualityMeter::push(std::span<const double> samples) { state_->push(samples); }

namespace {

void judge_values(const ChannelQuality& q, std::vector<Finding>& out) {
  if (!q.signs.counter.empty() && q.signs.wraps == 0) out.push_back(finding("counter", q.signs.counter));
  if (q.signs.wraps > 0) {
    Finding wraps =
        finding("phase_wraps", fmt::format("jumps by its whole range, {}, {} times: a phase or an angle that wraps",
                                           brief_text(q.signs.period, 6), q.signs.wraps));
    wraps.count = q.signs.wraps;
    wraps.help.push_back({"Unwrap it, as the phase or the angle that it is.",
                          {{"data", "phase"}, {"unwrap", shortest(q.signs.period)}}});
    out.push_back(std::move(wraps));
  }
  if (q.samples < 16) return;
  if (q.distinct_values == 1) out.push_back(finding("constant", "constant: nothing to characterize"));
  if (q.distinct_values <= 1) return;
  if (q.distinct_values <= 3)
    out.push_back(finding("quantization_limited",
                          fmt::format("{} distinct values: quantization-limited, record with more gain or resolution",
                                      q.distinct_values)));
  else if (q.resolution && q.standard_deviation < 0.5 * *q.resolution)
    out.push_back(finding(
        "coarse_resolution",
        fmt::format("standard deviation is {} of the resolution: quantization hides the noise, record with more gain",
                    brief_text(q.standard_deviation / *q.resolution, 2))));
  if (q.float32 && q.distinct_values > 16 && q.standard_deviation > 0 && q.float32_step > 0.5 * q.standard_deviation)
    out.push_back(finding(
        "float_step",
        fmt::format(
            "32-bit floats step by {} here, which is {} of the standard deviation: subtract the offset before storing",
            brief_text(q.float32_step), brief_text(q.float32_step / q.standard_deviation, 2))));
}

/// A noise of which a hundredth does not fit into the range is not the one that was recorded.
constexpr double kMostSaturated = 0.01;

/// Share of samples at one value inside the range that no rounding of a noise gives.
constexpr double kDeadBand = 0.3;

std::vector<Interval> times_of(const std::vector<ChannelQuality::Signs::Place>& places, double rate_hz) {
  std::vector<Interval> out;
  for (const auto& [from, to] : places)
    if (rate_hz > 0) out.push_back({static_cast<double>(from) / rate_hz, static_cast<double>(to) / rate_hz});
  return out;
}

/// Of the samples that only repeat the one before, or lie half-way: the step of the values over the deviation of their
/// differences says how many by chance. Not where quiet stretches have coarser steps than loud ones.
constexpr double kMostKurtosis = 10;

/// Between values that lie side by side: their grid, that of 32-bit floats, or what so few values leave.
double value_step(const ChannelQuality& q) {
  if (q.resolution) return *q.resolution;
  const double left = (q.maximum - q.minimum) / static_cast<double>(std::max<std::uint64_t>(1, q.distinct_values));
  return q.distinct_values < kDistinct ? left : q.float32 ? q.float32_step : 0;
}

/// Changes from sample to sample as noise does: what moves smoothly may rest, or go straight.
bool is_restless(const ChannelQuality& q) {
  constexpr double kLeast = 0.5, kRough = 1;
  return q.difference_sd > kLeast * q.standard_deviation || q.signs.roughness > kRough;
}

/// Zeros among values that hardly repeat: they stand for no reading, or for all values near them. True where found.
bool judge_zeros(const ChannelQuality& q, std::vector<Finding>& out) {
  constexpr std::uint64_t kFewest = 20;
  constexpr double kLeastShare = 5e-4, kTimes = 5, kApart = 20, kBand = 0.01;
  const std::uint64_t alone = q.signs.zeros - std::min(q.signs.zeros, q.signs.frozen);
  if (q.distinct_values <= 16 || 2 * alone < q.signs.zeros || q.signs.zeros < kFewest) return false;
  if (!(q.minimum < 0) || !(q.maximum > 0) || !is_restless(q)) return false;
  const double n = static_cast<double>(q.samples), share = static_cast<double>(q.signs.zeros) / n;
  const double step = q.resolution.value_or(0);
  const double density = 1 / (std::sqrt(2 * std::numbers::pi) * q.standard_deviation);
  // What values repeat by anyway: of any density, a value comes at most about so often.
  const double by_chance = kTimes * static_cast<double>(q.signs.other_repeats) / n;
  if (share < kLeastShare + std::max(kTimes * step * density, by_chance)) return false;
  const bool band = share > kBand && q.signs.nearest_to_zero > kApart * std::max(step, 1 / (2 * n * density));
  Finding found =
      finding(band ? "dead_band" : "missing_mark",
              band ? fmt::format("{} of the samples are exactly 0, and no other comes nearer to it than {}: a dead "
                                 "band, and noise at rest cannot be measured from this",
                                 percent_text(share), brief_text(q.signs.nearest_to_zero, 3))
                   : fmt::format("0 occurs {} times among values that hardly repeat: a mark for missing values?",
                                 q.signs.zeros));
  found.count = q.signs.zeros;
  if (!band) found.help.push_back({"Say that it means missing.", {{"missing", "0"}}});
  out.push_back(std::move(found));
  return true;
}

/// What repeats outside of the runs gives the chance of a run among these samples, and the other runs show how long
/// they get. Where neither tells (a quantity that changes little from sample to sample may rest, and between coarse
/// steps it does), a run that hung is left by a jump.
struct FrozenRuns {
  explicit FrozenRuns(const ChannelQuality& q) {
    constexpr double kHeld = 0.5, kAtEnds = 4, kTimesHeld = 4;
    const auto samples = static_cast<double>(q.samples), frozen = static_cast<double>(q.signs.frozen);
    const double repeats = (static_cast<double>(q.repeats) - frozen) / std::max(1.0, samples - frozen);
    const bool held = q.signs.held_times > 1 || frozen - static_cast<double>(q.longest_stuck) > kHeld * samples;
    const auto by_chance = [&](std::uint64_t run) { return samples * std::pow(repeats, static_cast<double>(run - 1)); };
    const bool saturated = kAtEnds * static_cast<double>(q.saturated) > frozen;  // rather than hung at an extreme
    rare = !saturated && !held && is_restless(q) && by_chance(kFrozenRun) < kChance;
    const std::uint64_t run = rare ? kFrozenRun : 2 * kFrozenRun;
    const bool known = !held && by_chance(run) < kChance;
    const bool alone = 2 * q.signs.longest.second < detail::RunExits::kLong;
    by_length = rare || q.signs.held_times > 1 || (is_restless(q) && (known || alone));
    longest = by_length ? q.longest_stuck : q.signs.longest.jump;
    // What goes to zero by itself and stays there, such as a concentration or a speed, has not hung.
    const bool at_zero = q.signs.zero_is_end && q.signs.frozen <= q.signs.zeros;
    found = !at_zero && q.distinct_values > 16 && longest >= (rare ? kFrozenRun : detail::RunExits::kLong) &&
            (q.signs.held_times == 1 || static_cast<double>(longest) > kTimesHeld * q.signs.held_times);
    if (!found || !known) return;
    fewest = by_length ? run : std::max(run, q.signs.longest.rest + 1);
    if (fewest > longest) fewest = 0;
  }
  static constexpr double kChance = 1e-3;
  bool found = false, rare = false;  ///< rare: the shortest that are counted
  bool by_length = false;            ///< none of these runs is a rest
  std::uint64_t longest = 0;
  std::uint64_t fewest = 0;  ///< samples of a run that neither chance nor a rest gives; 0: not known
};

/// Runs of one value, where values do not repeat anyway, as they do between coarse steps.
void judge_runs(const ChannelQuality& q, double rate_hz, std::vector<Finding>& out) {
  constexpr double kMuch = 0.01;
  const FrozenRuns runs(q);
  if (!runs.found) return;
  const auto samples = static_cast<double>(q.samples), frozen = static_cast<double>(q.signs.frozen);
  Finding stuck = finding(
      "stuck",
      q.signs.frozen_runs < 2 || !runs.rare
          ? fmt::format("one value {} times in a row: the sensor or the link hung", runs.longest)
          : fmt::format(
                "one value {} to {} times in a row in {} stretches, {} of the samples: the sensor or the link hung",
                kFrozenRun, runs.longest, q.signs.frozen_runs, percent_text(frozen / samples)));
  if ((runs.rare ? frozen : static_cast<double>(runs.longest)) > kMuch * samples) stuck.severity = Severity::bad;
  if (runs.fewest > 0)
    stuck.help.push_back({"Take frozen values as missing.", {{"frozen", fmt::format("{}", runs.fewest)}}});
  if (runs.by_length) stuck.where.time_s = times_of(q.signs.frozen_at, rate_hz);
  out.push_back(std::move(stuck));
}

/// Samples that only repeat the one before, here and there, where differences of a smooth density hardly are zero.
void judge_repeats(const ChannelQuality& q, std::vector<Finding>& out) {
  constexpr double kMuch = 0.01, kLeast = 1e-3, kTimes = 6, kFewest = 20, kMost = 0.3;
  if (q.distinct_values <= 16 || q.signs.held_times > 1 || !is_restless(q) || !q.signs.counter.empty()) return;
  if (q.difference_kurtosis > kMostKurtosis) return;
  const auto repeats = static_cast<double>(q.repeats - std::min(q.repeats, q.signs.frozen));
  const double by_chance = value_step(q) / (std::sqrt(2 * std::numbers::pi) * q.difference_sd);
  const double share = repeats / static_cast<double>(q.samples);
  // Digits of a fixed number step ten times coarser above a power of ten.
  if (repeats < kFewest || share < std::max(kLeast, kTimes * by_chance)) return;
  Finding again = finding("repeated_samples",
                          fmt::format("{} of the samples only repeat the one before, where {} would by chance: read "
                                      "faster than the sensor measures, or written twice",
                                      percent_text(share), percent_text(by_chance)));
  again.count = clamped_whole<std::uint64_t>(repeats);
  if (share > kMuch) again.severity = Severity::bad;
  if (share < kMost) again.help.push_back({"Take what repeats as missing.", {{"frozen", "2"}}});
  out.push_back(std::move(again));
}

void judge_held(const ChannelQuality& q, double rate_hz, std::vector<Finding>& out) {
  if (!(q.signs.held_times > 1)) return;
  const double times = q.signs.held_times;
  out.push_back(finding("held_values",
                        fmt::format("Each value is recorded {} times on average: the sensor {}.", number_text(times, 3),
                                    rate_hz > 0 ? fmt::format("gives {} Hz where the log has {} Hz",
                                                              number_text(rate_hz / times, 4), number_text(rate_hz, 4))
                                                : "is slower than the log")));
}

/// Gaps that were filled, or all of it resampled. A signal without noise is full of lines.
void judge_lines(const ChannelQuality& q, double rate_hz, std::vector<Finding>& out) {
  constexpr double kMuch = 0.01, kAll = 0.5;
  constexpr std::uint64_t kFewestSamples = 1000;
  const ChannelQuality::Signs::Lines& found = q.signs.lines;
  if (found.runs == 0 || q.samples < kFewestSamples || q.distinct_values <= 16) return;
  if (!q.signs.counter.empty() || !(is_restless(q) || found.throughout)) return;
  const double share = static_cast<double>(found.samples) / static_cast<double>(q.samples);
  const std::string samples =
      (found.least == 1 ? "about " : "") +
      (share < kMuch ? plural(found.samples, "sample") : percent_text(share) + " of the samples");
  Finding lines =
      found.throughout
          ? finding("resampled", samples +
                                     " lie on straight lines between two others, throughout: a slower channel, "
                                     "interpolated to this rate; its noise ends where that of the sensor does")
          : finding("interpolated", fmt::format("{} lie {}: filled or interpolated", samples,
                                                found.least == 1 ? "half-way between their neighbours"
                                                                 : "on straight lines between two others, in " +
                                                                       plural(found.runs, "place")));
  lines.count = found.runs;
  if (!found.throughout) lines.where.time_s = times_of(found.at, rate_hz);
  if (share > kMuch && !found.throughout) lines.severity = Severity::bad;
  if (share < kAll && !found.throughout)
    lines.help.push_back(
        {"Take what lies on lines as missing.", {{"interpolated", fmt::format("{}", found.least + 2)}}});
  out.push_back(std::move(lines));
}

void judge_ends(const ChannelQuality& q, double rate_hz, std::vector<Finding>& out) {
  if (!q.signs.marks.empty()) {  // what else is odd about the ends is these
    std::vector<std::string> texts;
    for (const double mark : q.signs.marks) texts.push_back(shortest(mark));
    Finding marked =
        finding("missing_mark", fmt::format("{} occurs {} times, far from all other values: a mark for missing values?",
                                            fmt::join(texts, " or "), q.signs.marked));
    marked.count = q.signs.marked;
    marked.help.push_back({"Say that it means missing.", {{"missing", fmt::format("{}", fmt::join(texts, ","))}}});
    out.push_back(std::move(marked));
    return;
  }
  if (q.saturated > 0 && q.distinct_values > 3) {
    const double share = static_cast<double>(q.saturated) / static_cast<double>(q.samples);
    std::vector<std::string> ends, texts;
    for (const double end : q.signs.ends) {
      ends.push_back(brief_text(end, 6));
      texts.push_back(shortest(end));
    }
    Finding cut =
        finding(share > kMostSaturated ? "much_saturated" : "saturated",
                fmt::format("{} samples ({}) are at the end of the range ({}): saturated, use a larger full scale",
                            q.saturated, percent_text(share), fmt::join(ends, " or ")));
    if (q.signs.apart) {
      cut.sentence =
          fmt::format("{} samples ({}) are {}, and no value comes near: a mark for missing values, or saturated",
                      q.saturated, percent_text(share), fmt::join(texts, " or "));
      cut.help.push_back({"Take the value as missing.", {{"missing", fmt::format("{}", fmt::join(texts, ","))}}});
    } else if (std::find(q.signs.ends.begin(), q.signs.ends.end(), 0.0) != q.signs.ends.end()) {
      cut.help.push_back({"Where 0 stands for no reading, `missing` 0 says so.", {}});
    }
    cut.count = q.saturated;
    out.push_back(std::move(cut));
  }
  // One long run is a sensor that froze; a dead band is entered again and again.
  const std::uint64_t again = q.signs.at_rest - std::min(q.signs.at_rest, q.longest_stuck);
  const double rests = static_cast<double>(again) / static_cast<double>(q.samples);
  if (rests > kDeadBand && q.distinct_values > 16 && q.minimum < q.signs.resting_value &&
      q.signs.resting_value < q.maximum) {
    Finding dead = finding(
        "dead_band",
        fmt::format("{} of the samples are exactly {}: a dead band, and noise at rest cannot be measured from this",
                    percent_text(rests), brief_text(q.signs.resting_value, 6)));
    dead.count = q.signs.at_rest;
    out.push_back(std::move(dead));
    return;
  }
  judge_held(q, rate_hz, out);
  if (judge_zeros(q, out)) return;
  if (!has(out, "much_saturated")) {  // it stands at the end of the range
    judge_runs(q, rate_hz, out);
    judge_repeats(q, out);
  }
  judge_lines(q, rate_hz, out);
}

std::vector<Finding> findings_of(const ChannelQuality& q, double rate_hz) {
  std::vector<Finding> out;
  if (q.beyond > 0) {
    out.push_back(finding("beyond_range", fmt::format("{} beyond {} in magnitude: no measurement, taken as missing",
                                                      plural(q.beyond, "sample"), brief_text(kLargestSample))));
    out.back().count = q.beyond;
  }
  if (q.samples == 0) {
    if (q.beyond == 0) out.push_back(finding("no_value", "no value at all: check that the channel is switched on"));
    return out;
  }
  judge_values(q, out);
  judge_ends(q, rate_hz, out);
  if (q.samples >= 1000 && q.difference_kurtosis > 10 && !(q.signs.held_times > 1))
    out.push_back(finding(
        "spiky", fmt::format("kurtosis of differences {} (3 for Gaussian noise): spikes or movement, look for outliers",
                             brief_text(q.difference_kurtosis))));
  return out;
}

}  // namespace

// Ends of a range are told from values that simply stand: of few levels, of a channel that stands
// most of the time wherever it is (coarse steps, slow changes), of a counter or a clock.
// By three deviations of the differences, or one step of a grid; of the run at the end it is not known, which is as
// long as those that rested, or longer.
void QualityMeter::State::judge_exits(ChannelQuality& q) const {
  constexpr double kDeviations = 3, kStep = 1.5;
  constexpr std::uint64_t kTimes = 4;
  const double usual = std::max(kDeviations * q.difference_sd, kStep * value_step(q));
  q.signs.longest.rest = odd.exits.longest(usual, false);
  q.signs.longest.jump = odd.exits.longest(usual, true);
  const std::uint64_t last = odd.same.now() + 1;
  if (last >= detail::RunExits::kLong && last > kTimes * q.signs.longest.rest)
    q.signs.longest.jump = std::max(q.signs.longest.jump, last);
}

bool QualityMeter::State::may_saturate(std::uint64_t levels) const {
  constexpr std::uint64_t kFewLevels = 8;
  if (levels <= kFewLevels || !odd.counter.sentence().empty()) return false;
  const double ends = static_cast<double>(top.count + bottom.count);
  const double others = values.n - ends;
  const double repeats = static_cast<double>(odd.same.set()) - ends;
  return repeats < 0.5 * others;
}

// Neither part has samples on hold.
void QualityMeter::State::join(const State& later) {
  const bool direct = joined && later.beginning.at_once;
  const std::optional<double> step = direct ? std::optional(later.beginning.value - previous) : std::nullopt;
  if (values.n == 0) values.origin = later.values.origin;
  join_runs(later, direct);
  values.join(later.values);
  if (step) {
    differences.add_one(*step);
    const double range = std::max(maximum, later.maximum) - std::min(minimum, later.minimum);
    odd.wraps.block(&later.beginning.value, &previous, 1, range);
  }
  odd.wraps.join(later.odd.wraps);
  odd.resting.join(later.odd.resting);
  odd.zero.join(later.odd.zero.count, later.odd.zero.nearest);
  odd.zero.repeats += later.odd.zero.repeats;
  differences.join(later.differences);
  odd.counter.join(later.odd.counter, step, later.beginning.value);
  for (const double value : later.distinct.values())
    if (!distinct.full()) distinct.add(value);
  missing += later.missing;
  beyond += later.beyond;
  minimum = std::min(minimum, later.minimum);
  maximum = std::max(maximum, later.maximum);
  float32 = float32 && later.float32;
  previous = later.previous;
  joined = later.joined;
  pushed += later.pushed;
}

void QualityMeter::State::join_runs(const State& later, bool direct) {
  const Beginning& other = later.beginning;
  const auto is = [](double n, std::uint64_t count) { return n == static_cast<double>(count); };
  const bool all = is(later.values.n, other.equal);
  top.join(later.top, later.top.value == other.value ? other.equal : 0, all);
  bottom.join(later.bottom, -later.bottom.value == other.value ? other.equal : 0, all);
  if (values.n > 0) {
    if (direct)
      odd.exits.join(later.odd.exits, odd.same.now() + 1, later.odd.same.lead() + 1, other.value - previous,
                     odd.same.pauses() == 0);
    else
      odd.exits.join_apart(later.odd.exits, odd.same.pauses() == 0);
    odd.same.push(direct && other.value == previous, pushed);
  } else {
    odd.exits = later.odd.exits;
  }
  odd.same.join(later.odd.same, pushed, 1);
  odd.lines.join(later.odd.lines, direct, pushed);
  if (values.n == 0) {
    beginning = other;
    beginning.at_once = other.at_once && pushed == 0;
    return;
  }
  if (beginning.over || (other.any && other.value != beginning.value)) {
    beginning.over = true;
    return;
  }
  beginning.equal += other.equal;
  beginning.over = other.over;
}

void QualityMeter::join(const QualityMeter& later) {
  if (later.state_->pushed == 0) return;
  state_->process_held();
  State other = *later.state_;
  other.process_held();
  if (other.values.n == 0) {
    state_->missing += other.missing;
    state_->beyond += other.beyond;
    state_->pushed += other.pushed;
    state_->joined = false;
    return;
  }
  state_->join(other);
}

void QualityMeter::write_state(StateWriter& to) const {
  State s = *state_;
  s.process_held();
  State::layout(to, s);
}

void QualityMeter::read_state(StateReader& from) {
  State s;
  State::layout(from, s);
  s.odd.same.check(from);
  s.odd.exits.check(from);
  s.odd.lines.check(from);
  constexpr double kExact = 0x1p53;  // a count is whole up to here
  if (!(s.values.n >= 0 && s.values.n <= kExact)) from.refuse("the number of its samples");
  *state_ = std::move(s);
}

std::uint64_t detail::frozen_run(const ChannelQuality& quality) {
  const FrozenRuns runs(quality);
  return runs.found && runs.rare ? runs.fewest : 0;
}

ChannelQuality QualityMeter::finish(double rate_hz) const {
  State state = *state_;
  state.process_held();
  ChannelQuality q;
  q.samples = static_cast<std::uint64_t>(state.values.n);
  q.missing = state.missing;
  q.beyond = state.beyond;
  if (q.samples > 0) {
    q.mean = state.values.origin + state.values.mean;
    if (q.samples > 1) q.standard_deviation = std::sqrt(state.values.m2 / (state.values.n - 1));
    q.minimum = state.minimum;
    q.maximum = state.maximum;
    constexpr double kSquareFits = 1e-140;
    if (q.maximum > q.minimum && q.maximum - q.minimum < kSquareFits)
      q.standard_deviation = std::numeric_limits<double>::quiet_NaN();
  }
  q.distinct_values = state.distinct.values().size();
  q.difference_kurtosis = state.differences.kurtosis();
  q.difference_sd = state.differences.standard_deviation();
  q.signs.counter = state.odd.counter.sentence();
  q.float32 = q.samples > 0 && state.float32;
  const auto largest = static_cast<float>(std::max(std::fabs(q.minimum), std::fabs(q.maximum)));
  if (std::isfinite(largest))
    q.float32_step = static_cast<double>(std::nextafter(largest, HUGE_VALF)) - static_cast<double>(largest);
  if (const auto step = grid_step(state.distinct.values()); step && q.samples >= 4) {
    const bool format_only = q.float32 && *step <= 1.01 * q.float32_step && q.distinct_values > 16;
    if (!format_only) q.resolution = tidy(*step);
  }
  q.longest_stuck = q.samples > 0 ? state.odd.same.longest() + 1 : 0;
  const double others = state.top.next + state.bottom.next;
  if (q.distinct_values > 3) {
    if (state.bottom.is_mark(state.top.value + state.bottom.next) || state.bottom.is_mark(others))
      q.signs.marks.push_back(q.minimum);
    else if (state.bottom.are_marks(state.top.value + state.bottom.third))
      q.signs.marks = {q.minimum, -state.bottom.next};
    if (state.top.is_mark(state.top.next + state.bottom.value) || state.top.is_mark(others))
      q.signs.marks.push_back(q.maximum);
    else if (state.top.are_marks(state.top.third + state.bottom.value))
      q.signs.marks.insert(q.signs.marks.end(), {state.top.next, q.maximum});
  }
  // What rests at zero is no mark, however far the rest is from it. It does for a good part of the record: what reads
  // zero now and then is off, or has no reading.
  const std::uint64_t resting = state.odd.same.from_length(kFrozenRun - 1).second;
  constexpr double kGoodPart = 0.1;
  const bool rests =
      static_cast<double>(state.odd.zero.count) > kGoodPart * state.values.n && 2 * resting > state.odd.zero.count;
  if (rests) std::erase(q.signs.marks, 0.0);
  q.signs.marked = 0;
  for (const double mark : q.signs.marks)
    q.signs.marked += mark == q.minimum            ? state.bottom.count
                      : mark == -state.bottom.next ? state.bottom.at_next
                      : mark == q.maximum          ? state.top.count
                                                   : state.top.at_next;
  std::tie(q.signs.frozen_runs, q.signs.frozen) = state.odd.same.from_length(kFrozenRun - 1);
  for (const auto& [from, to] : state.odd.same.places()) q.signs.frozen_at.push_back({from - 1, to});
  q.signs.longest.second = state.odd.same.second_longest() + 1;
  state.judge_exits(q);
  q.signs.held_times = held_times(state.odd.same);
  q.repeats = state.odd.same.set();
  const detail::LineWatch::Found lines =
      state.odd.lines.found(q.difference_kurtosis > kMostKurtosis ? 1 : value_step(q) / q.difference_sd, q.repeats);
  q.signs.lines.least = lines.least_run;
  q.signs.roughness = state.differences.roughness();
  q.signs.lines.throughout = lines.apart;
  if (lines.least_run > 0) {
    std::tie(q.signs.lines.runs, q.signs.lines.samples) = lines.runs->from_length(lines.least_run);
    if (lines.alone > 0)
      q.signs.lines.runs = q.signs.lines.samples = clamped_whole<std::uint64_t>(std::round(lines.alone));
    for (const auto& [from, to] : lines.runs->places())
      if (to - from >= q.signs.lines.least) q.signs.lines.at.push_back({from - 2, to});
  }
  q.signs.resting_value = state.odd.resting.value;
  q.signs.at_rest = state.odd.resting.count;
  q.signs.zeros = state.odd.zero.count;
  q.signs.zero_is_end = (q.minimum == 0 && state.bottom.is_reached(value_step(q))) ||
                        (q.maximum == 0 && state.top.is_reached(value_step(q)));
  q.signs.other_repeats = q.repeats - std::min(q.repeats, state.odd.zero.repeats);
  q.signs.nearest_to_zero = state.odd.zero.nearest;
  q.at_minimum = state.bottom.count;
  q.at_maximum = state.top.count;
  const bool may = state.top.value > -state.bottom.value && state.may_saturate(q.distinct_values);
  const auto saturated = [&](const Extreme& end) {
    const bool rest = (rests && end.value == 0) || end.is_rest(q.difference_sd, state.values.n);
    return may && !rest ? end.saturated(q.difference_sd < 2 * value_step(q)) : 0;
  };
  const std::uint64_t low = saturated(state.bottom), high = saturated(state.top);
  q.saturated = low + high;
  if (FrozenRuns(q).rare) q.saturated = 0;
  if (q.saturated > 0) {
    if (low > 0) q.signs.ends.push_back(q.minimum);
    if (high > 0) q.signs.ends.push_back(q.maximum);
    q.signs.apart = state.bottom.is_apart(others) || state.top.is_apart(others);
  }
  if (!state.odd.counter.is_even() && q.signs.marks.empty())
    state.odd.wraps.read(state.differences, q.maximum - q.minimum, q.signs);
  q.findings = findings_of(q, rate_hz);
  return q;
}

std::string detail::rate_remedy(const TimeBase& time) {
  const std::string column = time.candidate.empty() ? ""
                                                    : fmt::format("`time_column` {} takes that column for the time; ",
                                                                  shell_word(time.candidate));
  return column + "a log without time stamps needs `rate_hz`";
}

double known_rate_hz(const LogInfo& info) {
  if (info.time.rate_hz > 0) return info.time.rate_hz;
  throw numeric_error("E0402", info.file).says("the sampling rate is not known").hint(detail::rate_remedy(info.time));
}

}  // namespace libchar
