#pragma once
// The two-step transform of a pair of halves into rows of bins (half_segments.cpp has the
// equations): tables that depend on the length alone, and memory to work in, both shared by all who
// transform halves of that length.

#include <complex>
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

/// Memory and plans for one pair at a time.
class RowScratch {
 public:
  explicit RowScratch(const RowTables& tables);
  /// First step, of even and odd bins.
  void transform_columns(const HalfPair& pair);
  /// Second step, of one row: n2 interleaved values in one of two places, valid until the next
  /// row for that place.
  const double* row(std::size_t r, bool odd, std::size_t place);
  const double* untransformed(std::size_t r, bool odd) const {
    return row_values_[odd ? 1 : 0].get() + r * tables_.pitch;
  }
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

  const RowTables& tables_;
  ComplexFft columns_, row_;
  AlignedDoubles column_values_, row_values_[2], rows_, moved_, bins_;
};

/// What halves of one length share.
class RowPool {
 public:
  explicit RowPool(std::size_t half) : tables(half) {}
  std::unique_ptr<RowScratch> borrow();
  void give_back(std::unique_ptr<RowScratch> scratch);
  const RowTables tables;

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<RowScratch>> idle_;
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
