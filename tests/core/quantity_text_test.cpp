// Numbers and quantities as one types them: what each is read as, and that slips are refused.

#include "libchar/core/text/quantity_text.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <string>

#include "libchar/core/error.hpp"

using namespace libchar;

namespace {

/// What is said; empty where nothing is.
template <class Parse>
std::string refusal_of(Parse parse, const char* text) {
  try {
    parse(text);
  } catch (const Error& error) {
    CHECK(error.problem().kind == ErrorKind::usage);
    CHECK(error.problem().got == text);
    return error.what();
  }
  return "";
}

const auto kNumber = [](const char* t) { parse_number(t); };
const auto kPercent = [](const char* t) { parse_number(t, 0, 100); };
const auto kCount = [](const char* t) { parse_count(t); };
const auto kFew = [](const char* t) { parse_count(t, 1, 8); };
const auto kDuration = [](const char* t) { parse_duration_s(t); };
const auto kRate = [](const char* t) { parse_rate_hz(t); };
const auto kBytes = [](const char* t) { parse_bytes(t); };

}  // namespace

TEST_CASE("typed numbers are decimal, finite and in range") {
  CHECK(parse_number("5") == 5);
  CHECK(parse_number("+5") == 5);
  CHECK(parse_number("-5.") == -5);
  CHECK(parse_number(".5") == 0.5);
  CHECK(parse_number("-.5") == -0.5);
  CHECK(parse_number("0") == 0);
  CHECK(parse_number("0.1") == 0.1);
  CHECK(parse_number("1e-3") == 1e-3);
  CHECK(parse_number("0", 0, 100) == 0);
  CHECK(parse_number("100", 0, 100) == 100);
  for (const char* bad : {"", "+", "-", "--5", "+-5", "nan", "inf", "-inf", "0x10", "010", "-010", "1e400", "1 000",
                          "5x", "1,5", " 5", "e5"})
    CHECK_FALSE(refusal_of(kNumber, bad).empty());
  CHECK_THAT(refusal_of(kPercent, "100.5"), Catch::Contains("a number from 0 to 100"));
  CHECK_THAT(refusal_of(kPercent, "-0.1"), Catch::Contains("a number from 0 to 100"));
  CHECK_THAT(refusal_of([](const char* t) { parse_number(t, 1); }, "0"), Catch::Contains("a number not below 1"));
  CHECK_THAT(refusal_of([](const char* t) { parse_number(t, -1e308 * 10, 7); }, "8"),
             Catch::Contains("a number not above 7") || Catch::Contains("from"));
}

TEST_CASE("typed counts are digits, nothing else") {
  CHECK(parse_count("0") == 0);
  CHECK(parse_count("18446744073709551615") == UINT64_MAX);
  CHECK(parse_count("1", 1, 8) == 1);
  CHECK(parse_count("8", 1, 8) == 8);
  for (const char* bad : {"", "-1", "+1", "01", "00", "1e6", "1.0", "1_000", "18446744073709551616"})
    CHECK_FALSE(refusal_of(kCount, bad).empty());
  CHECK_THAT(refusal_of(kFew, "0"), Catch::Contains("a whole number from 1 to 8"));
  CHECK_THAT(refusal_of(kFew, "9"), Catch::Contains("a whole number from 1 to 8"));
  CHECK_THAT(refusal_of([](const char* t) { parse_count(t, 2); }, "1"), Catch::Contains("a whole number not below 2"));
}

TEST_CASE("typed durations, rates and sizes have their units") {
  CHECK(parse_duration_s("90") == 90);
  CHECK(parse_duration_s("90 s") == 90);
  CHECK(parse_duration_s("250ms") == 0.25);
  CHECK(parse_duration_s("10us") == 1e-5);
  CHECK(parse_duration_s("10µs") == 1e-5);
  CHECK(parse_duration_s("3ns") == 3e-9);
  CHECK(parse_duration_s("5min") == 300);
  CHECK(parse_duration_s("1.5h") == 5400);
  CHECK(parse_duration_s("2d") == 172800);
  CHECK(parse_duration_s("0") == 0);
  for (const char* bad : {"-1", "5 m", "5sec", "1e12", "nan", "s", ""})
    CHECK_THAT(refusal_of(kDuration, bad), Catch::Contains("a duration such as"));
  CHECK(parse_rate_hz("200") == 200);
  double off = 0;
  for (const char* text : {"200±0.5Hz", "200Hz±0.5Hz", "200 +- 0.5", "200Hz+/-0.25%", "0.2±0.0005kHz"}) {
    INFO(text);
    CHECK(parse_rate_hz(text, off) == Approx(200));
    CHECK(off == Approx(0.5));
  }
  CHECK(parse_rate_hz("1/300", off) == 1.0 / 300);
  CHECK(off == 0);
  for (const char* text : {"200±", "±0.5", " ±0.5", "200±-1", "200±x", "200Hz±200%"})
    CHECK_THROWS_AS(parse_rate_hz(text, off), Error);
  CHECK(parse_rate_hz("200Hz") == 200);
  CHECK(parse_rate_hz("500mHz") == 0.5);
  CHECK(parse_rate_hz("1.5kHz") == 1500);
  CHECK(parse_rate_hz("10MHz") == 1e7);
  CHECK(parse_rate_hz("1e-9") == 1e-9);
  CHECK(parse_rate_hz("1e9") == 1e9);
  CHECK(parse_rate_hz("1/300") == 1.0 / 300);
  CHECK(parse_rate_hz("1/300Hz") == 1.0 / 300);
  CHECK(parse_rate_hz("60/min") == 1);
  CHECK(parse_rate_hz("1/h") == 1.0 / 3600);
  CHECK(parse_rate_hz("5min") == 1.0 / 300);
  CHECK(parse_rate_hz("2ms") == 500);
  for (const char* bad : {"0", "-5", "9e-10", "1.1e9", "5GHz", "5 per s", "1/0", "/5", "0s"})
    CHECK_THAT(refusal_of(kRate, bad), Catch::Contains("a sampling rate above zero"));
  CHECK(parse_bytes("4096") == 4096);
  CHECK(parse_bytes("64k") == 65536);
  CHECK(parse_bytes("64KiB") == 65536);
  CHECK(parse_bytes("64kB") == 64000);
  CHECK(parse_bytes("64KB") == 64000);
  CHECK(parse_bytes("4MiB") == 4194304);
  CHECK(parse_bytes("4M") == 4194304);
  CHECK(parse_bytes("4MB") == 4000000);
  CHECK(parse_bytes("2GB") == 2000000000);
  CHECK(parse_bytes("2G") == 2147483648);
  CHECK(parse_bytes("0.5k") == 512);
  CHECK(parse_bytes("0") == 0);
  CHECK(parse_bytes("9007199254740992") == 9007199254740992);  // 2^53
  for (const char* bad : {"-1", "0.5", "1.0001k", "9007199254740994", "1e300GB", "5TB"})
    CHECK_THAT(refusal_of(kBytes, bad), Catch::Contains("a size such as"));
}

TEST_CASE("a range has two ends, and one that is left out is open") {
  const double open = std::numeric_limits<double>::infinity();
  const struct {
    const char* text;
    double low, high;
  } rows[] = {{"10..600", 10, 600}, {"10s..end", 10, open}, {"1min..2min", 60, 120},
              {"50..", 50, open},   {"..50", 0, 50},        {"250ms..1h", 0.25, 3600}};
  for (const auto& row : rows) {
    INFO(row.text);
    const Interval range = parse_range(row.text);
    CHECK(range.low == row.low);
    CHECK(range.high == row.high);
  }
  const Interval band = parse_range("100..1.5kHz", RangeOf::rate_hz);
  CHECK(band.low == 100);
  CHECK(band.high == 1500);
  for (const char* text : {"", "..", "..end", "50", "50..10", "10..10", "-1..2", "a..b", "1..2x"}) {
    INFO(text);
    CHECK_THROWS_WITH(parse_range(text), Catch::Contains("E0201"));
  }
  CHECK_THROWS_WITH(parse_range("1s..2s", RangeOf::rate_hz), Catch::Contains("E0201"));
  const Interval above = parse_range("1..", RangeOf::number), below = parse_range("..-2.5", RangeOf::number);
  CHECK(above.low == 1);
  CHECK(std::isinf(above.high));
  CHECK(below.low == -std::numeric_limits<double>::infinity());
  CHECK(below.high == -2.5);
  CHECK_THROWS_WITH(parse_range("3..1", RangeOf::number, "--x-range"),
                    Catch::StartsWith("--x-range: error E0201: expected LOW..HIGH"));
}
