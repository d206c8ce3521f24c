// PX4 ULog: files laid out byte by byte by fixtures/flight/make.py, whose formulas are repeated
// here; @foxglove/ulog 2.3.2 read the same numbers from them (fixtures/README.md).

#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <fstream>
#include <numbers>

#include "libchar/core/error.hpp"
#include "libchar/log/detail/format.hpp"
#include "libchar/log/flight/ulog_format.hpp"
#include "libchar/log/read.hpp"
#include "tests/support/memory_log.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;

namespace {

// A raw reading as make.py makes it.
int flight_count(int i, int axis) { return (37 * i + 101 * axis) % 2001 - 1000; }

// A number that was stored as a float.
double ulog_f32(double x) { return static_cast<double>(static_cast<float>(x)); }

std::string flight(const std::string& name) { return test::fixture("flight/" + name).string(); }

ReadOptions of_topic(const std::string& topic, std::vector<std::string> channels = {}) {
  ReadOptions options;
  options.topic = topic;
  options.channels = std::move(channels);
  return options;
}

std::uint64_t count_of(const LogInfo& info, std::string_view code) {
  const Finding* found = info.warnings.find(code);
  return found == nullptr ? 0 : found->count;
}

std::string channels_of(const LogInfo& info) {
  std::string all;
  for (const Channel& channel : info.channels) all += fmt::format("{}[{}] ", channel.name, channel.unit);
  return all;
}

std::string fault_of_bytes(const std::string& bytes) {
  const test::MemoryLog log(bytes);
  try {
    ReadOptions options;
    options.format = "ulog";
    log_listing(log.path(), options).topics;
    return "read";
  } catch (const Error& error) {
    return error.what();
  }
}

std::string little(std::uint64_t value, int bytes) {
  std::string text;
  for (int i = 0; i < bytes; ++i) text += static_cast<char>(value >> (8 * i));
  return text;
}

std::string ulog_message(char type, const std::string& body) { return little(body.size(), 2) + type + body; }

std::string ulog_start() { return std::string("ULog\x01\x12\x35\x01", 8) + little(1000, 8); }

}  // namespace

TEST_CASE("ULog: FIFO messages are samples at their own instants, scale times count") {
  const Recording gyro = read_recording(flight("fifo.ulg"), of_topic("sensor_gyro_fifo 0"));
  CHECK(channels_of(gyro.info) == "x[rad/s] y[rad/s] z[rad/s] ");
  CHECK(gyro.info.time.rate_hz == Approx(8000).epsilon(1e-12));
  // The first message holds 8 samples, the last of which was taken at 10 s + 7 · 125 µs.
  CHECK(gyro.info.time.start_ns == 10'000'000'000);
  CHECK(gyro.info.time.column == "timestamp_sample");
  CHECK(gyro.info.time.max_deviation_s == 0);
  CHECK(gyro.info.warnings.empty());
  REQUIRE(gyro.info.samples == 480);
  const auto scale = ulog_f32(2000 * std::numbers::pi / 180 / 32768);
  for (int i = 0; i < 480; ++i)
    for (int axis = 0; axis < 3; ++axis) REQUIRE(gyro.samples[axis][i] == flight_count(i, axis) * scale);

  const Recording accel = read_recording(flight("fifo.ulg"), of_topic("sensor_accel_fifo"));
  CHECK(channels_of(accel.info) == "x[m/s^2] y[m/s^2] z[m/s^2] ");
  CHECK(accel.info.time.rate_hz == Approx(4000).epsilon(1e-12));
  REQUIRE(accel.info.samples == 240);
  const auto g = ulog_f32(16 * 9.80665 / 32768);
  CHECK(accel.samples[2][239] == flight_count(239, 2) * g);
}

TEST_CASE("ULog: topics are listed with rows, rates, fields and which are sensors") {
  const std::vector<LogTopic> topics = log_listing(flight("fifo.ulg"), {}).topics;
  REQUIRE(topics.size() == 4);
  CHECK(topics[0].name == "sensor_gyro_fifo 0");
  CHECK(topics[0].type == "sensor_gyro_fifo");
  CHECK(topics[0].rows == 480);
  CHECK(topics[0].rate_hz == Approx(8000).epsilon(1e-9));
  CHECK(topics[0].sensor);
  CHECK(topics[3].name == "sensor_baro 0");
  CHECK(topics[3].rows == 6);
  REQUIRE(topics[3].fields.size() == 6);
  CHECK(topics[3].fields[3].name == "pressure");
  CHECK(topics[3].fields[3].unit == "Pa");
  CHECK_FALSE(topics[3].fields[3].integer);
  CHECK(topics[3].fields[2].integer);
}

TEST_CASE("ULog: instances, nested messages, arrays, padding and every type by value") {
  const Recording imu = read_recording(flight("instances.ulg"), of_topic("vehicle_imu 1"));
  CHECK(channels_of(imu.info) ==
        "delta_angle[0][rad] delta_angle[1][rad] delta_angle[2][rad] delta_velocity[0][m/s] delta_velocity[1][m/s] "
        "delta_velocity[2][m/s] ");
  CHECK(imu.info.time.rate_hz == Approx(200).epsilon(1e-12));
  CHECK(imu.info.time.start_ns == 20'000'120'000);
  CHECK(imu.info.rows == 116);
  CHECK(imu.info.time.missing_samples == 4);
  CHECK(std::isnan(imu.samples[0][61]));
  CHECK(imu.samples[2][100] == ulog_f32(flight_count(100, 5) * 1e-6));
  CHECK(imu.samples[3][100] == ulog_f32(flight_count(100, 7) * 1e-4));
  const Finding* dropout = imu.info.warnings.find("dropout");
  REQUIRE(dropout != nullptr);
  CHECK(dropout->count == 2);
  CHECK(dropout->sentence.find("23 ms in all") != std::string::npos);

  const Recording esc =
      read_recording(flight("instances.ulg"), of_topic("esc_status", {"esc[0].pair[0]", "esc[1].rpm"}));
  CHECK(esc.samples[0][23] == -115);
  CHECK(esc.samples[1][23] == 1115);

  const Recording every = read_recording(flight("instances.ulg"), of_topic("every_type 0"));
  CHECK(channels_of(every.info) == "a[] b[] c[] d[] e[] f[] g[] h[] i[] j[] k[] ");
  const std::vector<double> last = {-116, 115, 115 / 3.0, -230, 345, 28.75, -115, 115, -23, 115, 1};
  for (std::size_t c = 0; c < last.size(); ++c) CHECK(every.samples[c][23] == last[c]);
  CHECK(count_of(every.info, "rounded_integer") == 1);
}

TEST_CASE("ULog: the stamps are those of the sample, or those of the log when asked for") {
  ReadOptions options = of_topic("vehicle_imu 1");
  options.time_source = "log";
  const Recording imu = read_recording(flight("instances.ulg"), options);
  CHECK(imu.info.time.column == "timestamp");
  CHECK(imu.info.time.start_ns == 20'000'180'000);
  options.time_source = "auto";
  options.time_column = "timestamp";
  CHECK(read_recording(flight("instances.ulg"), options).info.time.start_ns == 20'000'180'000);
}

TEST_CASE("ULog: appended data are read, and the message in front that was cut is said") {
  const Recording mag = read_recording(flight("appended.ulg"));
  CHECK(mag.info.rows == 59);
  CHECK(mag.info.time.missing_samples == 1);
  CHECK(count_of(mag.info, "cut_message") == 1);
  CHECK(mag.samples[0][59] == ulog_f32(0.2 + 59e-4));
  bool said = false;
  for (const std::string& line : mag.info.dialect) said = said || line.find("data appended at byte") == 0;
  CHECK(said);
}

TEST_CASE("ULog: version 0 as PX4 1.4 wrote it, pressure in hPa, a topic without a clock") {
  const Recording baro = read_recording(flight("old.ulg"), of_topic("sensor_baro"));
  CHECK(channels_of(baro.info) == "pressure[hPa] altitude[m] temperature[degC] ");
  CHECK(baro.samples[0][9] == 955 + 90 / 64.0);
  const Recording both = read_recording(flight("old.ulg"), of_topic("sensor_combined"));
  CHECK(both.info.channels.size() == 11);
  CHECK(both.info.time.rate_hz == Approx(250).epsilon(1e-12));
  CHECK(both.samples[4][7] == ulog_f32(flight_count(7, 1) * 1e-2));
  CHECK_THROWS_WITH(read_recording(flight("old.ulg"), of_topic("commander_state")), Catch::Contains("E0315"));
}

TEST_CASE("ULog: what damage reaches is left out and counted, all else is right") {
  const Recording accel = read_recording(flight("damaged.ulg"));
  CHECK(accel.info.rows == 195);
  CHECK(accel.info.samples == 200);
  CHECK(accel.info.time.missing_samples == 5);
  // Rows 50 to 52 with the rest of what was overwritten; rows 100 and 101 but for what was lost of them.
  CHECK(count_of(accel.info, "damaged_bytes") == 3 * 49 + 2 * 49 - 75);
  for (int i = 0; i < 200; ++i) {
    const bool lost = (i >= 50 && i < 53) || i == 100 || i == 101;
    if (lost)
      REQUIRE(std::isnan(accel.samples[0][i]));
    else
      REQUIRE(accel.samples[0][i] == ulog_f32(flight_count(i, 0) * 0.01));
  }
}

TEST_CASE("ULog: cut anywhere, whole rows are delivered and the loss is said") {
  for (const char* name : {"fifo.ulg", "instances.ulg", "damaged.ulg"}) {
    const std::string whole = test::slurp(flight(name));
    const std::string topic = log_listing(flight(name), {}).topics.front().name;
    std::uint64_t rows_before = 0;
    for (std::size_t size = 17; size < whole.size(); size += 331) {
      INFO(name << " cut at " << size);
      const test::MemoryLog log(std::string_view(whole).substr(0, size));
      const std::vector<LogTopic> topics = log_listing(log.path(), {}).topics;
      if (topics.empty() || topics[0].rows < 3) continue;
      const Recording cut = read_recording(log.path(), of_topic(topic));
      CHECK(cut.info.rows >= rows_before);
      CHECK(cut.info.rows == topics[0].rows);
      rows_before = cut.info.rows;
    }
    CHECK(rows_before > 50);
  }
}

TEST_CASE("ULog: every cut of one message says how many bytes were left out") {
  const std::string whole = test::slurp(flight("damaged.ulg"));
  const Recording all = read_recording(flight("damaged.ulg"));
  for (std::size_t less = 1; less < 49; ++less) {
    // Behind the last row stands a sync message of 11 bytes.
    const test::MemoryLog log(std::string_view(whole).substr(0, whole.size() - 11 - less));
    const Recording cut = read_recording(log.path());
    CHECK(cut.info.rows == all.info.rows - 1);
    const Finding* said = cut.info.warnings.find("cut_message");
    REQUIRE(said != nullptr);
    CHECK(said->sentence.find(fmt::format("its last {} bytes", 49 - less)) != std::string::npos);
  }
}

TEST_CASE("ULog: rows do not depend on the size of blocks") {
  for (const char* name : {"fifo.ulg", "damaged.ulg", "appended.ulg"}) {
    const std::string topic = log_listing(flight(name), {}).topics.front().name;
    const Recording whole = read_recording(flight(name), of_topic(topic));
    for (const std::size_t block : {1, 7, 100, 4096}) {
      ReadOptions options = of_topic(topic);
      options.block_bytes = block;
      const Recording parts = read_recording(flight(name), options);
      REQUIRE(parts.info.samples == whole.info.samples);
      for (std::size_t c = 0; c < whole.samples.size(); ++c)
        CHECK(std::memcmp(parts.samples[c].data(), whole.samples[c].data(), whole.info.samples * sizeof(double)) == 0);
    }
  }
}

TEST_CASE("ULog: what cannot be read is refused in a sentence") {
  CHECK_THAT(fault_of_bytes("ULogEnc\x01 whatever follows"), Catch::Contains("E0481"));
  CHECK_THAT(fault_of_bytes(ulog_start().substr(0, 12)), Catch::Contains("E0480"));
  CHECK_THAT(fault_of_bytes("not a log at all"), Catch::Contains("E0480"));
  std::string flags(40, '\0');
  flags[8] = 4;
  CHECK_THAT(fault_of_bytes(ulog_start() + ulog_message('B', flags)), Catch::Contains("E0482"));
  flags[8] = 0;
  flags[15] = 1;
  CHECK_THAT(fault_of_bytes(ulog_start() + ulog_message('B', flags)), Catch::Contains("E0482"));
  // Compatible flags may be ignored, and a longer message of flags too.
  flags = std::string(48, '\0');
  flags[3] = 1;
  CHECK(fault_of_bytes(ulog_start() + ulog_message('B', flags)) == "read");
}

TEST_CASE("ULog: a topic whose definition cannot be used says why") {
  const auto why = [](const std::string& definitions, const std::string& name) {
    const std::string log = ulog_start() + definitions + ulog_message('A', std::string("\0\1\0", 3) + name) +
                            ulog_message('D', std::string("\1\0", 2) + std::string(9, 'a'));
    const test::MemoryLog file(log);
    const std::vector<LogTopic> topics = log_listing(file.path(), {}).topics;
    REQUIRE(topics.size() == 1);
    return topics[0].why_not;
  };
  CHECK(why("", "lost") == "the log does not define its format lost");
  CHECK(why(ulog_message('F', "a:uint64_t timestamp;b x;"), "a") == "the log does not define its format b");
  CHECK(why(ulog_message('F', "a:uint64_t timestamp;a x;"), "a") == "its format holds itself");
  CHECK(why(ulog_message('F', "a:uint64_t timestamp;float[70000] x;"), "a") ==
        "its format is longer than a message can be");
  CHECK(why(ulog_message('F', "a:b[4000000000] x;") + ulog_message('F', "b:;"), "a") ==
        "the formats of the log have too many fields in all");
  CHECK(why(ulog_message('F', "a:uint64_t " + std::string(300, 'n') + ";"), "a") ==
        "its fields have names of more than 255 characters");
  CHECK(why(ulog_message('F', "a:uint64_t timestamp;nonsense;"), "a") ==
        "its format has a field that cannot be read: nonsense");
  CHECK(why(ulog_message('F', "a:uint64_t timestamp;uint8_t x;") + ulog_message('F', "a:uint64_t timestamp;int8_t x;"),
            "a") == "the log defines its format twice, and not alike");
  CHECK(why(ulog_message('F', "a:uint64_t timestamp;uint8_t x;"), "a").empty());
}

TEST_CASE("ULog: topics without a message are not listed, losses are said with the list") {
  const std::string log = ulog_start() + ulog_message('F', "a:uint64_t timestamp;uint8_t x;") +
                          ulog_message('A', std::string("\0\1\0", 3) + "a") +
                          ulog_message('A', std::string("\1\2\0", 3) + "a") +
                          ulog_message('D', std::string("\2\0", 2) + std::string(9, 'a')) +
                          ulog_message('O', std::string("\5\0", 2)) + std::string(2, 'x');
  const test::MemoryLog file(log);
  const LogInfo listed = log_listing(file.path(), {});
  REQUIRE(listed.topics.size() == 1);
  CHECK(listed.topics[0].name == "a 1");
  CHECK(count_of(listed, "dropout") == 1);
  CHECK(count_of(listed, "cut_message") == 1);
}

TEST_CASE("ULog: one number for two topics makes neither readable") {
  const std::string log = ulog_start() + ulog_message('F', "a:uint64_t timestamp;uint8_t x;") +
                          ulog_message('A', std::string("\0\1\0", 3) + "a") +
                          ulog_message('D', std::string("\1\0", 2) + std::string(9, 'a')) +
                          ulog_message('A', std::string("\1\1\0", 3) + "a") +
                          ulog_message('D', std::string("\1\0", 2) + std::string(9, 'a'));
  const test::MemoryLog file(log);
  for (const LogTopic& topic : log_listing(file.path(), {}).topics)
    CHECK(topic.why_not == "its number 1 is that of another topic too");
}

TEST_CASE("ULog: a stamp of zero among others is none") {
  std::string log = ulog_start() + ulog_message('F', "a:uint64_t timestamp;float x;") +
                    ulog_message('A', std::string("\0\0\0", 3) + "a");
  for (int i = 0; i < 40; ++i) {
    const float x = static_cast<float>(i) / 2;
    std::string value(4, '\0');
    std::memcpy(value.data(), &x, 4);
    const std::uint64_t stamp = i == 0 || i == 17 ? 0 : 300'000'000ULL + 1000ULL * i;
    log += ulog_message('D', std::string(2, '\0') + little(stamp, 8) + value);
  }
  const test::MemoryLog file(log);
  const Recording rows = read_recording(file.path());
  CHECK(count_of(rows.info, "unusable_stamp") == 2);
  CHECK(rows.info.samples == 39);
  CHECK(rows.info.time.start_ns == 300'001'000'000);
  CHECK(std::isnan(rows.samples[0][16]));
  CHECK(rows.samples[0][38] == 19.5);
}

TEST_CASE("ULog: more samples than a FIFO message holds are counted, and those that it holds read") {
  std::string whole = test::slurp(flight("fifo.ulg"));
  const std::string mark = std::string("D\0\0", 3);
  const std::size_t first = whole.find(mark);
  REQUIRE(first != std::string::npos);
  whole[first + 3 + 28 + 192] = '\xff';
  const test::MemoryLog log(whole);
  const Recording gyro = read_recording(log.path(), of_topic("sensor_gyro_fifo 0"));
  CHECK(count_of(gyro.info, "too_many_samples") == 1);
  CHECK(gyro.info.rows == 504);
}
