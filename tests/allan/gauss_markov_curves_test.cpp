// The curves of a sampled Gauss-Markov process against its covariance phi^|j|, from its definition.

#include "libchar/allan/gauss_markov_curves.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "libchar/allan/noise_curves.hpp"

using namespace libchar;

namespace {

/// Covariance of the means of two stretches of m samples that begin `apart` samples apart, term by term.
long double covariance_of_means(long double x, int m, int apart) {
  long double sum = 0;
  for (int i = 0; i < m; ++i)
    for (int j = 0; j < m; ++j)
      sum += std::exp(-x * static_cast<long double>(std::abs(apart + j - i)));
  return sum / m / m;
}

}  // namespace

TEST_CASE("Gauss-Markov: means and Allan variance are those of the covariance") {
  const double dt = 0.25;
  for (const double tau : {0.05, 0.25, 3.0, 400.0})
    for (const int m : {1, 2, 5, 40}) {
      INFO("tau " << tau << " m " << m);
      const long double x = static_cast<long double>(dt) / tau;
      const auto own = covariance_of_means(x, m, 0), next = covariance_of_means(x, m, m);
      const MeanCovariance means = gauss_markov_means(tau, m, dt);
      CHECK(means.variance == Approx(static_cast<double>(own)).epsilon(1e-12));
      CHECK(means.neighbours == Approx(static_cast<double>(next)).epsilon(1e-12));
      CHECK(gauss_markov_allan_variance(tau, m, dt) ==
            Approx(static_cast<double>(own - next)).epsilon(1e-9));
    }
}

TEST_CASE("Gauss-Markov: slow against the averaging time it is the walk of K^2 = 2/tau") {
  const double dt = 0.01, m = 1000;
  const double walk = unit_allan_variance(Term::walk, m, dt);
  // On both sides of m dt/tau = 1e-5, where the difference of two numbers near one takes over.
  for (const double across : {1e-9, 0.99e-5, 1.01e-5, 1e-3}) {
    const double tau = m * dt / across;
    INFO("m dt/tau " << across);
    CHECK(gauss_markov_allan_variance(tau, m, dt) ==
          Approx(2 / tau * walk * (1 - 0.75 * across)).epsilon(across * across + 1e-8));
  }
}

TEST_CASE("Gauss-Markov: the spectrum is that of the covariance, lag by lag") {
  const double dt = 0.5;
  constexpr int kFrequencies = 512;
  for (const double tau : {0.2, 1.0, 7.0})
    for (const int lag : {0, 1, 3}) {
      double sum = 0;  // over whole turns: exact but for phi^512
      for (int k = 0; k < kFrequencies; ++k) {
        const double turns = (k + 0.5) / kFrequencies;
        sum += gauss_markov_spectrum(tau, turns / dt, dt) / dt *
               std::cos(2 * std::numbers::pi * turns * lag);
      }
      INFO("tau " << tau << " lag " << lag);
      CHECK(sum / kFrequencies == Approx(std::exp(-lag * dt / tau)).epsilon(1e-12));
    }
}
