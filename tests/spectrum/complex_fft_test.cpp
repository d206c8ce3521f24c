// Columns and rows of complex values against the defining sum, among them lengths that go in two steps.

#include <catch2/catch.hpp>
#include <cmath>
#include <complex>
#include <memory>
#include <new>
#include <numbers>
#include <random>

#include "libchar/spectrum/fft.hpp"

using libchar::ComplexFft;
using Complex = std::complex<double>;

namespace {

std::vector<Complex> sum_of(const std::vector<Complex>& x) {
  const std::size_t n = x.size();
  std::vector<Complex> turns(n), out(n);
  for (std::size_t k = 0; k < n; ++k)
    turns[k] = std::polar(1.0, -2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n));
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t t = 0; t < n; ++t) out[k] += x[t] * turns[k * t % n];
  return out;
}

struct Freed {
  void operator()(Complex* memory) const { ::operator delete[](memory, std::align_val_t{64}); }
};

// Largest error of `count` transforms, relative to the root of n; values between them must stay.
double largest_error(std::size_t n, std::size_t count, std::size_t step, std::size_t distance) {
  const std::size_t size = (n - 1) * step + (count - 1) * distance + 1;
  const std::unique_ptr<Complex[], Freed> memory(new (std::align_val_t{64}) Complex[size]);
  std::mt19937_64 random(n + count);
  std::normal_distribution<double> normal;
  for (std::size_t i = 0; i < size; ++i) memory[i] = {normal(random), normal(random)};
  std::vector<std::vector<Complex>> expected;
  for (std::size_t i = 0; i < count; ++i) {
    std::vector<Complex> x;
    for (std::size_t t = 0; t < n; ++t) x.push_back(memory[i * distance + t * step]);
    expected.push_back(sum_of(x));
  }
  ComplexFft(n, count, step, distance).transform(reinterpret_cast<double*>(memory.get()));
  double worst = 0;
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t k = 0; k < n; ++k)
      worst = std::max(worst, std::abs(memory[i * distance + k * step] - expected[i][k]));
  return worst / std::sqrt(static_cast<double>(n));
}

}  // namespace

TEST_CASE("complex transform: columns and rows against the sum that defines them") {
  for (const std::size_t n :
       {std::size_t{16}, std::size_t{128}, std::size_t{200}, std::size_t{250}, std::size_t{400}, std::size_t{500},
        std::size_t{625}, std::size_t{800}, std::size_t{1000}, std::size_t{1200}, std::size_t{1250}}) {
    CAPTURE(n);
    CHECK(largest_error(n, 8, 8, 1) < 1e-12);  // columns
    CHECK(largest_error(n, 12, 12, 1) < 1e-12);
    CHECK(largest_error(n, 4, 1, n + 4) < 1e-12);  // rows
    CHECK(largest_error(n, 1, 1, n) < 1e-12);
  }
}
