#include "libchar/simulate/detail/flicker.hpp"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <vector>

#include "libchar/allan/noise_curves.hpp"
#include "tests/support/flicker.hpp"
#include "tests/support/kasdin.hpp"

using namespace libchar;

namespace {

const std::vector<std::uint64_t> kLengths = {1, 100, 5'000, 1'000'000, 300'000'000, 0};

double longest(std::uint64_t length) { return static_cast<double>(length == 0 ? kLongestFlicker : length); }

/// Points from `low` to `high`, equally far apart in the logarithm.
std::vector<double> spread(double low, double high, int count) {
  std::vector<double> x;
  for (int i = 0; i <= count; ++i) x.push_back(low * std::pow(high / low, i / double(count)));
  return x;
}

/// Gamma(k + 1/2)/(Gamma(k + 1) sqrt pi), by recursion for small and Stirling's series for large k.
double exact_response(double k) {
  if (k < 1000) return test::kasdin_series(1, static_cast<std::size_t>(k) + 1).back();
  const double z = 1 / k;
  return (1 - z / 8 + z * z / 128 + 5 * z * z * z / 1024) / std::sqrt(std::numbers::pi * k);
}

std::vector<double> normals(std::uint64_t seed, std::size_t n) {
  std::vector<double> out(n);
  DeviateStream({seed, 0, Purpose::flicker}).fill_normal(out);
  return out;
}

}  // namespace

TEST_CASE("impulse response, spectrum and variogram of the filter are those of flicker to 1e-6") {
  for (const std::uint64_t length : kLengths) {
    const FlickerFilter filter = design_flicker(length);
    const double n = longest(length);
    double response = std::fabs(test::flicker_response(filter, 0) - 1), power = 0, variogram = 0;
    for (double k : spread(1, std::max(2.0, n), 700)) {
      k = std::min(n, std::round(k));
      response = std::max(response, std::fabs(test::flicker_response(filter, k) / exact_response(k) - 1));
      const double exact = 4 / std::numbers::pi * odd_harmonic(k);
      variogram = std::max(variogram, std::fabs(test::flicker_variogram(filter, k) / exact - 1));
    }
    for (const double nu : spread(std::min(0.49, 0.5 / n), 0.5, 3000))
      power = std::max(power, std::fabs(test::flicker_power(filter, nu) * 2 * std::sin(std::numbers::pi * nu) - 1));
    UNSCOPED_INFO("length " << length << ", " << filter.loss.size() << " sections: response " << response << ", power "
                            << power << ", variogram " << variogram);
    CHECK(response < 6e-7);
    CHECK(power < 6e-7);
    CHECK(variogram < 6e-7);
    CHECK(filter.loss.size() <= 56);
  }
}

TEST_CASE("the Allan variance of the filter's output is flicker's to 1e-6") {
  // From the variogram alone: the covariance s of the summed samples has second difference V/2
  const FlickerFilter filter = design_flicker(1'000'000);
  constexpr std::size_t most = 1U << 13U;
  std::vector<long double> s(2 * most + 1, 0.0L);
  for (std::size_t n = 1; n < 2 * most; ++n)
    s[n + 1] = 2 * s[n] - s[n - 1] + static_cast<long double>(test::flicker_variogram(filter, double(n))) / 2;
  for (std::size_t m = 1; m <= most; m *= 2) {
    const long double avar = (s[2 * m] - 4 * s[m]) / static_cast<long double>(m * m);
    CHECK(static_cast<double>(avar) == Approx(unit_allan_variance(Term::flicker, double(m), 1)).epsilon(1e-6));
  }
}

TEST_CASE("poles and weights are positive and ordered") {
  for (const std::uint64_t length : kLengths) {
    const FlickerFilter filter = design_flicker(length);
    for (std::size_t j = 0; j < filter.loss.size(); ++j) {
      CHECK(filter.weight[j] > 0);
      CHECK(filter.loss[j] > 0);
      CHECK(filter.loss[j] < 1);
      if (j > 0) CHECK(filter.loss[j] < filter.loss[j - 1]);
    }
  }
}

TEST_CASE("the closed Cholesky factor reproduces the stationary covariance") {
  for (const std::uint64_t length : {std::uint64_t{1000}, std::uint64_t{0}}) {
    const FlickerFilter filter = design_flicker(length);
    const std::vector<double> factor = stationary_factor(filter);
    const std::size_t n = filter.loss.size();
    double worst = 0;
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) {
        double sum = 0;
        for (std::size_t k = 0; k < n; ++k) sum += factor[i * n + k] * factor[j * n + k];
        const double qi = filter.loss[i], qj = filter.loss[j];
        const double covariance = 1 / (qi + qj - qi * qj);
        const double scale = 1 / std::sqrt((2 * qi - qi * qi) * (2 * qj - qj * qj));
        worst = std::max(worst, std::fabs(sum - covariance) / scale);
      }
    CHECK(worst < 1e-14);
  }
}

TEST_CASE("started at rest, an impulse gives the impulse response") {
  const FlickerFilter filter = design_flicker(0);
  FlickerStream stream(filter);
  std::vector<double> x(3000, 0.0);
  x[0] = 1;
  stream.run(x);
  for (std::size_t k = 0; k < x.size(); ++k)
    CHECK(x[k] == Approx(test::flicker_response(filter, static_cast<double>(k))).epsilon(1e-13));
}

TEST_CASE("started at rest, the record is that of the exact convolution") {
  const std::vector<double> driving = normals(3, 200'000);
  const std::vector<double> exact = test::kasdin_filter(driving);
  std::vector<double> x = driving;
  FlickerStream(design_flicker(x.size())).run(x);
  double error = 0, power = 0;
  for (std::size_t t = 0; t < x.size(); ++t) {
    error += (x[t] - exact[t]) * (x[t] - exact[t]);
    power += exact[t] * exact[t];
  }
  CHECK(std::sqrt(error / power) < 5e-7);
}

TEST_CASE("a stationary start draws the states' joint distribution and counts from the level before") {
  const FlickerFilter filter = design_flicker(10'000);
  DeviateStream one({9, 0, Purpose::flicker_start}), two({9, 0, Purpose::flicker_start});
  std::vector<double> states = stationary_states(filter, one);
  FlickerStream stream(filter, two);
  const std::vector<double> driving = normals(9, 500);
  std::vector<double> x = driving;
  stream.run(x);
  double level = 0;
  for (std::size_t j = 0; j < states.size(); ++j) level += filter.weight[j] * states[j];
  for (std::size_t t = 0; t < x.size(); ++t) {
    double sum = 0;
    for (std::size_t j = 0; j < states.size(); ++j) {
      states[j] += driving[t] - filter.loss[j] * states[j];
      sum += filter.weight[j] * states[j];
    }
    CHECK(x[t] == Approx(sum - level).margin(1e-12));
  }
}

// E (y_{t+n} - y_t)^2 of the stream, from the map that takes start and driving deviates to the samples: it must be
// (4/pi) H_n wherever in the record it is taken, also across the start (y_{-1} = 0).
TEST_CASE("the increments of a stationary start are stationary") {
  constexpr std::size_t length = 200;
  const FlickerFilter filter = design_flicker(length);
  const std::vector<double> factor = stationary_factor(filter);
  const std::size_t n = filter.loss.size();
  std::vector<std::vector<double>> row(length + 1, std::vector<double>(n + length, 0.0));
  for (std::size_t t = 0; t <= length; ++t)  // row 0 is the value before the first sample
    for (std::size_t j = 0; j < n; ++j) {
      const double keep = std::exp(static_cast<double>(t) * std::log1p(-filter.loss[j]));
      for (std::size_t k = 0; k <= j; ++k) row[t][k] += filter.weight[j] * keep * factor[j * n + k];
    }
  for (std::size_t t = 1; t <= length; ++t)
    for (std::size_t s = 1; s <= t; ++s) row[t][n + s - 1] = test::flicker_response(filter, static_cast<double>(t - s));
  for (std::size_t t = 0; t < length; ++t)
    for (std::size_t lag = 1; t + lag <= length; lag = 2 * lag + 1) {
      double sum = 0;
      for (std::size_t k = 0; k < n + length; ++k) sum += (row[t + lag][k] - row[t][k]) * (row[t + lag][k] - row[t][k]);
      CHECK(sum == Approx(4 / std::numbers::pi * odd_harmonic(double(lag))).epsilon(6e-7));
    }
}

TEST_CASE("flicker does not depend on the size of the blocks, bit for bit") {
  for (const std::uint64_t length : {std::uint64_t{1000}, std::uint64_t{1'000'000}, std::uint64_t{0}}) {
    const FlickerFilter filter = design_flicker(length);
    std::vector<double> whole = normals(4, 5000), parts = whole;
    FlickerStream one(filter), two(filter);
    one.run(whole);
    std::size_t at = 0;
    for (std::size_t size = 1; at < parts.size(); size = size * 7 % 700 + 1) {
      const std::size_t count = std::min(size, parts.size() - at);
      two.run(std::span(parts).subspan(at, count));
      at += count;
    }
    CHECK(whole == parts);
  }
}

// The sum is written out lane by lane as sections.cpp promises it: what a processor without AVX2
// computes, compared with the clone that this processor takes.
TEST_CASE("the vector code adds in the stated order, bit for bit") {
  const FlickerFilter filter = design_flicker(0);
  std::vector<double> loss = filter.loss, weight = filter.weight;
  loss.resize(56, 1.0);
  weight.resize(56, 0.0);
  std::vector<double> state(56, 0.0), x = normals(6, 2000);
  const std::vector<double> driving = x;
  FlickerStream(filter).run(x);
  for (std::size_t t = 0; t < x.size(); ++t) {
    std::array<double, 4> lane{};
    for (std::size_t pass = 0; pass < 2; ++pass)
      for (std::size_t l = 0; l < 4; ++l) {
        double sum = 0;
        for (std::size_t v = 0; v < 7; ++v) {
          const std::size_t j = 28 * pass + 4 * v + l;
          state[j] += weight[j] * driving[t] - loss[j] * state[j];
          sum = v == 0 ? state[j] : sum + state[j];
        }
        lane[l] = pass == 0 ? sum : lane[l] + sum;
      }
    REQUIRE(x[t] == ((lane[0] + lane[1]) + (lane[2] + lane[3])) - 0.0);
  }
}
