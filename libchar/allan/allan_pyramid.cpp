// Overlapping Allan deviation at octaves from dyadic sums, one pass: level 0 holds the samples,
// level l the sums z of 2^l neighbours (less the first sample of the record). m = 1, 2, 4 come from
// level 0 at every start; m = 2^(l+2) from level l,
//   d_i = (z_{i+4} + … + z_{i+7}) - (z_i + … + z_{i+3}),   sigma^2(m) = sum d_i^2 / (2 m^2 n),
// that is at every (m/4)-th start (docs/theory/allan.md). Each level works in blocks of
// 4096 that stay in the processor's cache; a block costs half as many of the level above, so that
// all of them cost twice the first.
//
// Squares are added in double within a block and in long double between blocks, whose wide exponent
// also carries blocks that had to be scaled because their squares overflow or vanish.

#include "libchar/allan/allan_pyramid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "libchar/allan/allan_deviation.hpp"
#include "libchar/allan/detail/pyramid_kernels.hpp"
#include "libchar/core/error.hpp"

namespace libchar {
namespace {

constexpr std::size_t kBlock = 4096;
constexpr std::size_t kTail =
    7;  // samples of the last block that terms reaching into the next one need
constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

struct Tally {
  long double sum = 0;
  std::uint64_t terms = 0;
};

/// Terms of sums of `width` neighbours that start in z[from], …, touching nothing missing; z scaled
/// so that squares are safe.
void add_one_by_one(const double* z, std::size_t n, std::size_t width, double scale, Tally& tally) {
  double lane[8] = {};
  std::uint64_t terms = 0;
  for (std::size_t i = 0; i + 2 * width <= n; ++i) {
    double d = (z[i + width] - z[i]) * scale;
    if (width == 2) d = (z[i + 2] - z[i]) * scale + (z[i + 3] - z[i + 1]) * scale;
    if (width == 4)
      d = ((z[i + 4] - z[i]) * scale + (z[i + 6] - z[i + 2]) * scale) +
          ((z[i + 5] - z[i + 1]) * scale + (z[i + 7] - z[i + 3]) * scale);
    if (std::isnan(d)) continue;
    lane[i % 8] += d * d;
    ++terms;
  }
  const double sum =
      ((lane[0] + lane[4]) + (lane[2] + lane[6])) + ((lane[1] + lane[5]) + (lane[3] + lane[7]));
  tally.sum += static_cast<long double>(sum) / static_cast<long double>(scale) /
               static_cast<long double>(scale);
  tally.terms += terms;
}

/// A power of two that brings the largest deviation of the block near 1.
double block_scale(const double* z, std::size_t n) {
  double first = kMissing, largest = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (std::isnan(z[i])) continue;
    if (std::isnan(first)) first = z[i];
    largest = std::max(largest, std::fabs(z[i] - first));
  }
  if (largest == 0 || !std::isfinite(largest)) return 1;
  return std::ldexp(1.0, std::clamp(-std::ilogb(largest), -1000, 1000));
}

/// Squares this large or small lose nothing to overflow or underflow.
bool safe(double sum) {
  return sum > 1e-250 && sum < 1e300;
}

}  // namespace

struct AllanPyramid::State {
  struct Level {
    std::array<double, kTail> tail;  // end of the previous block
    std::vector<double>
        block;  // kBlock places for the block that is being filled, `held` of them taken
    std::size_t held = 0;
    std::array<Tally, 3> tally;  // sums of 1 and 2 (level 0 only) and of 4
    bool started = false;        // tail is filled
  };
  std::vector<Level> levels;
  std::uint64_t samples = 0, missing = 0;
  double origin = kMissing;

  void push(const double* x, std::size_t n);
  void finish_block(std::size_t level, const double* z, std::size_t n);
  void finish_held(std::size_t level);
  void within(Level& level, bool base, const double* z, std::size_t n, const double* sums);
  void across(Level& level, bool base, const double* z, std::size_t n);
  void sanitized(std::size_t level, const double* z, std::size_t n);
  void hand_up(std::size_t level, const double* z, std::size_t n, double origin_of_level);
  Level& at(std::size_t level);
};

AllanPyramid::State::Level& AllanPyramid::State::at(std::size_t level) {
  while (levels.size() <= level) {
    levels.emplace_back();
    levels.back().block.resize(kBlock);
  }
  return levels[level];
}

void AllanPyramid::State::push(const double* x, std::size_t n) {
  samples += n;
  at(0);
  while (n > 0) {
    if (levels[0].held == 0 && n >= kBlock) {  // straight from the caller's memory
      finish_block(0, x, kBlock);
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
  std::vector<double> full = std::move(levels[level].block);
  levels[level].held = 0;
  finish_block(level, full.data(), kBlock);
  levels[level].block = std::move(full);
}

/// Terms inside one block; `sums` of a block without missing values, else null.
void AllanPyramid::State::within(
    Level& level, bool base, const double* z, std::size_t n, const double* sums) {
  for (std::size_t k = base ? 0 : 2; k < 3; ++k) {
    const std::size_t width = std::size_t{1} << k;
    if (n < 2 * width) continue;
    if (sums != nullptr && safe(sums[k])) {
      level.tally[k].sum += static_cast<long double>(sums[k]);
      level.tally[k].terms += n - 2 * width + 1;
    } else {
      add_one_by_one(z, n, width, block_scale(z, n), level.tally[k]);
    }
  }
}

/// Terms that begin in the previous block and end in this one.
void AllanPyramid::State::across(Level& level, bool base, const double* z, std::size_t n) {
  if (!level.started) return;
  double joint[2 * kTail];
  std::copy(level.tail.begin(), level.tail.end(), joint);
  const std::size_t taken = std::min(n, kTail);
  std::copy_n(z, taken, joint + kTail);
  const double scale = block_scale(joint, kTail + taken);
  for (std::size_t k = base ? 0 : 2; k < 3; ++k) {
    const std::size_t width = std::size_t{1} << k,
                      reach = 2 * width - 1;  // samples needed on either side
    const std::size_t right = std::min(taken, reach);
    add_one_by_one(joint + kTail - reach, reach + right, width, scale, level.tally[k]);
  }
}

void AllanPyramid::State::hand_up(std::size_t level, const double* z, std::size_t n, double shift) {
  const std::size_t pairs = n / 2;
  if (pairs == 0) return;
  Level& above = at(level + 1);
  sum_pairs(z, pairs, shift, above.block.data() + above.held);
  above.held += pairs;
  if (above.held == kBlock) finish_held(level + 1);
}

/// One block of a level: its terms, its tail, its pair sums. All blocks but the very last have
/// kBlock values.
void AllanPyramid::State::finish_block(std::size_t index, const double* z, std::size_t n) {
  const bool base = index == 0;
  double sums[3] = {};
  if (base)
    squares_of_one_two_four(z, n, sums);
  else
    sums[2] = squares_of_four(z, n);
  // Every value is in some difference, and what is missing or infinite is in the sum then; only
  // huge values are there too.
  const bool clean = n >= 8 && std::isfinite(sums[base ? 0 : 2]) ? true : all_finite(z, n);
  if (base && !clean) {
    for (std::size_t i = 0; i < n; ++i)
      if (std::isinf(z[i])) return sanitized(index, z, n);
    missing +=
        static_cast<std::uint64_t>(std::count_if(z, z + n, [](double v) { return std::isnan(v); }));
  }
  if (base && std::isnan(origin))
    for (std::size_t i = 0; i < n && std::isnan(origin); ++i) origin = z[i];
  Level& level = at(index);
  across(level, base, z, n);
  within(level, base, z, n, clean ? sums : nullptr);
  if (n == kBlock) {
    std::copy_n(z + n - kTail, kTail, level.tail.begin());
    level.started = true;
  }
  hand_up(index, z, n, base && !std::isnan(origin) ? origin : 0.0);
}

/// An infinite sample is a missing one.
void AllanPyramid::State::sanitized(std::size_t index, const double* z, std::size_t n) {
  std::vector<double> copy(z, z + n);
  for (double& v : copy)
    if (std::isinf(v)) v = kMissing;
  finish_block(index, copy.data(), n);
}

void AllanPyramid::StateDeleter::operator()(State* state) const {
  delete state;
}

AllanPyramid::AllanPyramid() : state_(new State) {}
AllanPyramid::~AllanPyramid() = default;
AllanPyramid::AllanPyramid(AllanPyramid&&) noexcept = default;
AllanPyramid& AllanPyramid::operator=(AllanPyramid&&) noexcept = default;

void AllanPyramid::push(std::span<const double> samples) {
  state_->push(samples.data(), samples.size());
}

AllanCurve AllanPyramid::finish(double dt_s) const {
  State state = *state_;  // the open blocks are closed in a copy: more samples may still come
  for (std::size_t l = 0; l < state.levels.size(); ++l) {
    const std::vector<double> rest(
        state.levels[l].block.begin(),
        state.levels[l].block.begin() + static_cast<std::ptrdiff_t>(state.levels[l].held));
    state.levels[l].held = 0;
    if (!rest.empty()) state.finish_block(l, rest.data(), rest.size());
  }
  AllanCurve curve;
  curve.dt_s = dt_s;
  curve.samples = state.samples;
  curve.missing = state.missing;
  curve.stride_divisor = 4;
  std::uint64_t without_terms = 0;
  const auto add = [&](std::uint64_t m, const Tally& tally) {
    if (2 * m > state.samples) return;
    if (tally.terms == 0) {
      ++without_terms;
      return;
    }
    AllanPoint point;
    point.m = m;
    point.tau_s = static_cast<double>(m) * dt_s;
    point.terms = tally.terms;
    const long double factor = static_cast<long double>(m);
    point.deviation = static_cast<double>(
        std::sqrt(tally.sum / (2.0L * static_cast<long double>(tally.terms))) / factor);
    curve.points.push_back(point);
  };
  for (std::size_t l = 0; l < state.levels.size(); ++l)
    for (std::size_t k = l == 0 ? 0 : 2; k < 3; ++k)
      add(std::uint64_t{1} << (l + k), state.levels[l].tally[k]);
  if (without_terms > 0)
    curve.notes.push_back("gaps leave no term at the " + std::to_string(without_terms) +
                          " longest averaging times");
  if (curve.points.empty())
    throw Error(
        {ErrorKind::numeric,
         "",
         "",
         "an Allan deviation needs at least 2 consecutive samples; none of its terms fits the " +
             std::to_string(state.samples) + " of this record",
         "",
         ""});
  return curve;
}

}  // namespace libchar
