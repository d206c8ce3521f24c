// Digits of doubles: as std::to_chars and std::from_chars of this machine's C++ library, also where
// ours do it (test_platform).

#include "libchar/core/text/double_text.hpp"

#include <bit>
#include <catch2/catch.hpp>
#include <charconv>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

using namespace libchar::detail;

namespace {

std::string written(double value) {
  char text[40];
  return {text, write_double(text, text + sizeof text, value).ptr};
}

std::string written_by_library(double value) {
  char text[40];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

void check_read(const std::string& text) {
  double ours = 7, theirs = 7;
  const auto a = read_double(text.data(), text.data() + text.size(), ours);
  const auto b = std::from_chars(text.data(), text.data() + text.size(), theirs);
  INFO(text);
  CHECK(a.ec == b.ec);
  CHECK(a.ptr == b.ptr);
  if (b.ec == std::errc())
    CHECK((std::bit_cast<std::uint64_t>(ours) == std::bit_cast<std::uint64_t>(theirs) || std::isnan(theirs)));
}

std::vector<double> odd_values() {
  std::vector<double> values = {0.0,
                                -0.0,
                                1,
                                -1,
                                0.1,
                                1.0 / 3,
                                1e15,
                                1e16,
                                1e17,
                                1e21,
                                1e22,
                                123456789012345680000.0,
                                9007199254740993.0,
                                100000,
                                1e5,
                                123456,
                                1e-4,
                                1e-5,
                                0.00012,
                                5e-324,
                                2.2250738585072014e-308,
                                1.7976931348623157e308,
                                0x1p63,
                                0x1p64,
                                std::numeric_limits<double>::infinity(),
                                -std::numeric_limits<double>::infinity(),
                                std::nan("")};
  std::mt19937_64 random(20);
  for (int i = 0; i < 20000; ++i) {
    values.push_back(std::bit_cast<double>(random()));
    values.push_back(static_cast<double>(random() % 2000000) * std::pow(10.0, static_cast<int>(random() % 40) - 20));
  }
  return values;
}

}  // namespace

TEST_CASE("double text: the shortest digits, in the notation of the C++ library") {
  for (const double value : odd_values()) {
    if (std::isnan(value)) {
      CHECK(written(std::fabs(value)) == "nan");
      continue;
    }
    const std::string text = written(value);
    if (text != written_by_library(value)) CHECK(text == written_by_library(value));
    check_read(text);
  }
}

TEST_CASE("double text: any text is read as the C++ library reads it") {
  for (const char* text : {"",
                           "-",
                           "+1",
                           "1",
                           "-1.5e3",
                           "1e",
                           "1e+",
                           "1.",
                           ".5",
                           ".",
                           "e5",
                           "1e400",
                           "-1e400",
                           "1e-400",
                           "-1e-400",
                           "0e-400",
                           "0.0000",
                           "5e-324",
                           "2e-324",
                           "1,5",
                           "0x10",
                           "inf",
                           "-inf",
                           "INF",
                           "infinity",
                           "nan",
                           "NaN",
                           "1 ",
                           " 1",
                           "1e5x",
                           "00012",
                           "123456789012345678901234567890",
                           "1.7976931348623159e308",
                           "0.000000000000000000000000000000000000000000000000000000000000000001"})
    check_read(text);
}
