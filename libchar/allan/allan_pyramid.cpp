// Overlapping Allan deviation at octaves from dyadic sums, one pass: level 0 holds the samples,
// level l the sums z of 2^l neighbours (less the first sample of the record). m = 1, 2, 4 come from
// level 0 at every start; m = 2^(l+2) from level l,
//   d_i = (z_{i+4} + … + z_{i+7}) - (z_i + … + z_{i+3}),   sigma^2(m) = sum d_i^2 / (2 m^2 n),
// that is at every (m/4)-th start (docs/theory/allan.md). Each level works in blocks of 4096 that stay in the
// processor's cache; a block costs half as many of the level above, so that all of them cost twice the first.
//
// In a record with missing samples a level also holds how many of the 2^l each sum lacks
// (present_points.cpp); blocks that lack none go the same way as ever.
//
// Squares are added in double within a block and in long double between blocks, whose wide exponent
// also carries blocks that had to be scaled because their squares overflow or vanish.

#include "libchar/allan/allan_pyramid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "libchar/allan/detail/kernels/octave_terms.hpp"

namespace libchar {
namespace {

constexpr std::size_t kBlock = 4096;
constexpr std::size_t kTail = 7;  // samples of the last block that terms reaching into the next one need
constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

/// `squares` of differences of sums, not of means.
using Tally = PresentTerms;

/// Squares this large or small lose nothing to overflow or underflow.
bool safe(double sum) { return sum > 1e-250 && sum < 1e300; }

}  // namespace

struct AllanPyramid::State {
  /// kBlock places that are set when they are filled: most levels of a short record never are.
  class Block {
   public:
    Block() = default;
    Block(Block&&) noexcept = default;
    Block& operator=(Block&&) noexcept = default;
    Block(const Block& other) : values_(other.values_ ? new double[kBlock] : nullptr) {
      if (values_) std::copy_n(other.values_.get(), kBlock, values_.get());
    }
    Block& operator=(const Block& other) { return *this = Block(other); }
    ~Block() = default;
    static Block made() {
      Block block;
      block.values_.reset(new double[kBlock]);
      return block;
    }
    double* data() const { return values_.get(); }

   private:
    std::unique_ptr<double[]> values_;
  };

  struct Level {
    std::array<double, kTail> tail, tail_absent{};  // end of the previous block
    Block block;                                    // being filled, `held` places taken
    std::size_t held = 0;
    std::vector<double> absent;  // how many samples the places of `block` lack; empty: none
    std::array<Tally, 3> tally;  // sums of 1 and 2 (level 0 only) and of 4
    bool started = false;        // tail is filled
    std::uint64_t count = 0;     // values so far
    LevelEnd first, last;        // of them
  };
  std::vector<Level> levels;
  std::uint64_t samples = 0, missing = 0;
  double origin = kMissing;

  void push(const double* x, std::size_t n);
  void close();
  void finish_block(std::size_t level, const double* z, const double* absent, std::size_t n);
  void finish_held(std::size_t level);
  void within(Level& level, bool base, const double* z, std::size_t n, const double* sums);
  void across(Level& level, std::size_t index, const double* z, const double* absent, std::size_t n);
  void across_holed(Level& level, std::size_t index, const Holed& joint, std::size_t taken);
  void holed_block(std::size_t level, const double* z, const double* sum, const double* absent, std::size_t n);
  void holed_base(const double* x, std::size_t n);
  void hand_up(std::size_t level, const double* z, const double* absent, std::size_t n, double origin_of_level);
  void keep_tail(Level& level, const double* z, const double* absent) const;
  void keep_ends(Level& level, const double* z, const double* absent, std::size_t n) const;
  Level& at(std::size_t level);
};

AllanPyramid::State::Level& AllanPyramid::State::at(std::size_t level) {
  while (levels.size() <= level) {
    levels.emplace_back();
    levels.back().block = Block::made();
  }
  return levels[level];
}

void AllanPyramid::State::push(const double* x, std::size_t n) {
  samples += n;
  at(0);
  while (n > 0) {
    if (levels[0].held == 0 && n >= kBlock) {  // straight from the caller's memory
      finish_block(0, x, nullptr, kBlock);
      x += kBlock;
      n -= kBlock;
      continue;
    }
    const std::size_t take = std::min(n, kBlock - levels[0].held);
    std::copy_n(x, take, levels[0].block.data() + levels[0].held);
    levels[0].held += take;
    x += take;
    n -= take;
    if (levels[0].held == kBlock) finish_held(0);
  }
}

/// The block of a level is full. It is taken out while it is looked at: levels may be added above.
void AllanPyramid::State::finish_held(std::size_t level) {
  Block full = std::move(levels[level].block);
  std::vector<double> absent = std::exchange(levels[level].absent, {});
  levels[level].held = 0;
  finish_block(level, full.data(), absent.empty() ? nullptr : absent.data(), kBlock);
  levels[level].block = std::move(full);
}

/// Terms inside one block; `sums` of a block without missing values, else null.
void AllanPyramid::State::within(Level& level, bool base, const double* z, std::size_t n, const double* sums) {
  for (std::size_t k = base ? 0 : 2; k < 3; ++k) {
    const std::size_t width = std::size_t{1} << k;
    if (n < 2 * width) continue;
    if (sums != nullptr && safe(sums[k])) {
      level.tally[k].squares += static_cast<long double>(sums[k]);
      level.tally[k].terms += n - 2 * width + 1;
      level.tally[k].starts += n - 2 * width + 1;
    } else {
      add_one_by_one(z, n, width, block_scale(z, n), level.tally[k]);
    }
  }
}

/// Terms that begin in the previous block and end in this one.
void AllanPyramid::State::across(Level& level, std::size_t index, const double* z, const double* absent,
                                 std::size_t n) {
  if (!level.started) return;
  const std::size_t taken = std::min(n, kTail), all = kTail + taken;
  double joint[2 * kTail], lacks[2 * kTail] = {};
  std::copy(level.tail.begin(), level.tail.end(), joint);
  std::copy_n(z, taken, joint + kTail);
  if (index > 0) std::copy(level.tail_absent.begin(), level.tail_absent.end(), lacks);
  if (absent != nullptr) std::copy_n(absent, taken, lacks + kTail);
  if (index == 0 && std::any_of(joint, joint + all, [](double v) { return std::isnan(v); }))
    split_present(joint, all, origin, joint, lacks);
  if (any_absent(lacks, all))
    return across_holed(level, index, {joint, lacks, std::ldexp(1.0, static_cast<int>(index))}, taken);
  const double scale = block_scale(joint, all);
  for (std::size_t k = index == 0 ? 0 : 2; k < 3; ++k) {
    const std::size_t width = std::size_t{1} << k,
                      reach = 2 * width - 1;  // samples needed on either side
    const std::size_t right = std::min(taken, reach);
    add_one_by_one(joint + kTail - reach, reach + right, width, scale, level.tally[k]);
  }
}

void AllanPyramid::State::across_holed(Level& level, std::size_t index, const Holed& joint, std::size_t taken) {
  const double scale = block_scale(joint.sum, kTail + taken);
  for (std::size_t k = index == 0 ? 0 : 2; k < 3; ++k) {
    const std::size_t width = std::size_t{1} << k, reach = 2 * width - 1;
    const std::size_t from = kTail - reach, right = std::min(taken, reach);
    add_present({joint.sum + from, joint.absent + from, joint.size}, reach + right, width, scale, level.tally[k]);
  }
}

void AllanPyramid::State::keep_tail(Level& level, const double* z, const double* absent) const {
  std::copy_n(z + kBlock - kTail, kTail, level.tail.begin());
  level.tail_absent = {};
  if (absent != nullptr) std::copy_n(absent + kBlock - kTail, kTail, level.tail_absent.begin());
  level.started = true;
}

/// What joins this part of a record to its neighbours (allan_sums.hpp).
void AllanPyramid::State::keep_ends(Level& level, const double* z, const double* absent, std::size_t n) const {
  const auto lacks = [&](std::size_t i) { return absent != nullptr ? absent[i] : 0.0; };
  for (std::size_t i = 0; i < std::min(n, kTail); ++i) level.first.push_back(z[i], lacks(i));
  for (std::size_t i = n - std::min(n, kTail); i < n; ++i) level.last.push_last(z[i], lacks(i));
  level.count += n;
}

void AllanPyramid::State::hand_up(std::size_t level, const double* z, const double* absent, std::size_t n,
                                  double shift) {
  const std::size_t pairs = n / 2;
  if (pairs == 0) return;
  Level& above = at(level + 1);
  sum_pairs(z, pairs, shift, above.block.data() + above.held);
  if (absent != nullptr && above.absent.empty()) above.absent.resize(kBlock);
  if (absent != nullptr)
    for (std::size_t i = 0; i < pairs; ++i) above.absent[above.held + i] = absent[2 * i] + absent[2 * i + 1];
  above.held += pairs;
  if (above.held == kBlock) finish_held(level + 1);
}

/// One block of a level: its terms, its tail, its pair sums. All blocks but the very last have
/// kBlock values. `absent` is null where none is missing, and at the base, where NaN says so.
void AllanPyramid::State::finish_block(std::size_t index, const double* z, const double* absent, std::size_t n) {
  const bool base = index == 0;
  if (absent != nullptr) return holed_block(index, z, z, absent, n);
  double sums[3] = {};
  if (base)
    squares_of_one_two_four(z, n, sums);
  else
    sums[2] = squares_of_four(z, n);
  // Every value is in some difference, and what is missing or infinite is in the sum then; only
  // huge values are there too.
  const bool clean = n >= 8 && std::isfinite(sums[base ? 0 : 2]) ? true : all_finite(z, n);
  if (base && !clean) return holed_base(z, n);
  if (base && std::isnan(origin)) origin = z[0];
  Level& level = at(index);
  across(level, index, z, nullptr, n);
  within(level, base, z, n, clean ? sums : nullptr);
  if (n == kBlock) keep_tail(level, z, nullptr);
  keep_ends(level, z, nullptr, n);
  hand_up(index, z, nullptr, n, base ? origin : 0.0);
}

/// Where something is missing: `z` as it stands in the tail, `sum` and `absent` as the terms and
/// the level above need it.
void AllanPyramid::State::holed_block(std::size_t index, const double* z, const double* sum, const double* absent,
                                      std::size_t n) {
  const double size = std::ldexp(1.0, static_cast<int>(index));
  Level& level = at(index);
  across(level, index, z, absent, n);
  const double scale = block_scale(sum, n);
  for (std::size_t k = index == 0 ? 0 : 2; k < 3; ++k)
    add_present({sum, absent, size}, n, std::size_t{1} << k, scale, level.tally[k]);
  if (n == kBlock) keep_tail(level, z, absent);
  keep_ends(level, z, absent, n);
  hand_up(index, sum, absent, n, 0);
}

/// Samples of which some are missing; an infinite one is.
void AllanPyramid::State::holed_base(const double* x, std::size_t n) {
  std::vector<double> values(x, x + n), sum(n), absent(n);
  for (double& v : values) {
    if (std::isinf(v)) v = kMissing;
    if (std::isnan(v)) ++missing;
    if (std::isnan(origin)) origin = v;
  }
  split_present(values.data(), n, origin, sum.data(), absent.data());
  holed_block(0, values.data(), sum.data(), absent.data(), n);
}

/// The blocks that are not full are looked at too; no more samples come.
void AllanPyramid::State::close() {
  for (std::size_t l = 0; l < levels.size(); ++l) {
    const std::size_t held = std::exchange(levels[l].held, 0);
    if (held == 0) continue;
    const Level& level = levels[l];
    const std::vector<double> rest(level.block.data(), level.block.data() + held);
    std::vector<double> absent;
    if (!level.absent.empty())
      absent.assign(level.absent.begin(), level.absent.begin() + static_cast<std::ptrdiff_t>(held));
    finish_block(l, rest.data(), absent.empty() ? nullptr : absent.data(), held);
  }
}

AllanPyramid::AllanPyramid() : state_(detail::hidden<State>()) {}
AllanPyramid::AllanPyramid(const AllanSums& sums) : AllanPyramid() {
  state_->samples = sums.samples;
  state_->missing = sums.missing;
  state_->origin = sums.origin;
  for (const AllanLevel& level : sums.levels) {
    State::Level& own = state_->levels.emplace_back();
    own.count = level.count;
    own.first = level.head;
    own.last = level.tail;
    own.tally = level.terms;
  }
}

void AllanPyramid::push(std::span<const double> samples) { state_->push(samples.data(), samples.size()); }

AllanCurve AllanPyramid::finish(double dt_s) const& {
  AllanPyramid closed;  // the open blocks are closed in a copy: more samples may still come
  *closed.state_ = *state_;
  return std::move(closed).finish(dt_s);
}

AllanCurve AllanPyramid::finish(double dt_s) && { return octave_curve(std::move(*this).sums(), dt_s); }

AllanSums AllanPyramid::sums() && {
  state_->close();
  AllanSums out{state_->samples, state_->missing, state_->origin, {}};
  for (const State::Level& level : state_->levels)
    out.levels.push_back({level.count, level.first, level.last, level.tally});
  return out;
}

AllanCurve pyramid_deviation(std::span<const double> record, double dt_s) {
  AllanPyramid pyramid;
  pyramid.push(record);
  return std::move(pyramid).finish(dt_s);
}

}  // namespace libchar
