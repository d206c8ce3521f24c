#include "libchar/core/text/readable.hpp"

#include <catch2/catch.hpp>
#include <limits>

#include "libchar/core/text/shown.hpp"

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
  CHECK(number_text(0.000123) == "0.0001230");
}

TEST_CASE("numbers of a sentence: no zeros behind, never an exponent of a program") {
  CHECK(brief_text(200, 6) == "200");
  CHECK(brief_text(0.05) == "0.05");
  CHECK(brief_text(199.997, 6) == "199.997");
  CHECK(brief_text(1812.4) == "1812");
  CHECK(brief_text(1.2e-7, 4) == "1.2×10⁻⁷");
  CHECK(brief_text(-0.0) == "0");
  CHECK(brief_text(std::numeric_limits<double>::infinity()) == "–");
  CHECK(power_of_ten(-12) == "10⁻¹²");
  CHECK(percent_text(0.0037) == "0.37 %");
  CHECK(percent_text(std::numeric_limits<double>::quiet_NaN()) == "–");
}

TEST_CASE("how much above the best possible: hundredths of a per cent, then times") {
  CHECK(excess_text(3e-7) == "0.00 %");
  CHECK(excess_text(0.0012) == "0.12 %");
  CHECK(excess_text(0.853) == "85.3 %");
  CHECK(excess_text(260.7009) == "262 ×");
  CHECK(excess_text(std::numeric_limits<double>::quiet_NaN()) == "–");
}

TEST_CASE("intervals: both ends with the digits of the value, infinity in words") {
  CHECK(interval_text({0.5, 2}, 2) == "0.50 … 2.0");
  CHECK(end_text(3e-5, 1.2e-5, 2) == "3.0×10⁻⁵");
  CHECK(end_text(0.03, 1.1e-16, 2) == "0.030");
  CHECK(interval_text({0.5, std::numeric_limits<double>::infinity()}, 2) == "0.50 … no end");
  CHECK(interval_text({std::numeric_limits<double>::quiet_NaN(), 2}) == "–");
}

TEST_CASE("digits follow the uncertainty: two digits of it") {
  CHECK(digits_for(0.0016) == 4);
  CHECK(digits_for(0.05) == 3);
  CHECK(digits_for(0.3) == 2);
  CHECK(digits_for(2) == 2);
  CHECK(digits_for(1e-9) == 6);
}

TEST_CASE("frequencies have the unit that fits") {
  CHECK(detail::frequency_text(0) == "0 Hz");
  CHECK(detail::frequency_text(25) == "25 Hz");
  CHECK(detail::frequency_text(12500, 6) == "12500 Hz");
  CHECK(detail::frequency_text(0.5) == "0.5 Hz");
  CHECK(detail::frequency_text(1.0 / 60, 6) == "16.6667 mHz");
  CHECK(detail::frequency_text(3.26e-5) == "32.6 µHz");
  CHECK(detail::frequency_text(2e-9) == "2 nHz");
  CHECK(detail::frequency_text(1.25e6) == "1250 kHz");
  CHECK(detail::frequency_text(10e6) == "10 MHz");
  CHECK(detail::frequency_text(10e9) == "10 GHz");
  CHECK(detail::frequency_text(std::nan("")) == "–");
}

TEST_CASE("a value and its uncertainty have the same decimals") {
  CHECK(detail::plus_minus_text(-18, 9.5) == "-18.0 ± 9.5");
  CHECK(detail::plus_minus_text(0.0031, 0.00062) == "0.00310 ± 0.00062");
  CHECK(detail::plus_minus_text(52.8, 1.1) == "52.8 ± 1.1");
  CHECK(detail::plus_minus_text(1234567, 1200) == "(1.2346 ± 0.0012)×10⁶");
  CHECK(detail::plus_minus_text(2.5e-9, 3e-10) == "(2.50 ± 0.30)×10⁻⁹");
  CHECK(detail::plus_minus_text(0, 0.5) == "0.00 ± 0.50");
  CHECK(detail::plus_minus_text(1, 4000) == "1 ± 4000");
  CHECK(detail::plus_minus_text(2, 0) == "2.000");
}

TEST_CASE("durations in the unit one would say") {
  CHECK(duration_text(0) == "0 s");
  CHECK(duration_text(2.5e-6) == "2.5 µs");
  CHECK(duration_text(0.0125) == "12.5 ms");
  CHECK(duration_text(82e-9) == "82 ns");
  CHECK(duration_text(1.2e-4, 2) == "120 µs");
  CHECK(duration_text(2508, 2) == "42 min");
  CHECK(duration_text(90) == "90 s");
  CHECK(duration_text(600) == "10 min");
  CHECK(duration_text(36000) == "10 h");
  CHECK(duration_text(864000) == "10 d");
  CHECK(place_text(2153.6698) == "2153.67");
  CHECK(place_text(1290550.4) == "1290550");
  CHECK(duration_text(3.15576e8) == "10 years");
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
