// Lines through the values of groups, one spread about all of them.

#include <catch2/catch.hpp>
#include <cmath>

#include "libchar/lot/detail/statistics/grouped_effects.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;

TEST_CASE("grouped lines: slopes and spread of values that lie exactly so") {
  // Group 0: 1 + 2 x and residuals +-1 about it; group 1 has two values, so that its line is exact;
  // group 2 has no line.
  const std::vector<double> y = {-1 + 1, 1 - 2, 3 + 1, 10, 14, 5, 7}, x = {-1, 0, 1, 0, 2, 0, 9};
  const std::vector<double> v(y.size(), 1e-6);
  const std::vector<std::size_t> group = {0, 0, 0, 1, 1, 2, 2};
  const GroupedLines lines = grouped_lines(y, v, x, group, {true, true, false});
  CHECK(lines.residual_dof == std::vector<double>{1, 0, 1});
  CHECK(lines.dof == 2);
  CHECK(lines.slope[0] == Approx(2));
  CHECK(lines.at_zero[0] == Approx(1));
  CHECK(lines.slope[1] == Approx(2));
  CHECK(lines.at_zero[1] == Approx(10));
  CHECK(lines.at_zero[2] == Approx(6));
  CHECK(std::isnan(lines.slope[2]));
  // Squares: 1 + 4 + 1 about the first line, 1 + 1 about the mean, over two degrees of freedom.
  const double square = 8.0 / 2;
  CHECK(lines.within == Approx(std::sqrt(square)).epsilon(1e-5));
  CHECK(lines.slope_variance[0] == Approx(square / 2).epsilon(1e-5));
  CHECK(lines.slope_variance[1] == Approx(square / 2).epsilon(1e-5));
  // At x = 0: group 1 has its mean at 1.
  CHECK(lines.at_zero_variance[1] == Approx(square / 2 + square / 2).epsilon(1e-5));
  CHECK(lines.at_zero_variance[2] == Approx(square / 2).epsilon(1e-5));
  CHECK(lines.slope_variance_low[0] < lines.slope_variance[0]);
  CHECK(lines.slope_variance_high[0] > lines.slope_variance[0]);
}

TEST_CASE("grouped lines: two values a line know no spread") {
  const std::vector<double> y = {0, 1, 2, 5}, v(4, 0.25), x = {0, 1, 0, 2};
  const std::vector<std::size_t> group = {0, 0, 1, 1};
  const GroupedLines lines = grouped_lines(y, v, x, group, {true, true});
  CHECK(lines.dof == 0);
  CHECK(std::isnan(lines.within));
  CHECK(lines.slope[1] == Approx(1.5));
  CHECK(lines.slope_variance[0] == Approx(0.5));
}
