// Welch's method with a Hann window and half-overlapping segments, without transforming any sample
// twice over a whole segment.
//
// With h samples in a half, L = 2h, and Z_k the DFT at the L frequencies of a half less its mean s
// and padded with zeros, a segment made of the halves p and a, less its own mean (s_p + s_a)/2, has
//   X_k = P_k + (-1)^k A_k + (s_p - s_a) (1 - i cot(pi k / L)) [k odd]
// (the last term is the transform of the step between the means), and with the periodic Hann
// window, three terms of a cosine sum,
//   Y_k = X_k/2 - (X_{k-1} + X_{k+1})/4.
// The same Z_k gives the orthonormal DCT-II of the half:   c_k = sqrt(2/h) Re(exp(-i pi k / L)
// Z_k).
//
// Z itself: even bins k = 2m are the DFT of the half, odd ones k = 2m+1 its DFT at frequencies
// moved by half a bin. Each is a complex transform of q = h/2 values u_s = x_{2s} + i x_{2s+1} and
// the usual separation (R. N. Bracewell, The Fourier Transform and Its Applications, on two real
// transforms in one). Each transform of q = n1 n2 values goes in two steps that stay in the cache
// (W. M. Gentleman and G. Sande, 1966; D. H. Bailey, 1990): over t1 at fixed t2, a turn by exp(-2
// pi i t2 m1 / q), over t2; s = n2 t1 + t2, m = m1 + n1 m2. The result is left where it stands, in
// rows of fixed m1: the mirror q - m of row r is row n1 - r backwards, the neighbours m ± 1 are the
// rows beside it, and everything after the transform goes row by row, as soon as a row is there:
// memory is what this costs, more than arithmetic.
//
// Inside a row four values stand as four real and four imaginary parts, in the order 0 2 1 3 that
// unpacking gives.

#include "libchar/spectrum/half_segments.hpp"

#include <algorithm>
#include <cmath>
#include <new>
#include <numbers>
#include <utility>

#include "libchar/spectrum/fft.hpp"
#include "libchar/spectrum/half_segment_kernels.hpp"

namespace libchar {

using namespace halves;

namespace {

constexpr std::size_t kColumns =
    4;  // transformed side by side, or a multiple of it: one line of the cache
constexpr std::size_t kPadding =
    8;  // between rows, or a column of them would fall into few sets of the cache
constexpr std::size_t kRows = 4;              // transformed one after another
constexpr std::size_t kShortest = 1U << 11U;  // halves below are transformed faster whole

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

/// n1 <= n2 as near to each other as can be, n2 a multiple of 8; {0, 0} when q has other factors
/// than 2, 3, 5, 7.
std::pair<std::size_t, std::size_t> split(std::size_t q) {
  std::size_t rest = q;
  for (const std::size_t prime : {2U, 3U, 5U, 7U})
    while (rest > 1 && rest % prime == 0) rest /= prime;
  if (rest != 1) return {0, 0};
  for (auto n1 = static_cast<std::size_t>(std::sqrt(static_cast<double>(q)) + 0.5); n1 >= 16; --n1)
    if (q % n1 == 0 && q / n1 % kColumns == 0 && q / n1 < 8 * n1) return {n1, q / n1};
  return {0, 0};
}

/// Where a column of all rows is more than the cache holds at once, several lines are taken from
/// each row.
std::size_t columns_at_once(std::size_t q, std::size_t n2) {
  std::size_t count = q <= (std::size_t{1} << 16U) ? 2 * kColumns : 6 * kColumns;
  while (n2 % count != 0) count -= kColumns;
  return count;
}

}  // namespace

struct HalfSegments::State {
  std::size_t h, q, n1, n2, pitch, count;               // count: columns at once
  ComplexFft columns, rows, row;                        // rows: kRows of them
  std::vector<double> shift, fine[2], coarse, quarter;  // fine: even bins, odd bins
  Buffer column_values;                                 // four columns
  Buffer row_values;                                    // n1 rows, `pitch` apart
  Buffer z;        // of the half before: even bins, then odd bins
  Buffer x_even;   // X of the segment
  Buffer scratch;  // rows: Z, Z of the mirror, X of odd bins: two rising, two falling, one moved
  double z_top = 0, x_top = 0;  // bin h
  Buffer segment_sums,
      block_sums;  // even bins, then odd bins; the second when it is first asked for
  double top_sum = 0;
  std::vector<char> row_done;
  bool joined = false;  // z is there
  double before_mean = 0;

  State(std::size_t half, std::size_t split1, std::size_t split2);
  void transform_columns(const double* x, double mean, bool odd);
  void transform_row(std::size_t r);
  Complex start_of(std::size_t r, bool odd) const {
    return turn(static_cast<double>(2 * r + (odd ? 1 : 0)), static_cast<double>(2 * h));
  }
  void z_of_rows(
      std::size_t r, std::size_t mirror, bool odd, bool block, double* z_row, double* z_mirror);
  void z_of_own_mirror(std::size_t r, bool odd, bool block, double* z_row);
  void take_even(const double* x, double mean, bool block);
  void take_odd(const double* x, double mean, bool block);
  void take_odd_row(std::size_t r, const double* z_row, double step, double* x_odd);
  void natural(const double* sums, double top, std::vector<double>& out) const;
};

HalfSegments::State::State(std::size_t half, std::size_t split1, std::size_t split2)
    : h(half),
      q(half / 2),
      n1(split1),
      n2(split2),
      pitch(2 * n2 + kPadding),
      count(columns_at_once(q, n2)),
      columns(n1, count, count, 1),
      rows(n2, kRows, 1, pitch / 2),
      row(n2, 1, 1, n2),
      column_values(zeros(2 * count * n1)),
      row_values(zeros(n1 * pitch)),
      z(zeros(4 * q)),
      x_even(zeros(2 * q)),
      scratch(zeros(14 * n2)),
      segment_sums(zeros(2 * q)) {
  const auto push = [](std::vector<double>& table, Complex value) {
    table.push_back(value.real());
    table.push_back(value.imag());
  };
  for (std::size_t t1 = 0; t1 < n1; ++t1)
    push(shift, turn(static_cast<double>(t1), static_cast<double>(n1)));
  for (std::size_t odd = 0; odd < 2; ++odd) {
    fine[odd].resize(2 * count * n1);
    for (std::size_t m1 = 0; m1 < n1; ++m1)
      for (std::size_t j = 0; j < count; ++j)
        put(fine[odd].data() + 2 * count * m1,
            j,
            turn(static_cast<double>(j) * static_cast<double>(2 * m1 + odd),
                 static_cast<double>(q)));
  }
  const std::size_t period = 2 * q / count;
  for (std::size_t j = 0; j < period; ++j)
    push(coarse, turn(2 * static_cast<double>(j), static_cast<double>(period)));
  quarter.resize(2 * n2);
  for (std::size_t m2 = 0; m2 < n2; ++m2)
    put(quarter.data(), m2, turn(static_cast<double>(m2), static_cast<double>(2 * n2)));
}

void HalfSegments::State::transform_columns(const double* x, double mean, bool odd) {
  ColumnStep step{
      n1, n2, pitch, count, 0, odd, shift.data(), fine[odd ? 1 : 0].data(), coarse.data()};
  for (; step.column < n2; step.column += count) {
    gather_columns(x, mean, step, column_values.get());
    columns.transform(column_values.get());
    scatter_columns(column_values.get(), step, row_values.get());
  }
  row_done.assign(n1, 0);
}

/// When it is first asked for, with its neighbours in memory.
void HalfSegments::State::transform_row(std::size_t r) {
  const std::size_t first = r / kRows * kRows;
  if (first + kRows > n1) {  // the last few
    if (std::exchange(row_done[r], char{1}) == 0) row.transform(row_values.get() + r * pitch);
  } else if (std::exchange(row_done[first], char{1}) == 0) {
    rows.transform(row_values.get() + first * pitch);
  }
}

void HalfSegments::State::z_of_rows(
    std::size_t r, std::size_t mirror, bool odd, bool block, double* z_row, double* z_mirror) {
  transform_row(r);
  if (mirror == r) return z_of_own_mirror(r, odd, block, z_row);
  transform_row(mirror);
  double* const c = block ? block_sums.get() + (odd ? q : 0) : nullptr;
  separate({row_values.get() + r * pitch,
            row_values.get() + mirror * pitch,
            z_row,
            z_mirror,
            block ? c + r * n2 : nullptr,
            block ? c + mirror * n2 : nullptr,
            quarter.data(),
            start_of(r, odd),
            n2});
}

/// A row that is its own mirror, value by value: the first one of the even bins (moved by one), and
/// the one in the middle.
void HalfSegments::State::z_of_own_mirror(std::size_t r, bool odd_bins, bool block, double* z_row) {
  const double* const u = row_values.get() + r * pitch;
  double* const c_row = block ? block_sums.get() + (odd_bins ? q : 0) + r * n2 : nullptr;
  const Complex start = start_of(r, odd_bins);
  const bool moved = r == 0 && !odd_bins;
  const auto at = [&](std::size_t m2) { return Complex(u[2 * m2], u[2 * m2 + 1]); };
  for (std::size_t m2 = 0; m2 < n2; ++m2) {
    const Complex mine = at(m2), other = std::conj(at(moved ? (n2 - m2) % n2 : n2 - 1 - m2));
    const Complex even = 0.5 * (mine + other), odd = Complex(0, -0.5) * (mine - other);
    const Complex turned = start * value_at(quarter.data(), m2);
    const Complex value = even + turned * turned * odd;
    put(z_row, m2, value);
    if (moved && m2 == 0) {
      const double top = even.real() - odd.real();
      x_top = std::exchange(z_top, top) + top;
    }
    if (!block) continue;
    const double c = turned.real() * value.real() - turned.imag() * value.imag();
    c_row[sum_place(m2)] += c * c;
  }
}

void HalfSegments::State::take_even(const double* x, double mean, bool block) {
  const std::size_t width = 2 * n2;
  double *z_row = scratch.get(), *z_mirror = z_row + width;
  transform_columns(x, mean, false);
  for (std::size_t r = 0; r <= n1 / 2; ++r) {
    const std::size_t mirror = r == 0 ? 0 : n1 - r;
    if (mirror < r) break;  // n1 odd: done
    z_of_rows(r, mirror, false, block, z_row, z_mirror);
    join_even(z_row, n2, z.get() + r * width, x_even.get() + r * width);
    if (mirror != r)
      join_even(z_mirror, n2, z.get() + mirror * width, x_even.get() + mirror * width);
  }
}

/// X of a row of odd bins, and its windowed power (between the even bins below and above, which are
/// there already).
void HalfSegments::State::take_odd_row(std::size_t r,
                                       const double* z_row,
                                       double step,
                                       double* x_odd) {
  const std::size_t width = 2 * n2;
  join_odd(z_row, n2, quarter.data(), start_of(r, true), step, z.get() + 2 * q + r * width, x_odd);
  if (!joined) return;
  const double* above = x_even.get() + (r + 1) * width;
  double* const moved = scratch.get() + 6 * width;
  if (r + 1 == n1) {  // above the last row stands the first one, moved by one; at its end bin h
    for (std::size_t m2 = 0; m2 + 1 < n2; ++m2) put(moved, m2, value_at(x_even.get(), m2 + 1));
    put(moved, n2 - 1, x_top);
    above = moved;
  }
  add_windowed(x_even.get() + r * width, x_odd, above, n2, segment_sums.get() + q + r * n2);
}

void HalfSegments::State::take_odd(const double* x, double mean, bool block) {
  const std::size_t width = 2 * n2;
  double *z_row = scratch.get(), *z_mirror = z_row + width;
  double *rising = z_mirror + width, *rising_before = rising + width,
         *falling = rising_before + width, *falling_before = falling + width;
  double* const moved = falling_before + width;
  const double step = before_mean - mean;
  transform_columns(x, mean, true);
  const auto even_row = [&](std::size_t r, const double* below, const double* above) {
    if (joined)
      add_windowed(below, x_even.get() + r * width, above, n2, segment_sums.get() + r * n2);
  };
  const std::size_t pairs = (n1 + 1) / 2;
  for (std::size_t r = 0; r < pairs; ++r) {
    const std::size_t mirror = n1 - 1 - r;
    z_of_rows(r, mirror, true, block, z_row, z_mirror);
    take_odd_row(r, z_row, step, rising);
    if (mirror != r)
      take_odd_row(mirror, z_mirror, step, falling);
    else
      std::swap(falling, rising);  // the middle row closes both ways
    if (r == 0) {
      // Below the first row stands the last one, moved by one; below bin 1 its conjugate.
      const double* const last = falling;
      for (std::size_t m2 = n2 - 1; m2 > 0; --m2) put(moved, m2, value_at(last, m2 - 1));
      put(moved, 0, std::conj(value_at(rising, 0)));
      even_row(0, moved, rising);
      const double top = 0.5 * x_top - 0.5 * value_at(last, n2 - 1).real();
      if (joined) top_sum += top * top;
    } else if (mirror == r) {
      even_row(r, rising_before, falling);
      even_row(r + 1, falling, falling_before);
    } else {
      even_row(r, rising_before, rising);
      even_row(mirror + 1, falling, falling_before);
    }
    if (mirror == r + 1) even_row(mirror, rising, falling);
    std::swap(rising, rising_before);
    std::swap(falling, falling_before);
  }
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
  return options.window == Window::hann && options.overlap == 0.5 &&
         options.detrend == Detrend::constant && options.segment % 4 == 0 && h >= kShortest &&
         split(h / 2).first != 0;
}

HalfSegments::HalfSegments(std::size_t segment) {
  const auto [n1, n2] = split(segment / 4);
  state_ = std::make_unique<State>(segment / 2, n1, n2);
}
HalfSegments::~HalfSegments() = default;
HalfSegments::HalfSegments(HalfSegments&&) noexcept = default;
HalfSegments& HalfSegments::operator=(HalfSegments&&) noexcept = default;

std::size_t HalfSegments::half() const {
  return state_->h;
}
double HalfSegments::mean_of(const double* x) const {
  return mean_about_first(x, state_->h);
}
void HalfSegments::forget() {
  state_->joined = false;
}

bool HalfSegments::push(const double* x, double mean, bool block) {
  State& s = *state_;
  if (!std::isfinite(mean)) {
    s.joined = false;
    return false;
  }
  if (block && !s.block_sums) s.block_sums = zeros(2 * s.q);
  s.take_even(x, mean, block);
  s.take_odd(x, mean, block);
  s.before_mean = mean;
  return std::exchange(s.joined, true);
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
  std::vector<double> power(state_->h, 0.0);
  if (!state_->block_sums) return power;
  state_->natural(state_->block_sums.get(), 0, power);
  power.resize(state_->h);
  for (double& c : power) c *= 2 / static_cast<double>(state_->h);
  return power;
}

}  // namespace libchar
