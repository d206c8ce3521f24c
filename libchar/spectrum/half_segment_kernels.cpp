#include "libchar/spectrum/half_segment_kernels.hpp"

#include "libchar/core/lanes.hpp"

namespace libchar::halves {
namespace {

// Interleaved complex numbers, two in a vector.
#define SWAPPED(v) __builtin_shufflevector(v, v, 1, 0, 3, 2)
#define REAL_PARTS(v) __builtin_shufflevector(v, v, 0, 0, 2, 2)
#define IMAGINARY_PARTS(v) __builtin_shufflevector(v, v, 1, 1, 3, 3)
#define BACKWARDS(v) __builtin_shufflevector(v, v, 3, 2, 1, 0)
// Two vectors of interleaved numbers to four real or imaginary parts, in the order 0 2 1 3.
#define FOUR_REAL(v, w) __builtin_shufflevector(v, w, 0, 4, 2, 6)
#define FOUR_IMAGINARY(v, w) __builtin_shufflevector(v, w, 1, 5, 3, 7)

constexpr Four kSigns = {-1, 1, -1, 1};

}  // namespace

LIBCHAR_WIDE_LANES void gather_columns(const double* x,
                                       double mean,
                                       const ColumnStep& step,
                                       double* to) {
  const double* from = x + 2 * step.column;
  const std::size_t width = 2 * step.count;
  for (std::size_t t1 = 0; t1 < step.n1; ++t1, from += 2 * step.n2, to += width) {
    const double cosine = step.shift[2 * t1];
    const Four crossed = step.shift[2 * t1 + 1] * kSigns;
    for (std::size_t i = 0; i < width; i += 4) {
      const Four u = LIBCHAR_FOUR(from + i) - mean;
      LIBCHAR_FOUR_TO(to + i) = step.odd ? u * cosine + SWAPPED(u) * crossed : u;
    }
  }
}

LIBCHAR_WIDE_LANES void scatter_columns(const double* from, const ColumnStep& step, double* to) {
  const std::size_t width = 2 * step.count, period = 2 * step.n1 * step.n2 / step.count,
                    block = step.column / step.count;
  const std::size_t stride = 2 * block % period;
  std::size_t at = step.odd ? block % period : 0;
  const double* fine = step.fine;
  to += 2 * step.column;
  for (std::size_t m1 = 0; m1 < step.n1; ++m1, from += width, fine += width, to += step.pitch) {
    const double cosine = step.coarse[2 * at], sine = step.coarse[2 * at + 1];
    for (std::size_t i = 0; i < width; i += 8) {
      const Four fr = LIBCHAR_FOUR(fine + i), fi = LIBCHAR_FOUR(fine + i + 4);
      const Four wr = cosine * fr - sine * fi, wi = cosine * fi + sine * fr;
      const Four u = LIBCHAR_FOUR(from + i), v = LIBCHAR_FOUR(from + i + 4);
      const Four ur = FOUR_REAL(u, v), ui = FOUR_IMAGINARY(u, v);
      const Four yr = ur * wr - ui * wi, yi = ur * wi + ui * wr;
      LIBCHAR_FOUR_TO(to + i) = FOUR_REAL(yr, yi);  // the same exchange of places undoes itself
      LIBCHAR_FOUR_TO(to + i + 4) = FOUR_IMAGINARY(yr, yi);
    }
    at += stride;
    if (at >= period) at -= period;
  }
}

LIBCHAR_WIDE_LANES void separate(const RowPair& p) {
  const double cr = p.start.real(), ci = p.start.imag();
  for (std::size_t b = 0; b < p.n2 / 4; ++b) {
    const std::size_t at = 8 * b, back = 2 * p.n2 - 8 - at;
    const Four u0 = LIBCHAR_FOUR(p.row + at), u1 = LIBCHAR_FOUR(p.row + at + 4);
    const Four v0 = LIBCHAR_FOUR(p.mirror + back), v1 = LIBCHAR_FOUR(p.mirror + back + 4);
    const Four ur = FOUR_REAL(u0, u1), ui = FOUR_IMAGINARY(u0, u1);
    const Four vr0 = FOUR_REAL(v0, v1), vi0 = FOUR_IMAGINARY(v0, v1);
    const Four vr = BACKWARDS(vr0), vi = BACKWARDS(vi0);
    const Four er = 0.5 * (ur + vr), ei = 0.5 * (ui - vi);        // of the even samples
    const Four odd_r = 0.5 * (ui + vi), odd_i = 0.5 * (vr - ur);  // of the odd samples
    const Four tr = LIBCHAR_FOUR(p.quarter + at), ti = LIBCHAR_FOUR(p.quarter + at + 4);
    const Four rr = cr * tr - ci * ti, ri = cr * ti + ci * tr;  // exp(-i pi k / L)
    const Four wr = rr * rr - ri * ri, wi = 2.0 * rr * ri;      // its square
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
    LIBCHAR_FOUR_TO(p.c_mirror + back / 2) =
        LIBCHAR_FOUR(p.c_mirror + back / 2) + BACKWARDS(squared);
  }
}

LIBCHAR_WIDE_LANES void join_even(const double* a, std::size_t n2, double* p, double* x) {
  for (std::size_t at = 0; at < 2 * n2; at += 4) {
    const Four now = LIBCHAR_FOUR(a + at);
    LIBCHAR_FOUR_TO(x + at) = LIBCHAR_FOUR(p + at) + now;
    LIBCHAR_FOUR_TO(p + at) = now;
  }
}

LIBCHAR_WIDE_LANES void join_odd(const double* a,
                                 std::size_t n2,
                                 const double* quarter,
                                 Complex start,
                                 double step,
                                 double* p,
                                 double* x) {
  const double cr = start.real(), ci = start.imag();
  for (std::size_t at = 0; at < 2 * n2; at += 8) {
    const Four tr = LIBCHAR_FOUR(quarter + at), ti = LIBCHAR_FOUR(quarter + at + 4);
    const Four cotangent = (cr * tr - ci * ti) / (cr * ti + ci * tr);  // with its sign
    const Four re = LIBCHAR_FOUR(a + at), im = LIBCHAR_FOUR(a + at + 4);
    LIBCHAR_FOUR_TO(x + at) = (LIBCHAR_FOUR(p + at) - re) + step;
    LIBCHAR_FOUR_TO(x + at + 4) = (LIBCHAR_FOUR(p + at + 4) - im) + step * cotangent;
    LIBCHAR_FOUR_TO(p + at) = re;
    LIBCHAR_FOUR_TO(p + at + 4) = im;
  }
}

LIBCHAR_WIDE_LANES void add_windowed(
    const double* low, const double* centre, const double* high, std::size_t n2, double* power) {
  for (std::size_t at = 0; at < 2 * n2; at += 8) {
    const Four re =
        0.5 * LIBCHAR_FOUR(centre + at) - 0.25 * (LIBCHAR_FOUR(low + at) + LIBCHAR_FOUR(high + at));
    const Four im = 0.5 * LIBCHAR_FOUR(centre + at + 4) -
                    0.25 * (LIBCHAR_FOUR(low + at + 4) + LIBCHAR_FOUR(high + at + 4));
    LIBCHAR_FOUR_TO(power + at / 2) = LIBCHAR_FOUR(power + at / 2) + (re * re + im * im);
  }
}

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

}  // namespace libchar::halves
