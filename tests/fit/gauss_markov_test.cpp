// A first-order Gauss-Markov process beside flicker and walk: found where there is one, and only there.
#include "tests/support/gauss_markov.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <string>
#include <vector>

#include "libchar/allan/allan_pyramid.hpp"
#include "libchar/allan/noise_curves.hpp"
#include "libchar/fit/curve/shaped_curves.hpp"
#include "libchar/fit/detail/record/dct_means.hpp"
#include "libchar/fit/noise_fit.hpp"
#include "libchar/simulate/detail/noise_generator.hpp"
#include "libchar/spectrum/fft.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;
using test::white_and_process;

namespace {

double cosine(std::size_t k, std::size_t t, std::size_t n) {
  return std::sqrt(2.0 / static_cast<double>(n)) *
         std::cos(M_PI * static_cast<double>(k) * (static_cast<double>(t) + 0.5) / static_cast<double>(n));
}

double lag(std::size_t a, std::size_t b) { return std::abs(static_cast<double>(a) - static_cast<double>(b)); }

std::vector<double> terms_record(std::uint64_t seed, std::size_t n, double rate, Mixture c) {
  NoiseDesign design;
  design.coefficient = c;
  design.rate_hz = rate;
  NoiseGenerator generator(design, seed, 0);
  std::vector<double> y(n, 0.0);
  generator.add(y, {});
  return y;
}

/// Density `level` f^-exponent, part of a longer record, so that its ends do not meet.
std::vector<double> law_record(std::size_t n, double rate, double exponent, double level, test::Gaussian& gauss) {
  constexpr std::size_t kSize = 1 << 20;
  RealFft fft(kSize);
  const double step_hz = rate / static_cast<double>(kSize);
  const auto c = fft.coefficients();
  c[0] = 0;
  for (std::size_t k = 1; k < c.size(); ++k) {
    const double sd = std::sqrt(level * std::pow(static_cast<double>(k) * step_hz, -exponent) * step_hz / 2);
    const double real = sd * gauss(), imaginary = sd * gauss();
    c[k] = {real, imaginary};
  }
  const auto y = fft.inverse();
  return {y.begin() + static_cast<std::ptrdiff_t>(n), y.begin() + static_cast<std::ptrdiff_t>(2 * n)};
}

NoiseFit fit_of(const std::vector<double>& y, double rate) {
  const AllanCurve curve = pyramid_deviation(y, 1 / rate);
  return fit_record(y, rate, &curve);
}

bool in_model(const NoiseFit& fit) { return fit.gauss_markov && fit.gauss_markov->in_model; }

bool says(const NoiseFit& fit, const std::string& words) {
  for (const Finding& one : fit.findings)
    if (one.sentence.find(words) != std::string::npos) return true;
  return false;
}

}  // namespace

TEST_CASE("Gauss-Markov: the Allan variance of times far below tau is that of a walk, on both sides of the series") {
  for (const double m : {1.0, 7.0, 1000.0})
    for (const double across : {1e-12, 0.99e-5, 1.01e-5, 1e-4}) {
      // sigma^2 = 1: K^2 = 2 / tau; the next term of the series is between 1/2 and 3/4 of T/tau.
      const double tau = 3, dt = across * tau / m, x = dt / tau;
      CHECK(gauss_markov_allan_variance(tau, m, dt) ==
            Approx(x * (2 * m * m + 1) / (3 * m) * (1 - 0.625 * across)).epsilon(0.2 * across + 1e-12));
    }
}

TEST_CASE("transform means of a Gauss-Markov process agree with the double sum over its covariance") {
  const std::size_t n = 48;
  for (const double step : {3.0, 0.2, 0.01, 1e-5})
    for (const std::size_t k : {1U, 2U, 7U, 30U, 47U}) {
      CAPTURE(step, k);
      double sum = 0;
      for (std::size_t s = 0; s < n; ++s)
        for (std::size_t t = 0; t < n; ++t) sum += cosine(k, s, n) * cosine(k, t, n) * std::exp(-step * lag(s, t));
      CHECK(gauss_markov_dct_mean(static_cast<double>(k), n, step) == Approx(sum).epsilon(1e-9));
    }
}

TEST_CASE("transform means of means of a Gauss-Markov process") {
  const std::size_t n = 12, m = 5;
  const double dt = 0.1;
  for (const double tau : {0.02, 0.7, 40.0})
    for (const std::size_t k : {1U, 2U, 9U}) {
      CAPTURE(tau, k);
      double sum = 0;
      for (std::size_t a = 0; a < n * m; ++a)
        for (std::size_t b = 0; b < n * m; ++b)
          sum += cosine(k, a / m, n) * cosine(k, b / m, n) * std::exp(-dt * lag(a, b) / tau) / m;
      PowerBin bin;
      bin.first = k;
      bin.end = k + 1;
      bin.length = n;
      bin.spacing = m;
      CHECK(gauss_markov_unit(bin, tau, 1 / dt) == Approx(sum).epsilon(1e-9));
    }
}

TEST_CASE("Allan variance and spectrum of a Gauss-Markov process") {
  const double dt = 0.1;
  for (const std::size_t m : {1U, 3U, 100U})
    for (const double tau : {0.02, 1.0, 1e3, 1e8}) {
      CAPTURE(m, tau);
      double sum = 0;  // of covariance within a mean, less that across: one minus the exponentials
      for (std::size_t i = 0; i < m; ++i)
        for (std::size_t j = 0; j < m; ++j)
          sum += std::expm1(-lag(i, j) * dt / tau) - std::expm1(-lag(i, j + m) * dt / tau);
      CHECK(gauss_markov_allan_variance(tau, static_cast<double>(m), dt) ==
            Approx(sum / static_cast<double>(m * m)).epsilon(1e-6));
    }
  // The integral of the density over all frequencies is the variance.
  double power = 0;
  const int nodes = 200000;
  for (int i = 0; i < nodes; ++i) power += 2 * gauss_markov_spectrum(2.0, 5.0 * (i + 0.5) / nodes, dt) * 5.0 / nodes;
  CHECK(power == Approx(1).epsilon(1e-6));
}

TEST_CASE("a Gauss-Markov process of 200 correlation times is found, not read as a walk") {
  const double rate = 10, q = 5e-3, sigma = 0.02, tau = 60;
  int covered = 0, passes = 0;
  double stated = 0, squares = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    CAPTURE(seed);
    const NoiseFit fit = fit_of(white_and_process(seed, 120000, rate, q, sigma, tau), rate);
    REQUIRE(in_model(fit));
    const GaussMarkovFit& process = *fit.gauss_markov;
    CHECK(process.sigma.status == Status::detected);
    CHECK(*process.sigma.value == Approx(sigma).epsilon(0.25));
    CHECK(*process.tau_s.value == Approx(tau).epsilon(0.5));
    CHECK(*fit[Term::white].value == Approx(q).epsilon(0.02));
    CHECK(fit[Term::ramp].status == Status::not_fitted);
    stated += process.sigma.relative_sd / 20;
    squares += std::pow(std::log(*process.sigma.value / sigma), 2) / 20;
    covered += process.sigma.ci95.low <= sigma && sigma <= process.sigma.ci95.high;
    covered += process.tau_s.ci95.low <= tau && tau <= process.tau_s.ci95.high;
    passes += fit.goodness.p > 1e-3 && fit.band.whole;
    CHECK(says(fit, "Gauss-Markov"));
    // The model's curve is that of the process: flat top at 1.9 tau.
    CHECK(shaped_allan_variance(fit, 1200, 0.1) ==
          Approx(q * q / 120 + sigma * sigma * gauss_markov_allan_variance(tau, 1200, 0.1)).epsilon(0.5));
  }
  CHECK(stated == Approx(std::sqrt(squares)).epsilon(0.6));
  CHECK(covered >= 31);  // of 40; 38 expected, and sigma and tau of a record miss together
  CHECK(passes >= 19);
}

TEST_CASE("a fast Gauss-Markov process is no filter, and white noise behind a low-pass no process") {
  constexpr std::size_t n = 200000;
  constexpr double rate = 100, white = 5e-3, sd = white * 10;
  test::Gaussian gauss(3);
  std::vector<double> process(n), filtered(n);
  const double a = std::exp(-1 / (rate * 0.5)), b = std::exp(-1 / (rate * 20)), pole = std::exp(-2 * M_PI * 0.3 / rate);
  double fast = 0, slow = 0, out = 0;
  for (std::size_t t = 0; t < n; ++t) {
    fast = a * fast + sd * std::sqrt(1 - a * a) * gauss();
    slow = b * slow + sd * std::sqrt(1 - b * b) * gauss();
    process[t] = sd * gauss() + fast + slow;
    out = pole * out + (1 - pole) * sd * gauss();
    filtered[t] = out;
  }
  const NoiseFit of_processes = fit_of(process, rate), behind = fit_of(filtered, rate);
  CHECK(in_model(of_processes));
  CHECK(of_processes[Term::white].value.value_or(0) == Approx(white).epsilon(0.01));
  CHECK(!in_model(behind));
  CHECK(behind[Term::white].value.value_or(0) == Approx(white).epsilon(0.06));
}

TEST_CASE("of two Gauss-Markov processes the slower has its intervals and the faster is in the shape") {
  constexpr std::size_t n = 200000;
  constexpr double rate = 100, white = 5e-3, sd = white * 10, fast_s = 0.1, slow_s = 5;
  test::Gaussian gauss(5);
  std::vector<double> y(n);
  const double a = std::exp(-1 / (rate * fast_s)), b = std::exp(-1 / (rate * slow_s));
  double fast = 0, slow = 0;
  for (double& value : y) {
    fast = a * fast + sd * std::sqrt(1 - a * a) * gauss();
    slow = b * slow + sd * std::sqrt(1 - b * b) * gauss();
    value = sd * gauss() + fast + slow;
  }
  const NoiseFit fit = fit_of(y, rate);
  REQUIRE(in_model(fit));
  CHECK(fit[Term::white].value.value_or(0) == Approx(white).epsilon(0.01));
  CHECK(!fit[Term::quantization].value);
  const Coefficient& tau = fit.gauss_markov->tau_s;
  CHECK(std::abs(std::log(tau.value.value_or(0) / slow_s)) < 3 * tau.relative_sd);
  CHECK(tau.relative_sd < 0.2);
  CHECK(std::count_if(fit.findings.begin(), fit.findings.end(),
                      [](const Finding& found) { return found.code == "gauss_markov"; }) == 2);
  for (const double f : {0.3, 1.0, 5.0, 40.0}) {
    const double expected =
        white * white +
        sd * sd * (gauss_markov_spectrum(fast_s, f, 1 / rate) + gauss_markov_spectrum(slow_s, f, 1 / rate));
    CHECK(shaped_density(fit, f, 1 / rate) == Approx(expected).epsilon(0.1));
  }
}

TEST_CASE("the corner of a process is not left out as a resonance") {
  constexpr std::size_t n = 220000, settled = 20000;
  constexpr double rate = 100, white = 5e-3, sd = white * 10;
  test::NoiseSource source(n, rate, 11);
  test::Gaussian gauss(7);
  std::vector<double> y;
  for (int record = 0; record < 4; ++record) {
    y = source.record(white, 0, 0);
    for (const double tau_s : {0.5, 5.0}) {
      const double a = std::exp(-1 / (rate * tau_s));
      double state = sd * gauss();
      for (double& value : y) value += state = a * state + sd * std::sqrt(1 - a * a) * gauss();
    }
  }
  y.erase(y.begin(), y.begin() + settled);
  const NoiseFit fit = fit_of(y, rate);
  CHECK(in_model(fit));
  CHECK(fit[Term::white].value.value_or(0) == Approx(white).epsilon(0.02));
}

TEST_CASE("slow noise of another exponent is a law over the whole spectrum, and no shape, band or process") {
  constexpr std::size_t n = 200000;
  constexpr double rate = 100, white = 5e-3;
  int found = 0;
  for (const double exponent : {0.7, 1.3, 1.6})
    for (const std::uint64_t seed : {1, 2, 3}) {
      test::Gaussian gauss(seed);
      std::vector<double> y = law_record(n, rate, exponent, white * white * 1.75, gauss);
      for (double& value : y) value += white * std::sqrt(rate) * gauss();
      const NoiseFit fit = fit_of(y, rate);
      const auto said = std::find_if(fit.findings.begin(), fit.findings.end(),
                                     [](const Finding& finding) { return finding.code == "power_law"; });
      if (said == fit.findings.end()) continue;
      ++found;
      CHECK(fit.band.whole);
      CHECK(fit[Term::white].value.value_or(0) == Approx(white).epsilon(exponent < 1 ? 0.04 : 0.015));
      CHECK(!in_model(fit));
      for (const double f : {0.01, 0.1, 1.0, 10.0})
        CHECK(shaped_density(fit, f, 1 / rate) ==
              Approx(white * white * (1 + 1.75 * std::pow(f, -exponent))).epsilon(f < 0.1 ? 0.3 : 0.1));
    }
  CHECK(found >= 8);
}

TEST_CASE("the Allan curve of a law goes on beyond the recording as the law does") {
  constexpr double rate = 100, white = 5e-3, exponent = 1.3;
  test::Gaussian gauss(2);
  std::vector<double> y = law_record(200000, rate, exponent, white * white * 1.75, gauss);
  for (double& value : y) value += white * std::sqrt(rate) * gauss();
  const NoiseFit fit = fit_of(y, rate);
  const auto variance = [&](double tau_s) { return shaped_allan_variance(fit, tau_s * rate, 1 / rate); };
  // Flicker and walk alone rise by twice. What is left of them at long times is a small difference of large numbers.
  CHECK(variance(200) / variance(100) == Approx(std::pow(2, exponent - 1)).epsilon(0.08));
  CHECK(variance(800) / variance(400) == Approx(std::pow(2, exponent - 1)).epsilon(0.2));
}

TEST_CASE("flicker and walk are not taken for a Gauss-Markov process") {
  int found = 0, of = 0;
  const std::vector<Mixture> kinds = {{5e-3, 5e-3, 1.5e-3, 0, 0},
                                      {5e-3, 5e-3, 0, 0, 0},
                                      {5e-3, 0, 1.5e-3, 0, 0},
                                      {5e-3, 0, 0, 0, 0},
                                      {5e-3, 1e-3, 1e-4, 0, 0}};
  for (const Mixture& kind : kinds)
    for (std::uint64_t seed = 1; seed <= 20; ++seed, ++of)
      found += in_model(fit_of(terms_record(100 + seed, 60000, 100, kind), 100));
  CAPTURE(of);
  CHECK(found <= 3);  // 1 expected of 100 at the stated rate; more than 3: one time in fifty
}

TEST_CASE("twenty correlation times look like a walk, and the record says so") {
  int told = 0, said = 0, silent = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const NoiseFit fit = fit_of(white_and_process(seed, 120000, 100, 5e-3, 0.02, 60), 100);
    if (in_model(fit))
      ++told;
    else if (says(fit, "cannot tell its slow noise from a first-order Gauss-Markov process"))
      ++said;
    else
      ++silent;
    if (!in_model(fit) && fit.gauss_markov && fit.gauss_markov->sigma.value) {
      CHECK(fit.gauss_markov->sigma.status == Status::undetermined);
    }
  }
  CAPTURE(told, said, silent);
  CHECK(said >= 8);
  CHECK(told + said >= 15);
}
