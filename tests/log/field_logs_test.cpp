// Lines as terminals, loggers, daemons, databases and instruments write them: each is read with its stamps, names and
// values, or refused with the way to a table.

#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <functional>
#include <numeric>
#include <random>

#include "libchar/log/detail/column_name.hpp"
#include "libchar/log/time/calendar.hpp"
#include "libchar/log/time/time_column.hpp"
#include "tests/log/log_text.hpp"

using namespace libchar;
using Catch::Contains;
using test::count;
using test::failure;
using test::read_text;

namespace {

constexpr int kFieldRows = 400;

std::string field_text(const std::function<std::string(int)>& line, int rows = kFieldRows) {
  std::string out;
  for (int k = 0; k < rows; ++k) out += line(k) + "\n";
  return out;
}

std::string field_clock(int k, int step_ms = 20) {
  const int ms = k * step_ms;
  return fmt::format("12:{:02}:{:02}.{:03}", ms / 60000, ms / 1000 % 60, ms % 1000);
}

double field_value(int k, int channel) { return 0.1 * channel + 0.001 * ((k * 7919) % 97); }
std::string field_cells(int k, char sign = ',') {
  return fmt::format("{:.3f}{}{:.3f}", field_value(k, 1), sign, field_value(k, 2));
}

/// Two channels at this rate, with the values of field_value().
void check_field_log(const std::string& text, double rate_hz, int rows = kFieldRows, const ReadOptions& options = {}) {
  const Recording log = read_text(text, options);
  REQUIRE(log.info.channels.size() == 2);
  CHECK(log.info.time.rate_hz == Approx(rate_hz).epsilon(1e-4));
  CHECK(log.info.time.missing_samples == 0);
  REQUIRE(log.samples.size() == 2);
  REQUIRE(log.samples[0].size() == static_cast<std::size_t>(rows));
  for (const int k : {0, 1, rows / 2, rows - 1})
    for (const int c : {0, 1}) CHECK(log.samples[c][static_cast<std::size_t>(k)] == Approx(field_value(k, c + 1)));
}

}  // namespace

TEST_CASE("words in front of the cells, with or without a stamp among them") {
  const std::vector<std::pair<std::string, std::function<std::string(int)>>> fronts = {
      {"ts", [](int k) { return "May 01 " + field_clock(k) + " "; }},
      {"ts %.s", [](int k) { return fmt::format("{:.6f} ", 1714564800 + 0.02 * k); }},
      {"journalctl", [](int k) { return "May 01 " + field_clock(k) + "456 host imu[123]: "; }},
      {"docker", [](int k) { return "2024-05-01T" + field_clock(k) + "456789Z "; }},
      {"logcat", [](int k) { return "05-01 " + field_clock(k) + "  1234  1250 I IMU     : "; }},
      {"spdlog", [](int k) { return "[2024-05-01 " + field_clock(k) + "] [info] "; }},
      {"spdlog with a name", [](int k) { return "[2024-05-01 " + field_clock(k) + "] [imu] [info] "; }},
      {"logging of Python",
       [](int k) {
         std::string clock = field_clock(k);
         clock[8] = ',';
         return "2024-05-01 " + clock + " - imu - INFO - ";
       }},
      {"RTT viewer", [](int k) { return field_clock(k) + " 00> "; }},
      {"console of ROS 2", [](int k) { return fmt::format("[INFO] [{:.9f}] [imu_node]: ", 1714564800 + 0.02 * k); }}};
  for (const auto& [name, front] : fronts) {
    INFO(name);
    check_field_log(field_text([&](int k) { return front(k) + field_cells(k); }), 50);
  }
  SECTION("loguru, blanks between the values") {
    check_field_log(field_text([](int k) {
                      return "2024-05-01 " + field_clock(k) + " | INFO     | __main__:read:12 - " + field_cells(k, ' ');
                    }),
                    50);
  }
  SECTION("a terminal's sign alone") {
    const Recording log = read_text(field_text([](int k) { return fmt::format("00> {},{}", 20 * k, field_cells(k)); }));
    CHECK(log.info.time.rate_hz == Approx(50));
    CHECK(log.info.channels.size() == 2);
  }
  SECTION("dates with an offset, decimal commas and names with numbers are no words in front") {
    check_field_log(field_text([](int k) { return "2024-05-01 " + field_clock(k) + " +0200," + field_cells(k); }), 50);
    const Recording comma = read_text(field_text([](int k) { return field_clock(k) + fmt::format(" 1,{:03}", k); }));
    CHECK(comma.info.channels.size() == 1);
    CHECK(comma.samples[0][5] == Approx(1.005));
    const Recording named = read_text(field_text([](int k) { return fmt::format("Sensor 1,{}", field_cells(k)); }));
    CHECK(named.info.channels.size() == 2);
  }
}

TEST_CASE("labels in front of stamps and with units") {
  check_field_log(field_text([](int k) {
                    return fmt::format("time=2024-05-01T{}Z level=info ax={} ay={}", field_clock(k), field_value(k, 1),
                                       field_value(k, 2));
                  }),
                  50);
  ReadOptions options;
  options.rate_hz = 10;
  const std::string text =
      field_text([](int k) { return fmt::format("ax(g): {}, ay(g): {}", field_value(k, 1), field_value(k, 2)); });
  check_field_log(text, 10, kFieldRows, options);
  CHECK(read_text(text, options).info.channels[1].unit == "g");
}

TEST_CASE("lines drawn between names and rows are no rows") {
  const auto rows = [](std::string_view form) {
    return field_text(
        [&](int k) { return fmt::format(fmt::runtime(form), 0.02 * k, field_value(k, 1), field_value(k, 2)); });
  };
  SECTION("influx") {
    check_field_log("name: imu\ntime                ax     ay\n----                --     --\n" + field_text([](int k) {
                      return fmt::format("{} {}", 1714564800000000000 + std::int64_t{20000000} * k,
                                         field_cells(k, ' '));
                    }),
                    50);
  }
  SECTION("psql") {
    check_field_log("  t   |  ax   |  ay\n------+-------+-------\n" + rows(" {:.2f} | {:.3f} | {:.3f}"), 50);
  }
  SECTION("mysql") {
    check_field_log("+---+----+----+\n| t | ax | ay |\n+---+----+----+\n" + rows("| {:.2f} | {:.3f} | {:.3f} |") +
                        "+---+----+----+\n",
                    50);
  }
  SECTION("Markdown") {
    check_field_log("| t | ax | ay |\n|---|:--|---|\n" + rows("| {:.2f} | {:.3f} | {:.3f} |"), 50);
  }
  SECTION("boxes") {
    check_field_log("┌───┬────┬────┐\n│ t │ ax │ ay │\n├───┼────┼────┤\n" + rows("│ {:.2f} │ {:.3f} │ {:.3f} │") +
                        "└───┴────┴────┘\n",
                    50);
  }
  SECTION("underscores, as MATLAB has them") {
    check_field_log("     t       ax       ay\n    ____    ____    ____\n\n" + rows("    {:.2f}    {:.3f}    {:.3f}"),
                    50);
  }
  SECTION("rows of missing values are rows") {
    ReadOptions options;
    options.rate_hz = 50;
    const Recording log = read_text("ax,ay\n1.5,2\n--,--\n1.25,2\n1.5,2.5\n", options);
    CHECK(log.info.samples == 4);
    CHECK(read_text("ax\n1.5\n------\n1.25\n1.5\n", options).info.samples == 4);
  }
  SECTION("not after a comment that names the columns") {
    const Recording log = read_text("# t ax ay\n# ----------\n------------\n" + rows("{:.2f} {:.3f} {:.3f}"));
    REQUIRE(log.info.channels.size() == 2);
    CHECK(log.info.channels[0].name == "ax");
  }
}

TEST_CASE("settings of oscilloscopes beside the names, and rates in front of the rows") {
  const auto rows = [](const char* form) {
    return field_text([&](int k) { return fmt::format(fmt::runtime(form), k, field_value(k, 1), field_value(k, 2)); });
  };
  const Recording old =
      read_text("X,CH1,CH2,Start,Increment,\nSequence,Volt,Volt,-6.0e-02,4.0e-04\n" + rows("{},{},{},"));
  CHECK(old.info.time.rate_hz == Approx(2500));
  CHECK(old.info.channels[old.info.channels.size() - 2].name == "CH1");
  CHECK(old.info.channels.back().unit == "Volt");
  check_field_log("CH1V,CH2V,t0 =-6.0e-02, tInc = 4.0e-04,\n" + rows("{1},{2},,"), 2500);
  check_field_log("Time(s),CH1V,CH2V,t0 =-6.0e-02, tInc = 4.0e-04,\n" +
                      field_text([](int k) { return fmt::format("{:.6e},{},,", -0.06 + 4e-4 * k, field_cells(k)); }),
                  2500);
  check_field_log("1714564800.000000, 1714564800.000000\n32.000000, 32.000000\n" + rows("{1},{2}"), 32);
  check_field_log(
      "-- Data File Created By ActiGraph GT3X+ date format M/d/yyyy at 30 Hz  Filter Normal --\nSerial: NEO1\n"
      "Accelerometer X,Accelerometer Y\n" +
          rows("{1},{2}"),
      30);
  check_field_log(
      "channel names:\t\nai0\tai1\nstart times:\n5/1/2024 12:00:00.0\t5/1/2024 12:00:00.0\ndt:\n0.001\t0.001\ndata:\n" +
          rows("{1}\t{2}"),
      1000);
  const Recording meter = read_text("\"Reading\",\"Sample\",\"Start Time\"\n" + field_text([](int k) {
                                      return fmt::format("\"{}\",\"{} V DC\",\"5/1/2024 12:{:02}:{:02} PM\"", k + 1,
                                                         field_value(k, 1), k / 60, k % 60);
                                    }));
  CHECK(meter.info.time.rate_hz == Approx(1));
  CHECK(meter.info.channels.back().name == "Sample");
  CHECK_THAT(failure("t_s,raw\n0,7\n0.1,0x1F\n0.2,9\n"), Catch::Contains("perl -pe"));
  // Other frequencies are no rate.
  CHECK(read_text("Lowpass at 5 Hz\nax,ay\n" + rows("{1},{2}")).info.time.rate_hz == 0);
  CHECK(read_text("# IMU sampled at 50Hz\nax,ay\n" + rows("{1},{2}")).info.time.rate_hz == Approx(50));
  CHECK(read_text("Acquisition period (ms): 20\nax,ay\n" + rows("{1},{2}")).info.time.rate_hz == Approx(50));
  CHECK_THAT(failure(field_text([](int) { return "1.5,2.5,"; }, 1) + "\n"), !Catch::Contains("E0326"));
  std::string one_row = "1.5";
  for (int k = 0; k < 200; ++k) one_row += fmt::format(",{}", field_value(k, 1));
  CHECK_THAT(failure(one_row + "\n"), Catch::Contains("E0326") && Catch::Contains("tr ','"));
  const Recording phases = read_text("File: x.dat\nData: Phase\nTau: 1.0e-01\nPoints: 400\n" + rows("{1}"));
  CHECK(phases.info.time.rate_hz == Approx(10));
  CHECK(phases.info.rows == kFieldRows);
  // Times and rates are measured, too.
  CHECK(read_text("1714564800\n32\n" + field_text([](int k) { return fmt::format("{}", 1714564800 + k); })).info.rows ==
        kFieldRows + 2);
}

TEST_CASE("stamps whose numbers stand in several columns, without names or beside a clock time") {
  const auto date = [](int k) {
    return fmt::format("2024,05,01,{:02},{:02},{:02}", 10 + k / 3600, k / 60 % 60, k % 60);
  };
  check_field_log(field_text([&](int k) { return date(k) + "," + field_cells(k); }), 1);
  check_field_log(field_text([&](int k) {
                    std::string cells = date(k * 60).substr(0, 16) + "," + field_cells(k);
                    std::replace(cells.begin(), cells.end(), ',', ' ');
                    return cells;
                  }),
                  1 / 60.0);
  CHECK(read_text(field_text([](int k) { return fmt::format("2024,05,{},10,{},30,0.5", 1 + k % 3, k % 60); }),
                  [] {
                    ReadOptions options;
                    options.rate_hz = 1;
                    return options;
                  }())
            .info.channels.size() == 7);
  std::string days =
      field_text([&](int k) { return fmt::format("2024 05 {:02} {:02} {}", 1 + k / 24, k % 24, field_cells(k, ' ')); });
  check_field_log(days, 1 / 3600.0);
  check_field_log("Time,ms,ax,ay\n" + field_text([](int k) {
                    return field_clock(k).substr(0, 8) + fmt::format(",{},{}", 20 * k % 1000, field_cells(k));
                  }),
                  50);
  check_field_log("seconds,microseconds,ax,ay\n" + field_text([](int k) {
                    return fmt::format("{},{},{}", k / 200, k % 200 * 5000, field_cells(k));
                  }),
                  200);
  check_field_log("time,ax,ay\n" + field_text([](int k) { return field_clock(k) + ".500," + field_cells(k); }), 50);
}

TEST_CASE("without names a later column may count the time since 1970") {
  check_field_log(field_text([](int k) { return field_cells(k) + fmt::format(",{}", 1714564800000 + 20 * k); }), 50);
  const Recording graphite = read_text(
      field_text([](int k) { return fmt::format("bench.temp {} {}", field_value(k, 1), 1714564800 + 10 * k); }));
  CHECK(graphite.info.time.rate_hz == Approx(0.1));
  CHECK(graphite.info.channels.size() == 1);
}

TEST_CASE("pairs of a time and a value, all times of one name") {
  check_field_log("X[s],EMG[V],X[s],ACC[g]\n" + field_text([](int k) {
                    return fmt::format("{:.3f},{:.3f},{:.3f},{:.3f}", 0.02 * k, field_value(k, 1), 0.02 * k,
                                       field_value(k, 2));
                  }),
                  50);
}

TEST_CASE("a line with two cells alike holds units below names, known or not") {
  const Recording log = read_text("Date,Time,CH1,CH2\n,,mm,mm\n" + field_text([](int k) {
                                    return "2024/05/01," + field_clock(k) + "," + field_cells(k);
                                  }));
  REQUIRE(log.info.channels.size() == 2);
  CHECK(log.info.channels[0].name == "CH1");
  CHECK(log.info.channels[0].unit == "mm");
  CHECK(read_text("\"time,s\",\"EMG,uV\"\n0,1\n0.1,2\n0.2,3\n").info.channels[0].unit == "uV");
}

TEST_CASE("a line of widths and types below the names") {
  check_field_log("# USGS\nagency\tdatetime\tax\tay\n5s\t20d\t14n\t14n\n" + field_text([](int k) {
                    return fmt::format("USGS\t2024-05-{:02} {:02}:{:02}\t{}", 1 + k / 96, k / 4 % 24, k % 4 * 15,
                                       field_cells(k, '\t'));
                  }),
                  1 / 900.0);
}

TEST_CASE("rows of several sources that each keep a clock of their own") {
  std::string text = "time,sensor,value\n", kinds;
  for (int k = 0; k < kFieldRows; ++k) {
    text += fmt::format("{:.6f},gx,{}\n", 0.005 * k, field_value(k, 1));
    kinds += fmt::format("ACC,{},{}\n", 20 * k, field_cells(k));
    if (k % 4 == 0) text += fmt::format("{:.6f},baro,{}\n", 0.005 * k + 0.0013, field_value(k, 2));
    if (k % 5 == 0) kinds += fmt::format("MAG,{},{}\n", 20 * k + 3, field_cells(k));
  }
  CHECK(failure(text).find("E0327") != std::string::npos);
  CHECK(failure(kinds).find("`where` c0=ACC") != std::string::npos);
  ReadOptions one;
  one.kinds.where = {"sensor=gx"};
  CHECK(read_text(text, one).info.time.rate_hz == Approx(200));
  CHECK(failure(field_text([](int k) {
          return fmt::format("imu{},{},{}", 1 + k % 2, 10 * k, field_cells(k));
        })).find("E0327") != std::string::npos);
  // Words that change with the values, whatever the clock does.
  const Recording log = read_text("time,state,ax,ay\n" + field_text([](int k) {
                                    return fmt::format("{:.3f},{},{}", 0.02 * k + 0.001 * (k * 7919 % 5),
                                                       k % 7 < 3 ? "idle" : "run", field_cells(k));
                                  }));
  CHECK(log.info.channels.size() == 2);
}

TEST_CASE("frames of a bus and messages of Gazebo are recognized, syslog is no web page") {
  for (const char* line : {"(1714564800.123456) can0 123#DEADBEEF", "  can0  123   [8]  DE AD BE EF 00 00 00 01",
                           " (1714564800.123456)  can0  12345678   [2]  DE AD", ";$FILEVERSION=1.1",
                           "date Wed May 1 12:00:00.000 am 2024\nbase hex  timestamps absolute"})
    CHECK_THAT(failure(std::string(line) + "\n" + line + "\n"),
               Catch::Contains("E0301") && Catch::Contains("CAN bus") && Catch::Contains("cantools"));
  CHECK_THAT(failure("header {\n  stamp {\n    sec: 1\n  }\n}\n"), Catch::Contains("json-output"));
  CHECK(read_text("can,0\n1,2\n3,4\n").info.channels.size() == 2);
  check_field_log(field_text([](int k) {
                    return "<14>1 2024-05-01T" + field_clock(k) + "000Z host imu 123 - - " + field_cells(k, ' ');
                  }),
                  50);
}

namespace {

/// As Sea-Bird writes: what the header says of columns and interval is behind lines of another kind.
std::string cast_text(int rows, const std::string& interval, const std::string& clock) {
  std::string out = "* Sea-Bird SBE 21 Data File:\n* Temperature SN = 3311\n# nquan = 3\n# name 0 = " + clock +
                    "\n# name 1 = t090C: Temperature [ITS-90, deg C]\n# name 2 = c0S/m: Conductivity [S/m]\n" +
                    interval + "# <Tau20> 1.4500</Tau20>\n# bad_flag = -9.990e-29\n# file_type = ascii\n*END*\n";
  for (int k = 0; k < rows; ++k)
    out += fmt::format("{:11.6f} {:10.4f} {:10.6f}\n", 236.736690 + 5.0 / 86400 * k, 27 + field_value(k, 1),
                       5.7 + field_value(k, 2));
  return out;
}

}  // namespace

TEST_CASE("a stated interval behind other lines gives stamps in days their unit, and numbered lines name columns") {
  const Recording log = read_text(cast_text(kFieldRows, "# interval = seconds: 5\n", "timeJ: Julian Days"));
  CHECK(log.info.time.rate_hz == Approx(0.2).epsilon(1e-3));
  CHECK(log.info.time.missing_samples == 0);
  const auto& channels = log.info.channels;
  REQUIRE(channels.size() >= 2);
  CHECK(channels[channels.size() - 2].name == "t090C");
  CHECK(channels[channels.size() - 2].unit == "deg C");
  CHECK(channels.back().name == "c0S/m");
  CHECK(log.samples.back()[0] == Approx(5.7 + field_value(0, 2)));
  const Recording elapsed =
      read_text("# Sample interval: 5 s\n" + field_text([](int k) {
                  return fmt::format("{:.6f} {}", 236.736690 + 5.0 / 86400 * k, field_cells(k, ' '));
                }));
  CHECK(elapsed.info.time.rate_hz == Approx(0.2).epsilon(1e-3));
  CHECK(elapsed.info.time.unit == "d");
}

TEST_CASE("a comment names the columns behind a word that announces them, and not when it is a sentence") {
  const auto named = [](const std::string& front, const std::string& rows) {
    std::vector<std::string> out;
    for (const auto& channel : read_text(front + rows).info.channels) out.push_back(channel.name);
    return out;
  };
  const std::string two = field_text([](int k) { return field_cells(k, '\t'); });
  CHECK(named("# Sampling Rate (Hz):= 100\n# Labels:= acc_x\tacc_y\n", two) ==
        std::vector<std::string>{"acc_x", "acc_y"});
  CHECK(named("# Columns: a\tb\n", two) == std::vector<std::string>{"a", "b"});
  const std::string one = field_text([](int k) { return fmt::format("{:.3f}", field_value(k, 1)); });
  CHECK(named("# Sampling Rate (Hz):= 125\n# Labels:= EEG\n", one) == std::vector<std::string>{"EEG"});
  CHECK(named("# recorded indoors\n", one) == std::vector<std::string>{"c0"});
  const std::string counts =
      field_text([](int k) { return fmt::format("{:7},2017-06-01 {}, {}", k + 1, field_clock(k, 3000), 20 + k % 7); });
  CHECK(named("#LOGGING with cycle 3.0 sec, and mode 'CPM', using device 'X v4.20'\n", counts) ==
        std::vector<std::string>{"c0", "c1"});
}

TEST_CASE("rows without anything between rows with stamps are blank lines") {
  for (const char sign : {',', ';'}) {
    const std::string empty(2, sign);
    const std::string text = fmt::format("t{0}a{0}b\n", sign) + field_text([&](int k) {
                               return fmt::format("{}\n{:.2f}{}{}", empty, 0.02 * k, sign, field_cells(k, sign));
                             });
    const Recording log = read_text(text);
    CHECK(test::count(log, "blank_line") == kFieldRows - 1);  // the first one holds the units
    check_field_log(text, 50);
  }
  CHECK(failure("t,a\n0,1\n1,2\n2,3\n,4\n5,6\n").find("E0313") != std::string::npos);
}

TEST_CASE("dates behind the clock, and stamps of digits with their fraction") {
  check_field_log(
      "Time/Date,a,b\n" + field_text([](int k) { return field_clock(k) + " 25/04/2014," + field_cells(k); }), 50);
  check_field_log(field_text([](int k) {
                    return fmt::format("20240730_1635{:02}{:06} {}", 8 + k / 50, 20000 * (k % 50), field_cells(k, ' '));
                  }),
                  50);
  const auto stamp = read_calendar("11:47:22.5 2014-04-25", DateOrder::day_first);
  REQUIRE(stamp);
  CHECK(stamp->ns == read_calendar("2014-04-25 11:47:22.5", DateOrder::day_first)->ns);
  CHECK(!read_calendar("11:47:22 25", DateOrder::day_first));
}

TEST_CASE("a line of sources or of processing between units and rows has no names") {
  const auto rows = [](int k) { return fmt::format("{:.2f},{}", 1767150797 + 0.02 * k, field_cells(k)); };
  for (const char* front : {"timestamp,speed,lean\nunix time,m/s^2,rad/s\n,100: gps,200: obd\n",
                            "TIMESTAMP,speed,lean\nTS,m/s^2,deg\n,Avg,Smp\n"}) {
    INFO(front);
    const std::string text = front + field_text(rows);
    check_field_log(text, 50);
    const Recording log = read_text(text);
    CHECK(log.info.channels[0].name == "speed");
    CHECK(log.info.channels[0].unit == "m/s^2");
    CHECK(log.info.channels[1].name == "lean");
  }
}

// What data loggers, analysers and clouds put beside the rows: titles, events, zones, counters, clocks of their own.

namespace {

constexpr int kLoggerRows = 300;

double logged(int k, int channel) { return 10.0 * channel + 0.01 * ((k * 7919) % 97); }

std::string logger_text(const std::string& front, const std::function<std::string(int)>& line, int rows = kLoggerRows) {
  std::string out = front;
  for (int k = 0; k < rows; ++k) out += line(k) + "\n";
  return out;
}

std::string clock_at(int seconds) {
  return fmt::format("{:02}:{:02}:{:02}", seconds / 3600, seconds / 60 % 60, seconds % 60);
}

std::vector<std::string> names_in(const Recording& log) {
  std::vector<std::string> out;
  for (const Channel& channel : log.info.channels) out.push_back(channel.name);
  return out;
}

void check_columns(const Recording& log, double rate_hz, int rows = kLoggerRows) {
  CHECK(log.info.time.rate_hz == Approx(rate_hz).epsilon(1e-3));
  CHECK(log.info.time.missing_samples == 0);
  REQUIRE(log.samples.size() >= 2);
  const std::size_t last = log.samples.size() - 1;
  REQUIRE(log.samples[last].size() == static_cast<std::size_t>(rows));
  for (const int k : {0, 1, rows - 1}) {
    CHECK(log.samples[last - 1][static_cast<std::size_t>(k)] == Approx(logged(k, 1)));
    CHECK(log.samples[last][static_cast<std::size_t>(k)] == Approx(logged(k, 2)));
  }
}

}  // namespace

TEST_CASE("a first value with its unit stands behind the stamp, and is a channel") {
  const Recording log = read_text(logger_text("", [](int k) {
    return fmt::format("12/25/2023 {} {:.2f}C, {:.2f}C", clock_at(3600 + 3 * k), logged(k, 1), logged(k, 2));
  }));
  REQUIRE(log.info.channels.size() == 2);
  CHECK(log.info.channels[0].unit == "C");
  check_columns(log, 1 / 3.0);
}

TEST_CASE("letters of a time zone behind a stamp, and line ends at the end of quoted cells") {
  const auto row = [](const char* zone) {
    return logger_text("created_at,entry_id,field1,field2\n", [zone](int k) {
      return fmt::format("2020-11-19 {} {},{},{:.2f},\"{:.2f}\r\n\r\n\"", clock_at(36000 + 15 * k), zone, k + 1,
                         logged(k, 1), logged(k, 2));
    });
  };
  for (const char* zone : {"CAT", "AEST", "UTC"}) {
    INFO(zone);
    const Recording log = read_text(row(zone));
    CHECK(names_in(log) == std::vector<std::string>{"entry_id", "field1", "field2"});
    check_columns(log, 1 / 15.0);
  }
  CHECK(read_text("state,a\n12:00:00 ERROR,1\n12:00:01 FAULT,2\n12:00:02 none,3\n").info.time.column.empty());
}

TEST_CASE("events of a logger between its samples have no place among them") {
  const auto hobo = [](int event_after) {
    std::string text = "\"#\",\"Date Time, GMT-08:00\",\"Abs Pres, kPa\",\"Temp, °C\",\"Coupler\"\n";
    int row = 0;
    const auto stamp = [&](int s) {
      return fmt::format("{},05/{:02}/19 {}", ++row, 1 + s / 86400, clock_at(s % 86400));
    };
    for (int k = 0, s = 45000; k < kLoggerRows; ++k, s += 900) {
      text += stamp(s) + fmt::format(",{:.2f},{:.2f},\n", logged(k, 1), logged(k, 2));
      if (k == 1) text += stamp(s + event_after) + ",,,Logged\n";
    }
    return text;
  };
  for (const int after : {25, 450, 840}) {
    INFO(after);
    const Recording log = read_text(hobo(after));
    CHECK(count(log, "own_rows") == 1);
    check_columns(log, 1 / 900.0);
  }
  // A sample that is missing keeps its place, late or early.
  std::string text = "t,x\n";
  for (int k = 0; k < kLoggerRows; ++k)
    text += k % 50 == 7 ? fmt::format("{:.3f},\n", k + 0.1)
                        : fmt::format("{:.3f},{:.2f}\n", k + 0.02 * (k % 3), logged(k, 1));
  const Recording jittery = read_text(text);
  REQUIRE(jittery.samples[0].size() == static_cast<std::size_t>(kLoggerRows));
  CHECK(jittery.samples[0].back() == Approx(logged(kLoggerRows - 1, 1)));
}

TEST_CASE("dates in columns behind the number of a row, lines that end in CR") {
  for (const char* end : {"\n", "\r"}) {
    std::string text = *end == '\r' ? "\r" : "";
    for (int k = 0; k < kLoggerRows; ++k)
      text += fmt::format("{} 2017 05 17 {:02} {:02} {:02} {:.2f} {:.2f}{}", 2932924 + 3 * k, 10 + k / 60, k % 60,
                          25 + k / 80, logged(k, 1), logged(k, 2), end);
    const Recording log = read_text(text);
    CHECK(log.info.channels.size() == 3);
    check_columns(log, 1 / 60.0);
  }
  // Whole values below 60 are no seconds.
  const Recording log = read_text(logger_text("", [](int k) {
    return fmt::format("2024,05,01,{:02},{:02},{},{:.2f}", 10 + k / 60, k % 60, 20 + k % 3, logged(k, 1));
  }));
  CHECK(log.info.channels.size() == 2);
}

TEST_CASE("year, day of year and hours with a fraction") {
  const Recording log = read_text(logger_text("Year\tDoY\tHour\tA\tB\n-\t-\t-\tm/s\tW/m^2\n", [](int k) {
    return fmt::format("1998\t{}\t{}\t{:.2f}\t{:.2f}", 1 + k / 48, 0.5 * (k % 48), logged(k, 1), logged(k, 2));
  }));
  CHECK(names_in(log) == std::vector<std::string>{"A", "B"});
  CHECK(log.info.channels[0].unit == "m/s");
  check_columns(log, 1 / 1800.0);
}

TEST_CASE("speeds and other units without a quantity make a line of units") {
  const Recording log = read_text(logger_text("time,wind,power\ns,m/s,kW\n", [](int k) {
    return fmt::format("{},{:.2f},{:.2f}", k, logged(k, 1), logged(k, 2));
  }));
  CHECK(log.info.channels[0].unit == "m/s");
  CHECK(log.info.channels[1].unit == "kW");
}

TEST_CASE("eight numbers of columns and more are their names, whatever is below them") {
  const auto table = [](int columns, int first) {
    std::string out;
    for (int row = -1; row < 40; ++row) {
      for (int c = 0; c < columns; ++c)
        out += fmt::format("{}{}", c > 0 ? "," : "", row < 0 ? first + c : (row * 31 + c * 17) % 90);
      out += "\n";
    }
    return out;
  };
  CHECK(read_text(table(16, 0)).info.channels[3].name == "3");
  CHECK(read_text(table(16, 0)).info.rows == 40);
  CHECK(read_text(table(5, 0)).info.rows == 41);
  CHECK(read_text(table(16, 4)).info.rows == 41);
}

TEST_CASE("names of nets and parts, empty brackets, units behind a word") {
  const auto split = [](const char* text) { return name_and_unit(text); };
  CHECK(split("V(V_tia)") == std::pair<std::string, std::string>("V(V_tia)", "V"));
  CHECK(split("I(R1)") == std::pair<std::string, std::string>("I(R1)", "A"));
  CHECK(split("V(mV)") == std::pair<std::string, std::string>("V", "mV"));
  CHECK(split("I(A)") == std::pair<std::string, std::string>("I", "A"));
  CHECK(split("Q ()") == std::pair<std::string, std::string>("Q", ""));
  CHECK(split("x (in radians/s)") == std::pair<std::string, std::string>("x", "radians/s"));
  CHECK(called_time("millis()"));
}

TEST_CASE("an analyser's preamble says rate, names and units, and names once more above the rows") {
  std::string front =
      "\"Header Size\"  ,16  \n\"TraceName\"  ,\"U1  \",\"I1  \"\n\"VUnit\"  ,\"V  \",\"A  \"\n"
      "\"SampleRate\"  ,32000.0  ,32000.0  \n\"Frequency Filter\",\"1kHz\"\n\"Update "
      "Rate\",\"500ms\"\n\n,\"U1\",\"I1\",\n\"$WaveData\"\n";
  const Recording log = read_text(
      logger_text(front, [](int k) { return fmt::format(",{:.2f}E+00,{:.2f}E+00,", logged(k, 1), logged(k, 2)); }));
  CHECK(names_in(log) == std::vector<std::string>{"U1", "I1"});
  CHECK(log.info.channels[1].unit == "A");
  check_columns(log, 32000);
}

TEST_CASE("a long table of a dashboard, one series behind the other") {
  std::string text = "\"Series\";\"Time\";\"Value\"\n";
  for (const char* series : {"Probe-1", "Probe-2"})
    for (int k = 0; k < kLoggerRows; ++k)
      text += fmt::format("\"{}\";\"2020-05-04T15:{:02}:{:02}+02:00\";{:.2f}\n", series, k / 60, k % 60, logged(k, 1));
  CHECK_THAT(failure(text), Contains("E0327") && Contains("`where` Series=Probe-1") && Contains("`group_by` Series"));
  ReadOptions one;
  one.kinds.where = {"Series=Probe-1"};
  CHECK(read_text(text, one).info.time.rate_hz == Approx(1));
  one = {};
  one.kinds.group_by = "Series";
  CHECK(names_in(read_text(text, one)) == std::vector<std::string>{"Probe-1", "Probe-2"});
}

TEST_CASE("numbers of many sources that share their stamps") {
  const auto traffic = [](const char* id, bool sorted) {
    return logger_text(fmt::format("{},time,speed\n", id), [sorted](int k) {
      return fmt::format("{},{:.2f},{:.2f}", sorted ? k : (k * 7919) % 357, 0.01 * (k / 3), logged(k, 1));
    });
  };
  CHECK_THAT(failure(traffic("ID", false)), Contains("E0327"));
  CHECK(failure(traffic("ID", true)).empty());
  CHECK(failure(traffic("speed_2", false)).empty());
}

TEST_CASE("OpenSignals names columns and rate in a comment of JSON") {
  const Recording log = read_text(logger_text(
      "# OpenSignals Text File Format\n# {\"20:16:12\": {\"sensor\": [\"ECG\"], \"column\": [\"nSeq\", \"I1\", "
      "\"A2\"], "
      "\"sync interval\": 2, \"time\": \"16:16:11.455\", \"sampling rate\": 100, \"resolution\": [4, 1, 10]}}\n"
      "# EndOfHeader\n",
      [](int k) { return fmt::format("{}\t{:.2f}\t{:.2f}\t", k % 16, logged(k, 1), logged(k, 2)); }));
  CHECK(names_in(log) == std::vector<std::string>{"nSeq", "I1", "A2"});
  check_columns(log, 100);
}

TEST_CASE("titles in front of a table without names, padded by a spreadsheet, and an epoch of so many seconds") {
  const Recording log = read_text(logger_text(
      "------ Data File Created By X date format M/d/yyyy ------,,,\nSerial Number: CLE2,,,\nStart Time 09:00:00,,,\n"
      "Epoch Period (hh:mm:ss) 00:00:15,,,\nBattery Voltage: 4.03     Mode = 13,,,\n"
      "----------------------------,,,\n",
      [](int k) { return fmt::format("{},{},{:.2f},{:.2f}", k % 5, k % 7, logged(k, 1), logged(k, 2)); }));
  CHECK(names_in(log) == std::vector<std::string>{"c0", "c1", "c2", "c3"});
  check_columns(log, 1 / 15.0);
  CHECK(read_text(logger_text("Logging interval: 5 min\na,b\n", [](int k) {
          return fmt::format("{:.2f},{:.2f}", logged(k, 1), logged(k, 2));
        })).info.time.rate_hz == Approx(1 / 300.0));
}

TEST_CASE("keys with as many values as the table has columns are no rows where dates begin them") {
  const Recording log = read_text(logger_text(
      "Serial number:,a,b\nName:,Acceleration,Light\nBinning mode:,Sum,Average\nRunning average bins:,0,0\n\n",
      [](int k) {
        return fmt::format("2000-01-27 {},{:.2f},{:.2f}", clock_at(3600 + k), logged(k, 1), logged(k, 2));
      }));
  CHECK(log.info.channels.size() == 2);
  check_columns(log, 1);
}

TEST_CASE("rows whose clock stands at no time are not named by the first of them") {
  const std::string text = logger_text(
      "", [](int k) { return fmt::format("45/25/2165 45:85:85 {:.2f} {:.2f}", logged(k, 1), logged(k, 2)); });
  CHECK_THAT(failure(text), Contains("log.csv:1:") && Contains("'!c0'"));
  ReadOptions but;
  but.channels = {"!c0"};
  but.rate_hz = 1;
  check_columns(read_text(text, but), 1);
}

TEST_CASE("rows in no order are refused with the way to sort them, and with no rate that they do not have") {
  std::mt19937 engine(4);
  std::vector<int> order(3000);
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), engine);
  std::string text = "time,a\n";
  for (const int k : order) text += fmt::format("{:.2f},{:.2f}\n", 0.01 * k, logged(k % kLoggerRows, 1));
  CHECK_THAT(failure(text), Contains("E0317") && Contains("in no order") && Contains("sort the rows by time") &&
                                !Contains("`rate_hz` 0"));
}

TEST_CASE("stamps that begin again every few rows are refused") {
  CHECK_THAT(failure(logger_text("Time (s),a\n",
                                 [](int k) { return fmt::format("{},{:.2f}", 1e-5 * (k % 2), logged(k, 1)); })),
             Contains("E0317") && Contains("`time_column` none"));
}

TEST_CASE("a rate that the file states decides what packets that are missing leave open") {
  std::int64_t us = 3343444552, k = 0;
  std::string text = "OutputRate:,60Hz\nPacketCounter,SampleTimeFine,a,b\n";
  for (int row = 0; row < kLoggerRows; ++row) {
    text += fmt::format("{},{},{:.2f},{:.2f}\n", k, us + k * 16667, logged(row, 1), logged(row, 2));
    k += row % 3 == 0 ? 1 : row % 17 == 0 ? 4 : 2;
  }
  const Recording log = read_text(text);
  CHECK(log.info.time.rate_hz == Approx(60).epsilon(1e-3));
  CHECK(log.info.time.unit == "us");
  CHECK(log.info.samples == static_cast<std::uint64_t>(k) - (kLoggerRows % 3 == 1 ? 0 : 1));
}

TEST_CASE("numbered clocks are those of the channels behind them") {
  const Recording log = read_text(logger_text("Tiempo1,A1,Tiempo2,A2\n", [](int k) {
    return fmt::format("{:.9f},{:.2f},{:.9f},{:.2f}", 0.00467 * k, logged(k, 1), 0.004673 * k, logged(k, 2));
  }));
  CHECK(names_in(log) == std::vector<std::string>{"A1", "A2"});
  CHECK(log.info.channels[1].own_clock == "Tiempo2");
}

TEST_CASE("one name for date and clock leaves the others with their columns") {
  const Recording log =
      read_text(logger_text("Site,FRCH,,,\nScan No,Date and Time,RAW VALUE,CALIBRATED VALUE,\n", [](int k) {
        return fmt::format("{},{}/6/2020, {},{:.2f},{:.2f}", k + 1, 11 + k / 96, clock_at(k % 96 * 900), logged(k, 1),
                           logged(k, 2));
      }));
  CHECK(names_in(log).back() == "CALIBRATED VALUE");
  CHECK(names_in(log)[names_in(log).size() - 2] == "RAW VALUE");
  check_columns(log, 1 / 900.0);
}

TEST_CASE("a table behind more lines of words and figures than are looked at first") {
  std::string front = "\"Export (5.0)\"\n";
  for (int k = 0; k < 130; ++k)
    front += k % 3 == 0   ? fmt::format("\"REST\",\"{}\",\"4/02/2015\",\"wed.\",\"{}.00\",\n", k, k)
             : k % 3 == 1 ? fmt::format("\"Threshold {}:\",\"40.00\",\"counts\"\n", k)
                          : fmt::format("\"Name {}:\",\"\"\n", k);
  front += "\n\"Line\",\"Date\",\"Hour\",\"A\",\"B\",\"State\",\n\n";
  const Recording log = read_text(logger_text(front, [](int k) {
    return fmt::format("\"{}\",\"4/02/2015\",\"{}\",\"{:.2f}\",\"{:.2f}\",\"ACTIVE\",", k + 1, clock_at(60 * k),
                       logged(k, 1), logged(k, 2));
  }));
  CHECK(names_in(log).back() == "B");
  check_columns(log, 1 / 60.0);
}

TEST_CASE("names below a row of numbers, below a colon, and behind the sign of comments") {
  const auto rows = [](const std::string& front, const char* form) {
    std::string text = front;
    for (int k = 0; k < 40; ++k) text += fmt::format(fmt::runtime(form), k, 0.01 * k, (k * 37) % 11, (k * 53) % 7);
    return read_text(text);
  };
  using Names = std::vector<std::string>;
  CHECK(names_in(rows("0,1,2,3\nt,a,b,c\n", "{1:.2f},{2},{3},{0}.5\n")) == Names{"a", "b", "c"});
  CHECK(names_in(rows("100,3,40\n1,2,3\nt,ax,ay\n", "{1:.2f},{2},{3}\n")) == Names{"ax", "ay"});
  CHECK(names_in(rows("Logger X\nSerial: 42\nFirmware: 1.2.3\n\nus voltage\n", "{0}0000 {2},5\n")) == Names{"voltage"});
  CHECK(names_in(rows("#,ax,ay\n,(mV),(uT)\n", "{0},{2}.5,{3}.25\n")) == Names{"ax", "ay"});
  CHECK(rows("", "{0}.000,{2}.5,{3},x{0}\n").info.time.rate_hz == Approx(1));
}

TEST_CASE("a byte-order mark in front of each line") {
  std::string text = "\xEF\xBB\xBF\"Time\",\"Flow, ml/min\"\n";
  for (int k = 0; k < 60; ++k) text += fmt::format("\xEF\xBB\xBF\"2021-09-17 11:{:02}:14.045\",{}.5\n", k, k % 7);
  const Recording log = read_text(text);
  CHECK(log.info.time.rate_hz == Approx(1 / 60.0));
  CHECK(log.info.channels.size() == 1);
}

TEST_CASE("cells with several numbers are a column for each") {
  using Names = std::vector<std::string>;
  struct Tuple {
    const char *head, *form;
    char sign;
  };
  for (const Tuple& one :
       {Tuple{"t,v [m/s^2],s\n", "{0:.2f},\"({1:.2f}, {2:.2f}, {3:.2f})\",{3:.2f}\n", ','},
        Tuple{"t,v [m/s^2],s\n", "{0:.2f},\"[{1:.2f} {2:.2f} {3:.2f}]\",{3:.2f}\n", ','},
        Tuple{"t,v [m/s^2],s\n", "{0:.2f},[{1:.2f}, {2:.2f}, {3:.2f}],{3:.2f}\n", ','},
        Tuple{"t,\"v [m/s^2]\",s\n", "{0:.2f},\"{1:.2f}, {2:.2f}, {3:.2f}\",{3:.2f}\n", ','},
        Tuple{"t;v [m/s^2];s\n", "{0:.2f};{{{1:.2f}, {2:.2f}, {3:.2f}}};{3:.2f}\n", ';'},
        Tuple{"t\tv [m/s^2]\ts\n", "{0:.2f}\tarray([{1:.2f}, {2:.2f}, {3:.2f}])\t{3:.2f}\n", '\t'}}) {
    INFO(one.form);
    std::string text = one.head;
    for (int k = 0; k < 300; ++k)
      text += k == 200 ? fmt::format("{1:.2f}{0}{0}1.5\n", one.sign, 0.01 * k)
                       : fmt::format(fmt::runtime(one.form), 0.01 * k, logged(k, 1), -logged(k, 2), logged(k, 3));
    const Recording log = read_text(text);
    CHECK(names_in(log) == Names{"v_0", "v_1", "v_2", "s"});
    CHECK(log.info.channels[1].unit == "m/s^2");
    CHECK(log.info.time.rate_hz == Approx(100));
    CHECK(log.samples[1][7] == Approx(-logged(7, 2)).margin(0.006));
    CHECK(std::isnan(log.samples[2][200]));
    CHECK(log.samples[3][200] == 1.5);
  }
  // Decimal commas and thousands in quotes are one number.
  std::string comma = "t,x\n", thousands = "t,x\n";
  for (int k = 0; k < 60; ++k) {
    comma += fmt::format("{},\"{},{:02}\"\n", k, k % 9, k);
    thousands += fmt::format("{},\"1 234 {}.5\"\n", k, 100 + k);
  }
  CHECK(names_in(read_text(comma)) == Names{"x"});
  CHECK(read_text(thousands).samples[0][7] == 1234107.5);
}

TEST_CASE("names in front of all columns but the first, which counts or holds the stamps") {
  using Names = std::vector<std::string>;
  const auto table = [](const std::string& head, const char* form) {
    std::string text = head;
    for (int k = 0; k < 200; ++k)
      text += fmt::format(fmt::runtime(form), k, 0.01 * k, logged(k, 1), logged(k, 2), logged(k, 3));
    return read_text(text);
  };
  for (const Recording& log : {table("# ax ay az\n", "{0} {2:.2f} {3:.2f} {4:.2f}\n"),
                               table("% ax\tay\taz\n", "{0}\t{2:.2f}\t{3:.2f}\t{4:.2f}\n"),
                               table("ax,ay,az\n", "{0},{2:.2f},{3:.2f},{4:.2f}\n"),
                               table("# ax ay az\n", "{1:.2f} {2:.2f} {3:.2f} {4:.2f}\n")}) {
    CHECK(names_in(log) == Names{"ax", "ay", "az"});
    CHECK(log.samples[2][5] == Approx(logged(5, 3)).margin(0.006));
  }
  CHECK(table("# ax ay az\n", "{1:.2f} {2:.2f} {3:.2f} {4:.2f}\n").info.time.rate_hz == Approx(100));
}

TEST_CASE("an interval with its unit in front of the table is that of the rows") {
  for (const auto& [line, rate] :
       {std::pair("Interval;0,5 s", 2.0), std::pair("Log interval: 5 min", 1 / 300.0),
        std::pair("Messintervall;10 ms", 100.0), std::pair("Calibration interval;5 s", 0.0)}) {
    std::string text = std::string(line) + "\nax;ay\n";
    for (int k = 0; k < 60; ++k) text += fmt::format("0,{:02};1,{:02}\n", (k * 13) % 60, (k * 7) % 60);
    INFO(line);
    CHECK(read_text(text).info.time.rate_hz == Approx(rate));
  }
}
