// Files of increments by NumPy (fixtures/arrays/make.py): at 200 Hz an increment of 1 is 200 times the preset's scale.

#include <catch2/catch.hpp>

#include "tests/log/array_log.hpp"

using namespace libchar;
using test::array_fault;
using test::array_log;

namespace {

ReadOptions by(const std::string& preset) {
  ReadOptions options;
  options.unsaid.preset = preset;
  return options;
}

}  // namespace

TEST_CASE("imu: increments times rate times scale of each preset") {
  struct Expected {
    const char *preset, *file;
    double gyro, accel;  // of an increment of 1 at 200 Hz, by hand
  };
  // 0.1 arc seconds · 200 Hz = 20"/s = 20 / 3600 · π / 180 rad/s
  const Expected all[] = {{"IMAR", "int.imu", 9.69627362219072e-05, 3.05176e-04},
                          {"LN200", "int.imu", 9.5367431640625e-05, 1.220703125e-02},
                          {"LN200IG", "int.imu", 3.814697265625e-04, 1.220703125e-02},
                          {"IXSEA", "float.imu", 9.69627362219072e-04, 0.2},
                          {"NAVCHIP_INT", "int.imu", 1.25e-03, 7.8125e-03},
                          {"NAVCHIP_FLT", "float.imu", 9.69627362219072e-04, 0.2}};
  for (const Expected& expected : all) {
    INFO(expected.preset);
    const Recording log = array_log(expected.file, by(expected.preset));
    REQUIRE(log.info.channels.size() == 6);
    CHECK(log.info.time.rate_hz == Approx(200).epsilon(1e-9));
    CHECK(log.info.time.start_ns == 1000'000'000'000);
    CHECK(log.info.channels[0].name == "gyro_x");
    CHECK(log.info.channels[0].unit == "rad/s");
    CHECK(log.info.channels[5].unit == "m/s^2");
    CHECK(log.samples[2][10] == Approx(20 * expected.gyro).epsilon(1e-12));
    CHECK(log.samples[1][19] == Approx(-19 * expected.gyro).epsilon(1e-12));
    CHECK(log.samples[3][10] == Approx(110 * expected.accel).epsilon(1e-12));
    CHECK(log.samples[5][19] == Approx(57 * expected.accel).epsilon(1e-12));
  }
}

TEST_CASE("imu: without a preset one sentence lists them, a wrong one is told from the times") {
  CHECK_THAT(array_fault("int.imu"),
             Catch::Contains("E0468") && Catch::Contains("IMAR, LN200, LN200IG, IXSEA, NAVCHIP_INT, NAVCHIP_FLT"));
  CHECK_THAT(array_fault("int.imu", by("LN100")), Catch::Contains("E0468") && Catch::Contains("LN100"));
  CHECK_THAT(array_fault("int.imu", by("IXSEA")),
             Catch::Contains("E0469") && Catch::Contains("those of IMAR, LN200, LN200IG, NAVCHIP_INT"));
  CHECK_THAT(array_fault("float.imu", by("LN200")),
             Catch::Contains("E0469") && Catch::Contains("those of IXSEA, NAVCHIP_FLT"));
}

TEST_CASE("imu: a cut record is counted, the whole ones are read") {
  const std::string bytes = test::slurp(test::fixture("arrays/int.imu"));
  for (std::size_t cut = 64; cut <= bytes.size(); cut += 7) {
    Recording log;
    INFO(cut);
    CHECK(test::with_bytes("log.imu", bytes.substr(0, cut), &log, by("LN200")) == "");
    CHECK(log.info.rows == cut / 32);
    CHECK((log.info.warnings.find("trailing_bytes") != nullptr) == (cut % 32 != 0));
  }
  CHECK_THAT(test::with_bytes("log.imu", bytes.substr(0, 63), nullptr, by("LN200")), Catch::Contains("E0469"));
}

TEST_CASE("Stable32: one value a line behind # comments, with CRLF, is one channel") {
  for (const char* end : {"\r\n", "\n"}) {
    std::string text;
    for (const char* line : {"# File: PHASE.DAT", "# Date: 01/02/03  12:34:56", "# Type: Phase", "# Tau: 1.000000e+00",
                             "# # Header End", "1.234567890e-09", "2.500000000e-09", "-3.750000000e-09", "4e-9"})
      text += std::string(line) + end;
    Recording log;
    ReadOptions options;
    options.rate_hz = 1;
    CHECK(test::with_bytes("PHASE.DAT", text, &log, options) == "");
    REQUIRE(log.samples.size() == 1);
    CHECK(log.samples[0] == std::vector<double>{1.23456789e-09, 2.5e-09, -3.75e-09, 4e-9});
  }
}
