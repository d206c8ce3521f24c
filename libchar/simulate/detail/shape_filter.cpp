// y = h * u by overlap-save: blocks of n samples, of which the first taps - 1 are those of the block before.
// boxcar: h = 1/m, m times; bartlett: its convolution with itself; measured: frequency sampling, h
// = inverse transform of the square root of the ratio (zero phase, moved by half its length), under
// a Hann window, divided by its sum. (Oppenheim & Schafer, Discrete-Time Signal Processing, 8.7.3
// and 7.5.)
#include "libchar/simulate/detail/shape_filter.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "libchar/spectrum/fft.hpp"

namespace libchar {
namespace {

constexpr std::size_t kMostTaps = std::size_t{1} << 16U;
constexpr std::size_t kFewestTaps = 64;
/// Of the lowest frequency of a measured shape: its bins are an eighth of an octave wide, and the
/// window smears none into the next.
constexpr double kTapsPerPeriod = 96;

std::size_t power_of_two(double at_least) {
  std::size_t n = 1;
  while (static_cast<double>(n) < at_least) n *= 2;
  return n;
}

std::vector<double> triangle(std::size_t m) {
  std::vector<double> h(2 * m - 1);
  const double scale = 1 / (static_cast<double>(m) * static_cast<double>(m));
  for (std::size_t i = 0; i < h.size(); ++i)
    h[i] = scale * static_cast<double>(i < m ? i + 1 : h.size() - i);
  return h;
}

std::vector<double> sampled_response(const NoiseShape& shape, double rate_hz) {
  const double wanted = kTapsPerPeriod * rate_hz / shape.frequency_hz.front();
  const std::size_t n = std::clamp(power_of_two(std::min(wanted, 1e9)), kFewestTaps, kMostTaps);
  RealFft plan(n);
  const std::span<std::complex<double>> gain = plan.coefficients();
  gain[0] = 1;
  for (std::size_t k = 1; k < gain.size(); ++k) {
    const double f = rate_hz * static_cast<double>(k) / static_cast<double>(n);
    // Half a block later: (-1)^k.
    gain[k] = (k % 2 == 0 ? 1 : -1) * std::sqrt(shape_ratio(shape, f, rate_hz));
  }
  const std::span<const double> response = plan.inverse();
  std::vector<double> h(n);
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double phase = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n);
    sum += h[i] = response[i] * 0.5 * (1 - std::cos(phase));
  }
  for (double& tap : h) tap /= sum;
  return h;
}

}  // namespace

std::vector<double> shape_taps(const NoiseShape& shape, double rate_hz) {
  const auto m = static_cast<std::size_t>(shape.taps);
  switch (shape.kind) {
    case NoiseShape::Kind::none:
      return {1};
    case NoiseShape::Kind::boxcar:
      return std::vector<double>(m, 1 / static_cast<double>(m));
    case NoiseShape::Kind::bartlett:
      return triangle(m);
    case NoiseShape::Kind::measured:
      return sampled_response(shape, rate_hz);
  }
  return {1};
}

struct ShapeFilter::State {
  std::function<void(std::span<double>)> source;
  std::size_t taps, fresh;
  RealFft plan;
  std::vector<std::complex<double>> response;
  std::vector<double> input;     ///< taps - 1 of the block before, then fresh ones
  std::vector<double> filtered;  ///< not given out from `given` on
  std::size_t given = 0;
  bool started = false;

  State(const std::vector<double>& h, std::function<void(std::span<double>)> from)
      : source(std::move(from)),
        taps(h.size()),
        fresh(power_of_two(4 * static_cast<double>(taps)) - taps + 1),
        plan(taps + fresh - 1),
        input(taps + fresh - 1, 0.0) {
    const std::span<double> padded = plan.input();
    std::fill(padded.begin(), padded.end(), 0.0);
    std::copy(h.begin(), h.end(), padded.begin());
    const auto transformed = plan.transform();
    response.assign(transformed.begin(), transformed.end());
  }

  void next_block() {
    const auto overlap = static_cast<std::ptrdiff_t>(taps - 1);
    if (!started) source(std::span(input).last(taps - 1));
    started = true;
    std::copy(input.end() - overlap, input.end(), input.begin());
    std::fill(input.begin() + overlap, input.end(), 0.0);
    source(std::span(input).last(fresh));
    std::copy(input.begin(), input.end(), plan.input().begin());
    const auto transformed = plan.transform();
    std::vector<std::complex<double>> product(transformed.begin(), transformed.end());
    for (std::size_t k = 0; k < product.size(); ++k) product[k] *= response[k];
    std::copy(product.begin(), product.end(), plan.coefficients().begin());
    const std::span<const double> y = plan.inverse();
    filtered.assign(y.begin() + overlap, y.end());
    for (double& v : filtered) v /= static_cast<double>(plan.size());
    given = 0;
  }
};

ShapeFilter::ShapeFilter(const NoiseShape& shape,
                         double rate_hz,
                         std::function<void(std::span<double>)> source)
    : state_(detail::hidden<State>(shape_taps(shape, rate_hz), std::move(source))) {}

void ShapeFilter::add(std::span<double> out) {
  State& s = *state_;
  for (double& sample : out) {
    if (s.given == s.filtered.size()) s.next_block();
    sample += s.filtered[s.given++];
  }
}

}  // namespace libchar
