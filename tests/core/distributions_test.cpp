#include "libchar/core/numeric/distributions.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

using namespace libchar;

// Closed forms: Student's t of one degree of freedom is Cauchy's, of two algebraic; F(2, 2) is f / (1 + f).
TEST_CASE("distributions: Student's t of one and two degrees of freedom") {
  for (const double p : {0.9, 0.975, 0.999}) {
    CHECK(student_quantile(p, 1) == Approx(std::tan(std::numbers::pi * (p - 0.5))).epsilon(1e-12));
    const double a = 2 * p - 1;
    CHECK(student_quantile(p, 2) == Approx(a * std::sqrt(2 / (1 - a * a))).epsilon(1e-12));
    CHECK(student_tail(student_quantile(p, 7.5), 7.5) == Approx(1 - p).epsilon(1e-10));
  }
}

TEST_CASE("distributions: Fisher's F of two and two degrees of freedom") {
  for (const double f : {0.1, 1.0, 19.0, 1e6}) {
    CHECK(fisher_cdf(f, 2, 2) == Approx(f / (1 + f)).epsilon(1e-12));
    CHECK(fisher_tail(f, 2, 2) == Approx(1 / (1 + f)).epsilon(1e-12));
    CHECK(fisher_upper_quantile(1 / (1 + f), 2, 2) == Approx(f).epsilon(1e-10));
  }
}

TEST_CASE("distributions: four fair coins") {
  CHECK(binomial_cdf(0, 4, 0.5) == Approx(1.0 / 16).epsilon(1e-13));
  CHECK(binomial_tail(2, 4, 0.5) == Approx(5.0 / 16).epsilon(1e-13));
  CHECK(binomial_tail(4, 4, 0.5) == 0);
}
