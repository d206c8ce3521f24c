#include "libchar/simulate/detail/noise_generator.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "libchar/allan/allan_covariance.hpp"
#include "libchar/allan/allan_deviation.hpp"
#include "libchar/allan/detail/equivalent_dof.hpp"
#include "libchar/allan/noise_curves.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/numeric/distributions.hpp"
#include "libchar/fit/detail/band/low_pass.hpp"
#include "libchar/fit/detail/record/dct_means.hpp"
#include "libchar/spectrum/fft.hpp"
#include "tests/support/algebra.hpp"

using namespace libchar;

namespace {

NoiseDesign design_of(const Mixture& coefficient, double rate_hz) {
  NoiseDesign design;
  design.coefficient = coefficient;
  design.rate_hz = rate_hz;
  return design;
}

/// Signal and noise of one sensor as its owner puts them together.
std::vector<double> record(const NoiseDesign& design, std::uint64_t seed, std::uint64_t sensor, std::size_t n) {
  NoiseGenerator generator(design, seed, sensor);
  std::vector<double> before(n, 0.0), after(n, 0.0);
  generator.add(before, after);
  const double a = design.bandwidth_hz ? std::exp(-2 * std::numbers::pi * *design.bandwidth_hz / design.rate_hz) : 0;
  double y = generator.low_pass_start();
  for (std::size_t t = 0; t < n; ++t) {
    y = a * y + (1 - a) * before[t];
    after[t] += y;
  }
  return after;
}

AllanOptions ten_octaves(double dt) {
  AllanOptions options;
  options.tau_max_s = 512 * dt;
  options.threads = 1;
  return options;
}

/// Agreement of the Allan variances of 200 records with the exact discrete curve of `assumed`, at
/// ten octaves: probabilities under the null hypothesis.
struct Agreement {
  double worst_octave = 1;  ///< least two-sided p of the mean, chi-square with the exact edf
  double together = 1;      ///< p of all ten means, chi-square with their exact covariance
  double worst_spread = 0;  ///< of the variance between records, in its standard deviations
};

Agreement agreement(const NoiseDesign& design, const Mixture& assumed, std::uint64_t seed) {
  constexpr std::size_t n = 1U << 14U;
  constexpr int records = 200;
  const double dt = 1 / design.rate_hz;
  Mixture theta{};
  for (std::size_t i = 0; i < kTerms; ++i) theta[i] = assumed[i] * assumed[i];
  AllanCurve curve;
  Eigen::ArrayXXd variance(10, records);
  for (int r = 0; r < records; ++r) {
    curve = allan_deviation(record(design, seed, static_cast<std::uint64_t>(r), n), dt, ten_octaves(dt));
    REQUIRE(curve.points.size() == 10);
    for (int j = 0; j < 10; ++j) variance(j, r) = std::pow(curve.points[static_cast<std::size_t>(j)].deviation, 2);
  }
  Agreement result;
  Eigen::VectorXd off(10);
  for (int j = 0; j < 10; ++j) {
    const AllanPoint& point = curve.points[static_cast<std::size_t>(j)];
    const double expected = allan_variance(theta, static_cast<double>(point.m), dt);
    const double edf = equivalent_dof(curve.type, theta, point.m, point.terms, 1, dt);
    const double chi2 = records * edf * variance.row(j).mean() / expected;
    result.worst_octave = std::min(
        {result.worst_octave, 2 * chi_square_cdf(chi2, records * edf), 2 * chi_square_tail(chi2, records * edf)});
    off[j] = variance.row(j).mean() - expected;
    const double spread = (variance.row(j) - expected).square().mean();
    const double unit = 2 * expected * expected / edf;  // its relative sd: chi-square, kurtosis
    result.worst_spread =
        std::max(result.worst_spread, std::fabs(spread / unit - 1) / std::sqrt((2 + 12 / edf) / records));
  }
  const Eigen::MatrixXd covariance = allan_covariance(curve, theta) / records;
  result.together = chi_square_tail(off.dot(test::solution(covariance, off).col(0)), 10);
  return result;
}

void check_curves(const NoiseDesign& design, std::uint64_t seed) {
  const Agreement found = agreement(design, design.coefficient, seed);
  CHECK(found.worst_octave > 1e-3);
  CHECK(found.together > 1e-3);
  CHECK(found.worst_spread < 3.9);
}

/// Mean of c_k^2 over records, in bins of lines, over expectation(k); the worst in standard
/// deviations. Lines of the cosine transform: k/(2n) cycles a sample.
template <typename Expected>
double worst_bin(const NoiseDesign& design, std::size_t n, int records, const Expected& expected) {
  Dct dct(n);
  std::vector<double> energy(n, 0.0);
  for (int r = 0; r < records; ++r) {
    const auto c = dct.transform(record(design, 77, static_cast<std::uint64_t>(r), n));
    for (std::size_t k = 1; k < n; ++k) energy[k] += c[k] * c[k] / records;
  }
  double worst = 0;
  for (std::size_t low = 1; low < n;) {
    const std::size_t high = std::min(n, low + std::max<std::size_t>(4, low));
    double sum = 0;
    for (std::size_t k = low; k < high; ++k) sum += energy[k] / expected(k) - 1;
    worst = std::max(worst, std::fabs(sum) * std::sqrt(records / (2.0 * static_cast<double>(high - low))));
    low = high;
  }
  return worst;
}

}  // namespace

TEST_CASE("Allan curves of 200 records agree with the exact discrete curves, term by term") {
  SECTION("white") { check_curves(design_of({5e-3, 0, 0, 0, 0}, 200), 1); }
  SECTION("flicker") { check_curves(design_of({0, 1e-3, 0, 0, 0}, 200), 2); }
  SECTION("flicker, filter of the record's length") {
    NoiseDesign design = design_of({0, 1e-3, 0, 0, 0}, 200);
    design.length = 1U << 14U;
    check_curves(design, 3);
  }
  SECTION("random walk") { check_curves(design_of({0, 0, 1e-4, 0, 0}, 200), 4); }
  SECTION("quantization") { check_curves(design_of({0, 0, 0, 1e-5, 0}, 200), 5); }
  SECTION("all together") { check_curves(design_of({5e-3, 2e-2, 1e-2, 1e-4, 0}, 200), 6); }
}

// What the test above can see: a coefficient 1 % off, and flicker of a filter cut at 63 taps.
TEST_CASE("Allan curves of a slightly different noise are rejected") {
  CHECK(agreement(design_of({1.01, 0, 0, 0, 0}, 1), {1, 0, 0, 0, 0}, 1).together < 1e-6);
  CHECK(agreement(design_of({0, 1.01, 0, 0, 0}, 1), {0, 1, 0, 0, 0}, 1).together < 1e-6);
  NoiseDesign cut = design_of({0, 1, 0, 0, 0}, 1);
  cut.flicker_method = "rv-truncated-iir";
  cut.truncated_taps = 63;
  CHECK(agreement(cut, cut.coefficient, 1).together < 1e-6);
}

TEST_CASE("records at rest first show the known lack of slow flicker") {
  NoiseDesign design = design_of({0, 1, 0, 0, 0}, 1);
  double mean[2] = {0, 0};
  for (int start = 0; start < 2; ++start) {
    design.start = start == 0 ? Start::zero : Start::stationary;
    for (std::uint64_t r = 0; r < 400; ++r) {
      AllanOptions options;
      options.grid = TauGrid::list;
      options.taus_s = {1024};
      const AllanCurve curve = allan_deviation(record(design, 8, r, 4096), 1, options);
      mean[start] += std::pow(curve.points.at(0).deviation, 2) / 400;
    }
    mean[start] /= unit_allan_variance(Term::flicker, 1024, 1);
  }
  // 0.9815 at m = N/4 (accuracy notes 1), the same deviates after the start in both
  CHECK(mean[0] / mean[1] == Approx(0.9815).margin(0.02));
  CHECK(mean[1] == Approx(1).margin(3.3 * std::sqrt(2 / 3.0 / 400)));
}

TEST_CASE("spectrum of simulated flicker over four decades") {
  constexpr std::size_t n = 1U << 16U;
  const NoiseDesign design = design_of({0, 2, 0, 0, 0}, 50);
  CHECK(worst_bin(design, n, 64, [](std::size_t k) { return 4 * dct_mean(static_cast<double>(k), n, 0.02)[1]; }) <
        3.9);  // 15 bins
}

TEST_CASE("noise made sample by sample and low-passed has the spectrum that the fit assumes") {
  constexpr std::size_t n = 1U << 14U;
  NoiseDesign design = design_of({1, 0, 0, 0, 0}, 100);
  design.bandwidth_hz = 5;
  CHECK(worst_bin(design, n, 100, [](std::size_t k) {
          return 100 * low_pass_gain(static_cast<double>(k) * 50 / n, 5, 100).gain;
        }) < 3.9);
  // accuracy notes 1: AVAR/(Q^2/tau) with a corner of a quarter of the rate
  design.bandwidth_hz = 25;
  const AllanCurve curve = allan_deviation(record(design, 5, 0, 1'000'000), 0.01, ten_octaves(0.01));
  const std::vector<double> known = {0.520, 0.693, 0.838, 0.919, 0.959};
  for (std::size_t j = 0; j < known.size(); ++j)
    CHECK(std::pow(curve.points[j].deviation, 2) * curve.points[j].tau_s == Approx(known[j]).epsilon(0.012));
}

// First and second sample of many sensors: variance and covariance of the filtered noise.
TEST_CASE("filtered noise is stationary from the first sample on") {
  constexpr int sensors = 20'000;
  const double a = std::exp(-2 * std::numbers::pi * 0.07), b = 1 - a;
  for (const bool white : {true, false}) {
    NoiseDesign design = design_of({white ? 1.0 : 0.0, 0, 0, white ? 0.0 : 1.0, 0}, 1);
    design.bandwidth_hz = 0.07;
    double variance = 0, covariance = 0;
    for (std::uint64_t r = 0; r < sensors; ++r) {
      const std::vector<double> y = record(design, 4, r, 2);
      variance += y[0] * y[0] / sensors;
      covariance += y[0] * y[1] / sensors;
    }
    // response b a^k (white); b (1, -b, -a b, -a^2 b ...) (quantization)
    const double expected = white ? b / (1 + a) : 2 * b * b / (1 + a);
    const double next = white ? a * expected : -b * b * b / (1 + a);
    CHECK(variance == Approx(expected).epsilon(3.3 * std::sqrt(2.0 / sensors)));
    CHECK(covariance == Approx(next).margin(3.3 * expected * std::sqrt(2.0 / sensors)));
  }
}

// Sampled, the low-passed continuous noise has variance Q^2 pi f_c and correlation a; its slow part
// has the density Q^2 x coth x, x = pi f_c/rate: aliases add to it.
TEST_CASE("noise band-limited before sampling is aliased as it should be") {
  constexpr std::size_t n = 1U << 14U;
  NoiseDesign design = design_of({2, 0, 0, 0, 0}, 100);
  design.bandwidth_hz = 25;
  design.sampling = Sampling::band_limited;
  const double x = std::numbers::pi / 4, a = std::exp(-2 * x);
  const double variance = 4 * 25 * std::numbers::pi;
  CHECK(worst_bin(design, n, 100, [=](std::size_t k) {
          const double cosine = std::cos(std::numbers::pi * static_cast<double>(k) / n);
          return variance * (1 - a * a) / (1 - 2 * a * cosine + a * a);
        }) < 3.9);
  const double slow = variance * (1 - a * a) / ((1 - a) * (1 - a)) / 100;
  CHECK(slow == Approx(4 * x / std::tanh(x)).epsilon(1e-13));
  // stationary from the first sample on
  double first = 0;
  for (std::uint64_t r = 0; r < 4000; ++r) first += std::pow(record(design, 1, r, 1)[0], 2) / 4000;
  CHECK(first == Approx(variance).epsilon(3.3 * std::sqrt(2.0 / 4000)));
}

TEST_CASE("which terms pass the low-pass") {
  NoiseDesign design = design_of({1, 1, 1, 1, 1}, 10);
  design.bandwidth_hz = 2;
  CHECK_FALSE(NoiseGenerator(design, 1, 0).adds_after());
  design.sampling = Sampling::band_limited;
  CHECK(NoiseGenerator(design, 1, 0).adds_after());
  design.coefficient = {};
  CHECK_FALSE(NoiseGenerator(design, 1, 0).adds_after());
  std::vector<double> before(5, 1.0);
  NoiseGenerator(design, 1, 0).add(before, {});
  CHECK(before == std::vector<double>(5, 1.0));
}

TEST_CASE("samples do not depend on the size of the blocks, bit for bit") {
  constexpr std::size_t n = 20'000;
  for (const Sampling sampling : {Sampling::per_sample, Sampling::band_limited})
    for (const std::string method : {"recursive", "rv-truncated-iir"}) {
      NoiseDesign design = design_of({1, 2, 3, 4, 5}, 10);
      design.bandwidth_hz = 2;
      design.sampling = sampling;
      design.flicker_method = method;
      design.truncated_taps = 50;
      NoiseGenerator one(design, 1, 7), two(design, 1, 7);
      std::vector<double> before(n, 0.5), after(n, 0.25), before_parts = before, after_parts = after;
      one.add(before, after);
      std::size_t at = 0;
      for (std::size_t size = 1; at < n; size = size * 7 % 1300 + 1) {
        const std::size_t count = std::min(size, n - at);
        two.add(std::span(before_parts).subspan(at, count), std::span(after_parts).subspan(at, count));
        at += count;
      }
      CHECK(before == before_parts);
      CHECK(after == after_parts);
    }
}

TEST_CASE("a term does not change the samples of the others") {
  const auto one = [](const Mixture& m) { return record(design_of(m, 10), 3, 1, 3000); };
  const std::vector<double> all = one({1, 2, 3, 4, 5});
  std::vector<double> sum(all.size(), 0.0);
  for (const Mixture& m :
       {Mixture{1, 0, 0, 0, 0}, {0, 2, 0, 0, 0}, {0, 0, 3, 0, 0}, {0, 0, 0, 4, 0}, {0, 0, 0, 0, 5}}) {
    const std::vector<double> term = one(m);
    for (std::size_t t = 0; t < sum.size(); ++t) sum[t] += term[t];
  }
  for (std::size_t t = 0; t < sum.size(); ++t) CHECK(sum[t] == Approx(all[t]).margin(1e-10));
}

TEST_CASE("sensors and seeds have noise of their own") {
  const NoiseDesign design = design_of({1, 0, 0, 0, 0}, 1);
  constexpr std::size_t n = 40'000;
  const std::vector<std::vector<double>> x = {record(design, 1, 0, n), record(design, 1, 1, n), record(design, 2, 0, n),
                                              record(design, 2, 1, n)};
  for (std::size_t i = 0; i < x.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      double sum = 0;
      for (std::size_t t = 0; t < n; ++t) sum += x[i][t] * x[j][t];
      CHECK(std::fabs(sum) / std::sqrt(double(n)) < 3.9);
    }
  CHECK(x[0] == record(design, 1, 0, n));
}

TEST_CASE("the ramp is exact and the walk starts at zero") {
  const std::vector<double> ramp = record(design_of({0, 0, 0, 0, -0.25}, 8), 1, 0, 100'000);
  for (std::size_t t = 0; t < ramp.size(); ++t) REQUIRE(ramp[t] == -0.25 * static_cast<double>(t) / 8);
  double first = 0;
  for (std::uint64_t r = 0; r < 4000; ++r)
    first += std::pow(record(design_of({0, 0, 6, 0, 0}, 4), 1, r, 1)[0], 2) / 4000;
  CHECK(first == Approx(9).epsilon(3.3 * std::sqrt(2.0 / 4000)));  // one step: K^2 dt
}

TEST_CASE("the published start is the convolution from rest") {
  NoiseDesign design = design_of({0, 1, 0, 0, 0}, 10);
  design.start = Start::zero;
  const std::vector<double> x = record(design, 5, 2, 2000);
  design.flicker_method = "rv-truncated-iir";
  design.truncated_taps = 2000;
  const std::vector<double> published = record(design, 5, 2, 2000);
  for (std::size_t t = 0; t < x.size(); ++t) CHECK(x[t] == Approx(published[t]).margin(1e-5));
}

TEST_CASE("designs that make no sense are refused in a sentence") {
  const auto refused = [](const NoiseDesign& design) -> std::string {
    try {
      NoiseGenerator(design, 1, 0);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  NoiseDesign design = design_of({1, 1, 0, 0, 0}, 10);
  CHECK(refused(design).empty());
  design.rate_hz = 0;
  CHECK(refused(design).find("sample rate") != std::string::npos);
  design.rate_hz = 10;
  design.sampling = Sampling::band_limited;
  CHECK(refused(design).find("needs a bandwidth") != std::string::npos);
  design.bandwidth_hz = -1;
  CHECK(refused(design).find("bandwidth must be positive") != std::string::npos);
  design.bandwidth_hz = 1;
  design.coefficient[2] = -1e-3;
  CHECK(refused(design).find("random_walk") != std::string::npos);
  design.coefficient[2] = std::numeric_limits<double>::quiet_NaN();
  CHECK(refused(design).find("random_walk") != std::string::npos);
  design.coefficient[2] = 1e308;
  CHECK(refused(design).find("too large") != std::string::npos);
  design.coefficient[2] = 0;
  design.flicker_method = "recursiv";
  CHECK(refused(design).find("`rv-truncated-iir`") != std::string::npos);
  design.flicker_method = "rv-truncated-iir";
  design.truncated_taps = 0;
  CHECK(refused(design).find("at least one") != std::string::npos);
}

TEST_CASE("the samples of a seed stay what they are") {
  const std::vector<double> x = record(design_of({1, 1, 1, 1, 1}, 4), 1, 0, 1000);
  CHECK(x[0] == Approx(3.2652962283780882).epsilon(1e-12));
  CHECK(x[1] == Approx(5.0632809997355848).epsilon(1e-12));
  CHECK(x[999] == Approx(250.77387683495408).epsilon(1e-12));
}

TEST_CASE("a Gauss-Markov process is simulated with its variance and covariance, from the first sample on") {
  NoiseDesign design;
  design.rate_hz = 4;
  design.gauss_markov_sigma = 0.3;
  design.gauss_markov_tau_s = 2;
  const std::vector<double> y = record(design, 3, 0, 400000);
  const double phi = std::exp(-1 / 8.0);
  for (const std::size_t lag : {0U, 1U, 8U, 24U}) {
    double sum = 0;
    for (std::size_t t = lag; t < y.size(); ++t) sum += y[t] * y[t - lag];
    // sd of the estimate: sigma² sqrt((1 + phi²)/(1 - phi²)/n) = 0.0004 at lag 0
    CHECK(std::abs(sum / static_cast<double>(y.size() - lag) - 0.09 * std::pow(phi, static_cast<double>(lag))) <
          0.0025);
  }
  double first = 0;
  for (std::uint64_t sensor = 0; sensor < 2000; ++sensor) {
    const double start = record(design, 5, sensor, 1)[0];
    first += start * start / 2000;
  }
  CHECK(first == Approx(0.09).epsilon(0.13));  // four standard deviations
  design.gauss_markov_tau_s = 0;
  CHECK_THROWS_WITH(NoiseGenerator(design, 1, 0), Catch::Contains("Gauss-Markov"));
}
