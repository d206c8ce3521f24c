// ArduPilot DataFlash: files laid out byte by byte by fixtures/flight/make.py, whose formulas are repeated here.

#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <fstream>

#include "libchar/core/error.hpp"
#include "libchar/log/detail/format.hpp"
#include "libchar/log/read.hpp"
#include "tests/support/memory_log.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;

namespace {

int bin_count(int i, int axis) { return (37 * i + 101 * axis) % 2001 - 1000; }

// A number that was stored as a float.
double bin_f32(double x) { return static_cast<double>(static_cast<float>(x)); }

std::string bin(const std::string& name) { return test::fixture("flight/" + name).string(); }

Recording read_bin(const std::string& path, const std::string& topic, std::string channel = "") {
  ReadOptions options;
  options.topic = topic;
  if (!channel.empty()) options.channels = {std::move(channel)};
  return read_recording(path, options);
}

std::string bin_channels(const LogInfo& info) {
  std::string all;
  for (const Channel& channel : info.channels) all += fmt::format("{}[{}] ", channel.name, channel.unit);
  return all;
}

std::uint64_t bin_warnings(const LogInfo& info, std::string_view code) {
  const Finding* found = info.warnings.find(code);
  return found == nullptr ? 0 : found->count;
}

}  // namespace

TEST_CASE("DataFlash: sensors are topics of their own, with units and stamps of the sample") {
  const std::vector<LogTopic> topics = log_listing(bin("copter.bin"), {}).topics;
  std::string names;
  for (const LogTopic& topic : topics)
    if (topic.why_not.empty()) names += topic.name + ", ";
  CHECK(names == "PARM, GYR 0, ACC 0, IMU 0, IMU 1, MAG 0, BARO 0, ATT, ");

  const Recording gyro = read_bin(bin("copter.bin"), "GYR");
  CHECK(bin_channels(gyro.info) == "GyrX[rad/s] GyrY[rad/s] GyrZ[rad/s] ");
  CHECK(gyro.info.time.column == "SampleUS");
  CHECK(gyro.info.time.rate_hz == Approx(1000).epsilon(1e-12));
  CHECK(gyro.info.time.max_deviation_s == 0);
  CHECK(gyro.info.time.start_ns == 2'000'000'000);
  REQUIRE(gyro.info.samples == 200);
  for (int i = 0; i < 200; ++i) REQUIRE(gyro.samples[1][i] == bin_f32(bin_count(i, 1) * 1e-4));

  const Recording imu = read_bin(bin("copter.bin"), "IMU 1");
  CHECK(bin_channels(imu.info) == "GyrX[rad/s] GyrY[rad/s] GyrZ[rad/s] AccX[m/s^2] AccY[m/s^2] AccZ[m/s^2] T[degC] ");
  CHECK(imu.info.time.rate_hz == Approx(200).epsilon(1e-12));
  CHECK(imu.samples[0][3] == bin_f32(bin_count(15, 0) * 1e-4 + 1));
}

TEST_CASE("DataFlash: multipliers of the log and letters of the format scale the numbers") {
  const Recording mag = read_bin(bin("copter.bin"), "MAG 0");
  CHECK(bin_channels(mag.info) == "MagX[Gauss] MagY[Gauss] MagZ[Gauss] ");
  CHECK(mag.samples[0][2] == (200 + 40 % 9) / 1000.0);
  const Recording baro = read_bin(bin("copter.bin"), "BARO 0");
  CHECK(bin_channels(baro.info) == "Alt[m] Press[Pa] Temp[degC] CRt[m/s] ");
  CHECK(baro.samples[2][0] == 31.5);
  const Recording attitude = read_bin(bin("copter.bin"), "ATT", "Yaw");
  CHECK(bin_channels(attitude.info) == "Yaw[deg] ");
  CHECK(attitude.samples[0][5] == 359.99);
  const Recording scaled = read_bin(bin("letters.bin"), "SCAL");
  CHECK(scaled.samples[0][1] == -1.51);
  CHECK(scaled.samples[1][1] == 400.01);
  CHECK(scaled.samples[2][1] == -10000.01);
  CHECK(scaled.samples[3][1] == 40000000.01);
  CHECK(scaled.samples[4][1] == 47.3977421);
}

TEST_CASE("DataFlash: every letter by value, arrays, doubled labels, and what is not read says why") {
  const Recording all = read_bin(bin("letters.bin"), "ALL");
  CHECK(bin_channels(all.info) == "b[] B[] h[] H[] i[] I[] q[] d[] f[] g[] M[] ");
  const std::vector<double> at_7 = {-7, 7, -2100, 4200, -490000, 3000000007.0, -7e12, 7 / 3.0, 1.75, 0.875, 7};
  for (std::size_t c = 0; c < at_7.size(); ++c) CHECK(all.samples[c][7] == at_7[c]);
  const Recording array = read_bin(bin("letters.bin"), "ARR", "a[31]");
  CHECK(array.samples[0][3] == bin_count(3, 0) + 31);
  CHECK(read_bin(bin("letters.bin"), "TWIC", "x_2").samples[0][4] == 8);
  std::map<std::string, std::string> why;
  for (const LogTopic& topic : log_listing(bin("letters.bin"), {}).topics) why[topic.name] = topic.why_not;
  CHECK(why["TEXT"] == "text");
  CHECK(why["BADL"] == "its format makes 15 bytes and its length says 22");
  CHECK(why["BADX"] == "its format has the letter x");
}

TEST_CASE("DataFlash: bursts of the batch sampler stand at their instants, and what they are good for is said") {
  const Recording accel = read_bin(bin("batch.bin"), "ISBD accel 0");
  CHECK(bin_channels(accel.info) == "x[m/s^2] y[m/s^2] z[m/s^2] ");
  CHECK(accel.info.time.rate_hz == Approx(1000).epsilon(1e-12));
  CHECK(accel.info.rows == 3 * 128 - 32);
  CHECK(accel.info.time.start_ns == 5'000'000'000);
  CHECK(bin_warnings(accel.info, "bursts") == 3);
  // The third burst is number 2 and began 0.8 s after the first; its second block is lost.
  CHECK(accel.samples[1][800] == bin_count(256, 1) / 100.0);
  CHECK(std::isnan(accel.samples[1][832]));
  CHECK(accel.samples[1][864] == bin_count(256 + 64, 1) / 100.0);
  CHECK(std::isnan(accel.samples[1][400]));
  const Recording gyro = read_bin(bin("batch.bin"), "ISBD gyro 0");
  CHECK(bin_channels(gyro.info) == "x[rad/s] y[rad/s] z[rad/s] ");
  CHECK(gyro.info.time.start_ns == 5'400'000'000);
  CHECK(gyro.samples[0][127] == bin_count(255, 0) / 1000.0);
}

TEST_CASE("DataFlash: a log of APM 3.1 in milliseconds, without units, with unwritten flash behind") {
  const Recording baro = read_bin(bin("old.bin"), "BARO");
  CHECK(bin_channels(baro.info) == "Alt[m] Press[Pa] Temp[degC] ");
  CHECK(baro.info.time.column == "TimeMS");
  CHECK(baro.info.time.rate_hz == Approx(10).epsilon(1e-12));
  CHECK(baro.info.time.start_ns == 7'000'000'000);
  CHECK(baro.samples[2][0] == 25.12);
  CHECK(baro.info.warnings.empty());
  const Recording imu = read_bin(bin("old.bin"), "IMU2");
  CHECK(bin_channels(imu.info) == "GyrX[rad/s] GyrY[rad/s] GyrZ[rad/s] AccX[m/s^2] AccY[m/s^2] AccZ[m/s^2] ");
  CHECK(imu.samples[0][79] == bin_f32(2 * bin_count(79, 0) * 1e-4));
}

TEST_CASE("DataFlash: what damage reaches is left out and counted, all else is right") {
  const Recording gyro = read_bin(bin("damaged.bin"), "");
  CHECK(gyro.info.rows == 194);
  CHECK(gyro.info.samples == 199);
  CHECK(bin_warnings(gyro.info, "damaged_bytes") == 3 * 32 + 2 * 32 - 40);
  CHECK(bin_warnings(gyro.info, "cut_message") == 1);
  for (int i = 0; i < 199; ++i) {
    const bool lost = (i >= 50 && i < 53) || i == 100 || i == 101;
    if (lost)
      REQUIRE(std::isnan(gyro.samples[0][i]));
    else
      REQUIRE(gyro.samples[0][i] == bin_f32(bin_count(i, 0) * 1e-4));
  }
}

TEST_CASE("DataFlash: cut anywhere, whole rows are delivered") {
  for (const char* name : {"copter.bin", "batch.bin", "damaged.bin"}) {
    const std::string whole = test::slurp(bin(name));
    std::uint64_t rows_before = 0;
    for (std::size_t size = 400; size < whole.size(); size += 331) {
      INFO(name << " cut at " << size);
      const test::MemoryLog log(std::string_view(whole).substr(0, size));
      ReadOptions options;
      options.format = "dataflash";
      std::vector<LogTopic> topics;
      try {
        topics = log_listing(log.path(), options).topics;
      } catch (const Error& error) {
        CHECK(error.problem().code == "E0485");
        continue;
      }
      std::uint64_t rows = 0;
      for (const LogTopic& topic : topics) {
        rows += topic.rows;
        if (topic.rows < 3 || !topic.why_not.empty() || topic.name == "PARM") continue;
        CHECK(read_bin(log.path(), topic.name).info.rows == topic.rows);
      }
      CHECK(rows >= rows_before);
      rows_before = rows;
    }
    CHECK(rows_before > 100);
  }
}

TEST_CASE("DataFlash: rows do not depend on the size of blocks") {
  const Recording whole = read_bin(bin("damaged.bin"), "GYR 0");
  for (const std::size_t block : {1, 7, 100, 4096}) {
    ReadOptions options;
    options.block_bytes = block;
    const Recording parts = read_recording(bin("damaged.bin"), options);
    REQUIRE(parts.info.samples == whole.info.samples);
    for (std::size_t c = 0; c < whole.samples.size(); ++c)
      CHECK(std::memcmp(parts.samples[c].data(), whole.samples[c].data(), whole.info.samples * sizeof(double)) == 0);
  }
}

TEST_CASE("DataFlash: a .bin with a sidecar stays raw, one without that is no log is told so") {
  const test::TemporaryFolder folder;
  const std::string path = (folder.path() / "x.bin").string();
  std::ofstream(path, std::ios::binary) << std::string("\xa3\x95\x80\x00", 4) + std::string(60, 'x');
  CHECK_THROWS_WITH(read_recording(path), Catch::Contains("E0422"));
  std::ofstream(path + ".json") << R"({"dtype": "i16", "endian": "little", "channels": 2, "rate_hz": 100})";
  const Recording raw = read_recording(path);
  CHECK(raw.info.format == "raw");
  CHECK(raw.info.samples == 16);
  ReadOptions options;
  options.format = "dataflash";
  CHECK_THROWS_WITH(read_recording(path, options), Catch::Contains("E0485"));
}

TEST_CASE("DataFlash: cut in front of its first whole message it is told to be cut") {
  const test::MemoryLog log(std::string_view(test::slurp(bin("copter.bin"))).substr(0, 100));
  CHECK_THROWS_WITH(read_recording(log.path(), {}),
                    Catch::Contains("E0426") && Catch::Contains("the log ends inside a message: its last 11 bytes"));
}
