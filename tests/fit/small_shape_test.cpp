// What is too weak for any test of the fit, and strong enough to leave an interval that knows one model.
#include "libchar/fit/detail/band/small_shape.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "libchar/fit/noise_fit.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;

namespace {

constexpr double kHz = 100, kWhiteHere = 0.005;
constexpr std::size_t kSize = 20000;

int holds_white(int records, const std::function<std::vector<double>()>& record) {
  int count = 0;
  FitOptions options;
  options.second_opinion = false;
  for (int r = 0; r < records; ++r) {
    const NoiseFit fit = fit_record(record(), kHz, nullptr, options);
    const Interval& white = fit[Term::white].ci95;
    count += white.low <= kWhiteHere && kWhiteHere <= white.high ? 1 : 0;
  }
  return count;
}

}  // namespace

TEST_CASE("small shape: a pole that the tests half see is in the interval of N") {
  test::Gaussian normal(77);
  const double a = std::exp(-2 * std::numbers::pi * 0.6), sd = kWhiteHere * std::sqrt(kHz);
  CHECK(holds_white(100, [&] {
          std::vector<double> y(kSize);
          double state = 0;
          for (double& v : y) v = state = a * state + (1 - a) * sd * normal();
          return y;
        }) >= 93);
}

TEST_CASE("small shape: slow noise that no flicker and no walk is has N in its interval") {
  test::Gaussian normal(78);
  const double sd = kWhiteHere * std::sqrt(kHz);
  CHECK(holds_white(40, [&] {  // telegraphs of five rates: 1/f up to 1.6 Hz, 1/f² above
          std::vector<double> y(kSize);
          for (double& v : y) v = sd * normal();
          for (const double rate : {0.01, 0.05, 0.2, 1.0, 5.0}) {
            double level = 0.15 * sd * (normal() < 0 ? -1 : 1);
            for (double& v : y) {
              if (normal.uniform() < rate / kHz) level = -level;
              v += level;
            }
          }
          return y;
        }) >= 31);
}

TEST_CASE("small shape: a hump too weak to be left out is in the interval of N") {
  test::Gaussian normal(79);
  const double sd = kWhiteHere * std::sqrt(kHz);
  CHECK(holds_white(40, [&] {  // steps on a floor that rings at 14 Hz
          std::vector<double> y(kSize);
          for (double& v : y) v = sd * normal();
          for (double at = 50; at < kSize - 50; at += 0.55 * kHz + 8 * normal())
            for (int i = 0; i < 40; ++i)
              y[static_cast<std::size_t>(at) + static_cast<std::size_t>(i)] +=
                  0.6 * sd * std::exp(-0.1 * i) * std::sin(0.9 * i);
          return y;
        }) >= 37);
}
