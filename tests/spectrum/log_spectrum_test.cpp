#include "libchar/spectrum/log_spectrum.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <random>

#include "libchar/spectrum/spectrum.hpp"
#include "libchar/spectrum/welch.hpp"
#include "libchar/spectrum/window.hpp"

using namespace libchar;

namespace {

std::vector<double> gaussian_record(std::size_t n, unsigned seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  std::vector<double> y(n);
  for (double& v : y) v = normal(generator);
  return y;
}

}  // namespace

TEST_CASE("logarithmic bins keep the power, the order and the number") {
  WelchOptions options;
  options.segment = 1000;
  const auto x = gaussian_record(1U << 17U, 1);
  for (const Scaling scaling : {Scaling::psd, Scaling::lsd}) {
    options.scaling = scaling;
    const Spectrum s = welch(x, 100, options);
    for (const std::size_t bins : {1U, 5U, 40U, 100000U}) {
      const Spectrum b = log_binned(s, bins);
      REQUIRE(b.value.size() <= std::min<std::size_t>(bins, 500));
      REQUIRE(b.value.size() == b.dof.size());
      CHECK(std::is_sorted(b.frequency_hz.begin(), b.frequency_hz.end()));
      CHECK(b.frequency_hz.front() > 0);
      CHECK(b.frequency_hz.back() <= 50);
    }
    const Spectrum all = log_binned(s, 1);
    double sum = 0;
    for (std::size_t k = 1; k < s.value.size(); ++k)
      sum += scaling == Scaling::psd ? s.value[k] : s.value[k] * s.value[k];
    const double mean = sum / 500;
    CHECK(all.value[0] == Approx(scaling == Scaling::psd ? mean : std::sqrt(mean)).epsilon(1e-13));
    CHECK(log_binned(s, 100000).value == std::vector<double>(s.value.begin() + 1, s.value.end()));
  }
  CHECK(log_binned(welch(x, 100, options), 0).value.empty());
}

TEST_CASE("the scatter of an average over bins is its stated degrees of freedom") {
  for (const Window window : {Window::hann, Window::rectangular, Window::blackman_harris}) {
    CAPTURE(name_of(window));
    WelchOptions options;
    options.segment = 128;
    options.window = window;
    double sum = 0, squares = 0, dof = 0;
    const int records = 3000;
    for (int i = 0; i < records; ++i) {
      const Spectrum b =
          log_binned(welch(gaussian_record(640, static_cast<unsigned>(i)), 1, options), 8);
      const double v = b.value[b.value.size() - 2];  // about sixteen bins
      sum += v;
      squares += v * v;
      dof = b.dof[b.value.size() - 2];
    }
    const double mean = sum / records, variance = squares / records - mean * mean;
    CHECK(2 * mean * mean / variance == Approx(dof).epsilon(0.12));
  }
}

TEST_CASE(
    "the log-frequency spectrum of a long record is flat for white noise and has the slope of a "
    "walk") {
  const double rate = 50;
  auto x = gaussian_record(3'000'000, 2);
  for (const Sides sides : {Sides::one, Sides::two}) {
    const Spectrum s = log_frequency_spectrum(x, rate, sides, 200);
    const double level = (sides == Sides::one ? 2 : 1) / rate;
    REQUIRE(s.value.size() > 150);
    REQUIRE(s.value.size() <= 200 + 8);  // a bin at a seam between levels may come twice
    CHECK(s.frequency_hz.front() < 1e-3);
    CHECK(std::is_sorted(s.frequency_hz.begin(), s.frequency_hz.end()));
    double chi2 = 0;
    for (std::size_t i = 0; i + 1 < s.value.size(); ++i) {
      CAPTURE(s.frequency_hz[i], s.dof[i]);
      CHECK(std::abs(s.value[i] / level - 1) < 5.5 * std::sqrt(2 / s.dof[i]));
      chi2 += std::pow(s.value[i] / level - 1, 2) * s.dof[i] / 2;
    }
    CHECK(chi2 / static_cast<double>(s.value.size()) == Approx(1).epsilon(0.4));
  }
  double walk = 1e9;
  for (double& v : x) v = walk += v;
  const Spectrum s = log_frequency_spectrum(x, rate, Sides::two, 200);
  for (std::size_t i = 3; i + 1 < s.value.size(); ++i) {
    const double f = s.frequency_hz[i] / rate;
    const double expected = 1 / (rate * std::pow(2 * std::sin(M_PI * f), 2));
    CAPTURE(s.frequency_hz[i], s.dof[i]);
    CHECK(std::abs(s.value[i] / expected - 1) < 5.5 * std::sqrt(2 / s.dof[i]) + 0.02);
  }
}

TEST_CASE("the log-frequency spectrum serves short records and records with missing samples") {
  CHECK(log_frequency_spectrum(gaussian_record(100, 1), 1, Sides::one, 30).value.size() > 5);
  auto x = gaussian_record(600'000, 3);
  for (std::size_t i = 11; i < x.size(); i += 101) x[i] = std::numeric_limits<double>::quiet_NaN();
  const Spectrum s = log_frequency_spectrum(x, 1, Sides::one, 64);
  CHECK(s.value.size() > 20);
  for (const double v : s.value) CHECK(std::isfinite(v));
}

TEST_CASE("an offset of the log-frequency spectrum is none, with missing samples either") {
  auto x = gaussian_record(600'000, 3);
  for (std::size_t i = 11; i < x.size(); i += 101) x[i] = std::numeric_limits<double>::quiet_NaN();
  const Spectrum here = log_frequency_spectrum(x, 1, Sides::one, 64);
  for (double& v : x) v += 1024;
  const Spectrum there = log_frequency_spectrum(x, 1, Sides::one, 64);
  REQUIRE(here.value.size() == there.value.size());
  for (std::size_t k = 0; k < here.value.size(); ++k)
    CHECK(there.value[k] == Approx(here.value[k]).epsilon(1e-6));
}
