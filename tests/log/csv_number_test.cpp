#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <charconv>
#include <cmath>
#include <random>
#include <string>

#include "libchar/log/csv/rows/number.hpp"

using namespace libchar::csv;

namespace {

std::uint64_t bits(double x) { return std::bit_cast<std::uint64_t>(x); }

struct Quick {
  bool taken = false, integer = false;
  double value = 0;
};

// The text as it stands in a file: something behind it, readable padding.
Quick quick(const std::string& text, char point = '.') {
  const std::string padded = text + "," + std::string(64, '7');
  Quick result;
  const char* const end = quick_number(padded.data(), point, result.value, result.integer);
  result.taken = end != nullptr;
  if (result.taken) REQUIRE(static_cast<std::size_t>(end - padded.data()) == text.size());
  return result;
}

double reference(const std::string& text) {
  double value = 0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  REQUIRE(status == std::errc());
  REQUIRE(end == text.data() + text.size());
  return value;
}

}  // namespace

TEST_CASE("the quick number gives the bits of from_chars, whatever the way of writing") {
  std::mt19937_64 random(20240611);
  std::normal_distribution<double> noise;
  std::uint64_t taken = 0, tried = 0;
  const auto check = [&](const std::string& text) {
    const Quick q = quick(text);
    ++tried;
    taken += q.taken;
    if (q.taken && bits(q.value) != bits(reference(text))) FAIL(text << " " << q.value);
  };
  for (int i = 0; i < 300000; ++i) {
    const double x = noise(random) * std::pow(10.0, static_cast<double>(random() % 12) - 6);
    check(fmt::format("{}", x));
    check(fmt::format("{:.17g}", x));
    check(fmt::format("{:.9g}", x));
    check(fmt::format("{:.6f}", x));
    check(fmt::format("{:.3e}", x));
  }
  // Nearly everything a logger writes takes the quick way.
  CHECK(static_cast<double>(taken) > 0.99 * static_cast<double>(tried));
  for (int i = 0; i < 300000; ++i) {
    const std::uint64_t any = random();
    const double x = std::bit_cast<double>(any);
    if (std::isfinite(x)) check(fmt::format("{}", x));
    check(fmt::format("{}", any));
    check(fmt::format("0.{}", any));
    check(fmt::format("{}.{}", any % 1000, random() >> (random() % 60)));
    check(fmt::format("0.{}{}", std::string(random() % 12, '0'), any % 1000000));
  }
}

TEST_CASE("numbers halfway between two doubles round to even") {
  // m + 1/2 ulp with m odd and even, written out in full: 2^53 + 1 and its kin, shifted below the mark.
  for (const char* text :
       {"9007199254740993", "9007199254740995", "900719925474099.3", "9007199254740.993", "1.0000000000000002",
        "4503599627370496.5", "4503599627370497.5", "450359962737049.65", "0.5", "0.25", "2.50", "1125899906842624.125",
        "1125899906842624.375", "0.000000000000001", "18446744073709551615", "9223372036854775807.5"}) {
    const Quick q = quick(text);
    if (q.taken) CHECK(bits(q.value) == bits(reference(text)));
  }
}

TEST_CASE("the quick number leaves to the slow way what is not plainly a number") {
  for (const char* text :
       {"", "-", "+1", ".", "-.", "e5", "1e", "1e+", "nan", "inf", "12345678901234567890", "1e99999", "0x", " 1"}) {
    const std::string padded = std::string(text) + "," + std::string(64, ' ');
    double value = 0;
    bool integer = false;
    const char* const end = quick_number(padded.data(), '.', value, integer);
    INFO(text);
    CHECK((end == nullptr || end - padded.data() < static_cast<std::ptrdiff_t>(std::string(text).size())));
  }
  CHECK(std::signbit(quick("-0").value));
  CHECK(std::signbit(quick("-0.0").value));
  CHECK(quick("5.").value == 5);
  CHECK(quick(".5").value == 0.5);
  CHECK(quick("1,5", ',').value == 1.5);
  CHECK(quick("7").integer);
  CHECK_FALSE(quick("7.0").integer);
}

TEST_CASE("a cell is one finite number, missing, infinite or wrong") {
  const auto kind = [](const char* text) { return read_cell(text, '.').kind; };
  for (const char* text : {"", "nan", "NaN", "NA", "null", "-nan", "N/A"}) CHECK(kind(text) == Cell::missing);
  for (const char* text : {"inf", "-inf", "Infinity", "+INF"}) CHECK(kind(text) == Cell::infinite);
  for (const char* text : {"1e400", "-1e400", "4e492493924924", "123e99999999999999999999"})
    CHECK(kind(text) == Cell::out_of_range);
  for (const char* text :
       {"1,5", "0x1p3", "1.5abc", "1'000", "1d5", "1 000", "--1", "+-1", ".", "e", "1e", "1e+", "1_0",
        "\xE2\x88\x92"
        "1",
        "true", "1.2.3"})
    CHECK(kind(text) == Cell::bad);
  CHECK(read_cell("1e-400", '.').number == 0);
  CHECK(std::signbit(read_cell("-1e-400", '.').number));
  CHECK(read_cell("5e-324", '.').number == 5e-324);
  CHECK(read_cell("3e-324", '.').number == 5e-324);
  CHECK(read_cell("1e-310", '.').number == 1e-310);
  CHECK(read_cell("2.2250738585072011e-308", '.').number == 2.2250738585072011e-308);
  CHECK(read_cell("+1.5", '.').number == 1.5);
  CHECK(read_cell("1,5", ',').number == 1.5);
  CHECK(read_cell("1.5", ',').kind == Cell::bad);
  CHECK(read_cell("9007199254740993", '.').inexact_integer);
  CHECK_FALSE(read_cell("9007199254740994", '.').inexact_integer);
  CHECK(read_cell("1_000", '.').offset == 1);
  CHECK(read_cell("--1", '.').offset == 0);
  CHECK(kind("+") == Cell::bad);
  CHECK(kind("-") == Cell::missing);
  for (const char* none : {"--", "---", "-----", "****", "?", "#N/A", "#DIV/0!", "#VALUE!", "<NA>", "n.a."})
    CHECK(kind(none) == Cell::missing);
  for (const char* not_none : {"-*", "--1", "**2", "#N/B", "-?"}) CHECK(kind(not_none) != Cell::missing);
}

TEST_CASE("a cell that is no number is told with reason and place") {
  struct Wrong {
    const char* text;
    std::size_t offset;
    const char* reason;
  };
  for (const Wrong& wrong :
       {Wrong{"0x1F2A", 1, "hexadecimal"}, Wrong{"--1", 0, "two signs"}, Wrong{"-+1", 0, "two signs"},
        Wrong{"1e", 0, "cut off in its exponent"}, Wrong{"1e-", 0, "cut off in its exponent"},
        Wrong{".", 0, "without digits"}, Wrong{"1_0", 1, "underscore"}, Wrong{"1,000.5", 1, "thousands separator"},
        Wrong{"1.2.3", 3, "second decimal mark"}, Wrong{"12abc", 2, "expected to end here"},
        Wrong{"1e5x", 3, "expected to end here"}, Wrong{"-abc", 0, "a number was expected"},
        Wrong{"\xE2\x88\x92"
              "1",
              0, "U+2212"},
        Wrong{"1\xC2\xA0"
              "0",
              1, "no-break space"},
        Wrong{"\xE2\x80\x8B"
              "1",
              0, "zero-width"},
        Wrong{"\x1A", 0, "Ctrl-Z"}}) {
    const Cell cell = read_cell(wrong.text, '.');
    INFO(wrong.text << ": " << cell.reason);
    CHECK(cell.kind == Cell::bad);
    CHECK(cell.offset == wrong.offset);
    CHECK(std::string(cell.reason).find(wrong.reason) != std::string::npos);
  }
  CHECK(read_cell("1.5", ',').offset == 1);
}

TEST_CASE("the sign of an exponent is one character, and underflow and overflow know their side") {
  for (const char* text : {"1e-5", "1e+5", "1E5", "2.5e-3"}) CHECK(read_cell(text, '.').number == reference(text));
  CHECK(read_cell("0.0001e-330", '.').number == 0);
  CHECK(read_cell("1000000e-330", '.').number == 0);
  CHECK(read_cell("0.0001e400", '.').kind == Cell::out_of_range);
  CHECK(read_cell("123456789e305", '.').kind == Cell::out_of_range);
}

TEST_CASE("a literal of 800 digits is rounded once") {
  // 2^-1 + 2^-54 exactly halfway, then one digit 700 places later that breaks the tie upwards.
  const std::string half = "0.500000000000000055511151231257827021181583404541015625";
  CHECK(read_cell(half, '.').number == 0.5);
  CHECK(read_cell(half + std::string(740, '0') + "1", '.').number == std::nextafter(0.5, 1.0));
}

TEST_CASE("time stamps become whole nanoseconds exactly") {
  const auto stamp = [](const std::string& text, std::int64_t unit) {
    std::int64_t ns = 0, quick_ns = 0;
    std::size_t offset = 0;
    REQUIRE(read_stamp(text, '.', unit, ns, offset) == StampDefect::none);
    const std::string padded = text + "," + std::string(32, '9');
    int digits = 0;
    for (std::int64_t u = unit; u > 1; u /= 10) ++digits;
    if (const char* end = quick_stamp(padded.data(), '.', digits, quick_ns); end != nullptr && *end == ',')
      CHECK(quick_ns == ns);
    return ns;
  };
  CHECK(stamp("1403636579758555392", 1) == 1403636579758555392);
  CHECK(stamp("1403636579.758555392", 1000000000) == 1403636579758555392);
  CHECK(stamp("0.1", 1000000000) == 100000000);
  CHECK(stamp("-0.000000001", 1000000000) == -1);
  CHECK(stamp("9.364549000E-3", 1000000000) == 9364549);
  CHECK(stamp("1e3", 1000000) == 1000000000);
  CHECK(stamp("0.0000000005", 1000000000) == 0);  // half to even
  CHECK(stamp("0.0000000015", 1000000000) == 2);
  CHECK(stamp("0.00000000050000000000000000000000000000000001", 1000000000) == 1);
  CHECK(stamp("9223372036854775807", 1) == INT64_MAX);
  CHECK(stamp("-9223372036854775808", 1) == INT64_MIN);
  CHECK(stamp("1.5", 60000000000) == 90000000000);
  // 27 digits of hours are more than 128 bits hold in nanoseconds.
  CHECK(stamp("0.123456789012345678901234567", 3600000000000) == 444444440444);
  std::int64_t ns = 0;
  std::size_t offset = 0;
  CHECK(read_stamp("9223372036854775808", '.', 1, ns, offset) == StampDefect::out_of_range);
  CHECK(read_stamp("18446744073709551616", '.', 1, ns, offset) == StampDefect::out_of_range);
  CHECK(read_stamp("1e30", '.', 1, ns, offset) == StampDefect::out_of_range);
  CHECK(read_stamp("", '.', 1, ns, offset) == StampDefect::missing);
  CHECK(read_stamp("nan", '.', 1, ns, offset) == StampDefect::missing);
  CHECK(read_stamp("12:30", '.', 1, ns, offset) == StampDefect::malformed);
  CHECK(read_stamp("1e", '.', 1, ns, offset) == StampDefect::malformed);
  CHECK(read_stamp("-", '.', 1, ns, offset) == StampDefect::missing);
  // Found by fuzzing: two signs in an exponent, and text behind an exponent that nothing can have.
  for (const char* text : {"1e+-5", "1e++5", "0e99999x", "1e99999x", "0e-99999 "}) {
    INFO(text);
    CHECK(read_stamp(text, '.', 1000000000, ns, offset) == StampDefect::malformed);
  }
  ns = 1;
  CHECK(read_stamp("0e99999", '.', 1, ns, offset) == StampDefect::none);
  CHECK(ns == 0);
  CHECK(read_stamp("1e99999", '.', 1, ns, offset) == StampDefect::out_of_range);
}
