#include "libchar/spectrum/detail/half_pass.hpp"

#include <utility>

namespace libchar::half_segments {
namespace {

inline void prefetch(const double* values, std::size_t n) {
  for (std::size_t i = 0; i < n; i += 8) __builtin_prefetch(values + i, 1, 2);
}

}  // namespace

Pass::Pass(const RowTables& tables, RowScratch& scratch, const PairWork& work)
    : t_(tables),
      scratch_(scratch),
      work_(work),
      bins_(tables.n2 / 2),
      even_{scratch.bins(0)},
      even_before_{scratch.bins(1)},
      odd_{scratch.bins(2)},
      odd_before_{scratch.bins(3)},
      even_falling_{scratch.bins(4)},
      even_falling_before_{scratch.bins(5)},
      odd_falling_{scratch.bins(6)},
      odd_falling_before_{scratch.bins(7)} {}

/// A row and its mirror row, which is made of the same two; the first even row and the middle ones are their own.
void Pass::make(std::size_t r, bool odd, Row to, Row to_mirror) {
  const std::size_t mirror = r == 0 && !odd ? 0 : t_.n1 - (odd ? 1 : 0) - r;
  const double* const values = scratch_.row(odd ? work_.odd : work_.even, r, 0);
  if (mirror != r) {
    const double* const mirrored = scratch_.row(odd ? work_.odd : work_.even, mirror, 1);
    make_row(r, odd, values, mirrored, to);
    return make_row(mirror, odd, mirrored, values, to_mirror);
  }
  if (r > 0 || odd) return make_row(r, odd, values, values, to);
  make_row(r, odd, values, scratch_.mirror_of(values), to);
  // Bin h is its own mirror.
  const double* const middle = values + t_.n2;
  first_top_ = *work_.before_top + middle[0];
  second_top_ = middle[0] + middle[1];
  if (work_.remember) *work_.after_top = middle[1];
}

void Pass::make_row(std::size_t r, bool odd, const double* values, const double* mirror, Row to) {
  const bool remember = work_.remember && !looks_ahead_;
  const bool block = work_.block_sums != nullptr && !looks_ahead_;
  const BinRow row{values,
                   mirror,
                   bins_,
                   t_.quarter.data(),
                   t_.start_of(r, odd),
                   work_.before.row(r, odd, t_.n1),
                   remember ? work_.after.row(r, odd, t_.n1) : scratch_.spare(0),
                   to.x,
                   to.x + scratch_.second(),
                   work_.before_mean - work_.mean_a,
                   work_.mean_a - work_.mean_b,
                   block ? work_.block_sums + place(r, odd) : nullptr,
                   work_.weight_a,
                   work_.weight_b};
  odd ? odd_bins(row) : even_bins(row);
}

void Pass::window(std::size_t r, bool odd, Row low, Row centre, Row high) {
  const std::size_t at = place(r, odd), next = scratch_.second();
  const Neighbours x{low.x, centre.x, high.x};
  const Neighbours y{low.x + next, centre.x + next, high.x + next};
  if (work_.first != nullptr && work_.first == work_.second) return add_windowed(x, y, bins_, work_.first + at);
  if (work_.first != nullptr) add_windowed(x, bins_, work_.first + at);
  if (work_.second != nullptr) add_windowed(y, bins_, work_.second + at);
}

/// Below the first row stands the last one, moved by one; below bin 1 its conjugate.
void Pass::window_first_row(Row last_odd, Row even, Row odd) {
  const Row below{scratch_.spare(0)};
  for (const std::size_t segment : {std::size_t{0}, scratch_.second()}) {
    for (std::size_t m2 = bins_ - 1; m2 > 0; --m2) put(below.x + segment, m2, value_at(last_odd.x + segment, m2 - 1));
    put(below.x + segment, 0, std::conj(value_at(odd.x + segment, 0)));
  }
  window(0, false, below, even, odd);
  // Both neighbours of bin h are the last odd bin, or its conjugate.
  const auto add = [&](double* sum, double x_top, const double* row) {
    if (sum == nullptr) return;
    const double y = 0.5 * x_top - 0.5 * value_at(row, bins_ - 1).real();
    *sum += y * y;
  };
  add(work_.first_top, first_top_, last_odd.x);
  add(work_.second_top, second_top_, last_odd.x + scratch_.second());
}

/// Above the last row stands the first one, moved by one; at its end bin h.
Pass::Row Pass::moved_up(Row first) {
  const Row above{scratch_.spare(1)};
  for (const std::size_t segment : {std::size_t{0}, scratch_.second()}) {
    for (std::size_t m2 = 0; m2 + 1 < bins_; ++m2) put(above.x + segment, m2, value_at(first.x + segment, m2 + 1));
    put(above.x + segment, bins_ - 1, segment == 0 ? first_top_ : second_top_);
  }
  return above;
}

/// Rows are short and in two orders, too short for the processor to see what comes next: asked for
/// a step ahead, what the next step needs is there.
void Pass::ask_for(std::size_t r, bool odd) const {
  const RowsBetween& rows = odd ? work_.odd : work_.even;
  if (rows.high == nullptr) {
    prefetch(rows.low + r * rows.pitch, 2 * t_.n2);
  } else {
    prefetch(rows.low + r * rows.pitch, t_.n2);
    prefetch(rows.high + r * rows.pitch, t_.n2);
  }
  prefetch(work_.before.row(r, odd, t_.n1), t_.n2);
  if (work_.block_sums != nullptr) prefetch(work_.block_sums + place(r, odd), bins_);
  if (work_.second != nullptr) prefetch(work_.second + place(r, odd), bins_);
}

void Pass::ask_for_step(std::size_t r) const {
  if (2 * r > t_.n1) return;
  ask_for(r, false);
  if (r > 0) ask_for(t_.n1 - r, false);
  if (2 * r == t_.n1) return;
  ask_for(r, true);
  ask_for(t_.n1 - 1 - r, true);
}

void Pass::make_step(std::size_t r) {
  make(r, false, even_, even_falling_);
  if (2 * r < t_.n1) make(r, true, odd_, odd_falling_);
}

/// Windows of the rows whose neighbours are there now.
void Pass::add_step(std::size_t r) {
  const std::size_t n1 = t_.n1, falling = n1 - r;
  if (r == 0) return window_first_row(odd_falling_, even_, odd_);
  window(r - 1, true, even_before_, odd_before_, even_);
  if (falling == r) {  // the middle row closes both ways
    window(r, false, odd_before_, even_, odd_falling_before_);
    return window(r, true, even_, odd_falling_before_, even_falling_before_);
  }
  const bool closes = 2 * r + 1 == n1;
  window(r, false, odd_before_, even_, odd_);
  window(falling, false, closes ? odd_ : odd_falling_, even_falling_, odd_falling_before_);
  window(falling, true, even_falling_, odd_falling_before_, even_falling_before_);
  if (closes) window(r, true, even_, odd_, even_falling_);
}

void Pass::keep_rows() {
  std::swap(even_falling_, even_falling_before_);
  std::swap(even_, even_before_);
  std::swap(odd_, odd_before_);
  std::swap(odd_falling_, odd_falling_before_);
}

void Pass::begin_at(std::size_t step) {
  if (step == 0) return;
  looks_ahead_ = true;
  make_step(step - 1);
  if (step == 1) even_falling_ = moved_up(even_);
  keep_rows();
  looks_ahead_ = false;
}

void Pass::run(std::size_t from, std::size_t to) {
  for (std::size_t r = from; r < to; ++r) {
    if (r + 1 < to) ask_for_step(r + 1);
    make_step(r);
    add_step(r);
    if (r == 0) even_falling_ = moved_up(even_);
    keep_rows();
  }
}

}  // namespace libchar::half_segments
