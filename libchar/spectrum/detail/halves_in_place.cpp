// The first step of a transform reads some columns of both halves, and has as many complex numbers of the even bins:
// they go where the samples of these columns were, half of them into the one half and half into the other; those of the
// odd bins go to memory beside. Once a step of the second kind has read its two even rows, their places are free for
// what the next pair needs of this one: even bins of the second half in the place of that half, odd ones in the place
// of the first. So a record of n samples in seven segments needs .375 n numbers beside it, and not .875 n.

#include <algorithm>
#include <atomic>
#include <cmath>

#include "libchar/core/parallel/parallel.hpp"
#include "libchar/spectrum/detail/half_pass.hpp"

namespace libchar {

using namespace half_segments;

struct HalvesInPlace::Pair {
  double *a = nullptr, *b = nullptr;  // none: not there
  double mean_a = 0, mean_b = 0;      // not finite: a sample is missing
  double* last_row = nullptr;
  double top = 0;  // bin h of b

  bool whole_a() const { return a != nullptr && std::isfinite(mean_a); }
  bool whole_b() const { return b != nullptr && std::isfinite(mean_b); }
  HalfBins bins(const RowTables& tables) const { return {b, a, tables.n2, (tables.n1 + 1) / 2, last_row}; }
};

HalvesInPlace::HalvesInPlace(std::size_t half, int threads)
    : tables_(half),
      odd_(aligned_room(tables_.n1 * tables_.pitch)),
      sums_(aligned_zeros(half)),
      last_row_{aligned_zeros(tables_.n2), aligned_zeros(tables_.n2)} {
  for (int k = 0; k < std::max(1, threads); ++k) {
    columns_.emplace_back(tables_);
    rows_.emplace_back(tables_);
  }
}

/// A half that is not whole is zeros: its partner has nothing to do with it.
double* HalvesInPlace::whole_or_nothing(double* half, double mean) {
  if (half != nullptr && std::isfinite(mean)) return half;
  if (half == nullptr) {
    if (!no_half_) no_half_ = aligned_room(tables_.h);
    half = no_half_.get();
  }
  std::fill_n(half, tables_.h, 0.0);
  return half;
}

void HalvesInPlace::transform_columns(const Pair& pair) {
  const RowTables& t = tables_;
  const RowsBetween even{pair.a, pair.b, t.n2}, odd{odd_.get(), nullptr, t.pitch};
  std::atomic<std::size_t> next{0};  // who does which columns makes no difference
  parallel::for_each(0, columns_.size(), [&](std::size_t k) {
    for (std::size_t column; (column = next.fetch_add(t.count)) < t.n2;)
      columns_[k].transform({pair.a, pair.b, pair.mean_a, pair.mean_b}, column, even, odd);
  });
}

void HalvesInPlace::add_rows(const Pair& before, Pair& pair, bool first, bool second) {
  const RowTables& t = tables_;
  double top_before = before.top;
  PairWork work{pair.mean_a,
                pair.mean_b,
                before.mean_b,
                {pair.a, pair.b, t.n2},
                {odd_.get(), nullptr, t.pitch},
                first ? before.bins(t) : pair.bins(t),  // numbers that are not used
                &top_before,
                pair.bins(t),
                &pair.top,
                true};
  work.first = first ? sums_.get() : nullptr;
  work.first_top = first ? &top_ : nullptr;
  work.second = second ? sums_.get() : nullptr;
  work.second_top = second ? &top_ : nullptr;
  std::vector<Pass> passes;
  for (RowScratch& rows : rows_) passes.emplace_back(t, rows, work);
  const std::size_t steps = passes[0].steps(), count = passes.size();
  const auto begin_of = [&](std::size_t k) { return steps * k / count; };
  parallel::for_each(0, count, [&](std::size_t k) { passes[k].begin_at(begin_of(k)); });
  parallel::for_each(0, count, [&](std::size_t k) { passes[k].run(begin_of(k), begin_of(k + 1)); });
}

std::vector<char> HalvesInPlace::add_all(std::span<double> record) {
  const std::size_t h = tables_.h, halves = record.size() / h;
  std::vector<char> used;
  Pair before;
  bool joined = false;
  for (std::size_t i = 0; i < halves; i += 2) {
    Pair pair;
    pair.a = record.data() + i * h;
    if (i + 1 < halves) pair.b = pair.a + h;
    parallel::both([&] { pair.mean_a = mean_about_first(pair.a, h); },
                   [&] {
                     if (pair.b != nullptr) pair.mean_b = mean_about_first(pair.b, h);
                   });
    pair.last_row = last_row_[i / 2 % 2].get();
    const bool whole_a = pair.whole_a(), whole_b = pair.whole_b();
    const bool first = joined && whole_a, second = whole_a && whole_b;
    if (i > 0) used.push_back(first);
    if (i + 1 < halves) used.push_back(second);
    pair.a = whole_or_nothing(pair.a, pair.mean_a);
    pair.b = whole_or_nothing(pair.b, pair.mean_b);
    if (!whole_a) pair.mean_a = 0;
    if (!whole_b) pair.mean_b = 0;
    if (whole_a || whole_b) {
      transform_columns(pair);
      add_rows(before, pair, first, second);
    }
    joined = whole_b;
    before = pair;
  }
  return used;
}

std::vector<double> HalvesInPlace::power() const {
  std::vector<double> out;
  natural_order(tables_, sums_.get(), top_, out);
  return out;
}

}  // namespace libchar
