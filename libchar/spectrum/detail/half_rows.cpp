#include "libchar/spectrum/detail/half_rows.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "libchar/core/parallel/parallel.hpp"

namespace libchar::half_segments {
namespace {

constexpr std::size_t kColumns = 8;  // a line of the cache from each half
constexpr std::size_t kPlaces = 2;   // for transformed rows
constexpr std::size_t kTurnsAtOnce = std::size_t{1} << 14U;

/// Where a column of all rows is more than the cache holds at once, several lines are taken from
/// each half.
std::size_t columns_at_once(std::size_t h, std::size_t n2) {
  std::size_t count = h <= (std::size_t{1} << 17U) ? kColumns : 2 * kColumns;
  while (n2 % count != 0) count -= kColumns;
  return count;
}

}  // namespace

AlignedDoubles aligned_room(std::size_t n) {
  return AlignedDoubles(
      static_cast<double*>(::operator new[](n * sizeof(double), std::align_val_t{64})));
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
  for (std::size_t t1 = 0; t1 < n1; ++t1)
    push(shift, turn(static_cast<double>(t1), static_cast<double>(n1)));
  for (std::size_t odd = 0; odd < 2; ++odd) {
    fine[odd].resize(2 * count * n1);
    for (std::size_t m1 = 0; m1 < n1; ++m1)
      for (std::size_t j = 0; j < count; ++j) {
        const Complex value = turn(static_cast<double>(j) * static_cast<double>(2 * m1 + odd),
                                   static_cast<double>(h));
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
void natural_order(const RowTables& tables,
                   const double* sums,
                   double top,
                   std::vector<double>& out) {
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

void ColumnScratch::transform(const HalfPair& pair,
                              std::size_t column,
                              const RowsBetween& even,
                              const RowsBetween& odd) {
  const RowTables& t = tables_;
  const ColumnStep step{t.n1, t.n2, t.count, column, t.shift.data()};
  double* const even_values = values_.get();
  double* const odd_values = even_values + 2 * t.count * t.n1;
  gather_columns(pair, step, even_values, odd_values);
  columns_.transform(even_values);
  scatter_columns(
      even_values, step, {t.fine[0].data(), t.coarse.data(), false}, even.columns(column, t.count));
  columns_.transform(odd_values);
  scatter_columns(
      odd_values, step, {t.fine[1].data(), t.coarse.data(), true}, odd.columns(column, t.count));
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
