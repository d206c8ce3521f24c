// Which column is the time, and in which unit: the same table gives the same answer whatever format holds it.

#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cstring>
#include <fstream>
#include <functional>
#include <random>

#include "libchar/core/error.hpp"
#include "libchar/log/detail/column_name.hpp"
#include "libchar/log/quality.hpp"
#include "libchar/log/read.hpp"
#include "tests/log/log_text.hpp"
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
  return a.has_time == b.has_time && a.unit == b.unit && a.guessed == b.guessed && a.rate_hz == b.rate_hz &&
         a.channels == b.channels;
}

std::ostream& operator<<(std::ostream& out, const Found& f) {
  return out << (f.has_time ? "time in " : "no time ") << f.unit << (f.guessed ? " (guessed) " : " ") << f.rate_hz
             << " Hz, " << f.channels << " channels";
}

Found found(const std::string& path, const ReadOptions& options) {
  const LogInfo info = read_recording(path, options).info;
  return {!info.time.column.empty(), info.time.unit, info.time.unit_guessed, info.time.rate_hz, info.channels.size()};
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
  std::ofstream(folder / "x.bin.json") << R"({"dtype": "i64", "endian": "little", "channels": [{"name": ")"
                                       << stamps.name << R"("}, {"name": "x"}]})";
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
  for (const char* name :
       {"t", "time", "elapsed", "Elapsed Time", "host_time", "seconds", "millis", "microseconds", "timeus",
        "timestamp_gps", "sampletimefine", "x_time", "temperature", "t_max", "speed_min", "index"}) {
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

TEST_CASE("seconds of a day, a week or an hour count seconds") {
  for (const char* name : {"seconds_of_day", "seconds of day", "seconds_of_week", "ms_of_day", "minutes_of_day"}) {
    std::string text = fmt::format("{},gyro\n", name);
    for (int i = 0; i < 500; ++i) text += fmt::format("{},{}\n", 30000 + 10 * i, i * 7919 % 101);
    INFO(name);
    const std::string_view word(name);
    const double unit = word.starts_with("ms") ? 1e-3 : word.starts_with("min") ? 60 : 1;
    CHECK(known_rate_hz(read_text(text).info) == Approx(0.1 / unit).epsilon(1e-9));
  }
}

TEST_CASE("two columns that differ in the unit of time only: the first is the time") {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "x.csv") << "time_us,time_ms,x\n0,0,1\n5000,5,2\n10000,10,1\n";
  const LogInfo info = read_recording((folder / "x.csv").string()).info;
  CHECK(info.time.column == "time_us");
  CHECK(info.time.rate_hz == Approx(200));
  CHECK(info.channels.size() == 1);  // time_ms is the same clock
}

TEST_CASE("stamps with a fraction are seconds since 1970 by their size, else go by their step") {
  const auto unit_of = [](const std::string& rows) {
    const test::TemporaryFolder folder;
    std::ofstream(folder / "x.csv") << "t,x\n" << rows;
    return read_recording((folder / "x.csv").string()).info.time.unit;
  };
  CHECK(unit_of("1700000000.5,0\n1700000010.5,1\n1700000020.5,0\n") == "s");
  CHECK_THROWS_WITH(unit_of("0.5,0\n10.5,1\n20.5,0\n30.5,1\n"),
                    Catch::Contains("E0325") && Catch::Contains("0.1 Hz in s"));
  CHECK(unit_of("500.5,0\n10500.5,1\n20500.5,0\n") == "us");
}

TEST_CASE("of several columns of time the choice is said where it is the device's") {
  const auto guesses = [](const std::string& header) {
    const test::TemporaryFolder folder;
    std::ofstream(folder / "x.csv") << header << "\n0,0,1\n5000,5,2\n10000,10,1\n";
    return read_recording((folder / "x.csv").string()).info.guesses;
  };
  CHECK(
      guesses("host_time[us],device_time[ms],x") ==
      std::vector<std::string>{
          "time column: device_time[ms], the device's own clock, not host_time[us] (`time_column` takes another one)"});
  CHECK(guesses("device_time[us],y[ms],x").empty());
  CHECK(
      guesses("host_timestamp[us],timestamp[ms],x") ==
      std::vector<std::string>{"time column: timestamp[ms], not host_timestamp[us] (`time_column` takes another one)"});
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
  const auto message = [](Found (*read)(const Stamps&, const ReadOptions&), const ReadOptions& options) {
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
  CHECK(guesses({}) ==
        std::vector<std::string>{"first column: rises evenly, kept as a channel (`time_column` c0 takes it as time)"});
  CHECK(test::read_rows("npy", test::fixture("npy/c_order.npy"), {}).info.time.candidate == "c0");
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

namespace {

/// Of a log of two columns, the stamps being those of `of_row`.
Recording with_stamps(const std::string& header, const std::function<std::string(int)>& of_row,
                      const ReadOptions& options = {}) {
  std::mt19937_64 random(3);
  std::string text = header + ",x\n";
  for (int i = 0; i < 300; ++i) text += of_row(i) + "," + std::to_string(static_cast<double>(random() % 1000)) + "\n";
  return test::read_text(text, options);
}

}  // namespace

TEST_CASE("a column that its name calls a time, and whose rows come in packets, is offered as one") {
  const auto packets = [](int row) { return fmt::format("{:.3f}", 0.04 * (row / 4) + 0.001 * (row % 4)); };
  CHECK(with_stamps("IMUTime", packets).info.time.candidate == "IMUTime");
  CHECK(with_stamps("pressure", packets).info.time.candidate.empty());
  const Recording wanders = with_stamps("playtime", [](int row) { return std::to_string(row * 7919 % 301); });
  CHECK(wanders.info.time.candidate.empty());
  ReadOptions options;
  options.time_column = "IMUTime";
  CHECK(with_stamps("IMUTime", packets, options).info.time.rate_hz == Approx(100).epsilon(1e-3));
  try {
    known_rate_hz(with_stamps("my time", packets).info);
    FAIL("no rate is known");
  } catch (const Error& error) {
    CHECK_THAT(error.problem().hint, Catch::StartsWith("`time_column` 'my time' takes"));
  }
}

TEST_CASE("a steady clock is the time, whatever its name") {
  struct Named {
    const char* header;
    double step, rate_hz;
  };
  for (const Named& named :
       {Named{"ms", 10, 100}, Named{"us", 10000, 100}, Named{"millis()", 10, 100}, Named{"micros()", 10000, 100},
        Named{"TOW", 0.1, 10}, Named{"UTC", 0.02, 50}, Named{"IMUTime", 0.005, 200}, Named{"MasterTime", 0.005, 200},
        Named{"sensor_ts", 10000000, 100}, Named{"Tick", 10, 100}, Named{"loggingTime", 0.01, 100},
        Named{"\xE6\x97\xB6\xE9\x97\xB4", 0.01, 100}, Named{"Laufzeit", 0.01, 100}, Named{"ts", 0.01, 100},
        Named{"frame_clock", 10000, 100}}) {
    INFO(named.header);
    const Recording r = with_stamps(named.header, [&](int i) { return fmt::format("{}", 1000 + named.step * i); });
    CHECK(r.info.time.column == name_and_unit(named.header).first);
    CHECK(r.info.time.rate_hz == Approx(named.rate_hz));
  }
}

TEST_CASE("a unit behind a clock's name wins over the usual one of the name") {
  for (const char* header : {"TOW[ms]", "TOW (ms)", "tow_ms", "seconds [ms]", "time [ms]", "millis() [ms]"}) {
    INFO(header);
    const Recording r = with_stamps(header, [](int i) { return std::to_string(345600000 + 10 * i); });
    CHECK(r.info.time.unit == "ms");
    CHECK(r.info.time.rate_hz == Approx(100));
  }
}

TEST_CASE("whole numbers in steps of a minute are milliseconds where a gyroscope is read") {
  std::mt19937_64 random(3);
  for (const auto& [header, hz] : {std::pair{"time,gyroX", 1000.0 / 60},
                                   {"time,accel_x", 1000.0 / 60},
                                   {"time,rate[deg/s]", 1000.0 / 60},
                                   {"time,z,y", 1000.0 / 60},
                                   {"time,level", 1.0 / 60}}) {
    INFO(header);
    const bool axes = std::string_view(header) == "time,z,y";
    const Recording r = with_stamps(header, [&](int i) {
      return fmt::format("{},{}", 500 + 60 * i,
                         axes ? fmt::format("0,{}", random() % 9) : fmt::to_string(random() % 9));
    });
    CHECK(r.info.time.rate_hz == Approx(hz));
  }
  for (const int seconds : {60, 120, 300, 600, 1800, 3600})
    CHECK(with_stamps("time", [&](int i) { return std::to_string(500 + seconds * i); }).info.time.rate_hz ==
          Approx(1.0 / seconds));
}

TEST_CASE("whole numbers in steps of ten to thirty are seconds where thermometers are read") {
  const auto unit_of = [](const std::string& head, int step) {
    std::string text = head + "\n";
    for (int k = 0; k < 40; ++k) text += fmt::format("{},{}.5,{}.25\n", step * k, 20 + k % 3, 40 + k % 5);
    return test::read_text(text).info.time.unit;
  };
  for (const int step : {10, 20, 30, 60}) CHECK(unit_of("time,in (°C),out (°C)", step) == "s");
  CHECK(unit_of("time,temp[degC],humidity[%]", 30) == "s");
  CHECK(unit_of("time,temp[degC],gx[deg/s]", 10) == "ms");
  CHECK(unit_of("time,temp[degC],x", 10) == "ms");
}

TEST_CASE("a temperature that rises and a row counter are no time") {
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise(0, 0.05);
  CHECK(with_stamps("T", [&](int i) {
          return fmt::format("{:.3f}", 20 + 0.01 * i + noise(random));
        }).info.time.column.empty());
  CHECK(with_stamps("T", [&](int i) { return fmt::format("{:.2f}", 20 + 0.001 * i); }).info.time.column.empty());
  CHECK(
      with_stamps("temperature", [&](int i) { return fmt::format("{:.2f}", 20 + 0.01 * i); }).info.time.column.empty());
  for (const char* name : {"T", "T1", "TC2", "T_air"}) {  // however evenly: it begins far from zero
    INFO(name);
    CHECK(with_stamps(name, [&](int i) { return fmt::format("{:.2f}", 20 + 0.01 * i); }).info.time.column.empty());
    CHECK(with_stamps(name, [&](int i) {
            return fmt::format("{:.4f}", 21.5 + 0.01 * i + 0.03 * noise(random));
          }).info.time.column.empty());
    CHECK(with_stamps(name, [&](int i) { return fmt::format("{:.2f}", 0.01 * i); }).info.time.rate_hz == Approx(100));
  }
  CHECK(with_stamps("T", [&](int i) { return std::to_string(4000 + 10 * i); }).info.time.rate_hz == Approx(100));
  CHECK(with_stamps("T [s]", [&](int i) { return fmt::format("{:.2f}", 20 + 0.01 * i); }).info.time.rate_hz ==
        Approx(100));
  CHECK(with_stamps("sample", [](int i) { return std::to_string(i); }).info.time.column.empty());
  ReadOptions rate;
  rate.rate_hz = 100;  // who knows the rate looks for no clock
  CHECK(with_stamps(
            "angle", [](int i) { return fmt::format("{}", 0.5 * i); }, rate)
            .info.time.column.empty());
}

TEST_CASE("a temperature's letter in front of a unit is no time where it begins far from zero") {
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise(0, 0.02);
  double level = 20;
  for (const char* name : {"T_min", "T_h", "t_h", "T_d"}) {
    INFO(name);
    CHECK(
        with_stamps(name, [&](int) { return fmt::format("{:.2f}", level += noise(random)); }).info.time.column.empty());
  }
}

TEST_CASE("a count of packets that lacks some is no clock, time since 1970 is one however it rises") {
  for (const char* name : {"Packet number", "sample_no", "msg_count", "frame_index", "packet id"}) {
    INFO(name);
    CHECK(with_stamps(name, [](int i) { return std::to_string(i + i / 40); }).info.time.column.empty());
  }
  for (const double step : {1.0, 0.25}) {
    const Recording r =
        with_stamps("unix", [&](int i) { return fmt::format("{:.2f}", 1714564800 + step * (i < 50 ? i : i + 40)); });
    CHECK(r.info.time.rate_hz == Approx(1 / step));
    CHECK(r.info.time.missing_samples == 40);
  }
}

TEST_CASE("counts of 100 ns since long ago are dates") {
  for (const std::int64_t of_1970 : {std::int64_t{621355968} * 1000000000, std::int64_t{116444736} * 1000000000})
    for (const char* name : {"Ticks", "filetime", "time"})
      for (const int hz : {1, 50, 1000}) {
        const Recording r = with_stamps(name, [&](int i) {
          return std::to_string(of_1970 + std::int64_t{17145648} * 1000000000 + std::int64_t{10000000} / hz * i);
        });
        CHECK(r.info.time.rate_hz == Approx(hz));
        CHECK(r.info.time.unit == "100ns");
        CHECK(*r.info.time.start_ns == std::int64_t{1714564800} * 1000000000);
      }
}

TEST_CASE("a word for the time of day is no unit of numbers") {
  for (const char* name : {"hora", "heure", "Uhrzeit"}) {
    INFO(name);
    const Recording r = with_stamps(name, [](int i) { return fmt::format("{:.2f}", 3.25 + 0.02 * i); });
    CHECK(r.info.time.rate_hz == Approx(50));
  }
}

TEST_CASE("seconds and what is left of them stand in two columns, two full clocks do not") {
  for (const auto& [names, unit] : {std::pair{"tv_sec,tv_usec", 1000000},
                                    {"sec,msec", 1000},
                                    {"Seconds,Microseconds", 1000000},
                                    {"secs,nsecs", 1000000000}}) {
    INFO(names);
    const Recording r = with_stamps(
        names, [unit = unit](int i) { return fmt::format("{},{}", 1714564800 + i / 50, i % 50 * (unit / 50)); });
    CHECK(r.info.time.rate_hz == Approx(50));
    CHECK(r.info.channels.size() == 1);
  }
  for (const int step_ms : {20, 5}) {  // less than a second of them is looked at first
    const Recording two =
        with_stamps("sec,msec", [&](int i) { return fmt::format("{},{}", step_ms * i / 1000, step_ms * i); });
    CHECK(two.info.time.rate_hz == Approx(1000.0 / step_ms));
    CHECK(two.info.time.missing_samples == 0);
  }
}

TEST_CASE("a device's clock of whole seconds gives way to a steady host clock") {
  const Recording r = with_stamps("device_time[s],host_time[s]",
                                  [](int i) { return fmt::format("{},{:.3f}", (i * 10 + 3) / 10, 100 + i * 1.0003); });
  CHECK(r.info.time.column == "device_time");  // as good: one row a second
  const Recording s = with_stamps("device_time[s],host_time[s]",
                                  [](int i) { return fmt::format("{},{:.3f}", i * 7 / 20, 100 + i * 0.35); });
  CHECK(s.info.time.column == "host_time");
  CHECK_THAT(s.info.guesses.front(), Catch::Contains("steadier than device_time"));
}

TEST_CASE("counts of days are read to the millisecond, as a guess") {
  struct Days {
    const char* header;
    double first;
    std::int64_t start_s;
  };
  for (const Days& days : {Days{"time", 45292, 1704067200}, Days{"MJD", 60310, 1704067200},
                           Days{"time", 739252, 1704067200}, Days{"time", 2460310.5, 1704067200}}) {
    for (const double step_s : {0.01, 1.0, 10.0, 60.0}) {
      INFO(days.header << " " << days.first << " " << step_s);
      const Recording r = with_stamps(
          days.header, [&](int i) { return fmt::format("{:.12f}", days.first + 0.25 + i * step_s / 86400); });
      CHECK(r.info.time.unit == "d");
      CHECK(r.info.time.unit_guessed);
      CHECK(r.info.time.rate_hz == Approx(1 / step_s).epsilon(1e-3));
      CHECK(static_cast<double>(*r.info.time.start_ns) * 1e-9 ==
            Approx(static_cast<double>(days.start_s + 21600)).margin(0.001));
    }
  }
  const Recording pair =
      with_stamps("MJD,sod", [](int i) { return fmt::format("{},{}", 60310 + i / 200, i % 200 * 432); });
  CHECK(pair.info.time.rate_hz == Approx(1.0 / 432));
  for (const char* header : {"mjd,secofday", "Day (MJD),Seconds of day [s]", "MJD,UTC seconds"})
    CHECK(with_stamps(header, [](int i) {
            return fmt::format("{},{}", 60310 + i / 200, i % 200 * 432);
          }).info.time.rate_hz == Approx(1.0 / 432));
  ReadOptions hours;
  for (const auto& [unit, rate] : {std::pair{"min", 1.0 / 60}, {"h", 1.0 / 3600}, {"d", 1.0 / 86400}}) {
    hours.time_unit = unit;
    CHECK(with_stamps(
              "t", [](int i) { return std::to_string(i); }, hours)
              .info.time.rate_hz == Approx(rate));
  }
}

TEST_CASE("minutes and seconds of an hour go on behind it") {
  const Recording r = with_stamps("t", [](int i) {
    const int tenths = 35900 + i;
    return fmt::format("{:02}:{:02}.{}", tenths / 600 % 60, tenths / 10 % 60, tenths % 10);
  });
  CHECK(r.info.time.rate_hz == Approx(10));
  CHECK(r.info.samples == 300);
}

TEST_CASE("two numbers of a clock are minutes and seconds where one of them is above any hour") {
  for (const int from : {0, 1300, 2400}) {
    std::string text = "time,x\n";
    for (int i = 0; i < 3000; ++i) text += fmt::format("{:02}:{:02},{}\n", (from + i) / 60, (from + i) % 60, i % 7);
    const Recording r = test::read_text(text);
    INFO(from);
    CHECK(r.info.time.rate_hz == Approx(1));
    CHECK(r.info.samples == 3000);
  }
  const Recording hours = with_stamps("time", [](int i) { return fmt::format("{:02}:{:02}", i / 60, i % 60); });
  CHECK(hours.info.time.rate_hz == Approx(1.0 / 60));
  const Recording hour_behind = with_stamps("time", [](int i) {
    const int s = 3500 + i;
    return s < 3600 ? fmt::format("{:02}:{:02}", s / 60, s % 60) : fmt::format("1:{:02}:{:02}", s / 60 % 60, s % 60);
  });
  CHECK(hour_behind.info.time.rate_hz == Approx(1));
  CHECK(hour_behind.info.samples == 300);
}

TEST_CASE("clocks with words for their units, and what ran for days") {
  const auto rate = [](const std::function<std::string(int)>& stamp) {
    const Recording r = with_stamps("Zeit", stamp);
    return r.info.samples == 300 ? r.info.time.rate_hz : -1;
  };
  CHECK(rate([](int i) { return fmt::format("{:02}h{:02}m{:02}s", i / 3600, i / 60 % 60, i % 60); }) == Approx(1));
  CHECK(rate([](int i) { return fmt::format("{}h{:02}", 5 + i / 60, i % 60); }) == Approx(1.0 / 60));
  CHECK(rate([](int i) { return fmt::format("{} {:02}:{:02}:00", i / 24, i % 24, 0); }) == Approx(1.0 / 3600));
  CHECK(rate([](int i) { return fmt::format("{}:{:02}:00", i / 6, i % 6 * 10); }) == Approx(1.0 / 600));
  CHECK(rate([](int i) { return fmt::format("2024年3月5日 {:02}时{:02}分{:02}秒", 8, i / 60, i % 60); }) == Approx(1));
  CHECK(rate([](int i) { return fmt::format("2024-03-05 오전 {}:{:02}:{:02}", 8, i / 60, i % 60); }) == Approx(1));
}

TEST_CASE("a word for a unit, alone or behind a word for time, names the time") {
  const auto steps = [](const std::string& name, int a_unit) {
    std::string text = name + ";x\n";
    for (int k = 0; k < 100; ++k) text += fmt::format("{:.7f};{}\n", k / static_cast<double>(a_unit), k % 7);
    return test::read_text(text).info;
  };
  for (const std::string name : {"Elapsed Hours", "Hours", "Zeit in Stunden", "Run Time, hours"})
    CHECK(steps(name, 360).time.rate_hz == Approx(0.1).epsilon(1e-5));
  for (const std::string name : {"Minutes", "time_min", "Elapsed Minutes"})
    CHECK(steps(name, 600).time.rate_hz == Approx(10).epsilon(1e-4));
  for (const std::string name : {"time (in hours)", "time [in hours]", "Time (hrs)", "time_h", "t/h", "Elapsed_h",
                                 "Zeit (Stunden)", "temps (heures)", "Hours since start", "hour", "runtime_h"})
    CHECK(steps(name, 360).time.rate_hz == Approx(0.1).epsilon(1e-5));
  for (const std::string name :
       {"Time (mins)", "Time/min", "Time [Minuten]", "time (in minutes)", "Time [m]", "minute"})
    CHECK(steps(name, 600).time.rate_hz == Approx(10).epsilon(1e-4));
  for (const std::string name :
       {"t [d]", "Time (d)", "time_d", "t / d", "Zeit [Tage]", "Days since start", "DOY", "day"})
    CHECK(steps(name, 8640).time.rate_hz == Approx(0.1).epsilon(1e-3));
  for (const std::string name : {"t [Sek.]", "Zeit (Sekunden)", "Time [seg]", "Seconds since start"}) {
    CHECK(steps(name, 50).time.rate_hz == Approx(50));
    CHECK_FALSE(steps(name, 50).time.unit_guessed);
  }
  std::string range = "t,min,max\n";
  for (int k = 0; k < 100; ++k) range += fmt::format("{:.2f},{},{}\n", k / 100.0, k, k + 1);
  CHECK(test::read_text(range).info.time.rate_hz == Approx(100));
}

TEST_CASE("tables of two loggers side by side: each channel has the stamps in front of it") {
  const auto table = [](const std::string& names, double a_hz, double b_hz, int a, int b) {
    std::string text = names + "\n";
    for (int k = 0; k < std::max(a, b); ++k)
      text += (k < a ? fmt::format("{:.3f},{},", k / a_hz, k % 7) : ",,") +
              (k < b ? fmt::format("{:.3f},{}\n", k / b_hz, k % 5) : ",\n");
    return text;
  };
  for (const char* names : {"Time A,A,Time B,B", "t1 [s],A,t2 [s],B"}) {
    INFO(names);
    const std::string second = std::string(names).starts_with("T") ? "Time B" : "t2";
    for (const bool longer : {false, true}) {  // than the table of the time
      const std::string text = table(names, 10, 4, longer ? 100 : 400, longer ? 400 : 200);
      const Recording both = test::read_text(text);
      REQUIRE(both.info.channels.size() == 2);
      CHECK(both.info.time.rate_hz == Approx(10));
      CHECK(both.info.channels[0].own_clock.empty());
      CHECK(both.info.channels[1].own_clock == second);
      const Finding* own = both.info.warnings.find("own_stamps");
      REQUIRE(own != nullptr);
      CHECK(own->severity == Severity::bad);
      CHECK(own->help.at(0).options == std::vector<Finding::Setting>{{"time_column", second}, {"channels", "B"}});
      ReadOptions by_own;
      by_own.time_column = second;
      by_own.channels = {"B"};
      const Recording b = test::read_text(text, by_own);
      CHECK(b.info.time.rate_hz == Approx(4));
      CHECK(b.samples.at(0).size() == (longer ? 400 : 200));
      CHECK(b.info.warnings.find("own_stamps") == nullptr);
    }
    CHECK(test::read_text(table(names, 10, 10.05, 400, 400)).info.warnings.find("own_stamps") == nullptr);
  }
  // A stamp that is missing in the midst of the table is missing.
  std::string hole = table("Time A,A,Time B,B", 10, 4, 400, 400);
  hole.replace(hole.find("\n20.000,") + 1, 6, "");
  CHECK_THAT(test::failure(hole), Catch::Contains("missing time stamp"));
}

TEST_CASE("counts of a timer of unknown speed are a doubt, whole milliseconds hardly one") {
  const auto severity = [](int step) {
    std::string text = "ticks,x\n";
    for (int k = 0; k < 100; ++k) text += fmt::format("{},{}\n", 1234567 + k * step, k % 7);
    const Finding* said = test::read_text(text).info.warnings.find("time_unit_guessed");
    REQUIRE(said != nullptr);
    return said->severity;
  };
  CHECK(severity(72000) == Severity::caution);
  CHECK(severity(84000) == Severity::caution);
  CHECK(severity(1000) == Severity::caution);  // 1 Hz or 1 kHz
  CHECK(severity(10) == Severity::caution);    // 100 Hz or 0.1 Hz
  CHECK(severity(498) == Severity::caution);   // a loop of 500 ms, or 2 kHz
  CHECK(severity(4) == Severity::note);
}

TEST_CASE(
    "tables side by side whose times have one name: each is chosen by its number, one that repeats is the first") {
  std::string text = "t,A,t,B,t,C\n";
  for (int k = 0; k < 200; ++k)
    text += fmt::format("{0},{1},{2},{3},{0},{4}\n", 0.1 * k, k % 7, 0.25 * k, k % 5, k % 3);
  const Recording log = test::read_text(text);
  REQUIRE(log.info.channels.size() == 3);
  CHECK(log.info.channels[1].own_clock == "t_2");
  CHECK(log.info.channels[2].own_clock.empty());
  ReadOptions options;
  options.time_column = "t_2";
  options.channels = {"B"};
  CHECK(test::read_text(text, options).info.time.rate_hz == Approx(4));
}

TEST_CASE("a temperature t that seldom changes is none the less no time") {
  std::string text = "f,ax,t\n";
  for (int k = 0; k < 60; ++k)
    text += fmt::format("{},{},{}\n", 2314 + 23 * k + k % 2, k % 7, k % 5 == 2 ? 27.9 : 27.8);
  CHECK(test::read_text(text).info.time.column == "f");
}

TEST_CASE("an index is time where it counts that since 1970, else it counts rows") {
  const auto column = [](std::int64_t first, std::int64_t step) {
    std::string text = "index,x\n";
    for (int k = 0; k < 50; ++k) text += fmt::format("{},{}\n", first + step * k, k % 7);
    return test::read_text(text).info.time.column;
  };
  CHECK(column(1700000000000000000, 5000000) == "index");
  CHECK(column(3, 1).empty());
}

TEST_CASE("a coarse clock is known beside a pause and a stretch where the log hung") {
  std::mt19937 generator(5);
  std::string text = "stamp_ms,x\n";
  double at = 5000;
  int last = 0;
  for (int k = 0; k < 20000; ++k) {
    at += 1;
    if (k == 469) at += 4380;
    if (k == 671) at += 57;
    if (k > 671 && k < 684) at += 2.5;
    last = std::max(last, static_cast<int>(at + std::uniform_real_distribution<>(0, 1.2)(generator)));
    text += fmt::format("{},{}.5\n", last, k * 37 % 101);
  }
  const Recording log = test::read_text(text);
  CHECK(log.info.time.rate_hz == Approx(1000).epsilon(1e-3));
  CHECK(log.info.warnings.find("duplicate_timestamp") == nullptr);
}

TEST_CASE("samples that beat slowly with whole seconds keep their rate") {
  for (const double interval : {1.0024, 0.9970, 1.0009}) {
    std::string text = "time,x\n";
    for (int i = 0; i < 6000; ++i)
      text += fmt::format("{},{}\n", 1700000000 + static_cast<int>(std::floor(0.4 + interval * i)), i % 7);
    const Recording r = test::read_text(text);
    INFO(interval);
    CHECK(r.info.time.rate_hz == Approx(1 / interval).epsilon(1e-4));
    CHECK(r.info.samples == 6000);
    CHECK(r.info.time.missing_samples == 0);
  }
  std::mt19937 random(7);
  std::string lost = "time,x\n";  // some at random
  for (int i = 0; i < 6000; ++i)
    if (random() % 500 != 0) lost += fmt::format("{},{}\n", 1700000000 + i, i % 7);
  const Recording r = test::read_text(lost);
  CHECK(r.info.time.rate_hz == Approx(1));
  CHECK(r.info.samples == 6000);
}

TEST_CASE("which number of a date is the day follows from the whole head") {
  for (const bool day_first : {true, false}) {
    const Recording r = with_stamps("date", [&](int i) {
      const int hour = i % 24, day = 1 + i / 24;
      return day_first ? fmt::format("{:02}/05/24 {:02}:00", day, hour)
                       : fmt::format("05/{:02}/24 {:02}:00", day, hour);
    });
    CHECK(r.info.samples == 300);
    CHECK(r.info.time.gaps == 0);
  }
}

TEST_CASE("a preamble says how long a count of the stamps is") {
  std::string text = "GYROFLOW IMU LOG\nversion,1.3\ntscale,0.002\nt,gx,gy\n";
  for (int i = 0; i < 300; ++i) text += fmt::format("{},{},{}\n", i, i % 7, i % 5);
  const Recording r = test::read_text(text);
  CHECK(r.info.time.rate_hz == Approx(500));
}

TEST_CASE("parts of a second without leading zeros") {
  for (const int per_second : {1000000000, 1000000}) {
    const Recording r = with_stamps("t[s]", [&](int i) {
      const std::int64_t part = static_cast<std::int64_t>(i % 100) * (per_second / 100);
      return fmt::format("{}.{}", 1700000000 + i / 100, part);
    });
    CHECK(r.info.time.rate_hz == Approx(100));
    CHECK(r.info.samples == 300);
  }
}

TEST_CASE("the finer clock of a table is the time, and a coarse one that keeps time with it no channel") {
  struct Clocks {
    const char *head, *form;  ///< of seconds since 1970, whole and with the host's delay
    const char* column;
  };
  for (const Clocks& one :
       {Clocks{"device_time,host_time", "{0},{1:.3f}", "host_time"}, Clocks{"device_ts,pc_ts", "{0},{1:.3f}", "pc_ts"},
        Clocks{"sensor_time,received_at", "{0},{1:.3f}", "received_at"},
        Clocks{"timestamp,millis", "{0},{2:.0f}", "millis"}, Clocks{"epoch,t_us", "{0},{3:.0f}", "t"}}) {
    INFO(one.head);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> delay(0, 0.004);
    std::string text = std::string(one.head) + ",x\n";
    for (int k = 0; k < 1200; ++k) {
      const double t = 0.05 * k + delay(random);
      text += fmt::format(fmt::runtime(one.form), 1700000000 + k / 20, 1.7e9 + t, 5000 + 1e3 * t, 1e6 * t);
      text += fmt::format(",{}\n", k % 7);
    }
    const Recording log = test::read_text(text);
    CHECK(log.info.time.column == one.column);
    CHECK(log.info.time.rate_hz == Approx(20).epsilon(1e-3));
    CHECK(log.info.channels.size() == 1);
  }
  // What rises beside a coarse clock need not be one.
  std::string text = "time_s,odometer\n";
  for (int k = 0; k < 300; ++k) text += fmt::format("{},{:.2f}\n", k / 20, 0.05 * k);
  CHECK(test::read_text(text).info.time.column == "time");
}

TEST_CASE("the unit of text without names is decided where only one makes sense, else both are offered") {
  const auto read = [](const std::string& front, double begin, double step, double wander) {
    std::string text = front;
    for (int i = 0; i < 40; ++i)
      text += fmt::format("{:.0f},{}\n", begin + step * i + wander * (i % 3), i * 7919 % 101);
    return test::read_text(text).info;
  };
  const auto refused = [&](double begin, double step) {
    try {
      return "read as " + read("", begin, step, 0).time.unit;
    } catch (const Error& error) {
      return std::string(error.what());
    }
  };
  CHECK_THAT(refused(12345, 1e7), Catch::Contains("E0325") && Catch::Contains("`time_unit` us or `time_unit` ns"));
  CHECK_THAT(refused(5e9, 1e6), Catch::Contains("E0325"));
  CHECK_THAT(refused(12345, 1000), Catch::Contains("E0325") && Catch::Contains("`time_unit` ms or `time_unit` us"));
  CHECK_THAT(refused(12345, 4000), Catch::Contains("read as us"));
  CHECK(read("", 12345, 10, 0).time.unit == "ms");
  CHECK(read("", 5e9, 1e7, 1).time.unit == "us");  // nanoseconds that wander by two do not exist
  CHECK(read("", 2e13, 1e6, 0).time.unit == "ns");
}

TEST_CASE("seconds kept in 32 bits are no days of a spreadsheet, and rates between their steps are even") {
  std::string text = "time,gx\n", finer = "time,gx\n";
  for (int i = 0; i < 3000; ++i) {
    text += fmt::format("{:.6f},{}\n", static_cast<double>(static_cast<float>(70000 + i / 64.0)), i * 7919 % 101);
    finer += fmt::format("{:.6f},{}\n", static_cast<double>(static_cast<float>(20000 + i / 400.0)), i * 7919 % 101);
  }
  CHECK(test::read_text(text).info.time.rate_hz == Approx(64).epsilon(1e-3));
  const Recording r = test::read_text(finer);
  CHECK(r.info.time.rate_hz == Approx(400).epsilon(1e-3));
  CHECK(r.info.time.missing_samples == 0);
}

TEST_CASE("what exceeds a week is no second of it") {
  const auto rate = [](const std::string& name, double begin, double step, int decimals) {
    std::string text = name + ",gx\n";
    for (int i = 0; i < 500; ++i) text += fmt::format("{:.{}f},{}\n", begin + step * i, decimals, i * 7919 % 101);
    return test::read_text(text).info.time.rate_hz;
  };
  CHECK(rate("TOW", 302400000, 20, 0) == Approx(50));
  CHECK(rate("TOW", 302400, 0.02, 2) == Approx(50));
  CHECK(rate("iTOW", 302400, 0.02, 2) == Approx(50));
  CHECK(rate("iTOW", 302400000, 20, 0) == Approx(50));
}

TEST_CASE("milliseconds since 1970 of a thermometer are no seconds") {
  std::string text = "timestamp,Temperature [degC],Humidity [%]\n";
  for (int i = 0; i < 500; ++i) text += fmt::format("{},20.{},40\n", 1715933602000 + 5 * i, i * 7919 % 101);
  CHECK(test::read_text(text).info.time.rate_hz == Approx(200));
}

TEST_CASE("first rows that share one time of a spreadsheet are days") {
  std::string text = "DateTime,x\n";
  for (int i = 0; i < 3000; ++i)
    text += fmt::format("{:.10f},{}\n", 45429.3427314815 + 3.0 * (i / 300) / 86400, i * 7919 % 101);
  CHECK(test::read_text(text).info.time.rate_hz == Approx(100).epsilon(1e-2));
}
