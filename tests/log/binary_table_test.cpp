// Binary logs of the field, read as a new user would: the file and, where it holds several streams, a topic. Names,
// units, rate, first stamp and samples by value. The files are written by independent writers or laid out byte by byte
// (fixtures/README.md); the formulas of their makers stand here again.

#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "libchar/log/read.hpp"
#include "tests/log/libraries.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;

namespace {

constexpr std::int64_t kMicro = 1000, kMilli = 1000000, kSecond = 1000000000;

struct TableSample {
  std::size_t channel = 0, at = 0;
  double value = 0;
};

struct TableLog {
  std::string file, topic;
  std::string channels;  // "name[unit] …"
  double rate_hz = 0;
  std::optional<std::int64_t> start_ns;
  std::uint64_t samples = 0;
  std::vector<TableSample> values;
  bool unit_guessed = false;                           // of the stamps, where the file cannot say it
  std::optional<double> given_rate_hz = std::nullopt;  // where the file has neither stamps nor a rate
};

double stored_as_float(double x) { return static_cast<double>(static_cast<float>(x)); }

// A raw reading of fixtures/flight/make.py.
int raw_reading(int i, int axis) { return (37 * i + 101 * axis) % 2001 - 1000; }

double reading(int i, int axis, double scale) { return stored_as_float(raw_reading(i, axis) * scale); }

std::vector<TableLog> flight_logs() {
  const double gyro_scale = stored_as_float(2000 * 3.14159265358979323846 / 180 / 32768);
  const double accel_scale = stored_as_float(16 * 9.80665 / 32768);
  return {
      {"flight/fifo.ulg",
       "sensor_gyro_fifo 0",
       "x[rad/s] y[rad/s] z[rad/s]",
       8000,
       10 * kSecond,
       480,
       {{0, 0, raw_reading(0, 0) * gyro_scale}, {2, 479, raw_reading(479, 2) * gyro_scale}}},
      {"flight/fifo.ulg",
       "sensor_accel_fifo",
       "x[m/s^2] y[m/s^2] z[m/s^2]",
       4000,
       10 * kSecond,
       240,
       {{1, 100, raw_reading(100, 1) * accel_scale}}},
      {"flight/fifo.ulg",
       "sensor_baro 0",
       "pressure[Pa] temperature[degC]",
       100,
       10 * kSecond + 375 * kMicro,
       6,
       {{0, 5, 101375}, {1, 0, 31.25}}},
      {"flight/instances.ulg",
       "vehicle_imu 1",
       "delta_angle[0][rad] delta_angle[1][rad] delta_angle[2][rad] delta_velocity[0][m/s] delta_velocity[1][m/s] "
       "delta_velocity[2][m/s]",
       200,
       20 * kSecond + 120 * kMicro,
       120,
       {{2, 100, reading(100, 5, 1e-6)}, {3, 7, reading(7, 7, 1e-4)}}},
      {"flight/appended.ulg",
       "",
       "x[Gauss] y[Gauss] z[Gauss] temperature[degC]",
       100,
       998 * kMilli,
       60,
       {{0, 59, stored_as_float(0.2 + 59e-4)}, {1, 3, stored_as_float(-0.1)}}},
      {"flight/old.ulg",
       "sensor_baro",
       "pressure[hPa] altitude[m] temperature[degC]",
       25,
       40 * kSecond,
       10,
       {{0, 9, 955 + 90 / 64.0}}},
      {"flight/damaged.ulg",
       "",
       "x[m/s^2] y[m/s^2] z[m/s^2] temperature[degC]",
       800,
       3 * kSecond,
       200,
       {{0, 49, reading(49, 0, 0.01)}, {2, 102, reading(102, 2, 0.01)}}},
      {"flight/copter.bin",
       "GYR 0",
       "GyrX[rad/s] GyrY[rad/s] GyrZ[rad/s]",
       1000,
       2 * kSecond,
       200,
       {{1, 150, reading(150, 1, 1e-4)}}},
      {"flight/copter.bin",
       "MAG",
       "MagX[Gauss] MagY[Gauss] MagZ[Gauss]",
       50,
       2 * kSecond + 300 * kMicro,
       10,
       {{0, 2, 0.204}, {1, 9, -0.1}}},
      {"flight/batch.bin",
       "ISBD accel 0",
       "x[m/s^2] y[m/s^2] z[m/s^2]",
       1000,
       5 * kSecond,
       1728,
       {{0, 127, raw_reading(127, 0) / 100.0}, {1, 800, raw_reading(256, 1) / 100.0}}},
      {"flight/old.bin",
       "IMU",
       "GyrX[rad/s] GyrY[rad/s] GyrZ[rad/s] AccX[m/s^2] AccY[m/s^2] AccZ[m/s^2]",
       50,
       7 * kSecond,
       80,
       {{0, 79, reading(79, 0, 1e-4)}, {5, 1, reading(1, 2, 1e-2)}}},
      {"flight/letters.bin", "SCAL", "c[] C[] e[] E[] L[]", 100, kSecond, 20, {{0, 1, -1.51}, {4, 1, 47.3977421}}},
      {"flight/damaged.bin",
       "",
       "GyrX[rad/s] GyrY[rad/s] GyrZ[rad/s]",
       400,
       kSecond,
       199,
       {{0, 49, reading(49, 0, 1e-4)}, {2, 198, reading(198, 2, 1e-4)}}},
  };
}

// By python3-rosbag, @mcap/core and sqlite3 (fixtures/ros): the same messages in every container.
std::vector<TableLog> ros_logs() {
  constexpr std::int64_t kStart = 1700000000 * kSecond;
  const std::string imu =
      "angular_velocity.x[rad/s] angular_velocity.y[rad/s] angular_velocity.z[rad/s] linear_acceleration.x[m/s^2] "
      "linear_acceleration.y[m/s^2] linear_acceleration.z[m/s^2]";
  const std::string magnetic = "magnetic_field.x[T] magnetic_field.y[T] magnetic_field.z[T]";
  const std::vector<TableSample> readings = {
      {0, 10, 0.001 * 10 - 0.3}, {1, 4, 2}, {2, 7, -1}, {3, 99, 24.75}, {4, 3, 0.25}, {5, 50, 9.81 - 50 * 1e-4}};
  std::vector<TableLog> logs;
  for (const char* name : {"ros2.mcap", "ros2_lz4.mcap", "ros2_zstd.mcap", "humble.db3"})
    logs.push_back({fmt::format("ros/{}", name), "/imu0/data", imu, 200, kStart, 200, readings});
  for (const char* name : {"ros1_none.bag", "ros1_bz2.bag", "ros1_lz4.bag"})
    logs.push_back({fmt::format("ros/{}", name), "/imu/data_raw", imu, 200, kStart, 100, readings});
  // The first 200 messages of all topics, of which 113 are the IMU's.
  logs.push_back({"ros/ros2_unchunked.mcap", "/imu0/data", imu, 200, kStart, 113, readings});
  logs.push_back({"ros/ros1.mcap", "", imu, 200, kStart, 100, readings});
  logs.push_back({"ros/jazzy.db3",
                  "/mag",
                  magnetic,
                  50,
                  kStart,
                  50,
                  {{0, 49, 2e-5 + 49 * 1e-9}, {1, 3, -1e-6 * 3}, {2, 0, 4e-5}}});
  // Messages without a header stand at the time of their recording.
  logs.push_back({"ros/ros2.mcap", "/level", "data[]", 40, kStart + kMilli, 40, {{0, 39, 39 * 39 / 64.0}}});
  return logs;
}

// By NumPy (fixtures/npy).
std::vector<TableLog> numpy_logs() {
  std::vector<TableLog> logs = {
      {"npy/structured.npy",
       "",
       "gyr_0[] gyr_1[] gyr_2[] acc_0[] acc_1[] acc_2[] count[]",
       200,
       1403636579758555392,
       5,
       {{1, 4, 3.25}, {5, 2, -4}, {6, 0, -2}},
       true},
      {"npy/aligned_version_3.npy", "", "flag[] Größe[]", 10, std::nullopt, 3, {{0, 2, 3}, {1, 1, 1.5}}, false, 10}};
  for (const char* name : {"c_order.npy", "fortran_order.npy", "big_endian_f4.npy", "version_2.npy"})
    logs.push_back({fmt::format("npy/{}", name),
                    "",
                    "c0[] c1[] c2[]",
                    100,
                    std::nullopt,
                    4,
                    {{0, 1, 0.375}, {2, 3, 1.375}},
                    false,
                    100});
  return logs;
}

std::vector<TableLog> all_logs() {
  std::vector<TableLog> all = flight_logs();
  for (auto* more : {&ros_logs, &numpy_logs})
    for (TableLog& log : more()) all.push_back(std::move(log));
  return all;
}

void check_table_log(const TableLog& expected) {
  INFO(expected.file << " " << expected.topic);
  ReadOptions options;
  options.topic = expected.topic;
  options.rate_hz = expected.given_rate_hz;
  const Recording log = read_recording(test::fixture(expected.file).string(), options);
  std::string channels;
  for (const Channel& channel : log.info.channels)
    channels += fmt::format("{}{}[{}]", channels.empty() ? "" : " ", channel.name, channel.unit);
  CHECK(channels == expected.channels);
  CHECK(log.info.time.rate_hz == Approx(expected.rate_hz).epsilon(1e-9));
  CHECK(log.info.time.unit_guessed == expected.unit_guessed);
  CHECK(log.info.time.start_ns == expected.start_ns);
  REQUIRE(log.info.samples == expected.samples);
  for (const TableSample& sample : expected.values) {
    INFO("channel " << sample.channel << ", sample " << sample.at);
    REQUIRE(sample.channel < log.samples.size());
    CHECK(log.samples[sample.channel][sample.at] == sample.value);
  }
}

}  // namespace

TEST_CASE("binary logs are read right at the first try: names, units, rate, stamps, values") {
  NEEDS_LIBRARY(LZ4);
  NEEDS_LIBRARY(ZSTD);
  NEEDS_LIBRARY(BZIP2);
  NEEDS_LIBRARY(ZLIB);
  NEEDS_LIBRARY(HDF5);
  NEEDS_LIBRARY(SQLITE);
  std::set<std::string> files;
  for (const TableLog& log : all_logs()) {
    check_table_log(log);
    files.insert(log.file);
  }
  CHECK(files.size() >= 24);
}
