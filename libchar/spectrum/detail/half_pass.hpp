#pragma once
// Everything after the first step of a pair's transform (half_segments.cpp has the equations): row
// by row into bins of both halves, of the two segments that they end, and sums of their power.

#include <cstddef>
#include <span>
#include <vector>

#include "libchar/spectrum/detail/half_rows.hpp"

namespace libchar::half_segments {

/// Where the rows of bins of one half stand, n2 doubles each.
struct HalfBins {
  double *even, *odd;
  std::size_t pitch;       ///< doubles from row to row
  std::size_t moved_from;  ///< odd rows from here on stand a row further,
  double* last;            ///< and the last one of them here
  double* row(std::size_t r, bool is_odd, std::size_t rows) const {
    if (!is_odd) return even + r * pitch;
    if (r < moved_from) return odd + r * pitch;
    return r + 1 == rows ? last : odd + (r + 1) * pitch;
  }
};

struct PairWork {
  double mean_a, mean_b, before_mean;
  RowsBetween even, odd;
  HalfBins before;  ///< of the half before the pair, and its bin h
  double* before_top;
  HalfBins after;  ///< of the pair's second half: may be the same places
  double* after_top;
  bool remember;                 ///< else nothing is written there
  double* block_sums = nullptr;  ///< none: not wanted
  double weight_a = 0, weight_b = 0;
  // Places of the sums of the two segments and their bins h; none: not wanted.
  double *first = nullptr, *second = nullptr, *first_top = nullptr, *second_top = nullptr;
};

/// The rows of a pair from both ends to the middle, a step for each: row r and its mirror, of even and of odd bins.
class Pass {
 public:
  /// All must live as long.
  Pass(const RowTables& tables, RowScratch& scratch, const PairWork& work);

  std::size_t steps() const { return t_.n1 / 2 + 1; }
  void run() { run(0, steps()); }
  /// Some of the steps. Several passes may share a pair's: `begin_at` the first of them, for all
  /// before the first `run`, for it reads what a `run` of the steps before may write over.
  void begin_at(std::size_t step);
  void run(std::size_t from, std::size_t to);

 private:
  /// X of a row of both segments.
  struct Row {
    double* x = nullptr;
  };
  std::size_t place(std::size_t r, bool odd) const { return (odd ? t_.h / 2 : 0) + r * bins_; }
  void make_step(std::size_t r);
  void make(std::size_t r, bool odd, Row to, Row to_mirror);
  void make_row(std::size_t r, bool odd, const double* values, const double* mirror, Row to);
  void add_step(std::size_t r);
  void window(std::size_t r, bool odd, Row low, Row centre, Row high);
  void window_first_row(Row below, Row even, Row odd);
  void ask_for(std::size_t r, bool odd) const;
  void ask_for_step(std::size_t r) const;
  void keep_rows();
  Row moved_up(Row even_first);

  const RowTables& t_;
  RowScratch& scratch_;
  const PairWork& work_;
  std::size_t bins_;
  bool looks_ahead_ = false;  ///< a row is made for its neighbours only
  double first_top_ = 0, second_top_ = 0;
  // Rows of this step and of the one before: rising from the first and falling from the last.
  Row even_, even_before_, odd_, odd_before_;
  Row even_falling_, even_falling_before_, odd_falling_, odd_falling_before_;
};

}  // namespace libchar::half_segments

// Welch's method by halves (half_segments.cpp has the equations) on a record that nobody needs any
// more: what the transforms write stands in the place of the samples, as far as it fits, and all
// threads share a pair. The bits are those of HalfSegments.

namespace libchar {

class HalvesInPlace {
 public:
  /// Of segments of 2 `half` samples that `HalfSegments::suits`.
  HalvesInPlace(std::size_t half, int threads);

  /// Sums the power of all half-overlapping segments of a record, of at least one; it holds no samples afterwards. Says
  /// of each segment whether it was used: those that touch a missing sample (NaN) are not.
  std::vector<char> add_all(std::span<double> record);
  /// Bins 0 … half.
  std::vector<double> power() const;

 private:
  struct Pair;
  double* whole_or_nothing(double* half, double mean);
  void transform_columns(const Pair& pair);
  void add_rows(const Pair& before, Pair& pair, bool first, bool second);

  half_segments::RowTables tables_;
  std::vector<half_segments::ColumnScratch> columns_;  // of each thread
  std::vector<half_segments::RowScratch> rows_;
  half_segments::AlignedDoubles odd_;          // rows of the odd bins, between the steps
  half_segments::AlignedDoubles sums_;         // even bins, then odd bins
  half_segments::AlignedDoubles last_row_[2];  // of one pair and of the next
  half_segments::AlignedDoubles no_half_;      // where there is none; when first needed
  double top_ = 0;                             // sum of bin h
};

}  // namespace libchar
