#include <catch2/catch.hpp>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>

#include "libchar/simulate/detail/sensor_chain.hpp"
#include "libchar/spectrum/welch.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;

namespace {

constexpr double kRate = 100;

double power_gain(const std::vector<double>& h, double frequency_hz) {
  std::complex<double> sum = 0;
  for (std::size_t i = 0; i < h.size(); ++i)
    sum += h[i] * std::polar(1.0, -2 * std::numbers::pi * frequency_hz / kRate * static_cast<double>(i));
  return std::norm(sum);
}

std::function<void(std::span<double>)> white(std::uint64_t seed) {
  return [gauss = std::make_shared<test::Gaussian>(seed)](std::span<double> out) {
    for (double& v : out) v += (*gauss)();
  };
}

}  // namespace

TEST_CASE("impulse responses have unit sum and the shape's gain") {
  const NoiseShape boxcar{NoiseShape::Kind::boxcar, 4, {}, {}};
  const NoiseShape bartlett{NoiseShape::Kind::bartlett, 5, {}, {}};
  NoiseShape smooth{NoiseShape::Kind::measured, 0, {}, {}};
  for (double f = 2; f < 50; f *= std::exp2(0.125)) {
    smooth.frequency_hz.push_back(f);
    smooth.ratio.push_back(1 / (1 + std::pow(f / 12, 4)));
  }
  for (const NoiseShape& shape : {boxcar, bartlett, smooth}) {
    const std::vector<double> h = shape_taps(shape, kRate);
    CHECK(std::accumulate(h.begin(), h.end(), 0.0) == Approx(1));
    const bool exact = shape.kind != NoiseShape::Kind::measured;
    for (const double f : {0.5, 3.0, 7.0, 13.0, 21.0, 37.0})
      CHECK(power_gain(h, f) == Approx(shape_ratio(shape, f, kRate)).epsilon(exact ? 1e-12 : 0.08).margin(1e-12));
  }
}

TEST_CASE("a measured shape that reaches below what the taps resolve has its gain above") {
  // That of 1/f^1.3 over a random walk that stands in for it: f^.7, up to .1 Hz.
  NoiseShape law{NoiseShape::Kind::measured, 0, {}, {}};
  for (double f = 2.5e-4; f < 50; f *= std::exp2(0.125)) {
    law.frequency_hz.push_back(f);
    law.ratio.push_back(std::min(1.0, std::pow(f / 0.1, 0.7)));
  }
  const std::vector<double> h = shape_taps(law, kRate);
  for (const double f : {0.02, 0.05, 0.5, 3.0, 37.0})
    CHECK(power_gain(h, f) == Approx(shape_ratio(law, f, kRate)).epsilon(0.08));
}

TEST_CASE("filtered noise is the convolution, stationary from the first sample, in pieces of any size") {
  const NoiseShape shape{NoiseShape::Kind::bartlett, 6, {}, {}};
  const std::vector<double> h = shape_taps(shape, kRate);
  constexpr std::size_t kCount = 5000;
  std::vector<double> u(kCount + h.size() - 1, 0.0), whole(kCount, 0.0), pieces(kCount, 0.0);
  white(3)(u);
  ShapeFilter(shape, kRate, white(3)).add(whole);
  ShapeFilter filter(shape, kRate, white(3));
  for (std::size_t at = 0, size = 1; at < kCount; at += size, size = size % 97 + 1)
    filter.add(std::span(pieces).subspan(at, std::min(size, kCount - at)));
  for (std::size_t t = 0; t < kCount; ++t) {
    double direct = 0;
    for (std::size_t i = 0; i < h.size(); ++i) direct += h[i] * u[t + h.size() - 1 - i];
    REQUIRE(whole[t] == Approx(direct).margin(1e-12));
    REQUIRE(pieces[t] == whole[t]);
  }
}
