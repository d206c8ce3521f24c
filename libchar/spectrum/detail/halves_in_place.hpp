#pragma once
// Welch's method by halves (half_segments.cpp has the equations) on a record that nobody needs any
// more: what the transforms write stands in the place of the samples, as far as it fits, and all
// threads share a pair. The bits are those of HalfSegments.

#include <cstddef>
#include <span>
#include <vector>

#include "libchar/spectrum/detail/half_pass.hpp"

namespace libchar {

class HalvesInPlace {
 public:
  /// Of segments of 2 `half` samples that `HalfSegments::suits`.
  HalvesInPlace(std::size_t half, int threads);

  /// Sums the power of all half-overlapping segments of a record, of at least one; it holds no
  /// samples afterwards. Says of each segment whether it was used: those that touch a missing
  /// sample (NaN) are not.
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
