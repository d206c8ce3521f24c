#include "libchar/log/detail/line_watch.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "libchar/core/numeric/lanes.hpp"
#include "libchar/log/quality.hpp"

namespace libchar::detail {

/// Exact lines that a grid of values makes for each repeated one.
constexpr double kOfRepeats = 2;

// The first two samples of a record have no flag.
void LineWatch::take(double x, bool direct, std::uint64_t at) {
  if (n_ == 0) first_ = x;
  if (n_ == 1) {
    second_ = x;
    direct_ = direct;
  }
  if (n_ > 1) {
    flag(before_, last_, x, direct && pair_, at);
    ++looked_;
  }
  pair_ = direct && n_ > 0;
  before_ = last_;
  last_ = x;
  ++n_;
}

/// Bits of x[0..n) that may have the flag, a little less straight than `on_line`, so that steps of zero need no look of
/// their own; x[-2] can be read.
LIBCHAR_LANES void line_bits_lanes(const double* x, std::size_t n, std::uint64_t* words) {
  std::size_t i = 0;
  for (; i + 64 <= n; i += 64) {
    auto bit = Four{} != Four{}, all = bit;
    bit = decltype(bit){1, 2, 4, 8};
    for (std::size_t k = i; k < i + 64; k += 4) {
      const double* at = x + k;  // first: k - 2 alone is no index
      const Four b = LIBCHAR_FOUR(at - 1), step = b - LIBCHAR_FOUR(at - 2), bend = (LIBCHAR_FOUR(at) - b) - step;
      all |= (bend * bend < kAboutStraight * (step * step)) & bit;
      bit <<= 4;
    }
    words[i / 64] = static_cast<std::uint64_t>(all[0] | all[1] | all[2] | all[3]);
  }
  if (i < n) words[i / 64] = 0;
  for (; i < n; ++i) {
    const double* at = x + i;
    words[i / 64] |= std::uint64_t{on_line(at[-2], at[-1], at[0], kStraight)} << (i % 64);
  }
}
constexpr InLanes<line_bits_lanes> line_bits;

void LineWatch::flag(double a, double b, double c, bool whole, std::uint64_t at) {
  const bool straight = whole && on_line(a, b, c, kStraight);
  runs_.push(straight, at);
  exact_.push(straight && on_line(a, b, c, kExactly), at);
}

void LineWatch::pass(std::uint64_t n) {
  for (FlagRuns* runs : {&runs_, &exact_}) runs->push_without(n);
}

void LineWatch::look(std::span<const double> x, const unsigned char* starts, std::size_t from, std::size_t to,
                     std::uint64_t at) {
  std::uint64_t words[kStretch / 64];
  line_bits(&x[from], to - from, words);
  looked_ += to - from;
  std::size_t next = from;
  for (std::size_t word = 0; 64 * word < to - from; ++word)
    for (std::uint64_t bits = words[word]; bits != 0; bits &= bits - 1) {
      const std::size_t i = from + 64 * word + static_cast<std::size_t>(std::countr_zero(bits));
      pass(i - next);
      flag(x[i - 2], x[i - 1], x[i], starts == nullptr || (starts[i] == 0 && starts[i - 1] == 0), at + i);
      next = i + 1;
    }
  pass(to - next);
}

// A lone flag is none: most stretches of a noise are passed over at once.
void LineWatch::block(std::span<const double> x, const unsigned char* starts, std::uint64_t at, std::uint32_t pairs,
                      std::uint64_t repeats) {
  const auto begins = [&](std::size_t i) { return starts != nullptr && starts[i] != 0; };
  std::size_t i = 0;
  for (; i < std::min<std::size_t>(3, x.size()); ++i) take(x[i], !begins(i), at + i);
  if (i == x.size()) return;
  n_ += x.size() - i;
  coarse_ = coarse_ || (n_ > kEnough && has_chance_lines(repeats));
  if (coarse_) i = x.size();
  while (i < x.size()) {
    const std::size_t stretch = i / kStretch, end = std::min((stretch + 1) * kStretch, x.size());
    const std::size_t from = stretch >= 32 || (pairs >> stretch & 1) != 0 ? i : end - 1;
    pass(from - i);
    look(x, starts, from, end, at);
    i = end;
  }
  before_ = x[i - 2];
  last_ = x[i - 1];
  pair_ = !begins(i - 1);
}

void LineWatch::join(const LineWatch& later, bool direct, std::uint64_t at) {
  if (later.n_ == 0) {
    pair_ = false;
    return;
  }
  const std::uint64_t own = n_;
  if (own == 0) {  // nothing but missing samples so far
    *this = later;
    runs_ = FlagRuns(kFewest);
    exact_ = FlagRuns(2);
    runs_.join(later.runs_, at, 2);
    return exact_.join(later.exact_, at, 2);
  }
  coarse_ = coarse_ || later.coarse_;
  take(later.first_, direct, at);
  if (later.n_ > 1) take(later.second_, later.direct_, at + 1);
  runs_.join(later.runs_, at, 2);
  exact_.join(later.exact_, at, 2);
  n_ = own + later.n_;
  looked_ += later.looked_;
  if (later.n_ > 1) {
    before_ = later.before_;
    last_ = later.last_;
    pair_ = later.pair_;
  }
}

// On a grid, steps are alike about as often as values repeat; elsewhere exact lines are nobody's chance.
bool LineWatch::has_chance_lines(std::uint64_t repeats) const {
  const std::vector<double>&closed = runs_.closed(), &exact = exact_.closed();
  if (closed.empty()) return false;
  const double filled =
      exact.empty() ? 0 : std::max(exact[2], exact[1] + exact[2] - kOfRepeats * static_cast<double>(repeats));
  return 40 * (closed[1] + closed[2] - filled) > static_cast<double>(n_);
}

// What moves smoothly is nearly straight nearly everywhere, and more often nearly than exactly; gaps that were filled
// are few and long.
bool LineWatch::are_apart(std::uint64_t repeats) const {
  constexpr double kLeast = 0.1, kBent = 0.05, kTimes = 4;  // close to a knot, a line bends by little
  constexpr double kLongest = 40;                           // ratio of the rates
  const auto n = static_cast<double>(n_), straight = static_cast<double>(runs_.set());
  const double exact = static_cast<double>(exact_.set()) - kOfRepeats * static_cast<double>(repeats);
  return exact > kLeast * n && n - straight > kBent * n &&
         exact > kTimes * (straight - static_cast<double>(exact_.set())) &&
         kLongest * static_cast<double>(exact_.from_length(1).first) > n;
}

// Runs of two and three say how chance goes on.
std::uint64_t LineWatch::least_run() const {
  constexpr double kChance = 1e-3;
  const std::vector<double>& closed = runs_.closed();
  if (closed.empty()) return 0;
  const double two = closed[2], three = closed[3], goes_on = (three + 1) / (two + 2);
  double expected = two * goes_on;  // of three
  for (std::uint64_t length = 4; length <= FlagRuns::kLongestCounted; ++length) {
    expected *= goes_on;
    if (length >= kFewest && expected < kChance * (1 - std::min(goes_on, 0.999)))
      return length <= runs_.longest() ? length : 0;
  }
  return 0;
}

// Lone flags say which share of the straight ones chance makes exact; runs of two and more of them are as many as a
// Poisson variable of that mean reaches once in 10^4 records (Chernoff's bound) or less.
std::uint64_t LineWatch::least_exact_run() const {
  constexpr double kLogChance = -9.2;
  const std::vector<double>&straight = runs_.closed(), &exact = exact_.closed();
  const double lone = straight.empty() ? 0 : straight[1];
  const double share = ((exact.empty() ? 0 : exact[1]) + 1) / (lone + 1);
  for (std::uint64_t length = 2; length < kFewest; ++length) {
    const double mean =
        static_cast<double>(runs_.from_length(length).second) * std::pow(share, static_cast<double>(length));
    const auto count = static_cast<double>(exact_.from_length(length).first);
    if (count > mean && count - mean - count * std::log(count / mean) < kLogChance) return length;
  }
  return 0;
}

// Between neighbours, the middle of a smooth density is as likely as what is beside it; on a grid it is one of few.
double LineWatch::alone(double grid) const {
  constexpr double kLeast = 20, kTimes = 3, kDeviations = 5, kPerStep = 20;
  const std::vector<double>&straight = runs_.closed(), &exact = exact_.closed();
  if (straight.empty() || exact.empty()) return 0;
  const double by_chance = straight[1] * (kExactly / kStraight + kPerStep * grid);
  if (exact[1] < kLeast || exact[1] < kTimes * by_chance + kDeviations * std::sqrt(by_chance)) return 0;
  return (exact[1] - by_chance) * static_cast<double>(n_) / static_cast<double>(std::max<std::uint64_t>(1, looked_));
}

LineWatch::Found LineWatch::found(double grid, std::uint64_t repeats) const {
  if (coarse_) return {};
  const bool apart = are_apart(repeats);
  const Found straight{least_run(), &runs_, 0, apart}, exact{least_exact_run(), &exact_, 0, apart};
  const auto on_lines = [](const Found& one) {
    return one.least_run == 0 ? 0 : one.runs->from_length(one.least_run).second;
  };
  const Found& longer = on_lines(exact) > on_lines(straight) ? exact : straight;
  const double single = alone(grid);
  return single > static_cast<double>(on_lines(longer)) ? Found{1, &exact_, single, apart} : longer;
}

void forget_frozen(std::span<double> samples, std::uint64_t fewest) {
  for (std::size_t from = 0, to = 0; from < samples.size(); from = to) {
    const double value = samples[from];
    for (to = from + 1; to < samples.size() && samples[to] == value;) ++to;
    if (to - from >= fewest)
      for (double& x : samples.subspan(from, to - from)) x = kMissing;
  }
}

static void forget_lines_of(std::span<double> samples, std::uint64_t fewest, double share) {
  for (std::size_t from = 0, to = 0; from + 2 < samples.size(); from = to - 1) {
    double a = samples[from], b = samples[from + 1];
    for (to = from + 2; to < samples.size() && on_line(a, b, samples[to], share); ++to) {
      a = b;
      b = samples[to];
    }
    if (to - from >= fewest)
      for (double& x : samples.subspan(from + 1, to - from - 2)) x = kMissing;
  }
}

void forget_lines(std::span<double> samples, std::uint64_t fewest) {
  constexpr std::uint64_t kLong = LineWatch::kFewest + 2;
  if (fewest < kLong) forget_lines_of(samples, fewest, kExactly);
  forget_lines_of(samples, std::max(fewest, kLong), kStraight);
}

}  // namespace libchar::detail
