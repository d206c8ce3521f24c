#pragma once
// FFTW behind a few small classes; nothing else includes fftw3.h. Plans are FFTW_ESTIMATE (same bits every run),
// created under one mutex, kept for the next of their length, and run on aligned buffers owned by the object.

#include <complex>
#include <cstddef>
#include <span>

#include "libchar/core/hidden.hpp"

namespace libchar {

/// Forward real-to-complex transform of fixed length n: X_k = sum_t x_t exp(-2 pi i k t / n), k = 0..n/2.
class RealFft {
 public:
  explicit RealFft(std::size_t n);
  std::span<double> input();                          ///< n values to fill in
  std::span<const std::complex<double>> transform();  ///< n/2 + 1 values, valid until the next call
  std::span<std::complex<double>> coefficients();     ///< n/2 + 1 values to fill in for `inverse`
  std::span<const double> inverse();                  ///< n values, not divided by n
  std::size_t size() const;

 private:
  struct State;
  detail::Hidden<State> state_;
};

/// Forward complex transforms of n values in place, `count` of them at once: value t of transform i is at
/// [i * distance + t * step]. Several at once are faster than one by one, because FFTW puts neighbours into one vector.
/// The memory is the caller's and must be aligned to 64 bytes. An object serves one thread at a time.
class ComplexFft {
 public:
  ComplexFft(std::size_t n, std::size_t count, std::size_t step, std::size_t distance);
  /// One transform of n values side by side, from one place to another.
  explicit ComplexFft(std::size_t n);
  void transform(double* interleaved) const;  ///< real and imaginary parts in turn
  /// The same from one place to another; `from` stays as it is.
  void transform(const double* from, double* to) const;

 private:
  struct State;
  detail::Hidden<State> state_;
};

/// Orthonormal DCT-II: c_0 = sum y / sqrt(n); c_k = sqrt(2/n) sum_t y_t cos(pi k (t + 1/2) / n), by
/// one real FFT of permuted data.
class Dct {
 public:
  explicit Dct(std::size_t n);
  /// n coefficients of y (n values), valid until the next call. The mean is subtracted first (c_0 corrected after).
  std::span<const double> transform(std::span<const double> y);

 private:
  struct State;
  detail::Hidden<State> state_;
};

/// y_t = c_0 / sqrt(n) + sqrt(2/n) sum_k c_k cos(pi k (t + 1/2) / n), t = 0..n-1: Dct undone.
class CosineSums {
 public:
  explicit CosineSums(std::size_t n);
  std::span<double> input();            ///< c_0..c_{n-1}, to fill in before every transform
  std::span<const double> transform();  ///< y_0..y_{n-1}, valid until the next call

 private:
  struct State;
  detail::Hidden<State> state_;
};

/// y_t = sum_k c_k sin(pi k t / n), k and t = 1..n-1; y_0 = 0, and c_0 is not looked at.
class SineSums {
 public:
  explicit SineSums(std::size_t n);
  std::span<double> input();            ///< c_0..c_{n-1}
  std::span<const double> transform();  ///< y_0..y_{n-1}, valid until the next call

 private:
  struct State;
  detail::Hidden<State> state_;
};

}  // namespace libchar
