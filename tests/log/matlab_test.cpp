// Files by SciPy (version 5) and by h5py as MATLAB lays out version 7.3 (fixtures/arrays/make.py).

#include <catch2/catch.hpp>

#include "libchar/log/arrays/hdf5_worker.hpp"
#include "tests/log/array_log.hpp"
#include "tests/log/libraries.hpp"

using namespace libchar;
using test::array_fault;
using test::array_log;
using test::check_common_log;
using test::with_bytes;

TEST_CASE("matlab: arrays of version 5, compressed or not, are one table") {
  NEEDS_LIBRARY(ZLIB);
  for (const char* name : {"log_v5.mat", "log_v5_compressed.mat"}) {
    INFO(name);
    const Recording log = array_log(name);
    check_common_log(log);
    CHECK(log.info.format == "matlab");
    CHECK(log.info.time.start_ns == 0);
    CHECK_THAT(test::joined(log.info.dialect), Catch::Contains("label is text"));
    for (const std::size_t bytes : {1, 70, 500}) {
      ReadOptions options;
      options.block_bytes = bytes;
      CHECK(array_log(name, options).samples == log.samples);
    }
  }
}

TEST_CASE("matlab: version 7.3 is read by the same rules") {
  NEEDS_LIBRARY(HDF5);
  const Recording log = array_log("log_v73.mat");
  check_common_log(log);
  CHECK(log.info.format == "matlab");
  const std::string said = test::joined(log.info.dialect);
  CHECK_THAT(said, Catch::Contains("MATLAB 7.3") && Catch::Contains("label is text"));
  CHECK_THAT(said, Catch::Contains("tt is an object (timetable); save its numbers"));
  ReadOptions options;
  options.topic = "cfg";
  const Recording slow = array_log("log_v73.mat", options);
  CHECK(slow.info.time.rate_hz == 100);  // cfg.Fs
  CHECK(slow.samples[2][4] == 1);
}

TEST_CASE("matlab: structs are groups, rows of stamps are stamps, classes are kept") {
  NEEDS_LIBRARY(ZLIB);
  ReadOptions options;
  options.topic = "imu";
  const Recording log = array_log("struct_v5.mat", options);
  REQUIRE(log.info.channels.size() == 3);
  CHECK(log.info.time.column == "time");
  CHECK(log.info.channels[0].name == "gyro");
  CHECK(log.info.channels[0].integer);
  CHECK(log.info.channels[1].name == "raw/x");
  CHECK(log.info.channels[2].name == "raw/y");
  CHECK_FALSE(log.info.channels[2].integer);
  CHECK(log.samples[0][19] == 19);
  CHECK(log.samples[1][19] == 19);
  CHECK(log.samples[2][19] == -19);
  const std::string said = test::joined(log.info.dialect);
  CHECK_THAT(said, Catch::Contains("imu/note is text") && Catch::Contains("imu/cells is a cell array"));
  options.topic = "acc";
  const Recording acc = array_log("struct_v5.mat", options);
  CHECK(acc.info.time.rate_hz == 100);
  CHECK(acc.samples.size() == 20);  // 3 × 20 and nothing beside it says otherwise
}

TEST_CASE("matlab: version 4, of either byte order, and what it cannot hold") {
  const Recording log = array_log("log_v4.mat");
  test::check_common_log(log);
  CHECK_THAT(test::joined(log.info.dialect), Catch::Contains("MATLAB 4") && Catch::Contains("label is text"));
  const auto matrix = [](std::uint32_t type, const std::string& name, const std::vector<std::int16_t>& values) {
    std::string out;
    for (const std::uint32_t head :
         {type, static_cast<std::uint32_t>(values.size()), 1U, 0U, static_cast<std::uint32_t>(name.size() + 1)})
      for (const unsigned shift : {24U, 16U, 8U, 0U}) out += static_cast<char>(head >> shift & 0xFFU);
    out += name + '\0';
    for (const std::int16_t value : values)
      out += {static_cast<char>(static_cast<std::uint16_t>(value) >> 8U), static_cast<char>(value & 0xFF)};
    return out;
  };
  const std::string big = matrix(1030, "time_ms", {0, 10, 20, 30}) + matrix(1030, "gx", {-300, 5, 6, 7});
  Recording swapped;
  CHECK(with_bytes("a.mat", big, &swapped).empty());
  CHECK(swapped.info.time.rate_hz == Approx(100));
  CHECK(swapped.samples == std::vector<std::vector<double>>{{-300, 5, 6, 7}});
  for (const std::size_t cut : {big.size() - 1, big.size() / 2, std::size_t{15}})
    CHECK_THAT(with_bytes("a.mat", big.substr(0, cut)), Catch::Contains("E0464"));
}

TEST_CASE("matlab: what is no MATLAB file is refused with what to do") {
  CHECK_THAT(with_bytes("a.mat", "t,x\n0,1\n"), Catch::Contains("E0464"));
}

TEST_CASE("matlab: a file cut anywhere is refused in one sentence, or has fewer arrays") {
  NEEDS_LIBRARY(ZLIB);
  for (const char* name : {"log_v5.mat", "log_v5_compressed.mat", "struct_v5.mat", "log_v4.mat"}) {
    const std::string bytes = test::slurp(test::fixture(std::string("arrays/") + name));
    std::size_t refused = 0;
    for (std::size_t cut = 0; cut < bytes.size(); ++cut) {
      Recording log;
      const std::string said = with_bytes("log.mat", bytes.substr(0, cut), &log);
      INFO(name << " cut at " << cut << ": " << said);
      refused += !said.empty();
      CHECK(said.find('\n') == std::string::npos);
      if (said.empty())
        for (const std::vector<double>& samples : log.samples) CHECK(samples.size() == log.info.rows);
    }
    CHECK(refused > bytes.size() / 2);
  }
}

TEST_CASE("matlab: changed bytes of compressed arrays are noticed, others end in a sentence or in values") {
  NEEDS_LIBRARY(ZLIB);
  const std::string bytes = test::slurp(test::fixture("arrays/log_v5_compressed.mat"));
  const Recording truth = array_log("log_v5_compressed.mat");
  for (std::size_t at = 128; at < bytes.size(); ++at) {
    std::string changed = bytes;
    changed[at] = static_cast<char>(static_cast<unsigned char>(changed[at]) ^ 0x11U);
    Recording log;
    const std::string said = with_bytes("log.mat", changed, &log);
    INFO("byte " << at << ": " << said);
    if (said.empty() && log.info.channels.size() == 6) CHECK(log.samples == truth.samples);
  }
}
