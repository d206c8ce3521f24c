#include "libchar/fit/detail/record/dct_means.hpp"

#include <catch2/catch.hpp>

#include "libchar/allan/noise_curves.hpp"
#include "libchar/spectrum/fft.hpp"

using namespace libchar;

namespace {

double basis(std::size_t k, std::size_t t, std::size_t n) {
  return std::sqrt(2.0 / static_cast<double>(n)) *
         std::cos(M_PI * static_cast<double>(k) * (static_cast<double>(t) + 0.5) / static_cast<double>(n));
}

/// E[c_k^2] by the double sum over a covariance function of the lag.
template <typename Covariance>
double brute_force(std::size_t k, std::size_t n, Covariance&& g) {
  double sum = 0;
  for (std::size_t s = 0; s < n; ++s) {
    for (std::size_t t = 0; t < n; ++t) sum += basis(k, s, n) * basis(k, t, n) * g(s > t ? s - t : t - s);
  }
  return sum;
}

double odd_harmonic(std::size_t n) {
  double sum = 0;
  for (std::size_t i = 1; i <= n; ++i) sum += 1.0 / static_cast<double>(2 * i - 1);
  return sum;
}

}  // namespace

TEST_CASE("the sine integral at multiples of pi") {
  CHECK(sine_integral_at_pi(0) == 0);
  CHECK(sine_integral_at_pi(1) == Approx(1.8519370519824661704).epsilon(2e-15));
  CHECK(sine_integral_at_pi(2) == Approx(1.4181515761326284502).epsilon(2e-15));
  CHECK(sine_integral_at_pi(10) == Approx(1.5390290796).epsilon(1e-10));
  // table and series meet
  const double jump = sine_integral_at_pi(65) - sine_integral_at_pi(64);
  const double before = sine_integral_at_pi(63) - sine_integral_at_pi(62);
  CHECK(jump == Approx(before).epsilon(0.05));
  CHECK(std::abs(sine_integral_at_pi(1000000) - M_PI / 2) < 4e-7);
}

TEST_CASE("transform means agree with the double sum over the covariance") {
  const std::size_t n = 48;
  const double dt = 0.01;
  const auto walk = [&](std::size_t lag) { return -dt * static_cast<double>(lag) / 2; };
  const auto flicker = [](std::size_t lag) { return -2 / M_PI * odd_harmonic(lag); };
  const BlockMeanDct exact(n, 1, dt);
  for (const std::size_t k : {1U, 2U, 3U, 10U, 31U, 47U}) {
    INFO("k = " << k);
    const auto unit = dct_mean(static_cast<double>(k), n, dt);
    CHECK(unit[0] == Approx(100).epsilon(1e-14));
    CHECK(unit[2] == Approx(brute_force(k, n, walk)).epsilon(1e-11));
    CHECK(exact.mean(k)[1] == Approx(brute_force(k, n, flicker)).epsilon(1e-11));
    CHECK(exact.mean(k)[2] == Approx(unit[2]).epsilon(1e-14));
    CHECK(unit[1] == Approx(brute_force(k, n, flicker)).epsilon(2e-2));
    // quantization: differences of white noise of variance 1, n + 1 draws
    double quantization = 0;
    for (std::size_t q = 0; q <= n; ++q) {
      const double weight = (q > 0 ? basis(k, q - 1, n) : 0) - (q < n ? basis(k, q, n) : 0);
      quantization += weight * weight;
    }
    CHECK(unit[3] == Approx(quantization / (dt * dt)).epsilon(1e-12));
    double ramp = 0;
    for (std::size_t t = 0; t < n; ++t) ramp += basis(k, t, n) * static_cast<double>(t) * dt;
    CHECK(unit[4] == Approx(ramp * ramp).epsilon(1e-9).margin(1e-20));
  }
}

TEST_CASE("the first flicker ratios are those of the theory") {
  const std::size_t n = 65536;
  const std::vector<double> ratio = {0.7737, 0.9028, 0.9311, 0.9499, 0.9592};
  for (std::size_t k = 1; k <= 5; ++k) {
    const double level = 2 * std::sin(M_PI * static_cast<double>(k) / (2.0 * n));
    CHECK(dct_mean(static_cast<double>(k), n, 1)[1] * level == Approx(ratio[k - 1]).margin(6e-5));
  }
}

TEST_CASE("means of blocks: agree with the double sum over averaged covariances") {
  const std::size_t n = 40, m = 5;
  const double dt = 0.1;
  const auto averaged = [&](auto&& g) {
    return [&, g](std::size_t lag) {
      double sum = 0;
      for (std::size_t s = 0; s < m; ++s) {
        for (std::size_t t = 0; t < m; ++t) {
          const auto distance = static_cast<long>(lag * m + s) - static_cast<long>(t);
          sum += g(static_cast<std::size_t>(std::labs(distance)));
        }
      }
      return sum / static_cast<double>(m);  // times sqrt(m) twice over m^2
    };
  };
  const auto walk = averaged([&](std::size_t lag) { return -dt * static_cast<double>(lag) / 2; });
  const auto flicker = averaged([](std::size_t lag) { return -2 / M_PI * odd_harmonic(lag); });
  const BlockMeanDct means(n, m, dt);
  for (const std::size_t k : {1U, 2U, 7U, 20U, 39U}) {
    INFO("k = " << k);
    CHECK(means.mean(k)[0] == Approx(10).epsilon(1e-14));
    CHECK(means.mean(k)[1] == Approx(brute_force(k, n, flicker)).epsilon(1e-9));
    CHECK(means.mean(k)[2] == Approx(brute_force(k, n, walk)).epsilon(1e-9));
  }
}
