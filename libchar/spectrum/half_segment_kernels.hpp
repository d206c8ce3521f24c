#pragma once
// The inner loops of HalfSegments (half_segments.cpp has the equations), in explicit lanes.

#include <complex>
#include <cstddef>

namespace libchar::halves {

using Complex = std::complex<double>;

/// Inside a row four values stand as four real and four imaginary parts, in the order that
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

struct ColumnStep {
  std::size_t n1, n2, pitch, count, column;
  bool odd;             // bins
  const double* shift;  // [n1] exp(-i pi t1 / n1), interleaved: half a bin
  const double* fine;  // [n1] exp(-2 pi i m1 j / q), j < count; four real and four imaginary parts.
                       // Odd bins: m1 + 1/2
  const double* coarse;  // exp(-2 pi i j / period) over a period of 2 q / count, interleaved
};

/// `count` columns of u less the mean; for the odd bins turned by half a bin.
void gather_columns(const double* x, double mean, const ColumnStep& step, double* to);

/// Turns the transformed columns and puts them back as columns of the rows to come.
void scatter_columns(const double* from, const ColumnStep& step, double* to);

/// Row r and its mirror row: from the complex transform to Z and to the squares of the cosine
/// transform.
struct RowPair {
  const double *row, *mirror;                    // interleaved
  double *z_row, *z_mirror;                      // four real, four imaginary
  double *c_row = nullptr, *c_mirror = nullptr;  // sums of squares; none: not wanted
  const double* quarter;                         // exp(-i pi m2 / (2 n2)), four and four
  Complex start;                                 // exp(-i pi k / L) at m2 = 0
  std::size_t n2;
};

void separate(const RowPair& pair);

/// X = P + A for a row of even bins; A takes the place of P.
void join_even(const double* a, std::size_t n2, double* p, double* x);

/// X = P - A + step (1 - i cot(pi k / L)) for a row of odd bins, and A takes the place of P;
/// `start` is exp(-i pi k / L) at its first.
void join_odd(const double* a,
              std::size_t n2,
              const double* quarter,
              Complex start,
              double step,
              double* p,
              double* x);

/// power += |centre/2 - (low + high)/4|^2
void add_windowed(
    const double* low, const double* centre, const double* high, std::size_t n2, double* power);

/// Mean about the first value, in eight lanes.
double mean_about_first(const double* x, std::size_t n);

}  // namespace libchar::halves
