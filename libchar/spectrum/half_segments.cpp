// Welch's method with a Hann window and half-overlapping segments, without transforming any sample twice over a whole segment.
//
// With h samples in a half, L = 2h, and Z_k the DFT at the L frequencies of a half less its mean s and padded with zeros, a segment
// made of the halves p and a, less its own mean (s_p + s_a)/2, has
//   X_k = P_k + (-1)^k A_k + (s_p - s_a) (1 - i cot(pi k / L)) [k odd]
// (the last term is the transform of the step between the means), and with the periodic Hann window, three terms of a cosine sum,
//   Y_k = X_k/2 - (X_{k-1} + X_{k+1})/4.
// The same Z_k gives the orthonormal DCT-II of the half:   c_k = sqrt(2/h) Re(exp(-i pi k / L) Z_k).
//
// Z itself: even bins k = 2m are the DFT of the half, odd ones k = 2m+1 its DFT at frequencies moved by half a bin. Each is a complex
// transform of q = h/2 values u_s = x_{2s} + i x_{2s+1} and the usual separation (R. N. Bracewell, The Fourier Transform and Its
// Applications, on two real transforms in one). Each transform of q = n1 n2 values goes in two steps that stay in the cache (W. M.
// Gentleman and G. Sande, 1966; D. H. Bailey, 1990): over t1 at fixed t2, a turn by exp(-2 pi i t2 m1 / q), over t2; s = n2 t1 + t2,
// m = m1 + n1 m2. The result is left where it stands, in rows of fixed m1: the mirror q - m of row r is row n1 - r backwards, the
// neighbours m ± 1 are the rows beside it, and everything after the transform goes row by row.
//
// Inside a row four values stand as four real and four imaginary parts, in the order 0 2 1 3 that unpacking gives.

#include "libchar/spectrum/half_segments.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>

#include "libchar/core/lanes.hpp"
#include "libchar/spectrum/fft.hpp"

namespace libchar {
namespace {

constexpr std::size_t kColumns = 4;  // transformed side by side: 128 bytes, two lines of the cache
constexpr std::size_t kPadding = 8;  // between rows, or a column of them would fall into few sets of the cache
constexpr std::size_t kRows = 4;     // transformed one after another
constexpr std::size_t kShortest = 1U << 11U;  // halves below are transformed faster whole
constexpr std::size_t kSlot[4] = {0, 2, 1, 3};

using Complex = std::complex<double>;

struct Freed {
  void operator()(double* memory) const { ::operator delete[](memory, std::align_val_t{64}); }
};
using Buffer = std::unique_ptr<double[], Freed>;
Buffer zeros(std::size_t n) {
  Buffer buffer(static_cast<double*>(::operator new[](n * sizeof(double), std::align_val_t{64})));
  std::fill_n(buffer.get(), n, 0.0);
  return buffer;
}

/// exp(-i pi num / den)
Complex turn(double num, double den) {
  const double angle = std::numbers::pi * num / den;
  return {std::cos(angle), -std::sin(angle)};
}

/// n1 <= n2 as near to each other as can be, n2 a multiple of 8; {0, 0} when q has other factors than 2, 3, 5, 7.
std::pair<std::size_t, std::size_t> split(std::size_t q) {
  std::size_t rest = q;
  for (const std::size_t prime : {2U, 3U, 5U, 7U})
    while (rest > 1 && rest % prime == 0) rest /= prime;
  if (rest != 1) return {0, 0};
  for (auto n1 = static_cast<std::size_t>(std::sqrt(static_cast<double>(q)) + 0.5); n1 >= 16; --n1)
    if (q % n1 == 0 && q / n1 % kColumns == 0 && q / n1 < 8 * n1) return {n1, q / n1};
  return {0, 0};
}

// Interleaved complex numbers, two in a vector.
#define SWAPPED(v) __builtin_shufflevector(v, v, 1, 0, 3, 2)
#define REAL_PARTS(v) __builtin_shufflevector(v, v, 0, 0, 2, 2)
#define IMAGINARY_PARTS(v) __builtin_shufflevector(v, v, 1, 1, 3, 3)
#define BACKWARDS(v) __builtin_shufflevector(v, v, 3, 2, 1, 0)
// Two vectors of interleaved numbers to four real or imaginary parts, in the order 0 2 1 3.
#define FOUR_REAL(v, w) __builtin_shufflevector(v, w, 0, 4, 2, 6)
#define FOUR_IMAGINARY(v, w) __builtin_shufflevector(v, w, 1, 5, 3, 7)

constexpr Four kSigns = {-1, 1, -1, 1};

struct ColumnStep {
  std::size_t n1, n2, pitch, column;
  const double* shift;      // [n1] exp(-i pi t1 / n1), interleaved: half a bin
  const double* fine;       // [n1][kColumns] exp(-2 pi i m1 j / q), then the same at m1 + 1/2
  const double* coarse;     // exp(-2 pi i j / period) over a period of 2 q / kColumns, interleaved
};

/// Eight columns of u less the mean, for the even bins and turned for the odd ones.
LIBCHAR_WIDE_LANES void gather_columns(const double* x, double mean, const ColumnStep& step, double* even, double* odd) {
  const double* from = x + 2 * step.column;
  for (std::size_t t1 = 0; t1 < step.n1; ++t1, from += 2 * step.n2, even += 2 * kColumns, odd += 2 * kColumns) {
    const double cosine = step.shift[2 * t1], sine = step.shift[2 * t1 + 1];
    const Four crossed = sine * kSigns;
    for (std::size_t i = 0; i < 2 * kColumns; i += 4) {
      const Four u = LIBCHAR_FOUR(from + i) - mean;
      LIBCHAR_FOUR_TO(even + i) = u;
      LIBCHAR_FOUR_TO(odd + i) = u * cosine + SWAPPED(u) * crossed;
    }
  }
}

/// Turns the transformed columns and puts them back as columns of the rows to come.
LIBCHAR_WIDE_LANES void scatter_columns(const double* from, const ColumnStep& step, bool odd, double* to) {
  const std::size_t period = 2 * step.n1 * step.n2 / kColumns, block = step.column / kColumns;
  const double* fine = step.fine + (odd ? 2 * kColumns * step.n1 : 0);
  const std::size_t stride = 2 * block % period;
  std::size_t at = odd ? block % period : 0;
  to += 2 * step.column;
  for (std::size_t m1 = 0; m1 < step.n1; ++m1, from += 2 * kColumns, fine += 2 * kColumns, to += step.pitch) {
    const double cosine = step.coarse[2 * at];
    const Four crossed = step.coarse[2 * at + 1] * kSigns;
    for (std::size_t i = 0; i < 2 * kColumns; i += 4) {
      const Four f = LIBCHAR_FOUR(fine + i), u = LIBCHAR_FOUR(from + i);
      const Four w = f * cosine + SWAPPED(f) * crossed;
      LIBCHAR_FOUR_TO(to + i) = u * REAL_PARTS(w) + SWAPPED(u) * (IMAGINARY_PARTS(w) * kSigns);
    }
    at += stride;
    if (at >= period) at -= period;
  }
}

/// Row r and its mirror row: from the complex transform to Z and to the squares of the cosine transform.
struct RowPair {
  const double *row, *mirror;        // interleaved
  double *z_row, *z_mirror;          // four real, four imaginary
  double *c_row = nullptr, *c_mirror = nullptr;  // sums of squares; none: not wanted
  const double* quarter;             // exp(-i pi m2 / (2 n2)), four and four
  Complex start;                     // exp(-i pi k / L) at m2 = 0
  std::size_t n2;
};

LIBCHAR_WIDE_LANES void separate(const RowPair& p) {
  const double cr = p.start.real(), ci = p.start.imag();
  for (std::size_t b = 0; b < p.n2 / 4; ++b) {
    const std::size_t at = 8 * b, back = 2 * p.n2 - 8 - at;
    const Four u0 = LIBCHAR_FOUR(p.row + at), u1 = LIBCHAR_FOUR(p.row + at + 4);
    const Four v0 = LIBCHAR_FOUR(p.mirror + back), v1 = LIBCHAR_FOUR(p.mirror + back + 4);
    const Four ur = FOUR_REAL(u0, u1), ui = FOUR_IMAGINARY(u0, u1);
    const Four vr0 = FOUR_REAL(v0, v1), vi0 = FOUR_IMAGINARY(v0, v1);
    const Four vr = BACKWARDS(vr0), vi = BACKWARDS(vi0);
    const Four er = 0.5 * (ur + vr), ei = 0.5 * (ui - vi);      // of the even samples
    const Four odd_r = 0.5 * (ui + vi), odd_i = 0.5 * (vr - ur);  // of the odd samples
    const Four tr = LIBCHAR_FOUR(p.quarter + at), ti = LIBCHAR_FOUR(p.quarter + at + 4);
    const Four rr = cr * tr - ci * ti, ri = cr * ti + ci * tr;    // exp(-i pi k / L)
    const Four wr = rr * rr - ri * ri, wi = 2.0 * rr * ri;        // its square
    const Four or_ = wr * odd_r - wi * odd_i, oi = wr * odd_i + wi * odd_r;
    const Four fr = er + or_, fi = ei + oi, gr = er - or_, gi = ei - oi;
    LIBCHAR_FOUR_TO(p.z_row + at) = fr;
    LIBCHAR_FOUR_TO(p.z_row + at + 4) = fi;
    const Four mirrored = -gi;
    LIBCHAR_FOUR_TO(p.z_mirror + back) = BACKWARDS(gr);
    LIBCHAR_FOUR_TO(p.z_mirror + back + 4) = BACKWARDS(mirrored);
    if (p.c_row == nullptr) continue;
    const Four c = rr * fr - ri * fi, d = rr * gi + ri * gr;
    LIBCHAR_FOUR_TO(p.c_row + at / 2) = LIBCHAR_FOUR(p.c_row + at / 2) + c * c;
    const Four squared = d * d;
    LIBCHAR_FOUR_TO(p.c_mirror + back / 2) = LIBCHAR_FOUR(p.c_mirror + back / 2) + BACKWARDS(squared);
  }
}

/// One row of even bins and one of odd bins of a segment: X of both halves joined, then windowed power. `before` are the rows
/// of X one index lower.
struct SegmentRows {
  const double *even_p, *even_a, *odd_p, *odd_a;  // Z of the two halves
  const double* cotangent;                        // of the odd bins, with its sign
  double step;                                    // difference of the means
  const double *even_before, *odd_before;         // X
  double *even, *odd;                             // X, written
  double *even_power, *odd_power_before;          // sums
  std::size_t n2;
};

LIBCHAR_WIDE_LANES void join(const SegmentRows& s) {
  for (std::size_t at = 0; at < 2 * s.n2; at += 8) {
    LIBCHAR_FOUR_TO(s.even + at) = LIBCHAR_FOUR(s.even_p + at) + LIBCHAR_FOUR(s.even_a + at);
    LIBCHAR_FOUR_TO(s.even + at + 4) = LIBCHAR_FOUR(s.even_p + at + 4) + LIBCHAR_FOUR(s.even_a + at + 4);
    LIBCHAR_FOUR_TO(s.odd + at) = (LIBCHAR_FOUR(s.odd_p + at) - LIBCHAR_FOUR(s.odd_a + at)) + s.step;
    LIBCHAR_FOUR_TO(s.odd + at + 4) = (LIBCHAR_FOUR(s.odd_p + at + 4) - LIBCHAR_FOUR(s.odd_a + at + 4)) + s.step * LIBCHAR_FOUR(s.cotangent + at / 2);
  }
}

/// power += |centre/2 - (low + high)/4|^2
LIBCHAR_WIDE_LANES void add_windowed(const double* low, const double* centre, const double* high, std::size_t n2, double* power) {
  for (std::size_t at = 0; at < 2 * n2; at += 8) {
    const Four re = 0.5 * LIBCHAR_FOUR(centre + at) - 0.25 * (LIBCHAR_FOUR(low + at) + LIBCHAR_FOUR(high + at));
    const Four im = 0.5 * LIBCHAR_FOUR(centre + at + 4) - 0.25 * (LIBCHAR_FOUR(low + at + 4) + LIBCHAR_FOUR(high + at + 4));
    LIBCHAR_FOUR_TO(power + at / 2) = LIBCHAR_FOUR(power + at / 2) + (re * re + im * im);
  }
}

/// Mean about the first value, in eight lanes.
LIBCHAR_WIDE_LANES double mean_about_first(const double* x, std::size_t n) {
  const double first = x[0];
  Four low = {}, high = {};
  std::size_t t = 0;
  for (; t + 8 <= n; t += 8) {
    low += LIBCHAR_FOUR(x + t) - first;
    high += LIBCHAR_FOUR(x + t + 4) - first;
  }
  const Four sum = low + high;
  double total = (sum[0] + sum[2]) + (sum[1] + sum[3]);
  for (; t < n; ++t) total += x[t] - first;
  return first + total / static_cast<double>(n);
}

/// Places of the real and imaginary parts of value m2 of a row, and of a sum.
std::size_t real_place(std::size_t m2) { return m2 / 4 * 8 + kSlot[m2 % 4]; }
std::size_t sum_place(std::size_t m2) { return m2 / 4 * 4 + kSlot[m2 % 4]; }

Complex value_at(const double* row, std::size_t m2) { return {row[real_place(m2)], row[real_place(m2) + 4]}; }
void put(double* row, std::size_t m2, Complex value) {
  row[real_place(m2)] = value.real();
  row[real_place(m2) + 4] = value.imag();
}

}  // namespace

struct HalfSegments::State {
  std::size_t h, q, n1, n2, pitch;
  ComplexFft columns, rows, row;        // rows: kRows of them
  std::vector<double> shift, fine, coarse, quarter, cotangent;
  Buffer even_columns, odd_columns;     // eight of them
  Buffer even_rows, odd_rows;           // n1 rows, `pitch` apart
  Buffer now, before;                   // Z: even bins, then odd bins
  double now_top = 0, before_top = 0;   // Z_h
  Buffer segment_sums, block_sums;      // even bins, then odd bins
  double top_sum = 0;
  Buffer scratch;                       // five rows of X
  std::vector<char> row_done;
  bool joined = false;                  // `before` is there
  double before_mean = 0;

  State(std::size_t half, std::size_t split1, std::size_t split2);
  void transform(const double* x, double mean, bool block);
  void separate_rows(bool block);
  void own_mirror(std::size_t r, bool odd_bins, bool block);
  void add_segment(double step);
  void natural(const double* sums, double top, std::vector<double>& out) const;
};

HalfSegments::State::State(std::size_t half, std::size_t split1, std::size_t split2)
    : h(half), q(half / 2), n1(split1), n2(split2), pitch(2 * n2 + kPadding), columns(n1, kColumns, kColumns, 1), rows(n2, kRows, 1, pitch / 2), row(n2, 1, 1, n2),
      even_columns(zeros(2 * kColumns * n1)), odd_columns(zeros(2 * kColumns * n1)), even_rows(zeros(n1 * pitch)), odd_rows(zeros(n1 * pitch)),
      now(zeros(4 * q)), before(zeros(4 * q)), segment_sums(zeros(2 * q)), block_sums(zeros(2 * q)), scratch(zeros(10 * n2)) {
  const auto push = [](std::vector<double>& table, Complex value) {
    table.push_back(value.real());
    table.push_back(value.imag());
  };
  const double count = static_cast<double>(q);
  for (std::size_t t1 = 0; t1 < n1; ++t1) push(shift, turn(static_cast<double>(t1), static_cast<double>(n1)));
  for (const double part : {0.0, 0.5})
    for (std::size_t m1 = 0; m1 < n1; ++m1)
      for (std::size_t i = 0; i < kColumns; ++i) push(fine, turn(2 * static_cast<double>(i) * (static_cast<double>(m1) + part), count));
  const std::size_t period = 2 * q / kColumns;
  for (std::size_t j = 0; j < period; ++j) push(coarse, turn(2 * static_cast<double>(j), static_cast<double>(period)));
  quarter.resize(2 * n2);
  for (std::size_t m2 = 0; m2 < n2; ++m2) put(quarter.data(), m2, turn(static_cast<double>(m2), static_cast<double>(2 * n2)));
  cotangent.resize(q);
  for (std::size_t r = 0; r < n1; ++r) {
    const Complex start = turn(static_cast<double>(2 * r + 1), static_cast<double>(2 * h));
    for (std::size_t m2 = 0; m2 < n2; ++m2) {
      const Complex there = start * value_at(quarter.data(), m2);
      cotangent[r * n2 + sum_place(m2)] = there.real() / there.imag();
    }
  }
}

void HalfSegments::State::transform(const double* x, double mean, bool block) {
  ColumnStep step{n1, n2, pitch, 0, shift.data(), fine.data(), coarse.data()};
  for (; step.column < n2; step.column += kColumns) {
    gather_columns(x, mean, step, even_columns.get(), odd_columns.get());
    columns.transform(even_columns.get());
    columns.transform(odd_columns.get());
    scatter_columns(even_columns.get(), step, false, even_rows.get());
    scatter_columns(odd_columns.get(), step, true, odd_rows.get());
  }
  separate_rows(block);
}

void HalfSegments::State::separate_rows(bool block) {
  const std::size_t width = 2 * n2;
  const auto transformed = [&](double* u, std::size_t r) {
    const std::size_t first = r / kRows * kRows;
    if (first + kRows > n1) {  // the last few
      if (std::exchange(row_done[r], char{1}) == 0) row.transform(u + r * pitch);
    } else if (std::exchange(row_done[first], char{1}) == 0) {
      rows.transform(u + first * pitch);
    }
  };
  const auto pair = [&](std::size_t r, std::size_t mirror, bool odd) {
    double* const u = odd ? odd_rows.get() : even_rows.get();
    transformed(u, r);
    if (mirror == r) return own_mirror(r, odd, block);
    transformed(u, mirror);
    double* const z = now.get() + (odd ? 2 * q : 0);
    RowPair p{u + r * pitch, u + mirror * pitch, z + r * width, z + mirror * width, nullptr, nullptr, quarter.data(), {}, n2};
    if (block) {
      double* const c = block_sums.get() + (odd ? q : 0);
      p.c_row = c + r * n2;
      p.c_mirror = c + mirror * n2;
    }
    p.start = turn(static_cast<double>(2 * r + (odd ? 1 : 0)), static_cast<double>(2 * h));
    separate(p);
  };
  row_done.assign(n1, 0);
  pair(0, 0, false);
  for (std::size_t r = 1; r <= n1 / 2; ++r) pair(r, n1 - r, false);
  row_done.assign(n1, 0);
  for (std::size_t r = 0; r < (n1 + 1) / 2; ++r) pair(r, n1 - 1 - r, true);
}

/// A row that is its own mirror, value by value: the first one of the even bins (moved by one), and the one in the middle.
void HalfSegments::State::own_mirror(std::size_t r, bool odd_bins, bool block) {
  const std::size_t width = 2 * n2;
  const double* const u = (odd_bins ? odd_rows.get() : even_rows.get()) + r * pitch;
  double* const z_row = now.get() + (odd_bins ? 2 * q : 0) + r * width;
  double* const c_row = block_sums.get() + (odd_bins ? q : 0) + r * n2;
  const Complex start = turn(static_cast<double>(2 * r + (odd_bins ? 1 : 0)), static_cast<double>(2 * h));
  const bool moved = r == 0 && !odd_bins;
  const auto at = [&](std::size_t m2) { return Complex(u[2 * m2], u[2 * m2 + 1]); };
  for (std::size_t m2 = 0; m2 < n2; ++m2) {
    const Complex mine = at(m2), other = std::conj(at(moved ? (n2 - m2) % n2 : n2 - 1 - m2));
    const Complex even = 0.5 * (mine + other), odd = Complex(0, -0.5) * (mine - other);
    const Complex turned = start * value_at(quarter.data(), m2);
    const Complex z = even + turned * turned * odd;
    put(z_row, m2, z);
    if (moved && m2 == 0) now_top = even.real() - odd.real();
    if (!block) continue;
    const double c = turned.real() * z.real() - turned.imag() * z.imag();
    c_row[sum_place(m2)] += c * c;
  }
}

void HalfSegments::State::add_segment(double step) {
  const std::size_t width = 2 * n2;
  double *even = scratch.get(), *even_last = even + width, *odd = even_last + width, *odd_last = odd + width, *shifted = odd_last + width;
  const double *p = before.get(), *a = now.get();
  const auto join_row = [&](std::size_t r) {
    join({p + r * width, a + r * width, p + 2 * q + r * width, a + 2 * q + r * width, cotangent.data() + r * n2, step, nullptr, nullptr, even, odd, nullptr, nullptr, n2});
  };
  // Below the first row of odd bins stands the last one, moved by one; below bin 1 its conjugate.
  join_row(n1 - 1);
  const double top = before_top + now_top;
  const double top_windowed = 0.5 * top - 0.5 * value_at(odd, n2 - 1).real();
  top_sum += top_windowed * top_windowed;
  std::swap(odd, shifted);
  for (std::size_t m2 = n2 - 1; m2 > 0; --m2) put(odd_last, m2, value_at(shifted, m2 - 1));
  join_row(0);
  put(odd_last, 0, std::conj(value_at(odd, 0)));
  // Above the last row of even bins stands the first one, moved by one; at its end bin h.
  for (std::size_t m2 = 0; m2 + 1 < n2; ++m2) put(shifted, m2, value_at(even, m2 + 1));
  put(shifted, n2 - 1, top);
  for (std::size_t r = 0; r < n1; ++r) {
    if (r > 0) {
      join_row(r);
      add_windowed(even_last, odd_last, even, n2, segment_sums.get() + q + (r - 1) * n2);
    }
    add_windowed(odd_last, even, odd, n2, segment_sums.get() + r * n2);
    std::swap(even, even_last);
    std::swap(odd, odd_last);
  }
  add_windowed(even_last, odd_last, shifted, n2, segment_sums.get() + q + (n1 - 1) * n2);
}

void HalfSegments::State::natural(const double* sums, double top, std::vector<double>& out) const {
  out.resize(h + 1);
  for (std::size_t r = 0; r < n1; ++r)
    for (std::size_t m2 = 0; m2 < n2; ++m2) {
      const std::size_t place = r * n2 + sum_place(m2), m = r + n1 * m2;
      out[2 * m] = sums[place];
      out[2 * m + 1] = sums[q + place];
    }
  out[h] = top;
}

bool HalfSegments::suits(const WelchOptions& options) {
  const std::uint64_t h = options.segment / 2;
  return options.window == Window::hann && options.overlap == 0.5 && options.detrend == Detrend::constant && options.segment % 4 == 0 &&
         h >= kShortest && split(h / 2).first != 0;
}

HalfSegments::HalfSegments(std::size_t segment) {
  const auto [n1, n2] = split(segment / 4);
  state_ = std::make_unique<State>(segment / 2, n1, n2);
}
HalfSegments::~HalfSegments() = default;
HalfSegments::HalfSegments(HalfSegments&&) noexcept = default;
HalfSegments& HalfSegments::operator=(HalfSegments&&) noexcept = default;

std::size_t HalfSegments::half() const { return state_->h; }
double HalfSegments::mean_of(const double* x) const { return mean_about_first(x, state_->h); }
void HalfSegments::forget() { state_->joined = false; }

bool HalfSegments::push(const double* x, double mean, bool block) {
  State& s = *state_;
  if (!std::isfinite(mean)) {
    s.joined = false;
    return false;
  }
  s.transform(x, mean, block);
  const bool whole = s.joined;
  if (whole) s.add_segment(s.before_mean - mean);
  std::swap(s.now, s.before);
  s.before_top = s.now_top;
  s.before_mean = mean;
  s.joined = true;
  return whole;
}

void HalfSegments::take_power(std::vector<double>& power) {
  State& s = *state_;
  s.natural(s.segment_sums.get(), s.top_sum, power);
  std::fill_n(s.segment_sums.get(), 2 * s.q, 0.0);
  s.top_sum = 0;
}

std::vector<double> HalfSegments::power() const {
  std::vector<double> power;
  state_->natural(state_->segment_sums.get(), state_->top_sum, power);
  return power;
}

std::vector<double> HalfSegments::block_power() const {
  std::vector<double> power;
  state_->natural(state_->block_sums.get(), 0, power);
  power.resize(state_->h);
  for (double& c : power) c *= 2 / static_cast<double>(state_->h);
  return power;
}

}  // namespace libchar
