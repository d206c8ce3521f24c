#include "libchar/spectrum/fft.hpp"

#include <fftw3.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>

#include "libchar/core/numeric/lanes.hpp"
#include "libchar/core/process/work.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/spectrum/detail/fft_plan.hpp"

namespace libchar {

using fft_plan::Aligned;
using fft_plan::aligned;
using fft_plan::Plan;

namespace {

constexpr Four kAlternating = {-1, 1, -1, 1};
#define SWAPPED(v) __builtin_shufflevector(v, v, 1, 0, 3, 2)

/// exp(-2 pi i k / n) times a factor, as products of two short exact tables, coarse (every 512th) and fine: neither a
/// table of all entries nor all their sines are paid, and no error builds up along k.
struct Turns {
  static constexpr std::size_t kFine = 512;
  std::vector<std::complex<double>> coarse, fine;

  /// For k < `count`.
  Turns(std::size_t n, std::size_t count, std::complex<double> factor)
      : coarse((count + kFine - 1) / kFine), fine(std::min(kFine, count)) {
    const auto turn = [n](std::size_t k) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n);
      return std::complex<double>(std::cos(angle), -std::sin(angle));
    };
    for (std::size_t j = 0; j < coarse.size(); ++j) coarse[j] = turn(j * kFine) * factor;
    for (std::size_t j = 0; j < fine.size(); ++j) fine[j] = turn(j);
  }
};

/// One block of `split_halves`: pairs k and m - k, from `low` on upwards and from `high` on downwards, each at two
/// doubles. `sign` is that of the imaginary part of the turns. Vectors, then what is left.
LIBCHAR_LANES void split_pairs_lanes(double* low, double* high, const double* fine, std::size_t pairs,
                                     const double* coarse, double half, double sign) {
  constexpr Four kConjugate = {1, -1, 1, -1};
  const double cr = coarse[0], ci = coarse[1];
  std::size_t i = 0;
  // Both places of a vector are written behind both have been read, and lie apart but for the last pairs.
  for (; i + 4 <= pairs; i += 2) {
    double* const up = low + 2 * i;
    double* const down = high - 2 * i - 2;
    const Four f = LIBCHAR_FOUR(fine + 2 * i), d0 = LIBCHAR_FOUR(down), a = LIBCHAR_FOUR(up);
    const Four w = f * cr + SWAPPED(f) * (ci * kAlternating);
    const Four b = __builtin_shufflevector(d0, d0, 2, 3, 0, 1) * kConjugate;
    const Four sum = (a + b) * half, difference = (a - b) * half;
    const Four real = __builtin_shufflevector(w, w, 0, 0, 2, 2);
    const Four crossed = __builtin_shufflevector(w, w, 1, 1, 3, 3) * (sign * kAlternating);
    const Four turned = difference * real + SWAPPED(difference) * crossed;
    const Four other = (sum - turned) * kConjugate;
    LIBCHAR_FOUR_TO(up) = sum + turned;
    LIBCHAR_FOUR_TO(down) = __builtin_shufflevector(other, other, 2, 3, 0, 1);
  }
  for (; i < pairs; ++i) {
    double* const up = low + 2 * i;
    double* const down = high - 2 * i;
    const double wr = fine[2 * i] * cr - fine[2 * i + 1] * ci;
    const double wi = sign * (fine[2 * i + 1] * cr + fine[2 * i] * ci);
    const double sr = (up[0] + down[0]) * half, si = (up[1] - down[1]) * half;
    const double dr = (up[0] - down[0]) * half, di = (up[1] + down[1]) * half;
    const double tr = dr * wr - di * wi, ti = di * wr + dr * wi;
    up[0] = sr + tr;
    up[1] = si + ti;
    down[0] = sr - tr;
    down[1] = ti - si;
  }
}
constexpr InLanes<split_pairs_lanes> split_pairs;

}  // namespace

// Of even n one complex transform of half the length: FFTW plans it thirty times faster than its real ones. With
// z_t = x_2t + i x_(2t+1), Z its transform of m = n / 2 values, Z_m = Z_0 and v_k = -i exp(-2 pi i k / n)
//   X_k = (Z_k + conj Z_(m-k)) / 2 + v_k (Z_k - conj Z_(m-k)) / 2,
//   Z_k =  X_k + conj X_(m-k) + conj(v_k) (X_k - conj X_(m-k))      (backward; the factor n stays)
// for k = 0..m (W. H. Press et al., Numerical Recipes, 12.3), and the same at m - k with the second term's sign turned,
// conjugated.
struct RealFft::State {
  std::size_t n;
  Aligned<double> values;
  Aligned<std::complex<double>> spectrum;
  Plan forward, backward;
  std::optional<Turns> turns{};

  bool by_halves() const { return n % 2 == 0; }
  // The interface with 64-bit sizes: a day at 25 kHz is past 2^31 samples.
  fftw_iodim64 dimension() const { return {static_cast<std::ptrdiff_t>(by_halves() ? n / 2 : n), 1, 1}; }
  fftw_complex* bins() const { return reinterpret_cast<fftw_complex*>(spectrum.get()); }
  fftw_complex* pairs() const { return reinterpret_cast<fftw_complex*>(values.get()); }
  void plan(Plan& plan, bool is_forward) const;
  void split_halves(double half, double sign);
};

void RealFft::State::plan(Plan& plan, bool is_forward) const {
  if (plan) return;
  plan = fft_plan::planned(is_forward ? fft_plan::Kind::real_forward : fft_plan::Kind::real_backward, n, [&] {
    const fftw_iodim64 length = dimension();
    const unsigned flags = FFTW_ESTIMATE | FFTW_DESTROY_INPUT;
    if (by_halves() && is_forward)
      return fftw_plan_guru64_dft(1, &length, 0, nullptr, pairs(), bins(), FFTW_FORWARD, flags);
    if (by_halves()) return fftw_plan_guru64_dft(1, &length, 0, nullptr, bins(), pairs(), FFTW_BACKWARD, flags);
    if (is_forward) return fftw_plan_guru64_dft_r2c(1, &length, 0, nullptr, values.get(), bins(), flags);
    return fftw_plan_guru64_dft_c2r(1, &length, 0, nullptr, bins(), values.get(), flags);
  });
}

void RealFft::State::split_halves(double half, double sign) {
  const std::size_t m = n / 2, count = m / 2 + 1;
  if (!turns) turns.emplace(n, count, std::complex<double>(0, -1));
  auto* const low = reinterpret_cast<double*>(spectrum.get());
  for (std::size_t j = 0; j < turns->coarse.size(); ++j) {
    const std::size_t k = j * Turns::kFine, pairs = std::min(Turns::kFine, count - k);
    split_pairs(low + 2 * k, low + 2 * (m - k), reinterpret_cast<const double*>(turns->fine.data()), pairs,
                reinterpret_cast<const double*>(&turns->coarse[j]), half, sign);
  }
}

RealFft::RealFft(std::size_t n) : state_(detail::hidden<State>()) {
  if (n == 0) throw numeric_error("E0413").says("a Fourier transform needs at least one value");
  state_->n = n;
  state_->values = aligned<double>(n);
  state_->spectrum = aligned<std::complex<double>>(n / 2 + 1);
}

std::span<double> RealFft::input() { return {state_->values.get(), state_->n}; }

std::span<std::complex<double>> RealFft::coefficients() { return {state_->spectrum.get(), state_->n / 2 + 1}; }

// Planned where it is used: FFTW's estimate leaves what stands in the buffers.
std::span<const std::complex<double>> RealFft::transform() {
  State& s = *state_;
  s.plan(s.forward, true);
  if (s.by_halves()) {
    fftw_execute_dft(s.forward.get(), s.pairs(), s.bins());
    s.spectrum[s.n / 2] = s.spectrum[0];
    s.split_halves(0.5, 1);
  } else {
    fftw_execute_dft_r2c(s.forward.get(), s.values.get(), s.bins());
  }
  return {s.spectrum.get(), s.n / 2 + 1};
}

std::span<const double> RealFft::inverse() {
  State& s = *state_;
  s.plan(s.backward, false);
  if (s.by_halves()) {
    for (std::complex<double>* const end : {&s.spectrum[0], &s.spectrum[s.n / 2]}) end->imag(0);
    s.split_halves(1, -1);
    fftw_execute_dft(s.backward.get(), s.bins(), s.pairs());
  } else {
    fftw_execute_dft_c2r(s.backward.get(), s.bins(), s.values.get());
  }
  return {s.values.get(), s.n};
}

std::size_t RealFft::size() const { return state_->n; }

// FFTW's estimate is at its worst for lengths with high powers of five, such as 625 or 1000, which records of a round
// number of samples give: plans of twice the time it could be. For these the transform of n = a b values goes in two
// steps that FFTW does well (W. M. Gentleman and G. Sande, 1966): over t1 at fixed t2, a turn by exp(-2 pi i m1
// t2 / n), over t2; t = b t1 + t2, m = m1 + a m2. The values between the steps stand packed in memory of the object.
namespace {

/// The first step's length; 0: FFTW alone.
std::size_t first_step(std::size_t n) {
  const auto does_well = [](std::size_t length) {
    return (length >= 8 && length <= 16) || length == 20 || length == 25 || length == 32;
  };
  if (n % 25 == 0 && does_well(n / 25)) return 25;
  if (n % 100 == 0 && does_well(n / 100)) return n / 100;
  return 0;
}

/// Four transforms side by side: one turn for four values.
LIBCHAR_LANES void turn_fours_lanes(double* values, const double* turns, std::size_t n) {
  for (std::size_t j = 0; j < n; ++j, values += 8) {
    const double cosine = turns[2 * j];
    const Four crossed = turns[2 * j + 1] * kAlternating;
    const Four u = LIBCHAR_FOUR(values), v = LIBCHAR_FOUR(values + 4);
    LIBCHAR_FOUR_TO(values) = u * cosine + SWAPPED(u) * crossed;
    LIBCHAR_FOUR_TO(values + 4) = v * cosine + SWAPPED(v) * crossed;
  }
}
constexpr InLanes<turn_fours_lanes> turn_fours;

/// One transform: a turn for each value; n is even.
LIBCHAR_LANES void turn_each_lanes(double* values, const double* turns, std::size_t n) {
  for (std::size_t j = 0; j < 2 * n; j += 4) {
    const Four u = LIBCHAR_FOUR(values + j), t = LIBCHAR_FOUR(turns + j);
    const Four cosine = __builtin_shufflevector(t, t, 0, 0, 2, 2);
    const Four crossed = __builtin_shufflevector(t, t, 1, 1, 3, 3) * kAlternating;
    LIBCHAR_FOUR_TO(values + j) = u * cosine + SWAPPED(u) * crossed;
  }
}
constexpr InLanes<turn_each_lanes> turn_each;

}  // namespace

struct ComplexFft::State {
  Plan plan;    // of all, or of the first step of `together` transforms
  Plan second;  // none: one plan
  std::size_t n = 0, count = 0, distance = 0, together = 1;
  Aligned<std::complex<double>> between;
  std::vector<double> turns;

  void plan_two_steps(std::size_t a, std::size_t step, fftw_complex* values);
  void two_steps(fftw_complex* from, fftw_complex* to) const;
};

void ComplexFft::State::plan_two_steps(std::size_t a, std::size_t step, fftw_complex* values) {
  const std::size_t b = n / a;
  const auto iodim = [](std::size_t length, std::size_t in, std::size_t out) {
    const auto signed_of = [](std::size_t value) { return static_cast<std::ptrdiff_t>(value); };
    return fftw_iodim64{signed_of(length), signed_of(in), signed_of(out)};
  };
  const fftw_iodim64 over_t1 = iodim(a, b * step, b * together), over_t2 = iodim(b, together, a * step);
  const fftw_iodim64 every_t2[2] = {iodim(b, step, together), iodim(together, distance, 1)};
  const fftw_iodim64 every_m1[2] = {iodim(a, b * together, step), iodim(together, 1, distance)};
  between = aligned<std::complex<double>>(n * together);
  auto* const packed = reinterpret_cast<fftw_complex*>(between.get());
  plan = fft_plan::owned(fftw_plan_guru64_dft(1, &over_t1, 2, every_t2, values, packed, FFTW_FORWARD, FFTW_ESTIMATE));
  second = fft_plan::owned(fftw_plan_guru64_dft(1, &over_t2, 2, every_m1, packed, values, FFTW_FORWARD, FFTW_ESTIMATE));
  for (std::size_t m1 = 0; m1 < a; ++m1)
    for (std::size_t t2 = 0; t2 < b; ++t2) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(m1 * t2) / static_cast<double>(n);
      turns.push_back(std::cos(angle));
      turns.push_back(-std::sin(angle));
    }
}

void ComplexFft::State::two_steps(fftw_complex* from, fftw_complex* to) const {
  auto* const packed = reinterpret_cast<fftw_complex*>(between.get());
  for (std::size_t i = 0; i < count; i += together, from += together * distance, to += together * distance) {
    fftw_execute_dft(plan.get(), from, packed);
    auto* const doubles = reinterpret_cast<double*>(between.get());
    together == 4 ? turn_fours(doubles, turns.data(), n) : turn_each(doubles, turns.data(), n);
    fftw_execute_dft(second.get(), packed, to);
  }
}

namespace {

// Planned for memory as the caller's will be: FFTW looks at no more than the lowest bits of the address.
struct PlannedFor {
  Aligned<std::complex<double>> memory;
  fftw_complex* values;
  explicit PlannedFor(std::size_t n) : memory(aligned<std::complex<double>>(n + 4)) {
    const auto past = reinterpret_cast<std::uintptr_t>(memory.get()) % 64;
    values = reinterpret_cast<fftw_complex*>(reinterpret_cast<char*>(memory.get()) + (64 - past) % 64);
  }
};

fftw_iodim64 dimension_of(std::size_t n, std::size_t step) {
  return {static_cast<std::ptrdiff_t>(n), static_cast<std::ptrdiff_t>(step), static_cast<std::ptrdiff_t>(step)};
}

}  // namespace

ComplexFft::ComplexFft(std::size_t n, std::size_t count, std::size_t step, std::size_t distance)
    : state_(detail::hidden<State>()) {
  const fftw_iodim64 dimension = dimension_of(n, step), batch = dimension_of(count, distance);
  const PlannedFor memory(n * step + count * distance);
  State& s = *state_;
  s.n = n;
  s.count = count;
  s.distance = distance;
  s.together = count % 4 == 0 && distance == 1 ? 4 : 1;
  const std::size_t a = first_step(n);
  const std::lock_guard lock(fft_plan::planner());
  if (a != 0 && (s.together == 4 || n % 2 == 0))
    s.plan_two_steps(a, step, memory.values);
  else
    s.plan = fft_plan::owned(
        fftw_plan_guru64_dft(1, &dimension, 1, &batch, memory.values, memory.values, FFTW_FORWARD, FFTW_ESTIMATE));
}

ComplexFft::ComplexFft(std::size_t n) : state_(detail::hidden<State>()) {
  const fftw_iodim64 dimension = dimension_of(n, 1);
  const PlannedFor from(n), to(n);
  State& s = *state_;
  s.n = s.distance = n;
  s.count = 1;
  const std::size_t a = first_step(n);
  const std::lock_guard lock(fft_plan::planner());
  if (a != 0 && n % 2 == 0)
    s.plan_two_steps(a, 1, from.values);
  else
    s.plan = fft_plan::owned(
        fftw_plan_guru64_dft(1, &dimension, 0, nullptr, from.values, to.values, FFTW_FORWARD, FFTW_ESTIMATE));
}

void ComplexFft::transform(double* interleaved) const {
  auto* const values = reinterpret_cast<fftw_complex*>(interleaved);
  if (state_->second) return state_->two_steps(values, values);
  fftw_execute_dft(state_->plan.get(), values, values);
}

void ComplexFft::transform(const double* from, double* to) const {
  // FFTW's interface knows no const; a transform to another place leaves its input as it is.
  auto* const values = reinterpret_cast<fftw_complex*>(const_cast<double*>(from));
  auto* const result = reinterpret_cast<fftw_complex*>(to);
  if (state_->second) return state_->two_steps(values, result);
  fftw_execute_dft(state_->plan.get(), values, result);
}

namespace {

// Mean about the first sample, in eight lanes. Centring keeps a large first coefficient from leaving its rounding
// errors in the others: without it they are 3e-14 where they could be 3e-16, and at an offset of 1e9 nothing is left.
double centre_of(std::span<const double> y) {
  const double first = y[0];
  double lanes[8] = {};
  std::size_t t = 0;
  for (; t + 8 <= y.size(); t += 8)
    for (std::size_t lane = 0; lane < 8; ++lane) lanes[lane] += y[t + lane] - first;
  for (; t < y.size(); ++t) lanes[0] += y[t] - first;
  double sum = 0;
  for (const double lane : lanes) sum += lane;
  return first + sum / static_cast<double>(y.size());
}

}  // namespace

// DCT-II from one real FFT (J. Makhoul, IEEE Trans. ASSP 28, 1980): with v = (y_0, y_2, y_4, …,
// y_5, y_3, y_1), V its DFT and W_k = exp(-i pi k / (2n)) V_k,
//   sum_t y_t cos(pi k (t + 1/2) / n) = Re W_k,      and the same at n - k is -Im W_k.
struct Dct::State {
  RealFft fft;
  Turns turns;

  explicit State(std::size_t n) : fft(n), turns(4 * n, n / 2 + 1, std::sqrt(2 / static_cast<double>(n))) {}
  void permute(std::span<const double> y, double centre);
  void rotate(std::span<const std::complex<double>> v, double* c) const;
};

Dct::Dct(std::size_t n) {
  if (n == 0) throw numeric_error("E0413").says("a cosine transform needs at least one value");
  state_ = detail::hidden<State>(n);
}

void Dct::State::permute(std::span<const double> y, double centre) {
  const std::span<double> v = fft.input();
  const std::size_t n = y.size(), half = n / 2;
  for (std::size_t j = 0; j < half; ++j) {
    v[j] = y[2 * j] - centre;
    v[n - 1 - j] = y[2 * j + 1] - centre;
  }
  if (n % 2 == 1) v[half] = y[n - 1] - centre;
}

void Dct::State::rotate(std::span<const std::complex<double>> v, double* c) const {
  const std::size_t n = fft.size(), last = n / 2;
  for (std::size_t j = 0; j < turns.coarse.size(); ++j) {
    const double cr = turns.coarse[j].real(), ci = turns.coarse[j].imag();
    const std::size_t begin = j * Turns::kFine, end = std::min(begin + Turns::kFine, last + 1);
    for (std::size_t k = begin; k < end; ++k) {
      const double fr = turns.fine[k - begin].real(), fi = turns.fine[k - begin].imag();
      const double wr = cr * fr - ci * fi, wi = cr * fi + ci * fr;
      if (k > 0) c[n - k] = -(wr * v[k].imag() + wi * v[k].real());
      c[k] = wr * v[k].real() - wi * v[k].imag();
    }
  }
}

std::span<const double> Dct::transform(std::span<const double> y) {
  const std::size_t n = state_->fft.size();
  if (y.size() != n) throw numeric_error("E0413").says("a cosine transform of {} values was given {}", n, y.size());
  count_work(WorkKind::cosine_transforms, 1);
  const double centre = centre_of(y);
  state_->permute(y, centre);
  const auto v = state_->fft.transform();
  const double sum = v[0].real(), root = std::sqrt(static_cast<double>(n));
  // The input of the FFT is free once it has run: the coefficients go there, and the whole costs
  // two arrays of n values.
  double* c = state_->fft.input().data();
  state_->rotate(v, c);
  c[0] = centre * root + sum / root;
  return {c, n};
}

// c_k sin(pi k t / n) is twice the real part of (-i c_k / 2) exp(2 pi i k t / 2n): one real
// transform of 2n values, as FFTW's own RODFT00 does it, which takes long to plan.
struct SineSums::State {
  explicit State(std::size_t n) : values(n), fft(2 * n) {}
  std::vector<double> values;
  RealFft fft;
};

SineSums::SineSums(std::size_t n) : state_(detail::hidden<State>(n)) {}

std::span<double> SineSums::input() { return state_->values; }

std::span<const double> SineSums::transform() {
  State& s = *state_;
  const std::span<std::complex<double>> bins = s.fft.coefficients();
  bins.front() = bins.back() = 0;
  for (std::size_t k = 1; k < s.values.size(); ++k) bins[k] = {0, -0.5 * s.values[k]};
  s.fft.inverse();
  const std::span<double> sums = s.fft.input().first(s.values.size());
  sums[0] = 0;
  return sums;
}

// FFTW's REDFT01 is c_0 + 2 sum c_k cos(...).
struct CosineSums::State {
  std::size_t n;
  Aligned<double> values, sums;
  Plan plan;
};

CosineSums::CosineSums(std::size_t n) : state_(detail::hidden<State>()) {
  if (n == 0) throw numeric_error("E0413").says("sums of cosines need at least one value");
  State& s = *state_;
  s.n = n;
  s.values = aligned<double>(n);
  s.sums = aligned<double>(n);
  s.plan = fft_plan::planned(fft_plan::Kind::sums_of_cosines, n, [&] {
    const fftw_iodim64 dimension = {static_cast<std::ptrdiff_t>(n), 1, 1};
    const fftw_r2r_kind r2r = FFTW_REDFT01;
    return fftw_plan_guru64_r2r(1, &dimension, 0, nullptr, s.values.get(), s.sums.get(), &r2r,
                                FFTW_ESTIMATE | FFTW_DESTROY_INPUT);
  });
}

std::span<double> CosineSums::input() { return {state_->values.get(), state_->n}; }

std::span<const double> CosineSums::transform() {
  const State& s = *state_;
  const double n = static_cast<double>(s.n), scale = std::sqrt(0.5 / n);
  for (std::size_t k = 1; k < s.n; ++k) s.values[k] *= scale;
  s.values[0] /= std::sqrt(n);
  fftw_execute_r2r(s.plan.get(), s.values.get(), s.sums.get());
  return {s.sums.get(), s.n};
}

}  // namespace libchar
