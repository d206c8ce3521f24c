// Archives by NumPy itself (fixtures/arrays/make.py), and archives broken byte by byte.

#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "libchar/log/read.hpp"
#include "tests/log/array_log.hpp"
#include "tests/log/libraries.hpp"

using namespace libchar;
using test::array_fault;
using test::array_log;
using test::check_common_log;
using test::with_bytes;

TEST_CASE("npz: arrays of one length are one table, stored or deflated, in either order of either type") {
  NEEDS_LIBRARY(ZLIB);
  for (const char* name : {"log.npz", "compressed.npz"}) {
    INFO(name);
    const Recording log = array_log(name);
    check_common_log(log);
    CHECK(log.info.format == "npz");
    CHECK(log.info.time.column == "t");
    CHECK(log.info.time.start_ns == 0);
    CHECK(log.info.warnings.empty());
    CHECK(log.info.sha256.size() == 64);
  }
}

TEST_CASE("npz: without stamps a number called fs is the rate, and what holds no numbers is said") {
  const Recording log = array_log("rate.npz");
  CHECK(log.info.time.rate_hz == 100);
  CHECK(log.info.time.column.empty());
  CHECK_FALSE(log.info.time.from_stamps);
  REQUIRE(log.info.channels.size() == 9);
  CHECK(log.info.channels[1].name == "gyr_1");
  CHECK(log.info.channels[1].integer);
  CHECK(log.samples[1][19] == -9);  // -9.5 as i2
  CHECK(log.info.channels[8].name == "cube_5");
  CHECK(log.samples[8][19] == 119);
  const std::string said = test::joined(log.info.dialect);
  CHECK_THAT(said, Catch::Contains("fs says 100 Hz"));
  CHECK_THAT(said, Catch::Contains("label holds text") && Catch::Contains("z holds complex numbers"));
  CHECK_THAT(said, Catch::Contains("still holds truth values"));
}

TEST_CASE("npz: arrays of 3 × n are turned as the stamps say") {
  const Recording log = array_log("turned.npz");
  REQUIRE(log.info.channels.size() == 6);
  CHECK(log.info.time.column == "time_us");
  CHECK(log.info.time.unit == "us");
  CHECK(log.info.time.rate_hz == Approx(100).epsilon(1e-9));
  for (std::size_t k = 0; k < 20; ++k) {
    CHECK(log.samples[0][k] == 1000.0 + static_cast<double>(k));
    CHECK(log.samples[5][k] == static_cast<double>(k) / 4);
  }
  CHECK_THAT(test::joined(log.info.dialect), Catch::Contains("acc (3 × 20)"));
}

TEST_CASE("npz: tables of several lengths and records with stamps of their own are topics") {
  const LogInfo listing = log_listing(test::fixture("arrays/tables.npz").string(), {});
  REQUIRE(listing.topics.size() == 3);
  CHECK(listing.topics[0].name == "gyr");
  CHECK(listing.topics[1].name == "record");
  CHECK(listing.topics[2].name == "slow_t");
  CHECK(listing.topics[2].rows == 5);
  CHECK_THAT(array_fault("tables.npz"), Catch::Contains("E0427"));
  ReadOptions options;
  options.topic = "record";
  const Recording record = array_log("tables.npz", options);
  CHECK(record.info.time.start_ns == 1403636579758555393);  // odd: a double would round it
  CHECK(record.info.channels[2].name == "mag_2");
  CHECK(record.samples[2][19] == 59.0 / 8);
  CHECK(record.samples[3][19] == 19);
  options = {};
  options.channels = {"baro"};
  options.rate_hz = 10;
  CHECK(array_log("tables.npz", options).samples[0][4] == 1017.25);
}

TEST_CASE("npz: groups share the stamps above them, a name with .. is a name") {
  NEEDS_LIBRARY(ZLIB);
  const Recording log = array_log("groups.npz");
  CHECK(log.info.topic == "imu");
  REQUIRE(log.info.channels.size() == 2);
  CHECK(log.info.channels[0].name == "gyr/x");
  CHECK(log.samples[1][19] == -9.5);
  CHECK(log.info.time.rate_hz == Approx(100));
  ReadOptions options;
  options.topic = "../../etc";
  options.rate_hz = 1;
  CHECK(array_log("groups.npz", options).samples[0][19] == 19.5);
}

TEST_CASE("npz: blocks of any size give the same rows") {
  NEEDS_LIBRARY(ZLIB);
  for (const char* name : {"compressed.npz", "turned.npz"}) {
    const Recording whole = array_log(name);
    for (const std::size_t bytes : {1, 60, 100, 1000}) {
      ReadOptions options;
      options.block_bytes = bytes;
      CHECK(array_log(name, options).samples == whole.samples);
    }
  }
}

TEST_CASE("npz: what is found by its content needs no suffix") {
  const test::TemporaryFolder folder;
  const std::string path = (folder / "log.dat").string();
  std::filesystem::copy(test::fixture("arrays/log.npz"), path);
  CHECK(read_recording(path).info.format == "npz");
}

TEST_CASE("npz: an archive cut anywhere is refused in one sentence") {
  NEEDS_LIBRARY(ZLIB);
  for (const char* name : {"log.npz", "compressed.npz", "groups.npz"}) {
    const std::string bytes = test::slurp(test::fixture(std::string("arrays/") + name));
    for (std::size_t cut = 0; cut < bytes.size(); cut += cut < 100 ? 1 : 37) {
      INFO(name << " cut at " << cut);
      const std::string said = with_bytes("log.npz", bytes.substr(0, cut));
      CHECK_THAT(said, Catch::Contains("error E0460"));
      CHECK(said.find('\n') == std::string::npos);
    }
  }
}

TEST_CASE("npz: no changed byte is read in silence, whatever it says") {
  NEEDS_LIBRARY(ZLIB);
  // Names, times of day and attributes are not covered by a checksum; the numbers and their headers are.
  for (const char* name : {"log.npz", "compressed.npz"}) {
    const std::string bytes = test::slurp(test::fixture(std::string("arrays/") + name));
    const Recording truth = array_log(name);
    std::size_t refused = 0;
    for (std::size_t at = 0; at < bytes.size(); ++at) {
      std::string changed = bytes;
      changed[at] = static_cast<char>(static_cast<unsigned char>(changed[at]) ^ 0x5AU);
      Recording log;
      const std::string said = with_bytes("log.npz", changed, &log);
      INFO(name << " byte " << at << ": " << said);
      refused += !said.empty();
      if (said.empty() && log.info.channels.size() == 6) CHECK(log.samples == truth.samples);
    }
    CHECK(refused > bytes.size() / 2);
  }
}

TEST_CASE("npz: archives that lie about their sizes are refused before they are unpacked") {
  NEEDS_LIBRARY(ZLIB);
  const std::string bytes = test::slurp(test::fixture("arrays/compressed.npz"));
  const std::size_t entry = bytes.find("PK\x01\x02");
  REQUIRE(entry != std::string::npos);
  const auto with = [&](std::size_t at, const std::string& text) {
    std::string changed = bytes;
    changed.replace(entry + at, text.size(), text);
    Recording log;
    const std::string said = with_bytes("log.npz", changed, &log);
    return said.empty() ? test::joined(log.info.dialect) : said;
  };
  using namespace std::string_literals;
  CHECK_THAT(with(24, "\xFF\xFF\xFF\x7F"), Catch::Contains("E0462") && Catch::Contains("a ratio of 1032 at most"));
  CHECK_THAT(with(20, "\xFF\xFF\xFF\x7F"), Catch::Contains("E0460") && Catch::Contains("ends after its end"));
  CHECK_THAT(with(8, "\x01"s), Catch::Contains("is encrypted"));
  CHECK_THAT(with(10, "\x0C"s), Catch::Contains("compressed by method 12"));
  CHECK_THAT(with(16, "\x00\x01\x02\x03"s), Catch::Contains("E0462") && Catch::Contains("checksum"));
  // two members that share their bytes
  const std::size_t second = bytes.find("PK\x01\x02", entry + 4);
  std::string twice = bytes;
  twice.replace(second + 42, 4, bytes.substr(entry + 42, 4));
  CHECK_THAT(with_bytes("log.npz", twice), Catch::Contains("overlaps"));
}
