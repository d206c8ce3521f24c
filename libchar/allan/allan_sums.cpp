// Parts A and B of a record, side by side: each has, of every level l of the pyramid
// (allan_pyramid.cpp), the terms within it and its first and last seven values z (sums of 2^l
// samples less the part's origin x_0). The terms of both are
//
//   terms(A) + terms(B) + terms of [last seven of A | first seven of B],   z_B := z_B + n_B (x_0B - x_0A),
//
// n_B samples present in z_B: a term of sums of w values spans 2 w <= 8 of them, so that one across the boundary has at
// most seven on either side. Where B ends with one value at its highest level and A with an odd number there, the two
// make a value of the level above, which goes the same way as a part of one value.

#include "libchar/allan/allan_sums.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>

#include "libchar/allan/allan_covariance.hpp"
#include "libchar/allan/allan_pyramid.hpp"
#include "libchar/allan/detail/equivalent_dof.hpp"
#include "libchar/allan/detail/kernels/octave_terms.hpp"
#include "libchar/allan/detail/kernels/present_points.hpp"
#include "libchar/core/process/work.hpp"
#include "libchar/core/refusal.hpp"

namespace libchar {
namespace {

constexpr std::size_t kReach = LevelEnd::kMost;

void add_point(std::uint64_t m, const PresentTerms& tally, MissingSamples& missing, std::vector<std::uint64_t>& without,
               AllanCurve& curve) {
  if (2 * m > curve.samples) return;
  const long double factor = static_cast<long double>(m);
  AllanPoint point;
  point.m = m;
  point.tau_s = static_cast<double>(factor) * curve.dt_s;
  point.terms = tally.terms;
  if (curve.missing == 0 && tally.terms > 0) {
    point.deviation =
        static_cast<double>(std::sqrt(tally.squares / (2.0L * static_cast<long double>(tally.terms))) / factor);
    return curve.points.push_back(point);
  }
  PresentTerms means = tally;
  means.squares /= factor * factor;
  const double dof =
      tally.terms == 0 ? 1 : equivalent_dof(curve.type, {1}, m, tally.terms, stride_of(curve, point), curve.dt_s);
  const auto found = missing.corrected(static_cast<double>(m), means, 2, 1 / static_cast<double>(m), dof);
  missing.add_octave(static_cast<double>(m), means, found.variance);
  if (found.variance < 0) return without.push_back(m);
  point.deviation = static_cast<double>(std::sqrt(found.variance));
  point.inflation = found.inflation;
  point.added = found.added;
  curve.points.push_back(point);
}

/// Values of level `index` about the origin of another part; the samples of level 0 have none. In
/// long double: the origins may be far apart, and so may z and what it becomes be near.
void move_origin(LevelEnd& end, std::size_t index, double from, double to) {
  if (index == 0 || std::isnan(from) || std::isnan(to)) return;
  const double size = std::ldexp(1.0, static_cast<int>(index));
  const long double shift = static_cast<long double>(from) - static_cast<long double>(to);
  for (std::size_t i = 0; i < end.count; ++i)
    end.value[i] = static_cast<double>(static_cast<long double>(end.value[i]) +
                                       static_cast<long double>(size - end.absent[i]) * shift);
}

/// Terms that begin in `before` and end in `after`.
void add_across(std::size_t index, double origin, const LevelEnd& before, const LevelEnd& after,
                std::array<PresentTerms, 3>& terms) {
  const std::size_t all = before.count + after.count;
  double z[2 * kReach], lacks[2 * kReach];
  std::copy_n(before.value.begin(), before.count, z);
  std::copy_n(after.value.begin(), after.count, z + before.count);
  std::copy_n(before.absent.begin(), before.count, lacks);
  std::copy_n(after.absent.begin(), after.count, lacks + before.count);
  const bool holed = any_absent(lacks, all);
  if (index == 0 && holed) split_present(z, all, origin, z, lacks);
  const double scale = block_scale(z, all), size = std::ldexp(1.0, static_cast<int>(index));
  for (std::size_t k = index == 0 ? 0 : 2; k < 3; ++k) {
    const std::size_t width = std::size_t{1} << k, reach = 2 * width - 1;
    const std::size_t left = std::min(before.count, reach), right = std::min(after.count, reach);
    const std::size_t from = before.count - left;
    if (holed)
      add_present({z + from, lacks + from, size}, left + right, width, scale, terms[k]);
    else
      add_one_by_one(z + from, left + right, width, scale, terms[k]);
  }
}

/// One level of a part behind the same level of what is there.
void join_level(AllanSums& sums, std::size_t index, const AllanLevel& later) {
  if (sums.levels.size() <= index) sums.levels.resize(index + 1);
  AllanLevel& level = sums.levels[index];
  add_across(index, sums.origin, level.tail, later.head, level.terms);
  for (std::size_t k = 0; k < 3; ++k) level.terms[k] += later.terms[k];
  for (std::size_t i = 0; i < later.head.count; ++i) level.head.push_back(later.head.value[i], later.head.absent[i]);
  for (std::size_t i = 0; i < later.tail.count; ++i) level.tail.push_last(later.tail.value[i], later.tail.absent[i]);
  level.count += later.count;
}

/// The last value of a level has just made their number even: with the one before it is a value of the level above.
void hand_up_pair(AllanSums& sums, std::size_t index) {
  while (sums.levels[index].count % 2 == 0) {
    const LevelEnd& tail = sums.levels[index].tail;
    double pair[2] = {tail.value[tail.count - 2], tail.value[tail.count - 1]};
    double lacks[2] = {tail.absent[tail.count - 2], tail.absent[tail.count - 1]};
    if (index == 0) split_present(pair, 2, sums.origin, pair, lacks);
    AllanLevel one;
    one.count = 1;
    one.head.push_back(pair[0] + pair[1], lacks[0] + lacks[1]);
    one.tail = one.head;
    join_level(sums, ++index, one);
  }
}

void end_layout(StateWriter& to, const LevelEnd& end) {
  to.reals(std::span(end.value).first(end.count));
  to.reals(std::span(end.absent).first(end.count));
}

void end_layout(StateReader& from, LevelEnd& end) {
  const std::vector<double> value = from.reals(), absent = from.reals();
  if (value.size() > kReach || absent.size() != value.size()) from.refuse("the end of a level");
  for (std::size_t i = 0; i < value.size(); ++i) end.push_back(value[i], absent[i]);
}

/// Terms of sums of 2^k values start at some of those that have as many behind them; others would
/// make a curve that no record has, whose covariance takes for ever.
bool possible(const AllanLevel& level) {
  for (std::size_t k = 0; k < level.terms.size(); ++k) {
    const std::uint64_t span = std::uint64_t{2} << k;
    const std::uint64_t most = level.count < span ? 0 : level.count - span + 1;
    const PresentTerms& terms = level.terms[k];
    if (terms.terms > terms.starts || terms.starts > most) return false;
  }
  return true;
}

}  // namespace

void LevelEnd::push_back(double z, double lacks) {
  if (count == kMost) return;
  value[count] = z;
  absent[count] = lacks;
  ++count;
}

void LevelEnd::push_last(double z, double lacks) {
  if (count < kMost) return push_back(z, lacks);
  std::copy(value.begin() + 1, value.end(), value.begin());
  std::copy(absent.begin() + 1, absent.end(), absent.begin());
  value.back() = z;
  absent.back() = lacks;
}

void join(AllanSums& sums, const AllanSums& later) {
  if (later.samples == 0) return;
  if (sums.samples == 0) {
    sums = later;
    return;
  }
  const std::size_t top = later.levels.size() - 1;
  if (top >= 63 || sums.samples % (std::uint64_t{1} << top) != 0)
    throw std::logic_error("Allan sums joined where a sum of the later part straddles");
  sums.samples += later.samples;
  sums.missing += later.missing;
  if (std::isnan(sums.origin)) sums.origin = later.origin;
  for (std::size_t l = 0; l <= top; ++l) {
    AllanLevel level = later.levels[l];
    move_origin(level.head, l, later.origin, sums.origin);
    move_origin(level.tail, l, later.origin, sums.origin);
    join_level(sums, l, level);
  }
  // Below the top the number of values was even in front, and the later part has paired its own.
  if (later.levels[top].count == 1) hand_up_pair(sums, top);
}

void scale(AllanSums& sums, double factor) {
  const long double square = static_cast<long double>(factor) * static_cast<long double>(factor);
  for (AllanLevel& level : sums.levels)
    for (PresentTerms& terms : level.terms) terms.squares *= square;
}

AllanCurve octave_curve(const AllanSums& sums, double dt_s) {
  AllanCurve curve;
  curve.dt_s = dt_s;
  curve.samples = sums.samples;
  curve.missing = sums.missing;
  curve.stride_divisor = kPyramidStride;
  std::vector<std::uint64_t> without;
  MissingSamples missing;
  const auto& levels = sums.levels;
  for (std::size_t l = 0; l < levels.size(); ++l)
    for (std::size_t k = l == 0 ? 0 : 2; k < 3; ++k)
      add_point(std::uint64_t{1} << (l + k), levels[l].terms[k], missing, without, curve);
  note_missing(without, curve);
  if (curve.points.empty())
    throw numeric_error("E0401").says(
        "an Allan deviation needs at least 2 consecutive samples; none of its terms fits the " +
        std::to_string(curve.samples) + " of this record");
  for (const AllanPoint& point : curve.points) count_work(WorkKind::allan_terms, point.terms);
  return curve;
}

template <class Archive, class Sums>
static void allan_layout(Archive& at, Sums& sums) {
  at(sums.samples, sums.missing, sums.origin);
  at.list(sums.levels, 8, [&](auto& level) {
    at(level.count);
    end_layout(at, level.head);
    end_layout(at, level.tail);
    for (auto& terms : level.terms) at(terms.squares, terms.shortfall, terms.imbalance, terms.terms, terms.starts);
  });
}

void write_state(const AllanSums& sums, StateWriter& to) { allan_layout(to, sums); }

AllanSums read_allan_sums(StateReader& from) {
  AllanSums sums;
  allan_layout(from, sums);
  for (const AllanLevel& level : sums.levels)
    if (level.head.count != std::min<std::uint64_t>(level.count, kReach) || level.tail.count != level.head.count ||
        !possible(level))
      from.refuse("a level of the pyramid");
  // What follows is joined by these numbers.
  if (sums.levels.size() != static_cast<std::size_t>(std::bit_width(sums.samples)) || sums.missing > sums.samples)
    from.refuse("levels of the pyramid");
  for (std::size_t l = 0; l < sums.levels.size(); ++l)
    if (sums.levels[l].count != sums.samples >> l) from.refuse("values of a level of the pyramid");
  return sums;
}

}  // namespace libchar
