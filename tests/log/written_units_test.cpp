// What instruments and programs write around and in place of numbers: samples that go on from line to line, counters
// with thousands, signs of an overload, times with their units, names with commas, lines below the table.

#include <fmt/format.h>

#include <catch2/catch.hpp>

#include "tests/log/log_text.hpp"

using namespace libchar;
using test::count;
using test::failure;
using test::read_text;

namespace {

constexpr int kUnitRows = 400;

double unit_value(int k) { return 0.5 + 0.001 * ((k * 7919) % 97); }

std::string unit_rows(const std::string& head, const std::function<std::string(int)>& row, int rows = kUnitRows) {
  std::string out = head;
  for (int k = 0; k < rows; ++k) out += row(k) + "\n";
  return out;
}

/// Seconds as Go prints them: "980ms", "1.02s", "1m0.5s", "1h0m0s".
std::string go_time(int ms) {
  if (ms == 0) return "0s";
  if (ms < 1000) return fmt::format("{}ms", ms);
  std::string seconds = fmt::format("{:.3f}", ms % 60000 / 1000.0);
  while (seconds.back() == '0') seconds.pop_back();
  if (seconds.back() == '.') seconds.pop_back();
  const int minutes = ms / 60000;
  if (minutes == 0) return seconds + "s";
  return minutes < 60 ? fmt::format("{}m{}s", minutes, seconds)
                      : fmt::format("{}h{}m{}s", minutes / 60, minutes % 60, seconds);
}

}  // namespace

TEST_CASE("samples of SLIST follow each other in a line, and are one channel") {
  for (const char* sign : {"\t", "  "}) {
    std::string text = "TIMESERIES XX_STA__BHZ_D, 400 samples, 20 sps, 2010-02-27T06:50:00.069500, SLIST, FLOAT, M/S\n";
    for (int k = 0; k < kUnitRows; ++k) text += fmt::format("{:.3f}", unit_value(k)) + (k % 6 == 5 ? "\n" : sign);
    const Recording log = read_text(text + "\n");
    REQUIRE(log.samples.size() == 1);
    CHECK(log.info.time.rate_hz == Approx(20));
    REQUIRE(log.samples[0].size() == kUnitRows);
    for (const int k : {0, 1, 5, 6, 7, 399})
      CHECK(log.samples[0][static_cast<std::size_t>(k)] == Approx(unit_value(k)));
  }
}

TEST_CASE(
    "behind a clock one comma divides whole numbers where the digits behind it do not change with those in front") {
  const Recording log = read_text(unit_rows("", [](int k) {
    return fmt::format("12:00:{:02}.{:03} {},{}", k / 50, k % 50 * 20, (k * 31) % 50 - 20, 1290 + k % 20);
  }));
  REQUIRE(log.samples.size() == 2);
  CHECK(log.samples[0].front() == -20);
  CHECK(log.samples[1].front() == 1290);
  CHECK(log.info.time.rate_hz == Approx(50));
  for (const char* clock : {"12:00:{:02}.{:03} ", "12:00:{:02}.{:03}  ", "12:00:{:02},{:03} "}) {
    const Recording decimal = read_text(unit_rows("", [&](int k) {
      const int n = 15000 + (k * 7919) % 9973;
      return fmt::format(fmt::runtime(clock), k / 50, k % 50 * 20) + fmt::format("{},{:03}", n / 1000, n % 1000);
    }));
    INFO(clock);
    REQUIRE(decimal.samples.size() == 1);
    CHECK(decimal.samples[0].front() == Approx(15));
    CHECK(decimal.samples[0][1] == Approx(22.919));
  }
  const Recording commas = read_text(
      unit_rows("", [](int k) { return fmt::format("12:00:{:02},{:03} 1,{:03}", k / 50, k % 50 * 20, 300 + k % 20); }));
  CHECK(commas.info.time.rate_hz == Approx(50));
}

TEST_CASE("counters group thousands in front of the point alone, too") {
  const Recording log =
      read_text(unit_rows("", [](int k) { return fmt::format("10,000,00{}.{:06} Hz", k % 3, 1000 + k); }));
  REQUIRE(log.samples.size() == 1);
  CHECK(log.samples[0][1] == Approx(10000001.001001).epsilon(1e-15));
  CHECK(log.info.channels[0].unit == "Hz");
  // Columns of numbers are none.
  CHECK(read_text(unit_rows("", [](int k) {
          return fmt::format("{},{},{}.5", k % 7, 100 + k % 80, 200 + k % 90);
        })).samples.size() == 3);
}

TEST_CASE("an overload of a multimeter is a missing value") {
  for (const char* sign : {"OL", "-OL", "O.L", "OVLD", "overload"}) {
    const Recording log = read_text(unit_rows("t,v\n", [&](int k) {
      return fmt::format("{:.2f},{}", 0.01 * k, k % 50 == 7 ? sign : fmt::format("{:.3f}", unit_value(k)));
    }));
    INFO(sign);
    CHECK(count(log, "missing_cell") == kUnitRows / 50);
    CHECK(log.info.time.missing_samples == 0);
  }
}

TEST_CASE("a comma inside of brackets is part of a name") {
  const auto row = [](int k) { return fmt::format("{:.2f},{:.3f},{}", 0.01 * k, unit_value(k), k % 5); };
  const Recording log = read_text(unit_rows("t,Temp (LGR 1, SEN 2),x\n", row));
  REQUIRE(log.info.channels.size() == 2);
  CHECK(log.info.channels[1].name == "x");
  CHECK(log.info.channels[0].name.starts_with("Temp"));
  CHECK(read_text(unit_rows("t,\"a\",b[x,y]\n", row)).info.channels.size() == 2);
}

TEST_CASE("names may have a line of empty units below them") {
  const Recording log = read_text(unit_rows(
      "timestamp,p1\n,\n", [](int k) { return fmt::format("{},{:.3f}", 1714564800000 + 100 * k, unit_value(k)); }));
  CHECK(log.info.time.rate_hz == Approx(10));
  CHECK(log.samples[0].size() == kUnitRows);
}

TEST_CASE("lines of words behind the last row end a table") {
  const auto row = [](int k) { return fmt::format("{:.2f},{:.3f}", 0.01 * k, unit_value(k)); };
  const auto barred = [](int k) { return fmt::format("{:.2f} | {:.3f}", 0.01 * k, unit_value(k)); };
  for (const auto& [text, lines] :
       {std::pair(unit_rows("t,x\n", row) + "Average,0.55\nMaximum,0.6\n", 2),
        std::pair(unit_rows("t x\n", [](int k) { return fmt::format("{:.2f} {:.3f}", 0.01 * k, unit_value(k)); }) +
                      "(400 rows)\n",
                  1),
        std::pair(unit_rows("t,x\n", row) + "\n(400 rows affected)\n", 1),
        std::pair(unit_rows("t,x\n", row) + "*** END OF DATA ***", 1),
        std::pair(unit_rows("t | x\n", barred) + "400 rows in set (0.00 sec)\n\n", 1),
        std::pair(unit_rows("x\n", [](int k) { return fmt::format("{}", unit_value(k)); }) + "End of file\n", 1)})
    for (const std::size_t block : {std::size_t{16}, std::size_t{1} << 20U}) {
      ReadOptions options;
      options.block_bytes = block;
      const Recording log = read_text(text, options);
      INFO(text.substr(text.size() - 40));
      CHECK(log.samples[0].size() == kUnitRows);
      CHECK(count(log, "footer_line") == static_cast<std::uint64_t>(lines));
      CHECK(log.samples[0].back() == Approx(unit_value(kUnitRows - 1)));
    }
}

TEST_CASE("lines of words between rows end no table, and words in the place of a table are none") {
  const auto row = [](int k) { return fmt::format("{:.2f},{:.3f}", 0.01 * k, unit_value(k)); };
  const std::string before = unit_rows("t,x\n", row, 50);
  for (const std::size_t block : {std::size_t{16}, std::size_t{1} << 20U}) {
    ReadOptions options;
    options.block_bytes = block;
    CHECK_THAT(failure(before + "Sensor lost\n0.50,1\n", options), Catch::Contains("log.csv:52:1"));
    CHECK_THAT(failure(before + "Sensor lost\n\n\n0.50,1\nSensor found\n", options), Catch::Contains("log.csv:52:1"));
    const std::string many = unit_rows(
        unit_rows("t,x\n", row, 150), [](int) { return "Sensor lost"; }, 45);
    CHECK_THAT(failure(many, options), Catch::Contains("log.csv:152:1"));
    CHECK_THAT(failure("t,x\n0,1\n0.1,2\nSensor lost\n", options), Catch::Contains("log.csv:4:1"));
    CHECK_THAT(failure(before + "0.50,error\n", options), Catch::Contains("log.csv:52:6"));
  }
  ReadOptions drop;
  drop.missing.bad_rows = true;
  CHECK(count(read_text(before + "Sensor lost\n0.50,1\n", drop), "bad_row") == 1);
}

TEST_CASE("stamps may have their units, which change on the way") {
  for (const int first : {0, 59000, 3599000}) {
    const Recording log = read_text(
        unit_rows("time,x\n", [&](int k) { return fmt::format("{},{:.3f}", go_time(first + 20 * k), unit_value(k)); }));
    INFO(first);
    CHECK(log.info.time.rate_hz == Approx(50));
    CHECK(log.info.time.missing_samples == 0);
    CHECK(log.samples.size() == 1);
  }
  // Lengths of time that come and go are no stamps.
  const Recording lengths = read_text(
      unit_rows("t,delay\n", [](int k) { return fmt::format("{:.2f},{}ms", 0.01 * k, 100 + (k * 31) % 17); }));
  CHECK(lengths.info.channels.at(0).unit == "ms");
  CHECK(lengths.info.time.rate_hz == Approx(100));
}

TEST_CASE("a tick of an unknown unit stands back behind a time in seconds") {
  const Recording log = read_text(unit_rows("Clock:Tick#,Clock:offsetTime,IMU_ATTI(0):accelX:C\n", [](int k) {
    return fmt::format("{},{:.3f},{:.3f}", 445000000 + 22500 * k, 0.005 * k, unit_value(k));
  }));
  CHECK(log.info.time.rate_hz == Approx(200));
  CHECK(log.info.time.column == "Clock:offsetTime");
}

TEST_CASE("recorders that write a key in front of each line, and oscilloscopes with their clock in a comment") {
  const Recording recorder = read_text(unit_rows(
      "\"Header Size\",16\n\"Model Name\",\"DL850\"\n\"TraceName\",\"CH1\",\"CH2\"\n\"BlockSize\",400,400\n"
      "\"VUnit\",\"V\",\"mV\"\n\"SampleRate\",5.0E+01,5.0E+01\n\"HResolution\",2.0E-02,2.0E-02\n"
      "\"HUnit\",\"s\",\"s\"\n\"Date\",\"2024/05/01\",\"2024/05/01\"\n\"Time\",\"12:00:00.0\",\"12:00:00.0\"\n\n",
      [](int k) { return fmt::format(",{:.3f},{:.3f},", unit_value(k), 1 + unit_value(k)); }));
  REQUIRE(recorder.info.channels.size() == 2);
  CHECK(recorder.info.channels[0].name == "CH1");
  CHECK(recorder.info.channels[1].unit == "mV");
  CHECK(recorder.info.time.rate_hz == Approx(50));
  CHECK(recorder.samples[0].size() == kUnitRows);
  const Recording scope = read_text(unit_rows("#CHANNEL:CH1\n#CLOCK=400.000uS\n#SIZE=400\n#UNITS:V\n",
                                              [](int k) { return fmt::format("{},{:.3f}", k, unit_value(k)); }));
  CHECK(scope.info.time.rate_hz == Approx(2500));
}

TEST_CASE("hexadecimal numbers are refused with the command that writes decimal ones") {
  const std::string text =
      unit_rows("t_ms,raw\n", [](int k) { return fmt::format("{},0x{:04X}", 20 * k, 1000 + k % 31); });
  CHECK_THAT(failure(text), Catch::Contains("E0326") && Catch::Contains("perl -pe"));
}

TEST_CASE("records of earthquakes list the samples of one channel") {
  const auto listed = [](int columns, const char* form) {
    std::string out;
    for (int k = 0; k < kUnitRows; ++k)
      out += fmt::format(fmt::runtime(form), unit_value(k)) + (k % columns + 1 == columns ? "\n" : "");
    return out + "\n";
  };
  const std::string peer =
      "PEER NGA STRONG MOTION DATABASE RECORD\nHill, 5/19/1940, Array #9, 180\n"
      "ACCELERATION TIME SERIES IN UNITS OF G\n";
  for (const auto& [text, rate_hz] :
       {std::pair(peer + "NPTS=    400, DT=   .0050 SEC,\n" + listed(5, "  {:.7E}"), 200),
        std::pair(peer + "  400    0.0200    NPTS, DT\n" + listed(5, "  {:.7E}"), 50),
        std::pair("Origin Time       2000/10/06 13:30:00\nSampling Freq(Hz) 100Hz\nScale Factor      "
                  "2000(gal)/8388608\nMemo.             \n" +
                      listed(8, "   {:.3f}"),
                  100)}) {
    const Recording log = read_text(text);
    REQUIRE(log.samples.size() == 1);
    CHECK(log.info.time.rate_hz == Approx(rate_hz));
    REQUIRE(log.samples[0].size() == kUnitRows);
    CHECK(log.samples[0][7] == Approx(unit_value(7)));
  }
}

TEST_CASE("one name above week and second of the week") {
  const Recording log = read_text(unit_rows("%  GPST          latitude(deg) height(m)\n", [](int k) {
    return fmt::format("2137 {}.000   {:.6f}  {:.4f}", 422922 + k, 40 + unit_value(k), 1578 + unit_value(k));
  }));
  CHECK(log.info.time.rate_hz == Approx(1));
  CHECK(log.info.time.column == "GPST");
  CHECK(log.info.channels.back().name == "height");
}

TEST_CASE("a unit that is not known is said with its channel, whoever wrote it") {
  const auto rows = [](const std::string& head) {
    return unit_rows(head + "\n",
                     [](int k) { return fmt::format("{},{},{},{}", k * 0.01, unit_value(k), k % 7, k % 5); });
  };
  const Recording log = read_text(rows("t,gx [dgs],ax [m/s^2],n"));
  CHECK(log.info.channels[0].unit == "dgs");
  const Finding* said = log.info.warnings.find("unknown_unit");
  REQUIRE(said != nullptr);
  CHECK(said->count == 1);
  CHECK(said->where.rows == std::vector<std::string>{"gx [dgs]"});
  CHECK(count(read_text(rows("t,w [rad_s^-1],p [kg m^2/s],i [µA]")), "unknown_unit") == 0);
  ReadOptions options;
  options.channel_unit = {"gx=deg/s"};
  CHECK(count(read_text(rows("t,gx [dgs],ax [m/s^2],n"), options), "unknown_unit") == 0);
  options.channel_unit = {"n=sverdrup"};
  CHECK(count(read_text(rows("t,gx [deg/s],ax [m/s^2],n"), options), "unknown_unit") == 1);
}
