#pragma once
// The two-step transform of a pair of halves into rows of bins (half_segments.cpp has the equations): tables that
// depend on the length alone, and memory to work in, both shared by all who transform halves of that length.

#include <complex>
#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <new>
#include <utility>
#include <vector>

#include "libchar/spectrum/fft.hpp"

namespace libchar::half_segments {
// The inner loops of HalfSegments (half_segments.cpp has the equations), in explicit lanes.

using Complex = std::complex<double>;

/// Inside a row of bins four values stand as four real and four imaginary parts, in the order that unpacking gives.
inline constexpr std::size_t kSlot[4] = {0, 2, 1, 3};

/// Places of the real and imaginary parts of value m2 of a row, and of a sum.
inline std::size_t real_place(std::size_t m2) { return m2 / 4 * 8 + kSlot[m2 % 4]; }
inline std::size_t sum_place(std::size_t m2) { return m2 / 4 * 4 + kSlot[m2 % 4]; }

inline Complex value_at(const double* row, std::size_t m2) { return {row[real_place(m2)], row[real_place(m2) + 4]}; }
inline void put(double* row, std::size_t m2, Complex value) {
  row[real_place(m2)] = value.real();
  row[real_place(m2) + 4] = value.imag();
}

/// Two halves and their means.
struct HalfPair {
  const double *a, *b;
  double mean_a, mean_b;
};

struct ColumnStep {
  std::size_t n1, n2, count, column;  // count: columns at once, a multiple of 8
  const double* shift;                // [n1] exp(-i pi t1 / n1), interleaved: half a bin
};

/// `count` columns of u = a + i b less the means, as they are (for the even bins) and turned by
/// half a bin (for the odd ones). Of four columns the middle two change places.
void gather_columns(const HalfPair& pair, const ColumnStep& step, double* even, double* odd);

struct ColumnTurns {
  const double* fine;    // [n1] exp(-2 pi i m j / h), j < count; four real and four imaginary parts;
                         // m = m1 (even bins), m1 + 1/2 (odd ones)
  const double* coarse;  // exp(-2 pi i j / period) over a period of 2 h / count, interleaved
  bool odd;              // bins
};

/// Where the columns of a step go: `count` doubles of each row to `low` and as many to `high`.
struct ColumnPlaces {
  double *low, *high;
  std::size_t pitch;  // doubles from row to row
};

/// Turns the transformed columns and puts them back as columns of the rows to come.
void scatter_columns(const double* from, const ColumnStep& step, const ColumnTurns& turns, ColumnPlaces to);

/// A row of bins of both halves: from the transform of a + i b, and of the half P before, to X of
/// the two segments that the pair ends.
struct BinRow {
  const double *row, *mirror;         // interleaved, n2 values; the mirror is read from its end
  std::size_t bins;                   // n2 / 2, a multiple of 4
  const double* quarter;              // exp(-i pi m2 / n2), four and four
  Complex start;                      // exp(-i pi k / L) at m2 = 0
  const double* before;               // P
  double* z;                          // B; may be P's place
  double *first, *second;             // X of (P, A) and of (A, B)
  double step_first, step_second;     // between the means, for odd bins
  double* cosine = nullptr;           // sums of squares of the cosine transforms; none: not wanted
  double weight_a = 0, weight_b = 0;  // 0: not of this half
};

void even_bins(const BinRow& row);
void odd_bins(const BinRow& row);

/// Three neighbouring rows of X.
struct Neighbours {
  const double *low, *centre, *high;
};

/// power += |centre/2 - (low + high)/4|^2
void add_windowed(const Neighbours& x, std::size_t bins, double* power);
/// The same for two segments, in their order.
void add_windowed(const Neighbours& x, const Neighbours& y, std::size_t bins, double* power);

/// Mean about the first value, in eight lanes.
double mean_about_first(const double* x, std::size_t n);

/// Doubles between rows: without them a column of rows, or a row and its neighbours, would fall
/// into few sets of the cache.
inline constexpr std::size_t kPadding = 8;

struct FreedAligned {
  void operator()(double* memory) const { ::operator delete[](memory, std::align_val_t{64}); }
};
/// Doubles that begin a line of the cache.
using AlignedDoubles = std::unique_ptr<double[], FreedAligned>;
AlignedDoubles aligned_zeros(std::size_t n);
/// The same, not written yet: who needs much of it lets all threads be the first to write.
AlignedDoubles aligned_room(std::size_t n);

/// exp(-i pi numerator / denominator)
Complex turn(double numerator, double denominator);

/// Rows and columns of a transform of h values, h = n1 n2, as near to each other as can be, n2 a
/// multiple of 8; {0, 0} when h has other factors than 2, 3, 5, 7, or does not split so.
std::pair<std::size_t, std::size_t> rows_and_columns(std::size_t h);

struct RowTables {
  std::size_t h, n1, n2, pitch, count;         // pitch: doubles from row to row; count: columns at once
  std::vector<double> shift, fine[2], coarse;  // of ColumnStep and ColumnTurns; even bins, odd bins
  std::vector<double> quarter;                 // of BinRow

  explicit RowTables(std::size_t half);
  /// exp(-i pi k / L) of the first bin of row r.
  Complex start_of(std::size_t r, bool odd) const {
    return turn(static_cast<double>(2 * r + (odd ? 1 : 0)), static_cast<double>(2 * h));
  }
};

/// Sums by rows of bins, even ones and then odd ones, in the order of their frequencies; `top` is bin h.
void natural_order(const RowTables& tables, const double* sums, double top, std::vector<double>& out);

/// Rows of one kind of bins between the two steps of a transform: whole rows; or, where they stand in the place of the
/// samples they are made of, every step's columns half in `low` and half in `high`.
struct RowsBetween {
  double* low;
  double* high;       ///< none: whole rows
  std::size_t pitch;  ///< doubles from row to row

  ColumnPlaces columns(std::size_t column, std::size_t count) const {
    return high == nullptr ? ColumnPlaces{low + 2 * column, low + 2 * column + count, pitch}
                           : ColumnPlaces{low + column, high + column, pitch};
  }
};

/// Memory and plan of the first step, of `count` columns at a time.
class ColumnScratch {
 public:
  explicit ColumnScratch(const RowTables& tables);
  /// Of a pair, the columns from `column` on: into rows of even and of odd bins. These may stand
  /// where the samples of the columns do.
  void transform(const HalfPair& pair, std::size_t column, const RowsBetween& even, const RowsBetween& odd);

 private:
  const RowTables& tables_;
  ComplexFft columns_;
  AlignedDoubles values_;
};

/// Memory and plan of the second step, of a row at a time, and of the rows of bins that follow.
class RowScratch {
 public:
  explicit RowScratch(const RowTables& tables);
  /// n2 interleaved values of a row in one of two places, valid until the next row for that place.
  const double* row(const RowsBetween& rows, std::size_t r, std::size_t place);
  /// Row 0 of the even bins moved by one, so that read from its end it is that row's mirror.
  const double* mirror_of(const double* first_row);
  /// Rows of X of two segments, the second one `second()` doubles behind the first.
  double* bins(std::size_t index) { return bins_.get() + index * bin_pitch(); }
  std::size_t second() const { return tables_.n2 + kPadding; }
  /// A row of bins without a place of its own, of two segments.
  double* spare(std::size_t index) { return bins(kBinRows + index); }
  static constexpr std::size_t kBinRows = 8, kSpareRows = 2;

 private:
  std::size_t bin_pitch() const { return 2 * second() + kPadding; }
  const double* gathered(const RowsBetween& rows, std::size_t r);

  const RowTables& tables_;
  ComplexFft row_;
  AlignedDoubles rows_, moved_, bins_;
  AlignedDoubles gathered_;  // a row whose pieces stood apart; when first needed
};

/// Memory and plans for one pair at a time.
class PairScratch {
 public:
  explicit PairScratch(const RowTables& tables);
  void transform_columns(const HalfPair& pair);
  RowsBetween even() const { return {values_[0].get(), nullptr, tables_.pitch}; }
  RowsBetween odd() const { return {values_[1].get(), nullptr, tables_.pitch}; }
  RowScratch& rows() { return rows_; }

 private:
  const RowTables& tables_;
  ColumnScratch columns_;
  RowScratch rows_;
  AlignedDoubles values_[2];
};

/// What halves of one length share.
class RowPool {
 public:
  explicit RowPool(std::size_t half) : tables(half) {}
  std::unique_ptr<PairScratch> borrow();
  void give_back(std::unique_ptr<PairScratch> scratch);
  const RowTables tables;

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<PairScratch>> idle_;
};

/// One of each length in use.
class RowPools {
 public:
  std::shared_ptr<RowPool> of(std::size_t half);

 private:
  std::mutex mutex_;
  std::map<std::size_t, std::weak_ptr<RowPool>> pools_;
};

}  // namespace libchar::half_segments
