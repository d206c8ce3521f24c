#include "libchar/spectrum/detail/half_rows.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "libchar/core/numeric/lanes.hpp"
#include "libchar/core/parallel/parallel.hpp"

namespace libchar::half_segments {
namespace {

// Interleaved complex numbers, two in a vector.
#define SWAPPED(v) __builtin_shufflevector(v, v, 1, 0, 3, 2)
#define BACKWARDS(v) __builtin_shufflevector(v, v, 3, 2, 1, 0)
// Two vectors of interleaved numbers to four real or imaginary parts, in the order 0 2 1 3; the
// same exchange of places undoes itself.
#define EVEN_PLACES(v, w) __builtin_shufflevector(v, w, 0, 4, 2, 6)
#define ODD_PLACES(v, w) __builtin_shufflevector(v, w, 1, 5, 3, 7)
// Four real and four imaginary parts in their order to interleaved numbers in theirs.
#define FIRST_TWO(re, im) __builtin_shufflevector(re, im, 0, 4, 1, 5)
#define LAST_TWO(re, im) __builtin_shufflevector(re, im, 2, 6, 3, 7)

constexpr Four kSigns = {-1, 1, -1, 1};

}  // namespace

LIBCHAR_LANES void gather_columns_lanes(const HalfPair& pair, const ColumnStep& step, double* even, double* odd) {
  const double *a = pair.a + step.column, *b = pair.b + step.column;
  const std::size_t width = 2 * step.count;
  for (std::size_t t1 = 0; t1 < step.n1; ++t1, a += step.n2, b += step.n2) {
    const double cosine = step.shift[2 * t1];
    const Four crossed = step.shift[2 * t1 + 1] * kSigns;
    for (std::size_t i = 0; i < step.count; i += 4) {
      const Four va = LIBCHAR_FOUR(a + i) - pair.mean_a, vb = LIBCHAR_FOUR(b + i) - pair.mean_b;
      const Four u = EVEN_PLACES(va, vb), v = ODD_PLACES(va, vb);
      LIBCHAR_FOUR_TO(even + 2 * i) = u;
      LIBCHAR_FOUR_TO(even + 2 * i + 4) = v;
      LIBCHAR_FOUR_TO(odd + 2 * i) = u * cosine + SWAPPED(u) * crossed;
      LIBCHAR_FOUR_TO(odd + 2 * i + 4) = v * cosine + SWAPPED(v) * crossed;
    }
    even += width;
    odd += width;
  }
}

void gather_columns(const HalfPair& pair, const ColumnStep& step, double* even, double* odd) {
  return InLanes<gather_columns_lanes>()(pair, step, even, odd);
}

LIBCHAR_LANES void scatter_columns_lanes(const double* from, const ColumnStep& step, const ColumnTurns& turns,
                                         ColumnPlaces to) {
  const std::size_t width = 2 * step.count, period = 2 * step.n1 * step.n2 / step.count,
                    block = step.column / step.count;
  const std::size_t stride = 2 * block % period;
  std::size_t at = turns.odd ? block % period : 0;
  const double* fine = turns.fine;
  for (std::size_t m1 = 0; m1 < step.n1; ++m1, from += width, fine += width) {
    const double cosine = turns.coarse[2 * at], sine = turns.coarse[2 * at + 1];
    for (std::size_t i = 0; i < width; i += 8) {
      const Four fr = LIBCHAR_FOUR(fine + i), fi = LIBCHAR_FOUR(fine + i + 4);
      const Four wr = cosine * fr - sine * fi, wi = cosine * fi + sine * fr;
      const Four u = LIBCHAR_FOUR(from + i), v = LIBCHAR_FOUR(from + i + 4);
      const Four ur = EVEN_PLACES(u, v), ui = ODD_PLACES(u, v);  // columns 0 1 2 3 again
      const Four yr = ur * wr - ui * wi, yi = ur * wi + ui * wr;
      double* const out = i < step.count ? to.low + i : to.high + (i - step.count);
      LIBCHAR_FOUR_TO(out) = FIRST_TWO(yr, yi);
      LIBCHAR_FOUR_TO(out + 4) = LAST_TWO(yr, yi);
    }
    to.low += to.pitch;
    to.high += to.pitch;
    at += stride;
    if (at >= period) at -= period;
  }
}

void scatter_columns(const double* from, const ColumnStep& step, const ColumnTurns& turns, ColumnPlaces to) {
  return InLanes<scatter_columns_lanes>()(from, step, turns, to);
}

// Both kinds of bins begin alike: A and B from the transform of a + i b at m and at its mirror, and exp(-i pi k / L).
#define LIBCHAR_SEPARATE(p, at, back)                                                        \
  const Four u0 = LIBCHAR_FOUR(p.row + at), u1 = LIBCHAR_FOUR(p.row + at + 4);               \
  const Four v0 = LIBCHAR_FOUR(p.mirror + back), v1 = LIBCHAR_FOUR(p.mirror + back + 4);     \
  const Four ur = EVEN_PLACES(u0, u1), ui = ODD_PLACES(u0, u1);                              \
  const Four vr0 = EVEN_PLACES(v0, v1), vi0 = ODD_PLACES(v0, v1);                            \
  const Four vr = BACKWARDS(vr0), vi = BACKWARDS(vi0);                                       \
  const Four ar = 0.5 * (ur + vr), ai = 0.5 * (ui - vi);                                     \
  const Four br = 0.5 * (ui + vi), bi = 0.5 * (vr - ur);                                     \
  const Four tr = LIBCHAR_FOUR(p.quarter + at), ti = LIBCHAR_FOUR(p.quarter + at + 4);       \
  const Four rr = cr * tr - ci * ti, ri = cr * ti + ci * tr;                                 \
  if (p.cosine != nullptr) {                                                                 \
    const Four ca = rr * ar - ri * ai, cb = rr * br - ri * bi;                               \
    LIBCHAR_FOUR_TO(p.cosine + at / 2) =                                                     \
        (LIBCHAR_FOUR(p.cosine + at / 2) + p.weight_a * (ca * ca)) + p.weight_b * (cb * cb); \
  }                                                                                          \
  const Four pr = LIBCHAR_FOUR(p.before + at), pi = LIBCHAR_FOUR(p.before + at + 4);         \
  LIBCHAR_FOUR_TO(p.z + at) = br;                                                            \
  LIBCHAR_FOUR_TO(p.z + at + 4) = bi

LIBCHAR_LANES void even_bins_lanes(const BinRow& p) {
  const double cr = p.start.real(), ci = p.start.imag();
  for (std::size_t at = 0; at < 2 * p.bins; at += 8) {
    const std::size_t back = 4 * p.bins - 8 - at;
    LIBCHAR_SEPARATE(p, at, back);
    LIBCHAR_FOUR_TO(p.first + at) = pr + ar;
    LIBCHAR_FOUR_TO(p.first + at + 4) = pi + ai;
    LIBCHAR_FOUR_TO(p.second + at) = ar + br;
    LIBCHAR_FOUR_TO(p.second + at + 4) = ai + bi;
  }
}

void even_bins(const BinRow& p) { return InLanes<even_bins_lanes>()(p); }

LIBCHAR_LANES void odd_bins_lanes(const BinRow& p) {
  const double cr = p.start.real(), ci = p.start.imag();
  for (std::size_t at = 0; at < 2 * p.bins; at += 8) {
    const std::size_t back = 4 * p.bins - 8 - at;
    LIBCHAR_SEPARATE(p, at, back);
    const Four cotangent = rr / ri;  // with its sign
    LIBCHAR_FOUR_TO(p.first + at) = (pr - ar) + p.step_first;
    LIBCHAR_FOUR_TO(p.first + at + 4) = (pi - ai) + p.step_first * cotangent;
    LIBCHAR_FOUR_TO(p.second + at) = (ar - br) + p.step_second;
    LIBCHAR_FOUR_TO(p.second + at + 4) = (ai - bi) + p.step_second * cotangent;
  }
}

void odd_bins(const BinRow& p) { return InLanes<odd_bins_lanes>()(p); }

#define LIBCHAR_WINDOWED(x, at) \
  (0.5 * LIBCHAR_FOUR(x.centre + at) - 0.25 * (LIBCHAR_FOUR(x.low + at) + LIBCHAR_FOUR(x.high + at)))

LIBCHAR_LANES void add_windowed_lanes(const Neighbours& x, std::size_t bins, double* power) {
  for (std::size_t at = 0; at < 2 * bins; at += 8) {
    const Four re = LIBCHAR_WINDOWED(x, at), im = LIBCHAR_WINDOWED(x, at + 4);
    LIBCHAR_FOUR_TO(power + at / 2) = LIBCHAR_FOUR(power + at / 2) + (re * re + im * im);
  }
}

void add_windowed(const Neighbours& x, std::size_t bins, double* power) {
  return InLanes<add_windowed_lanes>()(x, bins, power);
}

LIBCHAR_LANES void add_two_windowed_lanes(const Neighbours& x, const Neighbours& y, std::size_t bins, double* power) {
  for (std::size_t at = 0; at < 2 * bins; at += 8) {
    const Four re = LIBCHAR_WINDOWED(x, at), im = LIBCHAR_WINDOWED(x, at + 4);
    const Four re2 = LIBCHAR_WINDOWED(y, at), im2 = LIBCHAR_WINDOWED(y, at + 4);
    LIBCHAR_FOUR_TO(power + at / 2) = (LIBCHAR_FOUR(power + at / 2) + (re * re + im * im)) + (re2 * re2 + im2 * im2);
  }
}

void add_windowed(const Neighbours& x, const Neighbours& y, std::size_t bins, double* power) {
  return InLanes<add_two_windowed_lanes>()(x, y, bins, power);
}

LIBCHAR_LANES double mean_about_first_lanes(const double* x, std::size_t n) {
  const double first = x[0];
  Four low = {}, high = {};
  std::size_t t = 0;
  for (; t + 8 <= n; t += 8) {
    low += LIBCHAR_FOUR(x + t) - first;
    high += LIBCHAR_FOUR(x + t + 4) - first;
  }
  const Four sum = low + high;
  double total = (sum[0] + sum[2]) + (sum[1] + sum[3]);
  for (; t < n; ++t) total += x[t] - first;
  return first + total / static_cast<double>(n);
}

double mean_about_first(const double* x, std::size_t n) { return InLanes<mean_about_first_lanes>()(x, n); }

namespace {

constexpr std::size_t kColumns = 8;  // a line of the cache from each half
constexpr std::size_t kPlaces = 2;   // for transformed rows
constexpr std::size_t kTurnsAtOnce = std::size_t{1} << 14U;

/// Where a column of all rows is more than the cache holds at once, several lines are taken from each half.
std::size_t columns_at_once(std::size_t h, std::size_t n2) {
  std::size_t count = h <= (std::size_t{1} << 17U) ? kColumns : 2 * kColumns;
  while (n2 % count != 0) count -= kColumns;
  return count;
}

}  // namespace

AlignedDoubles aligned_room(std::size_t n) {
  return AlignedDoubles(static_cast<double*>(::operator new[](n * sizeof(double), std::align_val_t{64})));
}

AlignedDoubles aligned_zeros(std::size_t n) {
  AlignedDoubles values = aligned_room(n);
  std::fill_n(values.get(), n, 0.0);
  return values;
}

Complex turn(double numerator, double denominator) {
  const double angle = std::numbers::pi * numerator / denominator;
  return {std::cos(angle), -std::sin(angle)};
}

std::pair<std::size_t, std::size_t> rows_and_columns(std::size_t h) {
  std::size_t rest = h;
  for (const std::size_t prime : {2U, 3U, 5U, 7U})
    while (rest > 1 && rest % prime == 0) rest /= prime;
  if (rest != 1) return {0, 0};
  std::pair<std::size_t, std::size_t> best{0, 0};
  double nearest = 8;  // the longer over the shorter, at most
  for (std::size_t n2 = 16; n2 <= h / 16; n2 += 8) {
    if (h % n2 != 0) continue;
    const std::size_t n1 = h / n2;
    const double ratio = static_cast<double>(n2) / static_cast<double>(n1);
    const double unequal = std::max(ratio, 1 / ratio);
    if (unequal > nearest) continue;
    nearest = unequal;
    best = {h / n2, n2};
  }
  return best;
}

RowTables::RowTables(std::size_t half)
    : h(half),
      n1(rows_and_columns(half).first),
      n2(rows_and_columns(half).second),
      pitch(2 * n2 + kPadding),
      count(columns_at_once(half, n2)) {
  const auto push = [](std::vector<double>& table, Complex value) {
    table.push_back(value.real());
    table.push_back(value.imag());
  };
  for (std::size_t t1 = 0; t1 < n1; ++t1) push(shift, turn(static_cast<double>(t1), static_cast<double>(n1)));
  for (std::size_t odd = 0; odd < 2; ++odd) {
    fine[odd].resize(2 * count * n1);
    for (std::size_t m1 = 0; m1 < n1; ++m1)
      for (std::size_t j = 0; j < count; ++j) {
        const Complex value = turn(static_cast<double>(j) * static_cast<double>(2 * m1 + odd), static_cast<double>(h));
        double* const four = fine[odd].data() + 2 * count * m1 + j / 4 * 8;
        four[j % 4] = value.real();
        four[4 + j % 4] = value.imag();
      }
  }
  const std::size_t period = 2 * h / count;
  coarse.resize(2 * period);
  const auto fill = [&](std::size_t begin, std::size_t end) {
    for (std::size_t j = begin; j < end; ++j) {
      const Complex value = turn(2 * static_cast<double>(j), static_cast<double>(period));
      coarse[2 * j] = value.real();
      coarse[2 * j + 1] = value.imag();
    }
  };
  // Isolated: who waits here holds the lock of the tables that are shared, and must not begin what needs another.
  parallel::isolated([&] { parallel::over_ranges(0, period, kTurnsAtOnce, fill); });
  quarter.resize(n2);
  for (std::size_t m2 = 0; m2 < n2 / 2; ++m2)
    put(quarter.data(), m2, turn(static_cast<double>(m2), static_cast<double>(n2)));
}

// Row r has every n1-th bin of its kind. Eight rows at a time, so that what is written next to each
// other is a line of the cache or two.
void natural_order(const RowTables& tables, const double* sums, double top, std::vector<double>& out) {
  constexpr std::size_t kTogether = 8;
  const std::size_t n1 = tables.n1, bins = tables.n2 / 2;
  out.resize(tables.h + 1);
  for (std::size_t begin = 0; begin < n1; begin += kTogether) {
    const std::size_t end = std::min(n1, begin + kTogether);
    for (std::size_t m2 = 0; m2 < bins; ++m2)
      for (std::size_t r = begin; r < end; ++r) {
        const std::size_t place = r * bins + sum_place(m2), m = r + n1 * m2;
        out[2 * m] = sums[place];
        out[2 * m + 1] = sums[tables.h / 2 + place];
      }
  }
  out[tables.h] = top;
}

ColumnScratch::ColumnScratch(const RowTables& tables)
    : tables_(tables),
      columns_(tables.n1, tables.count, tables.count, 1),
      values_(aligned_zeros(4 * tables.count * tables.n1)) {}

void ColumnScratch::transform(const HalfPair& pair, std::size_t column, const RowsBetween& even,
                              const RowsBetween& odd) {
  const RowTables& t = tables_;
  const ColumnStep step{t.n1, t.n2, t.count, column, t.shift.data()};
  double* const even_values = values_.get();
  double* const odd_values = even_values + 2 * t.count * t.n1;
  gather_columns(pair, step, even_values, odd_values);
  columns_.transform(even_values);
  scatter_columns(even_values, step, {t.fine[0].data(), t.coarse.data(), false}, even.columns(column, t.count));
  columns_.transform(odd_values);
  scatter_columns(odd_values, step, {t.fine[1].data(), t.coarse.data(), true}, odd.columns(column, t.count));
}

RowScratch::RowScratch(const RowTables& tables)
    : tables_(tables),
      row_(tables.n2),
      rows_(aligned_zeros(kPlaces * tables.pitch)),
      moved_(aligned_zeros(2 * tables.n2)),
      bins_(aligned_zeros((kBinRows + kSpareRows) * bin_pitch())) {}

const double* RowScratch::gathered(const RowsBetween& rows, std::size_t r) {
  const std::size_t count = tables_.count;
  if (!gathered_) gathered_ = aligned_zeros(2 * tables_.n2);
  const double *low = rows.low + r * rows.pitch, *high = rows.high + r * rows.pitch;
  double* to = gathered_.get();
  for (std::size_t column = 0; column < tables_.n2; column += count, to += 2 * count) {
    std::memcpy(to, low + column, count * sizeof(double));
    std::memcpy(to + count, high + column, count * sizeof(double));
  }
  return gathered_.get();
}

const double* RowScratch::row(const RowsBetween& rows, std::size_t r, std::size_t place) {
  double* const to = rows_.get() + place * tables_.pitch;
  row_.transform(rows.high == nullptr ? rows.low + r * rows.pitch : gathered(rows, r), to);
  return to;
}

const double* RowScratch::mirror_of(const double* first_row) {
  std::memcpy(moved_.get(), first_row + 2, (2 * tables_.n2 - 2) * sizeof(double));
  std::memcpy(moved_.get() + 2 * tables_.n2 - 2, first_row, 2 * sizeof(double));
  return moved_.get();
}

PairScratch::PairScratch(const RowTables& tables)
    : tables_(tables),
      columns_(tables),
      rows_(tables),
      values_{aligned_zeros(tables.n1 * tables.pitch), aligned_zeros(tables.n1 * tables.pitch)} {}

void PairScratch::transform_columns(const HalfPair& pair) {
  for (std::size_t column = 0; column < tables_.n2; column += tables_.count)
    columns_.transform(pair, column, even(), odd());
}

std::shared_ptr<RowPool> RowPools::of(std::size_t half) {
  const std::lock_guard lock(mutex_);
  std::weak_ptr<RowPool>& known = pools_[half];
  std::shared_ptr<RowPool> pool = known.lock();
  if (!pool) known = pool = std::make_shared<RowPool>(half);
  return pool;
}

std::unique_ptr<PairScratch> RowPool::borrow() {
  {
    const std::lock_guard lock(mutex_);
    if (!idle_.empty()) {
      auto scratch = std::move(idle_.back());
      idle_.pop_back();
      return scratch;
    }
  }
  return std::make_unique<PairScratch>(tables);
}

void RowPool::give_back(std::unique_ptr<PairScratch> scratch) {
  const std::lock_guard lock(mutex_);
  idle_.push_back(std::move(scratch));
}

}  // namespace libchar::half_segments
