#include "libchar/log/csv/rows/vector_rows.hpp"

#include <catch2/catch.hpp>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <random>
#include <string>

using namespace libchar;

namespace {

struct Parsed {
  std::vector<double> values;
  std::vector<std::int64_t> stamps;
  VectorRows result;
  char fractional = 0;
};

// One stamp column (seconds) and one value column.
Parsed parse(std::string text, bool crlf = false) {
  const std::size_t size = text.size();
  text.append(kVectorPadding, '\0');
  Parsed out;
  out.values.assign(1000, 0);
  out.stamps.assign(1000, 0);
  const VectorColumn columns[] = {
      {.use = VectorColumn::Use::stamp, .stamps = out.stamps.data()},
      {.use = VectorColumn::Use::value, .values = out.values.data(), .fractional = &out.fractional}};
  std::vector<std::uint32_t> scratch;
  out.result = parse_vector_rows({text.data(), size}, ',', crlf, columns, 1000, scratch);
  return out;
}

bool same_bits(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0; }

}  // namespace

// Without AVX2 the general parser does all.
#define LIBCHAR_NEEDS_VECTOR_ROWS()                  \
  if (parse("0,1\n").result.rows == 0) {             \
    WARN("SKIPPED: this processor is without AVX2"); \
    return;                                          \
  }

TEST_CASE("vector rows: known numbers") {
  LIBCHAR_NEEDS_VECTOR_ROWS();
  const Parsed p = parse("0.001,-1.5\n-2,-0\n1e0,3\n");
  REQUIRE(p.result.rows == 2);  // a stamp with an exponent is left to the general parser
  CHECK(p.result.consumed == 17);
  CHECK(p.stamps[0] == 1'000'000);
  CHECK(p.stamps[1] == -2'000'000'000);
  CHECK(p.values[0] == -1.5);
  CHECK(same_bits(p.values[1], -0.0));
  CHECK(p.fractional);
  CHECK_FALSE(parse("0,1\n0,-20\n").fractional);
  CHECK(parse("0,5.\n").fractional);
  CHECK(parse("0,1e3\n").fractional);
  CHECK_FALSE(parse("0,1\n0,\n").fractional);  // found by fuzzing: a refused field made its column fractional
  CHECK_FALSE(parse("0,00000000000000000007\n").fractional);  // the same, 20 digits
  CHECK(parse("0,1\r\n", true).result.rows == 1);
  CHECK(parse("0,1\n", true).result.rows == 0);
  CHECK(parse("0,1\r\n", false).result.rows == 0);
}

TEST_CASE("vector rows: whatever is unusual is not taken") {
  for (const char* text : {"0,\n",
                           "0,nan\n",
                           "0,1,2\n",
                           "0\n",
                           "0,\"1\"\n",
                           "0,+1\n",
                           "0,1 \n",
                           "0, 1\n",
                           "0,1.2.3\n",
                           "0,.\n",
                           "0,-\n",
                           "0,0x1\n",
                           "0,1e400\n",
                           "#,1\n",
                           "\n",
                           "0,--1\n",
                           "0;1\n",
                           "9223372036854775808,1\n",
                           "0.0000000001,1\n",
                           "0,1_0\n"}) {
    CAPTURE(text);
    CHECK(parse(text).result.rows == 0);
  }
}

TEST_CASE("vector rows: the same bits as std::from_chars on random numbers of every width") {
  LIBCHAR_NEEDS_VECTOR_ROWS();
  std::mt19937_64 random(7);
  for (int round = 0; round < 300; ++round) {
    std::string text;
    std::vector<double> expected;
    for (int row = 0; row < 1000; ++row) {
      char number[64];
      const double value =
          (static_cast<double>(random() >> 11U) * 0x1p-53 - 0.5) * std::pow(10.0, static_cast<double>(random() % 12));
      switch (random() % 4) {
        case 0:
          std::snprintf(number, sizeof number, "%.*f", static_cast<int>(random() % 15), value);
          break;
        case 1:
          std::snprintf(number, sizeof number, "%.*g", static_cast<int>(1 + random() % 17), value);
          break;
        case 2:
          std::snprintf(number, sizeof number, "%lld", static_cast<long long>(random() >> (11 + random() % 50)));
          break;
        default:
          *std::to_chars(number, number + sizeof number, value).ptr = '\0';
      }
      text += "5," + std::string(number) + "\n";
      double reference = 0;
      std::from_chars(number, number + std::strlen(number), reference);
      expected.push_back(reference);
    }
    const Parsed p = parse(text);
    REQUIRE(p.result.rows == 1000);
    REQUIRE(p.result.consumed == text.size());
    for (std::size_t i = 0; i < 1000; ++i)
      if (!same_bits(p.values[i], expected[i])) FAIL("row " << i << ": " << p.values[i] << " against " << expected[i]);
  }
}

TEST_CASE("vector rows: one unusual field among regular ones is found in whatever row it stands") {
  LIBCHAR_NEEDS_VECTOR_ROWS();
  std::mt19937_64 random(8);
  for (const char* unusual : {"", "nan", "1.2.3", ".", "-", "-.", "1 ", "+1", "1_0", "--1", "\"1\"", "1/2", "1:2", ",",
                              "1,2", "12345678901234567x", "x"}) {
    for (int at = 0; at < 23; ++at) {
      std::string text;
      std::vector<double> expected;
      for (int row = 0; row < 23; ++row) {
        char number[64];
        std::snprintf(number, sizeof number, "%.9g", static_cast<double>(random() >> 11U) * 0x1p-53 - 0.5);
        text += "5," + std::string(row == at ? unusual : number) + "\n";
        expected.push_back(std::strtod(number, nullptr));
      }
      CAPTURE(unusual, at);
      const Parsed p = parse(text);
      REQUIRE(p.result.rows == static_cast<std::size_t>(at));
      for (std::size_t i = 0; i < p.result.rows; ++i) REQUIRE(same_bits(p.values[i], expected[i]));
    }
  }
}

TEST_CASE("vector rows: fields that fours cannot take, among those they can") {
  LIBCHAR_NEEDS_VECTOR_ROWS();
  const auto rows_of = [](const std::string& special) {
    std::string text;
    for (int row = 0; row < 12; ++row) text += "5," + (row == 6 ? special : "-1.5") + "\n";
    return text;
  };
  for (const std::string special :
       {"1.", "-7.", "1e-3", "9007199254740991", "9007199254740990.5", "0.1234567890123456", "-0.12345678901234567",
        "0000000000000.25", "-0", "-0.0", "999999999999999.9", "123456789.12345678"}) {
    CAPTURE(special);
    const Parsed p = parse(rows_of(special));
    REQUIRE(p.result.rows == 12);
    REQUIRE(same_bits(p.values[6], std::strtod(special.c_str(), nullptr)));
    for (const std::size_t i : {4U, 5U, 7U, 8U, 11U}) REQUIRE(p.values[i] == -1.5);
  }
  const auto fractional = [](const char* number) {
    std::string text;
    for (int row = 0; row < 9; ++row) text += "5," + std::string(row == 6 ? number : "12") + "\r\n";
    const Parsed p = parse(text, true);
    REQUIRE(p.result.rows == 9);
    return p.fractional != 0;
  };
  CHECK_FALSE(fractional("12"));
  CHECK_FALSE(fractional("-7"));
  CHECK(fractional("1.5"));
  CHECK(fractional("1.0"));
  CHECK(fractional("1."));
  CHECK(fractional("1e0"));
}
