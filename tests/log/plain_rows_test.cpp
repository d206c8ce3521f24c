#include "libchar/log/plain_rows.hpp"

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
  PlainRows result;
  char fractional = 0;
};

// One stamp column (seconds) and one value column.
Parsed parse(std::string text, bool crlf = false) {
  const std::size_t size = text.size();
  text.append(kPlainPadding, '\0');
  Parsed out;
  out.values.assign(1000, 0);
  out.stamps.assign(1000, 0);
  const PlainColumn columns[] = {{.use = PlainColumn::Use::stamp, .stamps = out.stamps.data()},
                                 {.use = PlainColumn::Use::value, .values = out.values.data(), .fractional = &out.fractional}};
  std::vector<std::uint32_t> scratch;
  out.result = parse_plain_rows({text.data(), size}, ',', crlf, columns, 1000, scratch);
  return out;
}

bool same_bits(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0; }

}  // namespace

TEST_CASE("plain rows: known numbers") {
  if (parse("0,1\n").result.rows == 0) return;  // a processor without AVX2: the general parser does all
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

TEST_CASE("plain rows: whatever is not a plain row is not taken") {
  for (const char* text : {"0,\n", "0,nan\n", "0,1,2\n", "0\n", "0,\"1\"\n", "0,+1\n", "0,1 \n", "0, 1\n", "0,1.2.3\n", "0,.\n", "0,-\n", "0,0x1\n", "0,1e400\n",
                           "#,1\n", "\n", "0,--1\n", "0;1\n", "9223372036854775808,1\n", "0.0000000001,1\n", "0,1_0\n"}) {
    CAPTURE(text);
    CHECK(parse(text).result.rows == 0);
  }
}

TEST_CASE("plain rows: the same bits as std::from_chars on random numbers of every width") {
  if (parse("0,1\n").result.rows == 0) return;
  std::mt19937_64 random(7);
  for (int round = 0; round < 300; ++round) {
    std::string text;
    std::vector<double> expected;
    for (int row = 0; row < 1000; ++row) {
      char number[64];
      const double value = (static_cast<double>(random() >> 11U) * 0x1p-53 - 0.5) * std::pow(10.0, static_cast<double>(random() % 12));
      switch (random() % 4) {
        case 0: std::snprintf(number, sizeof number, "%.*f", static_cast<int>(random() % 15), value); break;
        case 1: std::snprintf(number, sizeof number, "%.*g", static_cast<int>(1 + random() % 17), value); break;
        case 2: std::snprintf(number, sizeof number, "%lld", static_cast<long long>(random() >> (11 + random() % 50))); break;
        default: *std::to_chars(number, number + sizeof number, value).ptr = '\0';
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
