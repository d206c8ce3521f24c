#include "libchar/spectrum/detail/half_segment_kernels.hpp"

#include "libchar/core/numeric/lanes.hpp"

namespace libchar::half_segments {
namespace {

// Interleaved complex numbers, two in a vector.
#define SWAPPED(v) __builtin_shufflevector(v, v, 1, 0, 3, 2)
#define BACKWARDS(v) __builtin_shufflevector(v, v, 3, 2, 1, 0)
// Two vectors of interleaved numbers to four real or imaginary parts, in the order 0 2 1 3; the
// same exchange of places undoes itself.
#define EVEN_PLACES(v, w) __builtin_shufflevector(v, w, 0, 4, 2, 6)
#define ODD_PLACES(v, w) __builtin_shufflevector(v, w, 1, 5, 3, 7)
// Four real and four imaginary parts in their order to interleaved numbers in theirs.
#define FIRST_TWO(re, im) __builtin_shufflevector(re, im, 0, 4, 1, 5)
#define LAST_TWO(re, im) __builtin_shufflevector(re, im, 2, 6, 3, 7)

constexpr Four kSigns = {-1, 1, -1, 1};

}  // namespace

LIBCHAR_LANES void gather_columns_lanes(const HalfPair& pair,
                                        const ColumnStep& step,
                                        double* even,
                                        double* odd) {
  const double *a = pair.a + step.column, *b = pair.b + step.column;
  const std::size_t width = 2 * step.count;
  for (std::size_t t1 = 0; t1 < step.n1; ++t1, a += step.n2, b += step.n2) {
    const double cosine = step.shift[2 * t1];
    const Four crossed = step.shift[2 * t1 + 1] * kSigns;
    for (std::size_t i = 0; i < step.count; i += 4) {
      const Four va = LIBCHAR_FOUR(a + i) - pair.mean_a, vb = LIBCHAR_FOUR(b + i) - pair.mean_b;
      const Four u = EVEN_PLACES(va, vb), v = ODD_PLACES(va, vb);
      LIBCHAR_FOUR_TO(even + 2 * i) = u;
      LIBCHAR_FOUR_TO(even + 2 * i + 4) = v;
      LIBCHAR_FOUR_TO(odd + 2 * i) = u * cosine + SWAPPED(u) * crossed;
      LIBCHAR_FOUR_TO(odd + 2 * i + 4) = v * cosine + SWAPPED(v) * crossed;
    }
    even += width;
    odd += width;
  }
}

void gather_columns(const HalfPair& pair, const ColumnStep& step, double* even, double* odd) {
  return InLanes<gather_columns_lanes>()(pair, step, even, odd);
}

LIBCHAR_LANES void scatter_columns_lanes(const double* from,
                                         const ColumnStep& step,
                                         const ColumnTurns& turns,
                                         ColumnPlaces to) {
  const std::size_t width = 2 * step.count, period = 2 * step.n1 * step.n2 / step.count,
                    block = step.column / step.count;
  const std::size_t stride = 2 * block % period;
  std::size_t at = turns.odd ? block % period : 0;
  const double* fine = turns.fine;
  for (std::size_t m1 = 0; m1 < step.n1; ++m1, from += width, fine += width) {
    const double cosine = turns.coarse[2 * at], sine = turns.coarse[2 * at + 1];
    for (std::size_t i = 0; i < width; i += 8) {
      const Four fr = LIBCHAR_FOUR(fine + i), fi = LIBCHAR_FOUR(fine + i + 4);
      const Four wr = cosine * fr - sine * fi, wi = cosine * fi + sine * fr;
      const Four u = LIBCHAR_FOUR(from + i), v = LIBCHAR_FOUR(from + i + 4);
      const Four ur = EVEN_PLACES(u, v), ui = ODD_PLACES(u, v);  // columns 0 1 2 3 again
      const Four yr = ur * wr - ui * wi, yi = ur * wi + ui * wr;
      double* const out = i < step.count ? to.low + i : to.high + (i - step.count);
      LIBCHAR_FOUR_TO(out) = FIRST_TWO(yr, yi);
      LIBCHAR_FOUR_TO(out + 4) = LAST_TWO(yr, yi);
    }
    to.low += to.pitch;
    to.high += to.pitch;
    at += stride;
    if (at >= period) at -= period;
  }
}

void scatter_columns(const double* from,
                     const ColumnStep& step,
                     const ColumnTurns& turns,
                     ColumnPlaces to) {
  return InLanes<scatter_columns_lanes>()(from, step, turns, to);
}

// Both kinds of bins begin alike: A and B from the transform of a + i b at m and at its mirror, and
// exp(-i pi k / L).
#define LIBCHAR_SEPARATE(p, at, back)                                                        \
  const Four u0 = LIBCHAR_FOUR(p.row + at), u1 = LIBCHAR_FOUR(p.row + at + 4);               \
  const Four v0 = LIBCHAR_FOUR(p.mirror + back), v1 = LIBCHAR_FOUR(p.mirror + back + 4);     \
  const Four ur = EVEN_PLACES(u0, u1), ui = ODD_PLACES(u0, u1);                              \
  const Four vr0 = EVEN_PLACES(v0, v1), vi0 = ODD_PLACES(v0, v1);                            \
  const Four vr = BACKWARDS(vr0), vi = BACKWARDS(vi0);                                       \
  const Four ar = 0.5 * (ur + vr), ai = 0.5 * (ui - vi);                                     \
  const Four br = 0.5 * (ui + vi), bi = 0.5 * (vr - ur);                                     \
  const Four tr = LIBCHAR_FOUR(p.quarter + at), ti = LIBCHAR_FOUR(p.quarter + at + 4);       \
  const Four rr = cr * tr - ci * ti, ri = cr * ti + ci * tr;                                 \
  if (p.cosine != nullptr) {                                                                 \
    const Four ca = rr * ar - ri * ai, cb = rr * br - ri * bi;                               \
    LIBCHAR_FOUR_TO(p.cosine + at / 2) =                                                     \
        (LIBCHAR_FOUR(p.cosine + at / 2) + p.weight_a * (ca * ca)) + p.weight_b * (cb * cb); \
  }                                                                                          \
  const Four pr = LIBCHAR_FOUR(p.before + at), pi = LIBCHAR_FOUR(p.before + at + 4);         \
  LIBCHAR_FOUR_TO(p.z + at) = br;                                                            \
  LIBCHAR_FOUR_TO(p.z + at + 4) = bi

LIBCHAR_LANES void even_bins_lanes(const BinRow& p) {
  const double cr = p.start.real(), ci = p.start.imag();
  for (std::size_t at = 0; at < 2 * p.bins; at += 8) {
    const std::size_t back = 4 * p.bins - 8 - at;
    LIBCHAR_SEPARATE(p, at, back);
    LIBCHAR_FOUR_TO(p.first + at) = pr + ar;
    LIBCHAR_FOUR_TO(p.first + at + 4) = pi + ai;
    LIBCHAR_FOUR_TO(p.second + at) = ar + br;
    LIBCHAR_FOUR_TO(p.second + at + 4) = ai + bi;
  }
}

void even_bins(const BinRow& p) {
  return InLanes<even_bins_lanes>()(p);
}

LIBCHAR_LANES void odd_bins_lanes(const BinRow& p) {
  const double cr = p.start.real(), ci = p.start.imag();
  for (std::size_t at = 0; at < 2 * p.bins; at += 8) {
    const std::size_t back = 4 * p.bins - 8 - at;
    LIBCHAR_SEPARATE(p, at, back);
    const Four cotangent = rr / ri;  // with its sign
    LIBCHAR_FOUR_TO(p.first + at) = (pr - ar) + p.step_first;
    LIBCHAR_FOUR_TO(p.first + at + 4) = (pi - ai) + p.step_first * cotangent;
    LIBCHAR_FOUR_TO(p.second + at) = (ar - br) + p.step_second;
    LIBCHAR_FOUR_TO(p.second + at + 4) = (ai - bi) + p.step_second * cotangent;
  }
}

void odd_bins(const BinRow& p) {
  return InLanes<odd_bins_lanes>()(p);
}

#define LIBCHAR_WINDOWED(x, at)        \
  (0.5 * LIBCHAR_FOUR(x.centre + at) - \
   0.25 * (LIBCHAR_FOUR(x.low + at) + LIBCHAR_FOUR(x.high + at)))

LIBCHAR_LANES void add_windowed_lanes(const Neighbours& x, std::size_t bins, double* power) {
  for (std::size_t at = 0; at < 2 * bins; at += 8) {
    const Four re = LIBCHAR_WINDOWED(x, at), im = LIBCHAR_WINDOWED(x, at + 4);
    LIBCHAR_FOUR_TO(power + at / 2) = LIBCHAR_FOUR(power + at / 2) + (re * re + im * im);
  }
}

void add_windowed(const Neighbours& x, std::size_t bins, double* power) {
  return InLanes<add_windowed_lanes>()(x, bins, power);
}

LIBCHAR_LANES void add_two_windowed_lanes(const Neighbours& x,
                                          const Neighbours& y,
                                          std::size_t bins,
                                          double* power) {
  for (std::size_t at = 0; at < 2 * bins; at += 8) {
    const Four re = LIBCHAR_WINDOWED(x, at), im = LIBCHAR_WINDOWED(x, at + 4);
    const Four re2 = LIBCHAR_WINDOWED(y, at), im2 = LIBCHAR_WINDOWED(y, at + 4);
    LIBCHAR_FOUR_TO(power + at / 2) =
        (LIBCHAR_FOUR(power + at / 2) + (re * re + im * im)) + (re2 * re2 + im2 * im2);
  }
}

void add_windowed(const Neighbours& x, const Neighbours& y, std::size_t bins, double* power) {
  return InLanes<add_two_windowed_lanes>()(x, y, bins, power);
}

LIBCHAR_LANES double mean_about_first_lanes(const double* x, std::size_t n) {
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

double mean_about_first(const double* x, std::size_t n) {
  return InLanes<mean_about_first_lanes>()(x, n);
}

}  // namespace libchar::half_segments
