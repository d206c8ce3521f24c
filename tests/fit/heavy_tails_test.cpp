#include <catch2/catch.hpp>
#include <cmath>

#include "libchar/fit/noise_fit.hpp"
#include "libchar/fit/remedies.hpp"
#include "libchar/fit/signs/spike_cleaner.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;

namespace {

/// Independent samples of unit variance: Laplace's distribution has an excess kurtosis of 3, a
/// difference of exponentials.
std::vector<double> laplace_record(std::size_t n, std::uint64_t seed) {
  test::Gaussian gauss(seed);
  std::vector<double> y(n);
  for (double& v : y) {
    const double a = gauss(), b = gauss(), c = gauss(), d = gauss();
    v = 0.5 * (a * b + c * d);  // a sum of two products of normals is Laplace's
  }
  return y;
}

/// How many of 100 intervals of N hold the truth, of records at 100 Hz.
template <class Make>
int held(Make&& make, double truth) {
  int count = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    FitOptions options;
    options.second_opinion = options.stationarity = false;
    const Coefficient white = fit_record(make(seed), 100, nullptr, options)[Term::white];
    if (white.value && white.ci95.low <= truth && truth <= white.ci95.high) ++count;
  }
  return count;
}

}  // namespace

TEST_CASE("intervals of N hold the truth where the samples have heavy tails") {
  const double scale = std::sqrt(0.5);
  // Each product has variance 1, their half sum 1/2. Without the fourth moment it is about 78 of 100.
  CHECK(held([](std::uint64_t seed) { return laplace_record(8000, seed); }, scale * 0.1) >= 89);
}

TEST_CASE("spikes of which some are left out and some are not leave N where it is") {
  // A quarter of spikes of eight standard deviations are below six of the residual that finds them.
  for (const double sign : {0.0, 1.0})
    CHECK(held(
              [&](std::uint64_t seed) {
                test::Gaussian gauss(seed);
                std::vector<double> y(30000);
                for (double& v : y) {
                  v = gauss();
                  if (gauss.uniform() < 0.001) v += gauss.uniform() < 0.5 && sign == 0 ? -8 : 8;
                }
                return y;
              },
              0.1) >= 90);
}

TEST_CASE("outliers too few for the alarm: the interval of N reaches to where it is without them") {
  const auto with_outliers = [](std::uint64_t seed) {
    test::Gaussian gauss(seed);
    std::vector<double> y(20000);
    for (double& v : y) {
      v = gauss();
      if (gauss.uniform() < 0.003) v += gauss.uniform() < 0.5 ? -3.5 : 3.5;
    }
    return y;
  };
  CHECK(held(with_outliers, 0.1) >= 83);
}

TEST_CASE("small outliers are taken out where larger ones were left out, even if chance hides them") {
  const detail::CoreSums sums{20000, 40400, 40000, 40000};
  CHECK_FALSE(detail::outlier_variance(sums, false));
  const auto left = detail::outlier_variance(sums, true);
  REQUIRE(left);
  CHECK(left->variance == Approx(0.01));
  CHECK_FALSE(left->seen);
  CHECK(detail::outlier_variance({20000, 44000, 40000, 40000}, false)->seen);
}

TEST_CASE("values held and steps are no small outliers") {
  test::Gaussian gauss(11);
  std::vector<double> white(40000), held(white.size()), flipped(white.size());
  for (std::size_t t = 0; t < white.size(); ++t) {
    white[t] = gauss();
    held[t] = white[t - t % 2];
    flipped[t] = t < white.size() / 2 ? white[t] + 40 : -(white[t] + 40);
  }
  for (const auto& record : {held, flipped}) {
    CHECK_FALSE(detail::outlier_variance(detail::core_sums(record), false));
    const NoiseFit fit = fit_record(record, 100, nullptr, FitOptions{});
    CHECK_FALSE(has(fit.findings, "outliers_in_n"));
    const double truth = record == held ? std::sqrt(2) * 0.1 : 0.1;  // held: white noise of half the rate
    CHECK(*fit[Term::white].value == Approx(truth).epsilon(0.012));
  }
}

TEST_CASE("small outliers of a clock's readings are taken out of its phase noise") {
  // In one reading of a hundred, five standard deviations: Q would be 11 % too large.
  FitOptions clock;
  clock.clock = true;
  test::Gaussian gauss(13);
  double mean = 0;
  for (int r = 0; r < 8; ++r) {
    std::vector<double> x(10001), y(10000);
    for (double& reading : x) reading = 3 * gauss() + (gauss.uniform() < 0.01 ? 15 * gauss() : 0);
    for (std::size_t t = 0; t < y.size(); ++t) y[t] = gauss() + x[t + 1] - x[t];
    const NoiseFit fit = fit_record(y, 1, nullptr, clock);
    CHECK(has(fit.findings, "outliers_in_n"));
    mean += fit[Term::quantization].value.value() / 8;
  }
  CHECK(mean == Approx(3).epsilon(0.03));
}

TEST_CASE("Gaussian noise keeps the interval of its likelihood") {
  test::Gaussian gauss(5);
  std::vector<double> y(20000);
  for (double& v : y) v = gauss();
  FitOptions options;
  options.second_opinion = false;
  options.white_top = true;
  const NoiseFit fit = fit_record(y, 100, nullptr, options);
  REQUIRE(fit[Term::white].value);
  CHECK(fit[Term::white].relative_sd == Approx(0.5 * std::sqrt(2.0 / 20000)).epsilon(0.1));
  for (const Finding& one : fit.findings) CHECK(one.sentence.find("tails") == std::string::npos);
}

TEST_CASE("what heavy tails add is the fourth moment's: var ln theta + excess kurtosis / n") {
  const std::vector<double> y = laplace_record(200000, 3);
  FitOptions options;
  options.second_opinion = false;
  options.white_top = true;
  const NoiseFit fit = fit_record(y, 100, nullptr, options);
  const double n = 200000;
  CHECK(fit.covariance[0][0] == Approx((2 + 3) / n).epsilon(0.1));
  CHECK(fit[Term::white].relative_sd == Approx(0.5 * std::sqrt(5 / n)).epsilon(0.1));
  bool said = false;
  for (const Finding& one : fit.findings)
    said = said || one.sentence.find("heavier tails than Gaussian noise") != std::string::npos;
  CHECK(said);
}

TEST_CASE("the rounding of a straight line leaves no N of zero") {
  test::Gaussian gauss(3);
  for (const double noise : {1e-15, 1e-14, 1e-13})
    for (int record = 0; record < 40; ++record) {
      std::vector<double> y(8);
      for (std::size_t t = 0; t < y.size(); ++t) y[t] = 1e-3 * static_cast<double>(t) + noise * gauss();
      const Coefficient white = fit_record(y, 100, nullptr, FitOptions{})[Term::white];
      CHECK((!white.value || *white.value > 0));
    }
}
