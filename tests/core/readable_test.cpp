#include "libchar/core/readable.hpp"

#include <catch2/catch.hpp>
#include <limits>

using namespace libchar;

TEST_CASE("numbers with few digits") {
  CHECK(number_text(0.0049812345) == "0.004981");
  CHECK(number_text(1.23456e-5, 3) == "1.23×10⁻⁵");
  CHECK(number_text(-1.5e12, 2) == "-1.5×10¹²");
  CHECK(number_text(12345.678, 4) == "12346");
  CHECK(number_text(0.00099999, 4) == "0.001000");
  CHECK(number_text(0) == "0");
  CHECK(number_text(std::numeric_limits<double>::quiet_NaN()) == "–");
  CHECK(number_text(9.9999, 3) == "10.0");  // rounding up to the next power of ten
}

TEST_CASE("digits follow the uncertainty: two digits of it") {
  CHECK(digits_for(0.0016) == 4);
  CHECK(digits_for(0.05) == 3);
  CHECK(digits_for(0.3) == 2);
  CHECK(digits_for(2) == 2);
  CHECK(digits_for(1e-9) == 6);
}

TEST_CASE("durations in the unit one would say") {
  CHECK(duration_text(0) == "0 s");
  CHECK(duration_text(2.5e-6) == "2.50 µs");
  CHECK(duration_text(0.0125) == "12.5 ms");
  CHECK(duration_text(90) == "90.0 s");
  CHECK(duration_text(600) == "10.0 min");
  CHECK(duration_text(36000) == "10.0 h");
  CHECK(duration_text(864000) == "10.0 d");
  CHECK(place_text(2153.6698) == "2153.67");
  CHECK(place_text(1290550.4) == "1290550");
  CHECK(duration_text(3.15576e8) == "10.0 years");
}

TEST_CASE("coefficients: value with interval, limit, nothing") {
  Coefficient c;
  CHECK(coefficient_text(c) == "–");
  c.status = Status::not_detected;
  c.upper95 = 2e-4;
  CHECK(coefficient_text(c, 10) == "≤ 0.00200");
  c.status = Status::detected;
  c.value = 0.005;
  c.ci95 = {0.00498, 0.00502};
  CHECK(coefficient_text(c) == "0.005000 [0.004980, 0.005020]");
  CHECK(value_text(c, 60) == "0.3000");
}

TEST_CASE("counts and probabilities") {
  CHECK(count_text(999) == "999");
  CHECK(count_text(1234567) == "1\u202F234\u202F567");
  CHECK(probability_text(0.42) == "p = 0.42");
  CHECK(probability_text(3e-33) == "p < 0.0001");
  CHECK(probability_text(0.005, 199) == "p ≤ 0.005");
  CHECK(probability_text(0.01, 199) == "p = 0.010");
}

TEST_CASE("digits that an uncertainty leaves, none at all as well") {
  CHECK(digits_for(0.001) == 4);
  CHECK(digits_for(0.3) == 2);
  CHECK(digits_for(std::numeric_limits<double>::infinity()) == 2);
  CHECK(digits_for(std::numeric_limits<double>::quiet_NaN()) == 4);
  CHECK(digits_for(1e-300) == 6);
}
