// Intervals of terms that are reported because they passed a threshold.
#include "libchar/fit/detail/selection.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "libchar/fit/detail/profile.hpp"

using namespace libchar;

namespace {

double density(double x) {
  return std::exp(-x * x / 2) / std::sqrt(2 * std::numbers::pi);
}

/// Of z ~ N(mean, 1) reported when z > c, the share whose lower limit is below the mean.
double share_below(double mean, double c) {
  constexpr double kStep = 1e-3;
  double below = 0, all = 0;
  for (double z = c + kStep / 2; z < mean + c + 12; z += kStep) {
    const double weight = density(z - mean);
    all += weight;
    if (z - mean <= std::sqrt(selected_rise(z * z, c * c))) below += weight;
  }
  return below / all;
}

}  // namespace

TEST_CASE("selected lower limits: 97.5 % of what is reported, whatever the truth") {
  for (const double mean : {0.0, 0.5, 1.0, 2.0, 2.326, 3.0, 5.0})
    for (const double c : {std::sqrt(5.41), 4.0}) {
      INFO("mean " << mean << " threshold " << c);
      CHECK(std::abs(share_below(mean, c) - 0.975) < 1e-3);
    }
}

TEST_CASE("selected lower limits: zero at the threshold, the plain limit far from it") {
  CHECK(selected_rise(5.5, 5.41) > 5.5);
  CHECK(selected_rise(12.0, 5.41) > 12.0);
  CHECK(selected_rise(13.0, 5.41) < 13.0);
  CHECK(selected_rise(60, 5.41) == Approx(kTwoSided95).epsilon(1e-3));
  CHECK(selected_rise(INFINITY, 5.41) == kTwoSided95);
}
