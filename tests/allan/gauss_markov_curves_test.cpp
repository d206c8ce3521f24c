#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "libchar/allan/noise_curves.hpp"

using namespace libchar;

namespace {

// Variance of the mean of m samples and covariance of neighbouring means, added up pair by pair from phi^|lag|.
MeanCovariance pair_by_pair(double tau_s, int m, double dt_s) {
  const long double x = static_cast<long double>(dt_s) / tau_s;
  long double variance = 0, neighbours = 0;
  for (int i = 0; i < m; ++i)
    for (int k = 0; k < m; ++k) {
      variance += std::exp(-x * std::abs(i - k));
      neighbours += std::exp(-x * (m + k - i));
    }
  const long double pairs = static_cast<long double>(m) * m;
  return {static_cast<double>(variance / pairs), static_cast<double>(neighbours / pairs)};
}

}  // namespace

TEST_CASE("means of a Gauss-Markov process vary as the sum over all pairs of samples says") {
  for (const double dt : {0.01, 0.5})
    for (const double tau : {0.02, 1.0, 300.0})
      for (const int m : {1, 2, 3, 10, 250}) {
        INFO("dt " << dt << " tau " << tau << " m " << m);
        const MeanCovariance known = pair_by_pair(tau, m, dt), got = gauss_markov_means(tau, m, dt);
        CHECK(got.variance == Approx(known.variance).epsilon(1e-12));
        CHECK(got.neighbours == Approx(known.neighbours).epsilon(1e-12));
        CHECK(gauss_markov_allan_variance(tau, m, dt) == Approx(known.variance - known.neighbours).epsilon(1e-9));
      }
}

TEST_CASE("far below its correlation time a Gauss-Markov process is a random walk") {
  // K² = 2/tau: K² (2 m² + 1) dt / (6 m), less 3/4 of m dt/tau of it, to first order.
  for (const double across : {1e-9, 9e-6, 1.1e-5})
    for (const double m : {1.0, 7.0, 1000.0}) {
      const double dt = 0.1, tau = m * dt / across;
      const double walk = 2 / tau * (2 * m * m + 1) * dt / (6 * m);
      INFO(across << " " << m);
      CHECK(gauss_markov_allan_variance(tau, m, dt) == Approx(walk * (1 - 0.75 * across)).epsilon(across / m + 2e-9));
    }
}

TEST_CASE("the density of a Gauss-Markov process is the sum over its covariances") {
  const double dt = 0.25;
  for (const double tau : {0.1, 1.0, 5.0})
    for (const double f : {0.01, 0.3, 2.0}) {
      double sum = 1;
      for (int lag = 1; lag * dt < 45 * tau; ++lag)
        sum += 2 * std::exp(-lag * dt / tau) * std::cos(2 * std::numbers::pi * f * lag * dt);
      CAPTURE(tau, f);
      CHECK(gauss_markov_spectrum(tau, f, dt) == Approx(dt * sum).epsilon(1e-12));
    }
}

TEST_CASE("the density of a Gauss-Markov process adds up to its variance") {
  const double dt = 0.25, tau = 3;
  double sum = 0;
  constexpr int kSteps = 4096;
  for (int i = 0; i < kSteps; ++i) {
    const double f = (i + 0.5) / kSteps / (2 * dt);
    sum += 2 * gauss_markov_spectrum(tau, f, dt) / (2 * dt) / kSteps;
  }
  CHECK(sum == Approx(1).epsilon(1e-9));
}
