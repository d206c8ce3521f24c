#pragma once
// The two-step transform of a pair of halves into rows of bins (half_segments.cpp has the
// equations): tables that depend on the length alone, and memory to work in, both shared by all who
// transform halves of that length.

#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <new>
#include <utility>
#include <vector>

#include "libchar/spectrum/detail/half_segment_kernels.hpp"
#include "libchar/spectrum/fft.hpp"

namespace libchar::half_segments {

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
  std::size_t h, n1, n2, pitch, count;  // pitch: doubles from row to row; count: columns at once
  std::vector<double> shift, fine[2], coarse;  // of ColumnStep and ColumnTurns; even bins, odd bins
  std::vector<double> quarter;                 // of BinRow

  explicit RowTables(std::size_t half);
  /// exp(-i pi k / L) of the first bin of row r.
  Complex start_of(std::size_t r, bool odd) const {
    return turn(static_cast<double>(2 * r + (odd ? 1 : 0)), static_cast<double>(2 * h));
  }
};

/// Sums by rows of bins, even ones and then odd ones, in the order of their frequencies; `top` is bin h.
void natural_order(const RowTables& tables,
                   const double* sums,
                   double top,
                   std::vector<double>& out);

/// Rows of one kind of bins between the two steps of a transform: whole rows; or, where they stand
/// in the place of the samples they are made of, every step's columns half in `low` and half in
/// `high`.
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
  void transform(const HalfPair& pair,
                 std::size_t column,
                 const RowsBetween& even,
                 const RowsBetween& odd);

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
