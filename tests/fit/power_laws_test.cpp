// A clock's power laws: each of the five kinds of noise gets its own coefficient, from an independent generator.
#include "libchar/fit/curve/power_laws.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "libchar/allan/noise_curves.hpp"
#include "libchar/fit/curve/shaped_curves.hpp"
#include "libchar/fit/detail/record/dct_means.hpp"
#include "libchar/fit/noise_fit.hpp"
#include "libchar/simulate/detail/noise_generator.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;

namespace {

// Frequency of unit noise S_y ~ f^alpha: (1 - z^-1)^(alpha/2) w by its binomial series, dt = 1.
std::vector<double> power_law(std::uint64_t seed, int alpha, std::size_t n) {
  test::Gaussian normal(seed);
  const double d = -alpha / 2.0;
  std::vector<double> h(n, 1.0), w(n), y(n, 0.0);
  for (std::size_t k = 1; k < n; ++k) h[k] = h[k - 1] * (static_cast<double>(k) - 1 + d) / static_cast<double>(k);
  for (double& v : w) v = normal();
  for (std::size_t t = 0; t < n; ++t)
    for (std::size_t k = 0; k <= t; ++k) y[t] += h[k] * w[t - k];
  return y;
}

}  // namespace

TEST_CASE("transform means of flicker phase noise") {
  const std::size_t n = 5000;
  std::vector<double> covariance(n);
  for (std::size_t j = 0; j < n; ++j) covariance[j] = -4 / M_PI / (4 * static_cast<double>(j * j) - 1);
  const std::vector<double> exact = dct_means_of_covariance(covariance);
  for (const std::size_t k : {1U, 2U, 3U, 10U, 100U, 2500U, 4999U}) {
    CAPTURE(k);
    CHECK(flicker_phase_dct_mean(static_cast<double>(k), n, 1) == Approx(exact[k - 1]).epsilon(k == 1 ? 5e-3 : 1e-3));
  }
  // Means of samples: the same bins as differences of every fourth phase reading.
  PowerBin bin;
  bin.first = 3;
  bin.end = 4;
  bin.length = 100;
  bin.spacing = 4;
  double sum = 0;
  const auto g = [](double lag) { return -2 / M_PI * odd_harmonic(std::abs(lag)); };
  for (int s = 0; s < 100; ++s)
    for (int t = 0; t < 100; ++t)
      sum += 0.02 * std::cos(M_PI * 3 * (s + 0.5) / 100) * std::cos(M_PI * 3 * (t + 0.5) / 100) *
             (2 * g(4 * (s - t)) - g(4 * (s - t + 1)) - g(4 * (s - t - 1))) / 4;
  CHECK(flicker_phase_units({bin}, 1)[0] == Approx(sum).epsilon(1e-9));
}

TEST_CASE("Allan variance of flicker phase noise is that of its covariance") {
  const double dt = 0.5;
  const auto covariance = [&](double j) { return -4 / M_PI / (4 * j * j - 1) / (dt * dt); };
  for (const int m : {1, 3, 20}) {
    double sum = 0;
    for (int s = 0; s < 2 * m; ++s)
      for (int t = 0; t < 2 * m; ++t)
        sum += ((s < m) == (t < m) ? 1 : -1) * covariance(std::abs(s - t)) / (2.0 * m * m);
    CHECK(flicker_phase_allan_variance(m, dt) == Approx(sum).epsilon(1e-9));
  }
}

TEST_CASE("each of the five power laws gets its own coefficient") {
  FitOptions options;
  options.clock = true;
  int clean = 0, near = 0, total = 0;
  for (int alpha = -2; alpha <= 2; ++alpha)
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      const NoiseFit fit = fit_record(power_law(10 + seed, alpha, 16384), 1, nullptr, options);
      const std::vector<PowerLaw> laws = power_laws(fit);
      REQUIRE(laws.size() == 5);
      CHECK(fit[Term::ramp].status == Status::not_fitted);
      const std::vector<double> unit = {8 * M_PI * M_PI, 4 * M_PI, 2, 1 / M_PI, 1 / (2 * M_PI * M_PI)};
      bool others = false;
      for (std::size_t i = 0; i < 5; ++i) {
        CAPTURE(alpha, seed, laws[i].alpha, laws[i].name);
        if (laws[i].alpha != alpha) {
          others = others || laws[i].h.status == Status::detected;
          continue;
        }
        REQUIRE(laws[i].h.value);
        CHECK(laws[i].h.status == Status::detected);
        near += std::abs(*laws[i].h.value / unit[i] - 1) < 0.1;
        ++total;
      }
      clean += !others;
    }
  CHECK(near >= 18);
  CHECK(clean >= 17);  // of 20
  CHECK(total == 20);
}

TEST_CASE("flicker phase noise is simulated with its Allan variance") {
  NoiseDesign design;
  design.rate_hz = 2;
  design.flicker_phase = 3;
  NoiseGenerator generator(design, 4, 0);
  std::vector<double> y(200000, 0.0);
  generator.add(y, {});
  for (const std::size_t m : {1U, 8U, 64U}) {
    double sum = 0, x = 0;
    std::vector<double> phase = {0};
    for (const double v : y) phase.push_back(x += v);
    std::size_t count = 0;
    for (std::size_t t = 0; t + 2 * m < phase.size(); ++t, ++count) {
      const double second = phase[t + 2 * m] - 2 * phase[t + m] + phase[t];
      sum += second * second / (2.0 * static_cast<double>(m * m));
    }
    CHECK(sum / static_cast<double>(count) ==
          Approx(9 * flicker_phase_allan_variance(static_cast<double>(m), 0.5)).epsilon(0.05));
  }
}
