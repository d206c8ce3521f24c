#include "libchar/core/units.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

using namespace libchar;

TEST_CASE("units as people write them") {
  const double degree = std::numbers::pi / 180;
  struct Row {
    const char* text;
    const char* symbol;
    double to_si;
  };
  const Row rows[] = {
      {"deg/s", "deg/s", degree},
      {"°/s", "deg/s", degree},
      {"dps", "deg/s", degree},
      {"DPS", "deg/s", degree},
      {" deg / s ", "deg/s", degree},
      {"deg s^-1", "deg/s", degree},
      {"rad/s", "rad/s", 1},
      {"rad s^-1", "rad/s", 1},
      {"rad·s^-1", "rad/s", 1},
      {"Rad/Sec", "rad/s", 1},
      {"deg/h", "deg/h", degree / 3600},
      {"°/hr", "deg/h", degree / 3600},
      {"deg/hour", "deg/h", degree / 3600},
      {"mdps", "mdeg/s", degree / 1000},
      {"m/s^2", "m/s²", 1},
      {"m/s2", "m/s²", 1},
      {"m s^-2", "m/s²", 1},
      {"m s-2", "m/s²", 1},
      {"m/s/s", "m/s²", 1},
      {"m/s²", "m/s²", 1},
      {"m·s⁻²", "m/s²", 1},
      {"g", "g", 9.80665},
      {"mg", "mg", 9.80665e-3},
      {"µg", "µg", 9.80665e-6},
      {"ug", "µg", 9.80665e-6},
      {"uT", "µT", 1e-6},
      {"µT", "µT", 1e-6},
      {"T", "T", 1},
      {"nT", "nT", 1e-9},
      {"gauss", "Gauss", 1e-4},
      {"mGauss", "mGauss", 1e-7},
      {"Pa", "Pa", 1},
      {"hPa", "hPa", 100},
      {"mbar", "hPa", 100},
      {"degC", "°C", 1},
      {"°C", "°C", 1},
      {"K", "K", 1},
      {"V", "V", 1},
      {"mV", "mV", 1e-3},
      {"uV", "µV", 1e-6},
      {"Hz", "Hz", 1},
      {"ns", "ns", 1e-9},
      {"us", "µs", 1e-6},
      {"s", "s", 1},
      {"%", "%", 1e-2},
  };
  for (const Row& row : rows) {
    CAPTURE(row.text);
    const auto unit = find_unit(row.text);
    REQUIRE(unit);
    CHECK(unit->symbol == row.symbol);
    CHECK(unit->to_si == Approx(row.to_si).epsilon(1e-15));
  }
}

TEST_CASE("both encodings of micro are the same unit, and case tells apart what it must") {
  CHECK(find_unit("\xC2\xB5T")->symbol == find_unit("\xCE\xBCT")->symbol);
  // Capital M is mega, small m is milli: they must not be confused.
  for (const char* text : {"Mg", "MT", "MV", "mHz", "MPa"}) {
    const auto unit = find_unit(text);
    CAPTURE(text);
    CHECK_FALSE(unit);
  }
  CHECK_FALSE(find_unit("G"));
  CHECK_FALSE(find_unit("t"));
  CHECK(find_unit("MHz")->to_si == 1e6);
}

TEST_CASE("what is no unit is none") {
  for (const char* text :
       {"", " ", "furlong", "deg/s/s/s", "|", "deg/s|dps", "0 deg/s", "1/0 deg/s", "nan deg/s", "deg/s\n"}) {
    CAPTURE(text);
    CHECK_FALSE(find_unit(text));
  }
}

TEST_CASE("a factor in front is part of the unit") {
  CHECK(find_unit("1/16.4 deg/s")->to_si == Approx(std::numbers::pi / 180 / 16.4).epsilon(1e-15));
  CHECK(find_unit("0.05 deg/s")->symbol == "0.05 deg/s");
  CHECK(find_unit("1/16384 g")->quantity == Quantity::acceleration);
}

TEST_CASE("habitual units: 1 deg/s·√s is 60 deg/√h, and a datasheet's density is one-sided") {
  const auto white = habitual_units("white_noise", "deg/s");
  REQUIRE(white.size() == 3);
  CHECK(white[0].symbol == "deg/√h");
  CHECK(white[0].factor == Approx(60).epsilon(1e-14));
  CHECK(white[1].factor == Approx(std::numbers::sqrt2).epsilon(1e-14));
  CHECK(white[0].reading == Reading::plain);
  CHECK(white[1].reading == Reading::one_sided);
  CHECK(white[2].reading == Reading::two_sided);
  CHECK(habitual_units("bias_instability", "deg/s")[1].reading == Reading::floor);
  CHECK(habitual_units("white_noise", "rad/s")[0].factor == Approx(60 * 180 / std::numbers::pi).epsilon(1e-14));
  CHECK(habitual_units("bias_instability", "deg/s")[0].factor == Approx(3600).epsilon(1e-14));
  CHECK(habitual_units("random_walk", "deg/s")[0].factor == Approx(3600.0 * 60).epsilon(1e-14));
  CHECK(habitual_units("quantization", "deg/s")[0].factor == Approx(3600).epsilon(1e-14));
  CHECK(habitual_units("rate_ramp", "deg/s")[0].factor == Approx(3600.0 * 3600).epsilon(1e-14));
  CHECK(habitual_units("white_noise", "m/s^2")[1].factor == Approx(1e6 / 9.80665 * std::numbers::sqrt2).epsilon(1e-14));
  CHECK(habitual_units("white_noise", "g")[0].factor == Approx(60 * 9.80665).epsilon(1e-14));
  CHECK(habitual_units("bias_instability", "m/s^2")[1].factor == Approx(1e6 / 9.80665 * 0.66428247034).epsilon(1e-9));
  const auto pressure = habitual_units("white_noise", "hPa");
  REQUIRE(pressure.size() == 1);
  CHECK(pressure[0].factor == Approx(std::numbers::sqrt2).epsilon(1e-14));
  CHECK(pressure[0].symbol == "hPa/√Hz");
  CHECK(pressure[0].reading == Reading::one_sided);
  CHECK(habitual_units("bias_instability", "hPa")[0].symbol == "hPa");
  CHECK(habitual_units("white_noise", "furlong").empty());
  CHECK(habitual_units("ramp", "V").empty());
}

TEST_CASE("units of the coefficients") {
  CHECK(term_unit("white_noise", "deg/s") == "deg/s·√s");
  CHECK(term_unit("random_walk", "g") == "g/√s");
  CHECK(term_unit("bias_instability", "") == "U");
  CHECK(term_unit("quantization", "V") == "V·s");
  CHECK(term_unit("rate_ramp", "V") == "V/s");
}

TEST_CASE("the unit of a term keeps a unit of several words together") {
  CHECK(term_unit("white_noise", "1/16.4 deg/s") == "(1/16.4 deg/s)·√s");
  CHECK(term_unit("bias_instability", "1/16.4 deg/s") == "1/16.4 deg/s");
  CHECK(term_unit("random_walk", "deg/s") == "deg/s/√s");
}
