// Partial states as bytes: what was written comes back, and what is not that is refused.

#include "libchar/core/numeric/state_archive.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "libchar/core/error.hpp"

using namespace libchar;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

std::string some_state(std::uint32_t version = 3) {
  StateWriter to("sample", version);
  to.number(0xFEDCBA9876543210U);
  to.real(-0.1);
  for (const long double x : {1 / 3.0L, -1e4000L, 0.0L, -0.0L, 3e-4940L}) to.wide(x);
  to.wide(std::numeric_limits<long double>::infinity());
  to.wide(std::numeric_limits<long double>::quiet_NaN());
  to.flag(true);
  to.text(std::string("nul \0 in it", 11));
  to.reals(std::vector<double>{1, kNan, -0.0});
  to.numbers(std::vector<std::uint64_t>{7, 8});
  to.flags(std::vector<unsigned char>{1, 0, 1});
  to.texts(std::vector<std::string>{"a", ""});
  return to.finish();
}

void read_all(StateReader& from) {
  REQUIRE(from.number() == 0xFEDCBA9876543210U);
  REQUIRE(from.real() == -0.1);
  for (const long double x : {1 / 3.0L, -1e4000L, 0.0L, -0.0L, 3e-4940L}) {
    const long double back = from.wide();
    REQUIRE(back == x);
    REQUIRE(std::signbit(back) == std::signbit(x));
  }
  REQUIRE(from.wide() == std::numeric_limits<long double>::infinity());
  REQUIRE(std::isnan(from.wide()));
  REQUIRE(from.flag());
  REQUIRE(from.text() == std::string("nul \0 in it", 11));
  const std::vector<double> reals = from.reals();
  REQUIRE(reals.size() == 3);
  REQUIRE(reals[0] == 1);
  REQUIRE(std::isnan(reals[1]));
  REQUIRE(std::signbit(reals[2]));
  REQUIRE(from.numbers() == std::vector<std::uint64_t>{7, 8});
  REQUIRE(from.flags() == std::vector<unsigned char>{1, 0, 1});
  REQUIRE(from.texts() == std::vector<std::string>{"a", ""});
  from.finish();
}

std::string state_refusal(const std::string& bytes, std::uint32_t version = 3) {
  try {
    StateReader from(bytes, "x.state", "sample", version);
  } catch (const Error& error) {
    REQUIRE(error.problem().code == "E0723");
    REQUIRE(error.problem().where == "x.state");
    return error.problem().what;
  }
  return "";
}

}  // namespace

TEST_CASE("state archive: every number comes back with its bits") {
  const std::string bytes = some_state();
  StateReader from(bytes, "x.state", "sample", 3);
  read_all(from);
}

TEST_CASE("state archive: a byte that is another one, or is not there, is told") {
  const std::string whole = some_state();
  for (std::size_t i = 0; i < whole.size(); ++i) {
    std::string other = whole;
    other[i] = static_cast<char>(other[i] ^ 0x10);
    CAPTURE(i);
    REQUIRE_FALSE(state_refusal(other).empty());
    REQUIRE_FALSE(state_refusal(whole.substr(0, i)).empty());
  }
  REQUIRE(state_refusal(whole + " ") == "is damaged: its digest is another one");
  REQUIRE(state_refusal("") == "is empty");
  REQUIRE(state_refusal("some text") == "is not a partial state");
}

TEST_CASE("state archive: another kind or version is named") {
  REQUIRE(state_refusal(some_state(4)) == "is of version 4; this program reads version 3");
  const std::string other = StateWriter("other", 3).finish();
  REQUIRE(state_refusal(other) == "is a state of other, not of sample");
}

TEST_CASE("state archive: a list longer than what follows takes no memory") {
  StateWriter to("sample", 1);
  to.number(std::uint64_t{1} << 60U);
  const std::string bytes = to.finish();
  StateReader from(bytes, "x.state", "sample", 1);
  REQUIRE_THROWS_AS(from.reals(), Error);
}
