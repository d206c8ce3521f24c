#pragma once
// The inner loops of HalfSegments (half_segments.cpp has the equations), in explicit lanes.

#include <complex>
#include <cstddef>

namespace libchar::half_segments {

using Complex = std::complex<double>;

/// Inside a row of bins four values stand as four real and four imaginary parts, in the order that
/// unpacking gives.
inline constexpr std::size_t kSlot[4] = {0, 2, 1, 3};

/// Places of the real and imaginary parts of value m2 of a row, and of a sum.
inline std::size_t real_place(std::size_t m2) {
  return m2 / 4 * 8 + kSlot[m2 % 4];
}
inline std::size_t sum_place(std::size_t m2) {
  return m2 / 4 * 4 + kSlot[m2 % 4];
}

inline Complex value_at(const double* row, std::size_t m2) {
  return {row[real_place(m2)], row[real_place(m2) + 4]};
}
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
  const double* fine;  // [n1] exp(-2 pi i m j / h), j < count; four real and four imaginary parts;
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
void scatter_columns(const double* from,
                     const ColumnStep& step,
                     const ColumnTurns& turns,
                     ColumnPlaces to);

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

}  // namespace libchar::half_segments
