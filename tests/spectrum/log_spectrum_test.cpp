
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <random>

#include "libchar/spectrum/spectrum.hpp"
#include "libchar/spectrum/welch.hpp"

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
      const Spectrum b = log_binned(welch(gaussian_record(640, static_cast<unsigned>(i)), 1, options), 8);
      const double v = b.value[b.value.size() - 2];  // about sixteen bins
      sum += v;
      squares += v * v;
      dof = b.dof[b.value.size() - 2];
    }
    const double mean = sum / records, variance = squares / records - mean * mean;
    CHECK(2 * mean * mean / variance == Approx(dof).epsilon(0.12));
  }
}
