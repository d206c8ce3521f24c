#include "libchar/allan/noise_curves.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <vector>

using namespace libchar;

namespace {

__extension__ typedef __float128 Quad;
const Quad kPi113 = Quad(std::numbers::pi) + Quad(1.2246467991473532e-16);  // to 107 bits

Quad odd_sum(long n) {
  Quad sum = 0;
  for (long i = n; i > 0; --i) sum += Quad(1) / Quad(2 * i - 1);
  return sum;
}

/// B^2/(4 pi m^2) [(16 m^2 - 1) H_2m - (16 m^2 - 4) H_m] as published, in 113 bits.
double flicker_reference(long m) {
  const Quad z = Quad(m) * Quad(m);
  return static_cast<double>(((16 * z - 1) * odd_sum(2 * m) - (16 * z - 4) * odd_sum(m)) / (4 * kPi113 * z));
}

double from_phase(Term t, double m, double dt) {
  return (phase_covariance(t, 2 * m, dt) - 4 * phase_covariance(t, m, dt) + 3 * phase_covariance(t, 0, dt)) / (m * m);
}

}  // namespace

TEST_CASE("flicker Allan variance agrees with 113-bit sums") {
  CHECK(unit_allan_variance(Term::flicker, 1, 0.01) == Approx(2 / std::numbers::pi).epsilon(2e-16));
  double worst = 0;
  for (const long m : {1L, 2L, 3L, 5L, 11L, 12L, 13L, 16L, 23L, 24L, 25L, 31L, 47L, 48L, 100L, 1000L, 4096L, 100000L}) {
    const double got = unit_allan_variance(Term::flicker, double(m), 1);
    worst = std::max(worst, std::fabs(got / flicker_reference(m) - 1));
  }
  CHECK(worst < 1e-15);
}

TEST_CASE("flicker Allan variance joins its asymptote: the published factors and m up to 1e9") {
  const double floor = 2 * std::numbers::ln2 / std::numbers::pi;
  const auto ratio = [&](double m) { return unit_allan_variance(Term::flicker, m, 1) / floor; };
  CHECK(ratio(1) == Approx(1.4427).margin(5e-5));
  CHECK(ratio(2) == Approx(1.1542).margin(5e-5));
  CHECK(ratio(3) == Approx(1.0803).margin(1e-4));
  CHECK(ratio(4) == Approx(1.0500).margin(5e-5));
  CHECK(ratio(8) == Approx(1.0154).margin(5e-5));
  CHECK(ratio(16) == Approx(1.0046).margin(5e-5));
  for (const double m : {1e4, 1e6, 1e9}) {
    const double next =
        (1.5 * (std::log(m) + std::numbers::egamma) + 2.5 * std::numbers::ln2 - 0.25) / (4 * std::numbers::pi * m * m);
    CHECK(unit_allan_variance(Term::flicker, m, 1) == Approx(floor + next).epsilon(1e-15));
  }
}

TEST_CASE("walk, white, quantization, ramp: closed forms and small-m factors") {
  const double dt = 0.005;
  CHECK(unit_allan_variance(Term::walk, 1, dt) == Approx(dt / 2).epsilon(1e-15));
  CHECK(unit_allan_variance(Term::walk, 2, dt) == Approx(1.125 * 2 * dt / 3).epsilon(1e-15));
  CHECK(unit_allan_variance(Term::white, 7, dt) == Approx(1 / (7 * dt)).epsilon(1e-15));
  CHECK(unit_allan_variance(Term::quantization, 7, dt) == Approx(3 / (49 * dt * dt)).epsilon(1e-15));
  CHECK(unit_allan_variance(Term::ramp, 7, dt) == Approx(49 * dt * dt / 2).epsilon(1e-15));
  const Mixture theta = {2, 3, 5, 7, 11};
  double sum = 0;
  for (std::size_t t = 0; t < kTerms; ++t) sum += theta[t] * unit_allan_variance(Term(t), 3, dt);
  CHECK(allan_variance(theta, 3, dt) == Approx(sum).epsilon(1e-15));
}

TEST_CASE("generalised covariance of the phase gives the Allan variance") {
  for (const double m : {1.0, 2.0, 3.0, 17.0, 64.0, 1000.0})
    for (const Term t : {Term::white, Term::flicker, Term::walk, Term::quantization}) {
      INFO("m " << m << " term " << int(t));
      CHECK(from_phase(t, m, 0.25) == Approx(unit_allan_variance(t, m, 0.25)).epsilon(1e-12));
    }
}

TEST_CASE("second difference of the summed phase covariance is the phase covariance") {
  for (const Term t : {Term::white, Term::flicker, Term::walk, Term::quantization})
    for (const double n : {0.0, 1.0, 2.0, 5.0, 23.0, 24.0, 25.0, 40.0}) {
      const double second = summed_phase_covariance(t, n + 1, 0.5) - 2 * summed_phase_covariance(t, n, 0.5) +
                            summed_phase_covariance(t, n - 1, 0.5);
      const double size = std::fabs(summed_phase_covariance(t, n + 1, 0.5));
      INFO("n " << n << " term " << int(t));
      CHECK(second == Approx(phase_covariance(t, n, 0.5)).margin(1e-14 * (size + 1)));
    }
}

TEST_CASE("odd harmonic numbers at real arguments follow their recurrence") {
  CHECK(odd_harmonic(0) == 0);
  CHECK(odd_harmonic(3) == Approx(1 + 1.0 / 3 + 1.0 / 5).epsilon(1e-15));
  for (const double n : {0.25, 0.5, 3.7, 22.9, 23.5, 24.0, 99.1})
    CHECK(odd_harmonic(n + 1) - odd_harmonic(n) == Approx(1 / (2 * n + 1)).margin(3e-15));
  CHECK(odd_harmonic(0.5) == Approx(std::numbers::ln2).epsilon(1e-15));  // psi(1) = -gamma
}

TEST_CASE("the spectrum integrates to the Allan variance") {
  // AVAR(m) = 2 * integral over 0 < nu < 1/2 of S(nu)/dt * 2 sin^4(pi nu m) / (m^2 sin^2(pi nu))
  // dnu / 2 * 2 (two sides).
  const double dt = 0.01;
  for (const Term t : {Term::white, Term::flicker, Term::walk, Term::quantization})
    for (const double m : {1.0, 2.0, 5.0}) {
      const int cells = 20000;
      double sum = 0;
      for (int i = 0; i < cells; ++i) {
        const double nu = (i + 0.5) / (2.0 * cells);
        const double s = std::sin(std::numbers::pi * nu * m);
        const double chord = std::sin(std::numbers::pi * nu);
        sum += unit_spectrum(t, nu / dt, dt) / dt * 4 * s * s * s * s / (m * m * chord * chord);
      }
      INFO("term " << int(t) << " m " << m);
      CHECK(sum / (2.0 * cells) == Approx(unit_allan_variance(t, m, dt)).epsilon(1e-6));
    }
  CHECK(spectrum({2, 0, 3, 0, 9}, 1.0, dt) == Approx(2 + 3 * unit_spectrum(Term::walk, 1.0, dt)).epsilon(1e-15));
}

TEST_CASE("discrete densities meet their asymptotes at low frequency and the stated ratios above") {
  const double dt = 0.5;
  for (const Term t : {Term::white, Term::flicker, Term::walk, Term::quantization})
    CHECK(unit_spectrum(t, 1e-6, dt) == Approx(spectrum_asymptote(t, 1e-6, dt)).epsilon(1e-11));
  // Aliasing of sampled noise: S_d/S_c at nu = 1/2 is pi/2 for flicker, (pi/2)^2 for the walk.
  CHECK(unit_spectrum(Term::flicker, 1, dt) / spectrum_asymptote(Term::flicker, 1, dt) == Approx(1.5708).margin(1e-4));
  CHECK(unit_spectrum(Term::walk, 1, dt) / spectrum_asymptote(Term::walk, 1, dt) == Approx(2.4674).margin(1e-4));
}
