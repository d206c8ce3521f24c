#include "libchar/core/present.hpp"

#include <catch2/catch.hpp>
#include <limits>
#include <vector>

using namespace libchar;

TEST_CASE("present: runs end at the first missing sample, wherever it stands") {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (const std::size_t n : {std::size_t{0},
                              std::size_t{1},
                              std::size_t{63},
                              std::size_t{64},
                              std::size_t{65},
                              std::size_t{300}}) {
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
