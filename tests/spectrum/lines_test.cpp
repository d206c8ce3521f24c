
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <functional>
#include <numbers>
#include <random>

#include "libchar/spectrum/fft.hpp"
#include "libchar/spectrum/spectrum.hpp"
#include "libchar/spectrum/welch.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;

namespace {

// Noise of density f^-exponent, by shaping white noise in the frequency domain over twice the length.
std::vector<double> coloured(std::size_t n, double exponent, unsigned seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  RealFft fft(2 * n);
  auto bins = fft.coefficients();
  bins[0] = 0;
  for (std::size_t k = 1; k < bins.size(); ++k) {
    const double size =
        std::pow(2 * std::sin(std::numbers::pi * static_cast<double>(k) / (2 * static_cast<double>(n))), -exponent / 2);
    // One after the other: compilers differ in the order of arguments.
    const double imaginary = normal(generator), real = normal(generator);
    bins[k] = size * std::complex<double>(real, imaginary) / std::sqrt(4.0 * static_cast<double>(n));
  }
  const auto y = fft.inverse();
  return {y.begin(), y.begin() + static_cast<std::ptrdiff_t>(n)};
}

WelchOptions line_segments(std::uint64_t n) {
  WelchOptions options;
  options.segment = n;
  return options;
}

// Column `name` position of a plain little-endian double array file (version 1 header), rows of equal size.
std::vector<double> npy_column(const std::filesystem::path& path, std::size_t column, std::size_t columns) {
  const std::string bytes = test::slurp(path);
  const std::size_t header = 10 + static_cast<unsigned char>(bytes[8]) + 256U * static_cast<unsigned char>(bytes[9]);
  std::vector<double> out;
  for (std::size_t at = header + 8 * column; at + 8 <= bytes.size(); at += 8 * columns) {
    double v = 0;
    std::memcpy(&v, bytes.data() + at, 8);
    out.push_back(v);
  }
  return out;
}

}  // namespace

TEST_CASE("a sine of half a standard deviation between two bins is found, with frequency and amplitude") {
  for (const Window window : {Window::hann, Window::blackman_harris, Window::flat_top})
    for (const double place : {0.0, 0.27, 0.5}) {
      CAPTURE(name_of(window), place);
      auto y = coloured(1U << 18U, 0, 1);
      const double rate = 200, frequency = (300 + place) * rate / 4096;
      for (std::size_t t = 0; t < y.size(); ++t)
        y[t] += 0.5 * std::sin(2 * std::numbers::pi * frequency * static_cast<double>(t) / rate);
      WelchOptions options = line_segments(4096);
      options.window = window;
      for (const Sides sides : {Sides::one, Sides::two})
        for (const Scaling scaling : {Scaling::psd, Scaling::ps, Scaling::lsd, Scaling::ls}) {
          options.sides = sides;
          options.scaling = scaling;
          const auto lines = find_lines(welch(y, rate, options));
          REQUIRE(lines.size() == 1);
          // The top of a flat top is flat: a parabola says less there.
          CHECK(std::abs(lines[0].frequency_hz - frequency) < (window == Window::flat_top ? 0.15 : 0.06) * rate / 4096);
          CHECK(lines[0].amplitude == Approx(0.5).epsilon(0.03));
          CHECK(lines[0].width_hz < 6 * rate / 4096);
          CHECK(lines[0].excess > 10);
        }
    }
}

TEST_CASE("two lines are two, a strong line is one in spite of its leakage") {
  auto y = coloured(1U << 17U, 0, 2);
  for (std::size_t t = 0; t < y.size(); ++t)
    y[t] += 1e3 * std::sin(0.5003 * static_cast<double>(t)) + std::sin(1.7 * static_cast<double>(t)) +
            std::sin(1.75 * static_cast<double>(t));
  const auto lines = find_lines(welch(y, 2 * std::numbers::pi, line_segments(4096)));
  REQUIRE(lines.size() == 3);
  CHECK(lines[0].frequency_hz == Approx(0.5003).margin(2e-4));
  CHECK(lines[0].amplitude == Approx(1e3).epsilon(0.01));
  CHECK(lines[1].frequency_hz == Approx(1.7).margin(2e-4));
  CHECK(lines[2].frequency_hz == Approx(1.75).margin(2e-4));
  CHECK(lines[2].amplitude == Approx(1).epsilon(0.05));
}

TEST_CASE("noise of any slope raises no false alarm") {
  int alarms = 0;
  for (const double exponent : {0.0, 1.0, 2.0})
    for (unsigned seed = 0; seed < 60; ++seed) {
      const auto y = coloured(1U << 14U, exponent, 100 + seed);
      alarms += !find_lines(welch(y, 1)).empty();  // seven segments: few degrees of freedom
      alarms += !find_lines(welch(y, 1, line_segments(256))).empty();
    }
  CHECK(alarms <= 2);  // 360 spectra at 1e-3 each: 0.36 expected

  // The promised rate itself, where it can be counted: at a generous alarm the count stays below it.
  int generous = 0;
  for (unsigned seed = 0; seed < 300; ++seed)
    generous += !find_lines(welch(coloured(4096, 0, 1000 + seed), 1), 0.2).empty();
  CHECK(generous < 60 + 3 * 7);
  CHECK(generous > 3);  // and the threshold is not so high that nothing could pass it
}

TEST_CASE("the lines of a real unit: the gyroscope at 19.9 Hz, the accelerometers at 0.56 Hz") {
  NEEDS_SHARED("data/static_adis16405_run1.npy");
  const auto has = [](const std::vector<SpectralLine>& lines, double from, double to) {
    for (const SpectralLine& line : lines)
      if (line.frequency_hz > from && line.frequency_hz < to) return true;
    return false;
  };
  const auto path = test::shared("data/static_adis16405_run1.npy");
  CHECK(has(find_lines(welch(npy_column(path, 2, 6), 100, line_segments(8192))), 19.8, 20.0));
  bool seen = false;
  for (const std::size_t axis : {3U, 4U, 5U})
    seen = seen || has(find_lines(welch(npy_column(path, axis, 6), 100, line_segments(32768))), 0.5, 0.62);
  CHECK(seen);
}

// 30 records a drift and noise: with lines in 1 % of them five or more would be in one of 2,000.
TEST_CASE("rounding a slow drift makes no lines, and hides none that are larger than its own") {
  constexpr std::size_t n = 1U << 15U;
  const auto at = [](std::size_t t) { return static_cast<double>(t) / static_cast<double>(n); };
  const std::vector<std::pair<const char*, std::function<double(double)>>> drifts = {
      {"ramp", [](double x) { return 400 * x; }},
      {"fast ramp", [](double x) { return 5000.3 * x; }},
      {"parabola", [](double x) { return 300 * x * x; }},
      {"warm-up", [](double x) { return 200 * std::exp(-3 * x); }},
      {"slow sine", [](double x) { return 40 * std::sin(9 * x); }}};
  const auto rounded_lines = [&](const std::vector<double>& y) {
    std::vector<double> rounded = y;
    double square = 0;
    for (double& value : rounded) value = std::round(value);
    const double mean = (rounded.back() - rounded.front()) / static_cast<double>(n - 1);
    for (std::size_t t = 1; t < n; ++t) square += std::pow(rounded[t] - rounded[t - 1] - mean, 2);
    return find_lines(welch(rounded, 1), 1e-3, quantization_of(1, std::sqrt(square / n)));
  };
  for (const auto& [name, drift] : drifts) {
    for (const double sd : {0.0, 0.05, 0.15, 0.3, 0.6}) {
      int with_lines = 0, hidden = 0;
      for (unsigned seed = 0; seed < 30; ++seed) {
        std::vector<double> y = coloured(n, 0, 7000 + seed);
        for (std::size_t t = 0; t < n; ++t) y[t] = sd * y[t] + (1 + 0.01 * seed) * drift(at(t));
        with_lines += !rounded_lines(y).empty();
        for (std::size_t t = 0; t < n; ++t) y[t] += std::sin(1.3 * static_cast<double>(t));
        hidden += rounded_lines(y).empty();
      }
      CAPTURE(name, sd);
      CHECK(with_lines <= 4);
      CHECK(hidden == 0);
    }
  }
  // With noise of 0.6 LSB a line of a tenth of the step is no work of the rounding.
  std::vector<double> y = coloured(n, 0, 5);
  for (std::size_t t = 0; t < n; ++t) y[t] = 0.6 * y[t] + 400 * at(t) + 0.1 * std::sin(1.3 * static_cast<double>(t));
  CHECK(rounded_lines(y).size() == 1);
}

TEST_CASE("a line next to the end of the spectrum is as wide as one in its middle") {
  const auto line_at = [](std::size_t bin) {
    std::mt19937_64 generator(21);
    std::normal_distribution<double> normal;
    std::vector<double> x(65536);
    for (std::size_t i = 0; i < x.size(); ++i)
      x[i] = 0.05 * normal(generator) +
             std::sin(2 * std::numbers::pi * static_cast<double>(bin) * static_cast<double>(i) / 1024 +
                      std::numbers::pi / 4);
    const auto lines = find_lines(welch(x, 1024, line_segments(1024)));
    REQUIRE(lines.size() == 1);
    CHECK(lines[0].frequency_hz == Approx(static_cast<double>(bin)).margin(0.2));
    return lines[0].width_hz;
  };
  // Hann's window: a neighbour has a quarter of the power, so that half of it is 2/3 of a bin away by straight lines.
  CHECK(line_at(256) == Approx(4.0 / 3).epsilon(0.01));
  CHECK(line_at(510) == Approx(4.0 / 3).epsilon(0.01));
}

TEST_CASE("constant, empty and tiny spectra have no lines") {
  CHECK(find_lines(Spectrum{}).empty());
  CHECK(find_lines(welch(std::vector<double>(1000, 2.0), 1)).empty());
  CHECK(find_lines(welch(coloured(64, 0, 1), 1, line_segments(8))).empty());
}
