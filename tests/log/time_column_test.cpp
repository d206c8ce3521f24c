// Which column is the time, and in which unit: the same table gives the same answer whatever format holds it.

#include <catch2/catch.hpp>
#include <cstring>
#include <fstream>

#include "libchar/core/error.hpp"
#include "libchar/log/read.hpp"
#include "tests/support/rows.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;

namespace {

struct Stamps {
  std::string name;  ///< header of the column
  std::vector<std::int64_t> values;
};

// What is to be compared between formats: nothing for a log without a time column.
struct Found {
  bool has_time = false;
  std::string unit;
  bool guessed = false;
  double rate_hz = 0;
  std::size_t channels = 0;
};

bool operator==(const Found& a, const Found& b) {
  return a.has_time == b.has_time && a.unit == b.unit && a.guessed == b.guessed &&
         a.rate_hz == b.rate_hz && a.channels == b.channels;
}

std::ostream& operator<<(std::ostream& out, const Found& f) {
  return out << (f.has_time ? "time in " : "no time ") << f.unit
             << (f.guessed ? " (guessed) " : " ") << f.rate_hz << " Hz, " << f.channels
             << " channels";
}

Found found(const std::string& path, const ReadOptions& options) {
  const LogInfo info = read_recording(path, options).info;
  return {!info.time.column.empty(),
          info.time.unit,
          info.time.unit_guessed,
          info.time.rate_hz,
          info.channels.size()};
}

void append(std::string& bytes, std::int64_t value) {
  char raw[8];
  std::memcpy(raw, &value, 8);
  bytes.append(raw, 8);
}

void append(std::string& bytes, double value) {
  char raw[8];
  std::memcpy(raw, &value, 8);
  bytes.append(raw, 8);
}

Found from_csv(const Stamps& stamps, const ReadOptions& options) {
  const test::TemporaryFolder folder;
  std::ofstream file(folder / "x.csv");
  file << stamps.name << ",x\n";
  for (std::size_t i = 0; i < stamps.values.size(); ++i)
    file << stamps.values[i] << "," << (i % 2 == 0 ? "0.5" : "0.25") << "\n";
  file.close();
  return found((folder / "x.csv").string(), options);
}

Found from_npy(const Stamps& stamps, const ReadOptions& options) {
  const std::string header = "{'descr': [('" + stamps.name +
                             "', '<i8'), ('x', '<f8')], 'fortran_order': False, 'shape': (" +
                             std::to_string(stamps.values.size()) + ",), }\n";
  std::string bytes("\x93NUMPY\x01\x00", 8);
  bytes += static_cast<char>(header.size() & 0xFFU);
  bytes += static_cast<char>(header.size() >> 8U);
  bytes += header;
  for (std::size_t i = 0; i < stamps.values.size(); ++i) {
    append(bytes, stamps.values[i]);
    append(bytes, i % 2 == 0 ? 0.5 : 0.25);
  }
  const test::TemporaryFolder folder;
  std::ofstream(folder / "x.npy", std::ios::binary) << bytes;
  return found((folder / "x.npy").string(), options);
}

Found from_raw(const Stamps& stamps, const ReadOptions& options) {
  std::string bytes;
  for (std::size_t i = 0; i < stamps.values.size(); ++i) {
    append(bytes, stamps.values[i]);
    append(bytes, static_cast<std::int64_t>(i % 2));
  }
  const test::TemporaryFolder folder;
  std::ofstream(folder / "x.bin", std::ios::binary) << bytes;
  std::ofstream(folder / "x.bin.json")
      << R"({"dtype": "i64", "endian": "little", "channels": [{"name": ")" << stamps.name
      << R"("}, {"name": "x"}]})";
  return found((folder / "x.bin").string(), options);
}

std::vector<std::int64_t> every(std::int64_t step, std::int64_t from = 0) {
  std::vector<std::int64_t> values;
  for (std::int64_t i = 0; i < 20; ++i) values.push_back(from + i * step);
  return values;
}

}  // namespace

TEST_CASE("the same stamps have one unit and one rate in every format") {
  const std::vector<std::pair<Stamps, Found>> cases = {
      {{"t", every(100)}, {true, "ms", true, 10, 1}},
      {{"t", every(1)}, {true, "s", true, 1, 1}},
      {{"t", every(2)}, {true, "ms", true, 500, 1}},
      {{"t", every(199)}, {true, "ms", true, 1000.0 / 199, 1}},
      {{"t", every(200)}, {true, "us", true, 5000, 1}},
      {{"t", every(5000)}, {true, "us", true, 200, 1}},
      {{"t", every(200000)}, {true, "ns", true, 5000, 1}},
      {{"t", every(10000000)}, {true, "ns", true, 100, 1}},
      {{"timestamp", every(10, 1700000000000)}, {true, "ms", true, 100, 1}},
      {{"timestamp", every(10000, 1700000000000000)}, {true, "us", true, 100, 1}},
      {{"t_us", every(5000)}, {true, "us", false, 200, 1}},
      {{"Time [ms]", every(10)}, {true, "ms", false, 100, 1}},
      {{"time_sec", every(2)}, {true, "s", false, 0.5, 1}},
      {{"TIMESTAMP", every(10)}, {true, "ms", true, 100, 1}}};
  for (const auto& [stamps, expected] : cases) {
    INFO(stamps.name << " " << stamps.values[0] << " " << stamps.values[1]);
    CHECK(from_csv(stamps, {}) == expected);
    CHECK(from_npy(stamps, {}) == expected);
    CHECK(from_raw(stamps, {}) == expected);
  }
}

TEST_CASE("a name says time in every format or in none") {
  ReadOptions options;
  options.rate_hz = 100;
  for (const char* name : {"t",
                           "time",
                           "elapsed",
                           "Elapsed Time",
                           "host_time",
                           "seconds",
                           "millis",
                           "microseconds",
                           "timeus",
                           "timestamp_gps",
                           "sampletimefine",
                           "x_time",
                           "temperature",
                           "t_max",
                           "speed_min",
                           "index"}) {
    INFO(name);
    const Stamps stamps{name, every(10)};
    const Found csv = from_csv(stamps, options);
    CHECK(from_npy(stamps, options) == csv);
    CHECK(from_raw(stamps, options) == csv);
  }
  CHECK(from_npy({"elapsed", every(10)}, {}).has_time);
  CHECK_FALSE(from_npy({"temperature", every(10)}, options).has_time);
}

TEST_CASE("a column that is named as the time brings the unit of its name") {
  ReadOptions options;
  options.time_column = "millis";
  const Found expected{true, "ms", false, 200, 1};
  CHECK(from_csv({"millis", every(5)}, options) == expected);
  CHECK(from_npy({"millis", every(5)}, options) == expected);
  options.time_unit = "us";
  CHECK(from_raw({"millis", every(5)}, options) == Found{true, "us", false, 200000, 1});
}

TEST_CASE("two columns that differ in the unit of time only: the first is the time") {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "x.csv") << "time_us,time_ms,x\n0,0,1\n5000,5,2\n10000,10,1\n";
  const LogInfo info = read_recording((folder / "x.csv").string()).info;
  CHECK(info.time.column == "time_us");
  CHECK(info.time.rate_hz == Approx(200));
  CHECK(info.channels.size() == 2);
}

TEST_CASE("stamps with a fraction are seconds since 1970 by their size, else go by their step") {
  const auto unit_of = [](const std::string& rows) {
    const test::TemporaryFolder folder;
    std::ofstream(folder / "x.csv") << "t,x\n" << rows;
    return read_recording((folder / "x.csv").string()).info.time.unit;
  };
  CHECK(unit_of("1700000000.5,0\n1700000010.5,1\n1700000020.5,0\n") == "s");
  CHECK(unit_of("0.5,0\n10.5,1\n20.5,0\n") == "ms");
  CHECK(unit_of("500.5,0\n10500.5,1\n20500.5,0\n") == "us");
}

TEST_CASE("of several columns of time the choice is said where it is the device's") {
  const auto guesses = [](const std::string& header) {
    const test::TemporaryFolder folder;
    std::ofstream(folder / "x.csv") << header << "\n0,0,1\n5000,5,2\n10000,10,1\n";
    return read_recording((folder / "x.csv").string()).info.guesses;
  };
  CHECK(guesses("host_time[us],device_time[ms],x") ==
        std::vector<std::string>{"time column: device_time[ms], the device's own clock, not "
                                 "host_time[us] (`time_column` takes another one)"});
  CHECK(guesses("device_time[us],y[ms],x").empty());
  CHECK(guesses("host_timestamp[us],timestamp[ms],x") ==
        std::vector<std::string>{"time column: timestamp[ms], not host_timestamp[us] "
                                 "(`time_column` takes another one)"});
}

TEST_CASE("the device's own time is preferred to the host's") {
  const auto column_of = [](const std::string& header) {
    const test::TemporaryFolder folder;
    std::ofstream(folder / "x.csv") << header << "\n0,0,1\n5000,5,2\n10000,10,1\n";
    return read_recording((folder / "x.csv").string()).info.time.column;
  };
  CHECK(column_of("host_time[us],device_time[ms],x") == "device_time");
  CHECK(column_of("timestamp[us],imu_time[ms],x") == "imu_time");
  CHECK(column_of("sensor_timestamp[us],time[ms],x") == "sensor_timestamp");
  CHECK(column_of("host_timestamp[us],timestamp[ms],x") == "timestamp");
  CHECK(column_of("recv_time[us],arrival_time[ms],x") == "recv_time");
  CHECK(column_of("time[us],T_imu[degC],x") == "time");  // a temperature
}

TEST_CASE("a wrong time column or unit is refused in every format alike") {
  const auto message = [](Found (*read)(const Stamps&, const ReadOptions&),
                          const ReadOptions& options) {
    try {
      read({"t", every(10)}, options);
      return std::string("accepted");
    } catch (const Error& error) {
      const std::string text = error.what();
      return text.substr(text.find("E03"));
    }
  };
  ReadOptions column, unit;
  column.time_column = "time";
  unit.time_unit = "fortnight";
  for (const ReadOptions& options : {column, unit}) {
    const std::string csv = message(from_csv, options);
    CHECK_THAT(csv, Catch::Contains("got \""));
    CHECK(message(from_npy, options) == csv);
    CHECK(message(from_raw, options) == csv);
  }
}

TEST_CASE("an array without names is all channels, a first column that rises evenly is said") {
  const auto guesses = [](const ReadOptions& options) {
    return test::read_rows("npy", test::fixture("npy/c_order.npy"), options).info.guesses;
  };
  CHECK(guesses({}) == std::vector<std::string>{"first column: rises evenly, kept as a channel "
                                                "(`time_column` c0 takes it as time)"});
  ReadOptions options;
  options.rate_hz = 100;  // who knows the rate looks for no stamps
  CHECK(guesses(options).empty());
}

TEST_CASE("a unit that a sidecar states wins over the one in the name") {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "x.bin", std::ios::binary) << std::string("\0\1\5\2\12\3", 6);
  std::ofstream(folder / "x.bin.json")
      << R"({"dtype": "u8", "channels": [{"name": "time_us", "unit": "ms"}, {"name": "x"}]})";
  const Found expected{true, "ms", false, 200, 1};
  CHECK(found((folder / "x.bin").string(), {}) == expected);
}
