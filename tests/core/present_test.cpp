#include "libchar/core/numeric/present.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <vector>

using namespace libchar;

TEST_CASE("present: runs end at the first missing sample, wherever it stands") {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (const std::size_t n :
       {std::size_t{0}, std::size_t{1}, std::size_t{63}, std::size_t{64}, std::size_t{65}, std::size_t{300}}) {
    std::vector<double> x(n, 1e308);  // sums of these leave the range of a double
    CHECK(present_run(x) == n);
    CHECK(finite_run(x) == n);
    CHECK(count_missing(x) == 0);
    for (std::size_t at = 0; at < n; ++at) {
      x[at] = nan;
      CHECK(present_run(x) == at);
      CHECK(finite_run(x) == at);
      CHECK(count_missing(x) == 1);
      x[at] = -infinity;
      CHECK(present_run(x) == n);
      CHECK(finite_run(x) == at);
      CHECK(count_missing(x) == 0);
      x[at] = -1e308;
    }
    for (double& v : x) v = nan;
    CHECK(count_missing(x) == n);
  }
}

TEST_CASE("present: the mean of what is finite, at any offset, length and place") {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (std::size_t n = 1; n < 40; ++n) {
    std::vector<double> x(n);
    for (std::size_t i = 0; i < n; ++i) x[i] = 1e9 + static_cast<double>(i);
    CHECK(mean_present(x) == 1e9 + 0.5 * static_cast<double>(n - 1));
    for (const double missing : {nan, infinity}) {
      std::vector<double> holed = x;
      holed[n / 2] = missing;
      double sum = 0;
      for (std::size_t i = 0; i < n; ++i) sum += i == n / 2 ? 0 : static_cast<double>(i);
      if (n == 1) {
        CHECK(std::isnan(mean_present(holed)));
      } else {
        CHECK(mean_present(holed) == Approx(1e9 + sum / static_cast<double>(n - 1)).epsilon(1e-16));
      }
    }
  }
}

TEST_CASE("present: samples beyond 1e100 are counted wherever they stand, missing ones are not") {
  for (std::size_t at = 0; at < 19; ++at) {
    std::vector<double> x(19, -1e100);
    CHECK(count_beyond(x) == 0);
    x[at] = 1.1e100;
    CHECK(count_beyond(x) == 1);
    x[at] = -std::numeric_limits<double>::infinity();
    CHECK(count_beyond(x) == 1);
    x[at] = std::numeric_limits<double>::quiet_NaN();
    CHECK(count_beyond(x) == 0);
  }
}
