// Dialects of CSV that must just work, and what must be refused with a sentence.
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "libchar/log/csv/head/header.hpp"
#include "tests/log/libraries.hpp"
#include "tests/log/log_text.hpp"

using namespace libchar;
using test::count;
using test::failure;
using test::read_text;

namespace {

using Names = std::vector<std::string>;

Names names(const Recording& r) {
  Names list;
  for (const Channel& c : r.info.channels) list.push_back(c.unit.empty() ? c.name : c.name + "|" + c.unit);
  return list;
}

bool guessed(const Recording& r, const std::string& what) {
  for (const std::string& g : r.info.guesses)
    if (g.find(what) != std::string::npos) return true;
  return false;
}

}  // namespace

TEST_CASE("EuRoC: the header is a comment, stamps are 19-digit nanoseconds") {
  const Recording r = read_text(
      "#timestamp [ns],w_RS_S_x [rad s^-1],a_RS_S_z [m s^-2]\n"
      "1403636579758555392,-0.099134701513277898,8.1476917083333333\n"
      "1403636579763555584,-0.099134701513277898,8.1\n1403636579768555520,-0.1,8\n");
  CHECK(names(r) == Names{"w_RS_S_x|rad s^-1", "a_RS_S_z|m s^-2"});
  CHECK(r.info.time.column == "timestamp");
  CHECK(r.info.time.unit == "ns");
  CHECK_FALSE(r.info.time.unit_guessed);
  CHECK(r.info.time.start_ns == 1403636579758555392);
  CHECK(r.info.time.rate_hz == Approx(200).epsilon(1e-4));
  CHECK(r.samples[0][0] == -0.099134701513277898);
  CHECK(r.info.warnings.empty());
}

TEST_CASE("TUM: blanks between columns, several comment lines") {
  const Recording r = read_text(
      "# accelerometer data\n# file: 'rgbd.bag'\n# timestamp ax ay az\n"
      "1311868164.363181 -0.1 9.7 1.2\n1311868164.365181  -0.2   9.8 1.3 \n 1311868164.367181 -0.3 9.9 1.4\n");
  CHECK(names(r) == Names{"ax", "ay", "az"});
  CHECK(r.info.time.start_ns == 1311868164363181000);
  CHECK(r.info.time.rate_hz == Approx(500));
  CHECK(r.samples[2] == std::vector<double>{1.2, 1.3, 1.4});
  CHECK(guessed(r, "delimiter: blanks"));
}

TEST_CASE("phyphox: quoted names, exponents, semicolon and tab with decimal comma") {
  const char* header[] = {"\"Time (s)\",\"Acceleration x (m/s^2)\"", "\"Time (s)\";\"Acceleration x (m/s^2)\"",
                          "\"Time (s)\"\t\"Acceleration x (m/s^2)\""};
  const std::string rows[] = {"\n9.364549000E-3,1.5E0\n1.936454900E-2,-2.5E0\n2.936454900E-2,3.25E0\n",
                              "\n9,364549000E-3;1,5E0\n1,936454900E-2;-2,5E0\n2,936454900E-2;3,25E0\n",
                              "\n9,364549000E-3\t1,5E0\n1,936454900E-2\t-2,5E0\n2,936454900E-2\t3,25E0\n"};
  for (int i = 0; i < 3; ++i) {
    const Recording r = read_text(header[i] + rows[i]);
    INFO(rows[i]);
    CHECK(names(r) == Names{"Acceleration x|m/s^2"});
    CHECK(r.info.time.start_ns == 9364549);
    CHECK(r.info.time.rate_hz == Approx(100));
    CHECK(r.samples[0] == std::vector<double>{1.5, -2.5, 3.25});
    CHECK(guessed(r, "comma") == (i > 0));
    CHECK(r.info.warnings.empty());
  }
}

TEST_CASE("decimal commas inside quotes between commas") {
  const Recording r = read_text("t,x\n\"0,00\",\"1,5\"\n\"0,01\",\"-2,25\"\n\"0,02\",\"3,0\"\n");
  CHECK(r.samples[0] == std::vector<double>{1.5, -2.25, 3});
  CHECK(r.info.time.rate_hz == Approx(100));
}

TEST_CASE("Xsens: the rate stands in a comment, fields that are off are empty") {
  const Recording r = read_text(
      "// Start Time: unknown\n// Update Rate: 100.0Hz\n// Filter Profile: human\n"
      "PacketCounter\tAcc_X\tMag_X\tGyr_X\n65534\t0.1\t\t1\n65535\t0.2\t\t2\n0\t0.3\t\t3\n");
  CHECK(names(r) == Names{"PacketCounter", "Acc_X", "Mag_X", "Gyr_X"});
  CHECK(r.info.time.rate_hz == 100);
  CHECK_FALSE(r.info.time.from_stamps);
  CHECK(r.info.channels[0].integer);
  CHECK_FALSE(r.info.channels[1].integer);
  CHECK(count(r, "missing_cell") == 3);
  CHECK(count(r, "no_finite_value") == 1);
  CHECK(r.samples[3] == std::vector<double>{1, 2, 3});
}

TEST_CASE("Stable32: one value a line, comments, CRLF, rate from the user") {
  ReadOptions options;
  options.rate_hz = 1;
  const Recording r = read_text("# PHASE\r\n# Tau 1\r\n1.5e-9\r\n2.5e-9\r\n-3e-9\r\n", options);
  CHECK(r.samples[0] == std::vector<double>{1.5e-9, 2.5e-9, -3e-9});
  CHECK(names(r) == Names{"c0"});
  CHECK(r.info.time.rate_hz == 1);
}

TEST_CASE("units in names, and names that only look like it") {
  using libchar::name_and_unit;
  using Pair = std::pair<std::string, std::string>;
  CHECK(name_and_unit("gyro_x [deg/s]") == Pair{"gyro_x", "deg/s"});
  CHECK(name_and_unit("imu1_gx[1/16.4 deg/s]") == Pair{"imu1_gx", "1/16.4 deg/s"});
  CHECK(name_and_unit("speed(m/s)") == Pair{"speed", "m/s"});
  CHECK(name_and_unit("gyro_x") == Pair{"gyro_x", ""});
  CHECK(name_and_unit("Temperatur °C") == Pair{"Temperatur", "°C"});
  CHECK(name_and_unit("acc x m/s^2") == Pair{"acc x", "m/s^2"});
  CHECK(name_and_unit("Humidity %") == Pair{"Humidity", "%"});
  CHECK(name_and_unit("gyro x g") == Pair{"gyro x g", ""});
  CHECK(name_and_unit("Sensor -") == Pair{"Sensor -", ""});
  CHECK(name_and_unit("rate_x_deg_per_s") == Pair{"rate_x", "deg/s"});
  CHECK(name_and_unit("accel_m_per_s2") == Pair{"accel", "m/s2"});
  CHECK(name_and_unit("turns_per_s") == Pair{"turns_per_s", ""});
  CHECK(name_and_unit("gyro_x_dps") == Pair{"gyro_x", "dps"});
  CHECK(name_and_unit("gyro_x_rad_s") == Pair{"gyro_x", "rad/s"});
  CHECK(name_and_unit("acc_z_m_s2") == Pair{"acc_z", "m/s2"});
  CHECK(name_and_unit("t_ns") == Pair{"t", "ns"});
  CHECK(name_and_unit("o3_1") == Pair{"o3_1", ""});
  CHECK(name_and_unit("gyro(2)") == Pair{"gyro(2)", ""});
  CHECK(name_and_unit("node_h") == Pair{"node_h", ""});
  CHECK(name_and_unit("temp_C") == Pair{"temp", "degC"});
  const Recording r = read_text("t,acc_g,acc_mg\n0,1,2\n1,1,2\n");
  CHECK(names(r) == Names{"acc_g|g", "acc_mg|mg"});  // one name twice: the full texts stay
}

TEST_CASE("the time column and its unit") {
  const auto unit = [](const std::string& text) { return read_text(text).info.time; };
  CHECK(unit("t_us,x\n0,1\n5000,2\n10000,3\n").rate_hz == Approx(200));
  CHECK(unit("timestamp,x\n1700000000000,1\n1700000000010,2\n1700000000020,2\n").unit == "ms");
  CHECK(unit("timestamp,x\n1700000000000000,1\n1700000000010000,2\n1700000000020000,2\n").unit == "us");
  CHECK(unit("t,x\n0.00,1\n0.01,2\n0.02,4\n").unit == "s");
  CHECK(unit("t,x\n0,1\n10,2\n20,4\n").unit == "ms");
  CHECK(unit("t,x\n0,1\n10,2\n20,4\n").unit_guessed);
  CHECK(unit("millis,x\n0,1\n10,2\n20,4\n").unit == "ms");
  CHECK_FALSE(unit("millis,x\n0,1\n10,2\n20,4\n").unit_guessed);
  CHECK(unit("x,Time [min]\n0,1\n10,2\n20,3\n").rate_hz == Approx(1.0 / 60));
  ReadOptions options;
  options.time_unit = "us";
  CHECK(read_text("t,x\n0,1\n10,2\n20,4\n", options).info.time.rate_hz == Approx(1e5));
  options = {};
  options.time_column = "b";
  CHECK(read_text("a,b,c\n0,0,1\n5,1,2\n", options).info.channels.size() == 2);
  options.time_column = "none";
  CHECK(read_text("t,x\n0,1\n1,2\n", options).info.channels.size() == 2);
  // Without header: an evenly rising first column is time, a counter of rows is not.
  CHECK(unit("0.5,7\n0.6,8\n0.7,9\n").rate_hz == Approx(10));
  CHECK(read_text("0,7\n1,8\n2,9\n").info.channels.size() == 2);
  for (const char* clock : {"2024-01-01T00:00:00", "12:30:01", "2024/01/01", "2024-01-01"})
    CHECK(unit("time,x\n" + std::string(clock) + ",1\n").unit == "ns");
  CHECK(failure("time,x\n2024-01-01T00:00:00,1\n2024-01-01T00:00:0x,2\n")
            .find("log.csv:3:1 (byte 29): error E0321: no date or clock time") == 0);
  for (const char* text : {"node-07x", "20a4-01-01", "1x:30:01", "12:a0:01", "2024-x1-01"})
    CHECK_THAT(failure("time,x\n" + std::string(text) + ",1\n"), Catch::Contains("error"));
}

TEST_CASE("channels are selected by name, in file order, and nothing else is parsed") {
  ReadOptions options;
  options.channels = {"z", "x"};
  const Recording r = read_text("t,x,note,z\n0,1,hello,3\n1,2,\"a, b\",4\n", options);
  CHECK(names(r) == Names{"x", "z"});
  CHECK(r.samples[1] == std::vector<double>{3, 4});
  options.channels = {"c2"};
  CHECK(names(read_text("t,x,note,z\n0,1,hello,3\n", options)) == Names{"z"});
  options.channels = {"accel"};
  CHECK(failure("t,accel_x\n0,1\n", options).find("did you mean accel_x?") != std::string::npos);
  options.channels = {"x"};
  CHECK_THAT(failure("t;x;y\n0,0;1,5;2\n0,1;2,5;3\n0,2;3,5\n", {}),
             Catch::Contains("`drop_bad_rows`") && !Catch::Contains("if the guess is wrong"));
  CHECK(failure("t,x,note\n0,1,a\n1,2\n", options).find("log.csv:3:4 (byte 18): error E0304: 2 fields, 3 expected") ==
        0);
}

TEST_CASE("the first line that cannot be is named with line, column and byte") {
  CHECK(
      failure("t,x\n0,1\n1,1e400\n")
          .find(
              "log.csv:3:3 (byte 10): error E0312: number out of range; got \"1e400\"; hint: `overflow_as_missing`") ==
      0);
  CHECK(failure("").find("log.csv:1:1 (byte 0): error E0322: the file is empty") == 0);
  CHECK(failure("t,x\n").find("no data rows") != std::string::npos);
  CHECK(failure("\x1F\x8B\x08").find(LIBCHAR_HAVE_ZLIB ? "compressed" : "cannot unpack") != std::string::npos);
  CHECK(failure("PK\x03\x04zip").find("ZIP") != std::string::npos);
  CHECK(failure(std::string("t\0,\0x\0\n\0", 8)).find("UTF-16") != std::string::npos);
  CHECK(failure("t," + std::string(1025, 'n') + "\n0,1\n").find("1024") != std::string::npos);
  CHECK(failure("t,x\n0,1\n" + std::string(3U << 20U, '1'))
            .find("log.csv:3:1 (byte 8): error E0305: line longer than 1 MiB") == 0);
  std::string wide = "c0";
  for (int i = 1; i <= 50001; ++i) wide += ",c" + std::to_string(i);
  CHECK(failure(wide + "\n").find("limit is 32769") != std::string::npos);
  ReadOptions options;
  options.delimiter = "tabs";
  CHECK(failure("t,x\n0,1\n", options).find("unknown delimiter") != std::string::npos);
  options = {};
  options.channels = {"b"};
  CHECK(failure("t,x\n0,1\n", options).find("no channel of this name") != std::string::npos);
}

TEST_CASE("options that hints name do what they say") {
  ReadOptions options;
  options.missing.overflow = true;
  CHECK(count(read_text("t,x\n0,1\n1,1e400\n2,3\n", options), "number_out_of_range") == 1);
  options = {};
  options.skip_repeated_header = true;
  const Recording joined = read_text("t,x\n0,1\n1,2\nt,x\n2,3\n", options);
  CHECK(joined.samples[0] == std::vector<double>{1, 2, 3});
  CHECK(count(joined, "repeated_header") == 1);
  options = {};
  options.skip_rows = 3;
  CHECK(read_text("Logger v1\nSerial,77\n\nt,x\n0,1\n1,2\n", options).samples[0] == std::vector<double>{1, 2});
  options = {};
  options.encoding = "latin1";
  CHECK(names(read_text("t,\xB0"
                        "C\n0,1\n",
                        options)) == Names{"°C"});
  options = {};
  options.encoding = "cp1252";
  CHECK(names(read_text("t,\x80/h\n0,1\n", options)) == Names{"€/h"});
  CHECK_THROWS_WITH(read_text("t,\xEF\xBC\x9D\n0,1\n", options), Catch::Contains("byte 0x9D at offset 4"));
  options = {};
  options.header = "no";
  CHECK(count(read_text("0,7\n1,8\n", options), "no_header") == 0);
  options = {};
  options.decimal = "comma";
  options.delimiter = ";";
  CHECK(read_text("t;x\n0;1\n1;2,5\n", options).samples[0] == std::vector<double>{1, 2.5});
}

TEST_CASE("a header that is no UTF-8 is read as Windows-1252, which is said") {
  const auto guessed = [](const Recording& r) {
    return std::any_of(r.info.guesses.begin(), r.info.guesses.end(),
                       [](const std::string& guess) { return guess.find("Windows-1252") != std::string::npos; });
  };
  const Recording excel = read_text(
      "Zeit [s];Temperatur [\xB0"
      "C];Strom [\xB5"
      "A];a [m/s\xB2]\n"
      "0,0;20,5;1;9,8\n0,1;20,6;2;9,7\n0,2;20,7;3;9,8\n");
  CHECK(names(excel) == Names{"Temperatur|°C", "Strom|µA", "a|m/s²"});
  CHECK(guessed(excel));
  CHECK(excel.info.warnings.empty());
  const Recording units = read_text("t,x\ns,m/s\xB2\n0,1\n1,2\n2,3\n");
  CHECK(units.info.channels[0].unit == "m/s²");
  CHECK(guessed(units));
  CHECK_FALSE(guessed(read_text("t,x [°C]\n0,1\n1,2\n")));
}

TEST_CASE("numbers with their unit behind them: the unit of the column") {
  // MATLAB's writetimetable, durations in front.
  const Recording matlab = read_text("Time,gx\n0 sec,1.5\n0.005 sec,-2\n0.01 sec,3e-1\n0.015 sec,4\n");
  CHECK(matlab.info.time.rate_hz == Approx(200));
  CHECK(matlab.info.time.unit == "s");
  CHECK_FALSE(matlab.info.time.unit_guessed);
  CHECK(matlab.samples[0] == std::vector<double>{1.5, -2, 0.3, 4});
  CHECK(read_text("Time,x\n0 ms,1\n5 ms,2\n10 ms,3\n").info.time.rate_hz == Approx(200));
  CHECK(read_text("Time,x\n0 min,1\n1 min,2\n2 min,3\n").info.time.rate_hz == Approx(1.0 / 60));
  CHECK(read_text("Time,x\n0 hr,1\n1 hr,2\n2 hr,3\n").info.time.rate_hz == Approx(1.0 / 3600));
  CHECK(read_text("Time,x\n0 days,1\n1 day,2\n2 days,3\n").info.time.rate_hz == Approx(1.0 / 86400));
  // Grafana, as it shows the values.
  const Recording grafana = read_text(
      "\"Time\",\"temp\",\"a\"\n"
      "2024-01-05 12:00:00,0.686 °C,12.3 m/s²\n2024-01-05 12:00:01,,12.4 m/s²\n2024-01-05 12:00:02,-1.5 °C,NaN\n");
  CHECK(names(grafana) == Names{"temp|°C", "a|m/s²"});
  CHECK(grafana.samples[0][2] == -1.5);
  CHECK(std::isnan(grafana.samples[0][1]));
  CHECK(grafana.samples[1][0] == 12.3);
  CHECK(grafana.samples[1][1] == 12.4);
  CHECK(names(read_text("t;x\n0;1,5 V\n1;2,5 V\n2;3,25 V\n")) == Names{"x|V"});
  CHECK(names(read_text("t,x\n0,1.5 \xB0"
                        "C\n1,2\xB0"
                        "C\n2,3 \xB0"
                        "C\n")) == Names{"x|°C"});
  CHECK(names(read_text("t,x [degC]\n0,1.5 °C\n1,2 °C\n2,3 °C\n")) == Names{"x|degC"});
}

TEST_CASE("a unit that changes inside a column is refused with both and the line") {
  const std::string changed = failure("Time,x\n0 s,1\n0.5 s,2\n600 ms,3\n");
  CHECK_THAT(changed, Catch::Contains("log.csv:4:1") && Catch::Contains("E0333") &&
                          Catch::Contains("a value in ms, those before it are in s"));
  std::string far = "t,x\n";
  for (int i = 0; i < 5000; ++i) far += std::to_string(i) + ",1.5 V\n";
  CHECK_THAT(failure(far + "5000,2 mV\n"), Catch::Contains("log.csv:5002:6") && Catch::Contains("in mV"));
  CHECK_THAT(failure("t,x\n0,1 V\n1,2\n2,3 V\n"), Catch::Contains("log.csv:3:3") && Catch::Contains("without a unit"));
  CHECK_THAT(failure("t,x [mV]\n0,1 V\n1,2 V\n2,3 V\n"), Catch::Contains("a value in V, and the header says mV"));
  // Numbers first: what stands behind a number is damage.
  CHECK_THAT(failure("t,x\n0,1\n1,2 V\n2,3\n"), Catch::Contains("E0311"));
}

TEST_CASE("a log cut by a power failure keeps its whole rows and says what was lost") {
  const Recording r = read_text("t,x\n0,1\n1,2\n2,3.14" + std::string(5000, '\0'));
  CHECK(r.samples[0] == std::vector<double>{1, 2});
  CHECK(count(r, "nul_tail") == 1);
  CHECK(read_text("t,x\n0,1\n1,2\n" + std::string(4U << 20U, '\0')).info.rows == 2);
  CHECK(failure("t,x\n0,1\n" + std::string(50, '\0') + "1,2\n").find("log.csv:3:1 (byte 8)") == 0);
  // A last row without its line end is a row.
  CHECK(read_text("t,x\n0,1\n1,2").samples[0] == std::vector<double>{1, 2});
}

TEST_CASE("missing cells are counted by column with their places") {
  const Recording r = read_text("t,x,y\n0,,1\n1,nan,\n2,3,NA\n3,4,5\n");
  REQUIRE(count(r, "missing_cell") == 4);
  CHECK(r.info.warnings.find("missing_cell")->sentence.find("x 2, y 2") != std::string::npos);
  CHECK(r.info.warnings.find("missing_cell")->where.rows[0] == "line 2, column 3");
  CHECK(std::isnan(r.samples[0][0]));
  CHECK(r.samples[1][3] == 5);
}

TEST_CASE("a last column that is mostly empty is a slow channel, not the end of the line") {
  std::string text = "t[s],x,temp[degC]\n";
  for (int i = 0; i < 600; ++i)
    text += std::to_string(i) + "," + std::to_string(i % 7) + (i % 50 == 0 ? ",21.5\n" : ",\n");
  const Recording r = read_text(text);
  REQUIRE(r.samples.size() == 2);
  CHECK(r.info.channels[1].unit == "degC");
  CHECK(r.samples[1][50] == 21.5);
  CHECK(std::isnan(r.samples[1][51]));
  CHECK(count(r, "trailing_delimiter") == 0);
}

TEST_CASE("values, warnings and errors depend on neither block size nor threads") {
  std::mt19937_64 random(5);
  std::string text = "t[s];x (g);y\r\n";
  for (int i = 0; i < 1300; ++i) {
    const int oddity = static_cast<int>(random() % 60);
    text += fmt::format("{:.4f};{};{}", i * 0.01 + (oddity == 1 ? 0.03 : 0), static_cast<double>(random()) * 1e-19,
                        oddity == 2   ? ""
                        : oddity == 3 ? "\"1.5\""
                                      : fmt::format("{}", i));
    text += oddity == 4 ? "\n" : "\r\n";
    if (oddity == 5) text += "\r\n";
    if (oddity == 6) text += "# remark\r\n";
    if (i == 1200) text += fmt::format("{:.4f};1;2\r\n", i * 0.01);
  }
  const test::TemporaryFolder folder;
  const auto outcome = [&](const std::string& path, std::size_t block, int threads) {
    ReadOptions options;
    options.block_bytes = block;
    options.threads = threads;
    std::string said;
    try {
      const Recording r = read_recording(path, options);
      for (const Finding& w : r.info.warnings.list()) said += one_line(w, "") + "\n";
      said += fmt::format("{} {} {} {} {}", r.info.rows, r.info.samples, r.info.time.rate_hz,
                          r.info.time.max_deviation_s, r.info.sha256);
      for (const auto& channel : r.samples)
        for (const double x : channel) said += fmt::format(" {}", std::bit_cast<std::uint64_t>(x));
    } catch (const Error& error) {
      said = error.what();
    }
    return said;
  };
  for (const std::string ending : {"", "99;oops;1\r\n"}) {
    const std::string path = (folder / "log.csv").string();
    std::ofstream(path, std::ios::binary) << text << ending;
    const std::string whole = outcome(path, 1U << 24U, 1);
    CHECK((whole.find("oops") != std::string::npos) == !ending.empty());
    std::vector<std::size_t> sizes = {4095, 4096, 4097, 65535, 65536, 65537};
    for (std::size_t b = 1; b <= 67; ++b) sizes.push_back(b);
    for (const std::size_t block : sizes)
      if (outcome(path, block, 1) != whole) FAIL("block size " << block);
    for (int threads = 2; threads <= 8; ++threads)
      if (outcome(path, 997, threads) != whole) FAIL("threads " << threads);
  }
}

TEST_CASE("any delimiter, line end and decimal mark give the same samples") {
  const std::vector<std::vector<double>> values = {{1.5, -2.25, 1e-7}, {3, 4.125, -0.0}};
  for (const char delimiter : {',', ';', '\t', ' ', '|'})
    for (const char* end : {"\n", "\r\n", "\r"})
      for (const char mark : {'.', ','}) {
        if (delimiter == ',' && mark == ',') continue;
        std::string text = fmt::format("t{0}x{0}y{1}", delimiter, end);
        for (int i = 0; i < 3; ++i) {
          std::string row =
              fmt::format("{:.2f}{}{:.9f}{}{:.9f}", 0.01 * i, delimiter, values[0][i], delimiter, values[1][i]);
          for (char& c : row)
            if (c == '.') c = mark;
          text += row + end;
        }
        ReadOptions options;
        if (delimiter == '|') options.delimiter = "|";
        INFO(text);
        const Recording r = read_text(text, options);
        CHECK(r.samples == values);
        CHECK(std::signbit(r.samples[1][2]));
        CHECK(r.info.time.rate_hz == Approx(100));
      }
}

TEST_CASE("a last row that the end of the file cuts is left out and said, if there was a table before it") {
  std::string table = "t,x,y\n";
  for (int k = 0; k < 20; ++k) table += std::to_string(k) + ",0.5," + std::to_string(k % 3) + "\n";
  for (const char* rest : {"20", "20,", "20,0.2", "20,-"}) {
    CAPTURE(rest);
    const auto r = read_text(table + rest);
    CHECK(r.samples.at(0).size() == 20);
    REQUIRE(count(r, "no_final_newline") == 1);
    CHECK_THAT(r.info.warnings.find("no_final_newline")->sentence, Catch::Contains("the row is left out"));
  }
  CHECK_THROWS_WITH(read_text(table + "20,0.2\n"), Catch::Contains("E0304"));   // a whole line
  CHECK_THROWS_WITH(read_text("t,x,y\n0,1,2\n1,2"), Catch::Contains("E0304"));  // not a table yet
}

TEST_CASE("a last line without line end is kept and said, unless its last cell is seen to be whole") {
  for (const char* text : {"t,x\n1.0,2.0\n2.0,3.0\n3.0,4.", "t,x\n1.0,2.0\r\n2.0,3.0\n3.0,4", "a\n1\n2\n4"}) {
    const Recording r = read_text(text);
    INFO(text);
    CHECK(r.samples[0].back() == 4);
    CHECK(r.samples[0].size() == 3);
    REQUIRE(count(r, "no_final_newline") == 1);
    CHECK_THAT(r.info.warnings.find("no_final_newline")->where.rows[0], Catch::StartsWith("line 4"));
  }
  for (const char* text : {"t,x\n1,2\n2,3\n3,4\n", "t,x\n1,2\n2,3\n3,\"4\"", "t,x,\n1,2,\n2,3,\n3,4,",
                           "t,x\n1,2\n2,3\n3,4\n# end", "t,x\n1,2\n2,3\n3,4\n  "}) {
    INFO(text);
    CHECK(count(read_text(text), "no_final_newline") == 0);
  }
}

TEST_CASE("a delimiter that does not fit is answered with the one that does") {
  ReadOptions options;
  options.delimiter = ";";
  CHECK_THAT(
      failure("t,x,y\n1,2,3\n2,3,4\n", options),
      Catch::StartsWith("log.csv:2:1 ") && Catch::Contains("looks separated by , (3 columns): leave `delimiter` out"));
  // One column of decimal commas is what was asked for.
  CHECK(read_text("x\n1,5\n2,25\n", options).samples[0] == std::vector<double>{1.5, 2.25});
  options.delimiter = ",";
  CHECK_THAT(failure("a;b\n1;2\n3;4\n", options), Catch::Contains("separated by ; (2 columns)"));
}

TEST_CASE("binary content is called binary, whatever its first lines look like") {
  std::mt19937 random(7);
  for (int i = 0; i < 200; ++i) {
    std::string bytes = i % 4 == 0 ? "t,x\n1,2\n" : "";
    const int size = 200 + i * 20;
    for (int k = 0; k < size; ++k) bytes += static_cast<char>(random() & 0xFFU);
    const std::string said = failure(bytes);
    INFO(i << " " << said);
    CHECK_THAT(said, Catch::Contains("binary"));
    CHECK_THAT(said, !Catch::Contains("skip_rows"));
  }
  // Doubles, as an array dumped into a file.
  std::string doubles;
  for (int k = 0; k < 500; ++k) {
    const double value = std::sin(k);
    doubles.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  CHECK_THAT(failure(doubles), Catch::Contains("binary"));
  // A log with a few odd bytes is not binary.
  CHECK_THAT(failure("t,x\n1,\x01\n2,3\n"), Catch::Contains("E0311"));
}

TEST_CASE("names that are given go by what is read") {
  ReadOptions options;
  options.names = {"a", "b", "c"};
  options.channels = {"gz"};
  CHECK_THAT(failure("t,gx,gy,gz\n1,2,3,4\n2,3,4,5\n", options), Catch::Contains("3 given, and 1 channel is read: gz"));
  options.channels = {"a"};
  CHECK_THAT(
      failure("t,gx,gy,gz\n1,2,3,4\n2,3,4,5\n", options),
      Catch::Contains("`channels` chooses by the names in the log, gx, gy, gz, and `names` then name what was chosen"));
}

TEST_CASE("web pages and JSON documents are called by their names") {
  CHECK_THAT(failure("<!DOCTYPE html>\n<html>404</html>\n"), Catch::Contains("E0301") && Catch::Contains("HTML"));
  CHECK_THAT(failure("\n{\"a\": 1}\n"), Catch::Contains("E0301") && Catch::Contains("JSON"));
}

TEST_CASE("counts become values: by a number in the unit, by options for channels of a name or pattern") {
  const std::string text = "t [s],gx [1/16.4 deg/s],gy [0.05 deg/s],a\n0,164,20,1\n0.1,-82,40,2\n0.2,0,-20,4\n";
  const Recording r = read_text(text);
  CHECK(r.info.channels[0].unit == "deg/s");
  CHECK(r.samples[0] == std::vector<double>{164 * (1 / 16.4), -82 * (1 / 16.4), 0});
  CHECK(r.samples[1] == std::vector<double>{20 * 0.05, 40 * 0.05, -20 * 0.05});
  CHECK(r.samples[2] == std::vector<double>{1, 2, 4});
  CHECK(r.info.channels[2].integer);
  CHECK_FALSE(r.info.channels[0].integer);
  ReadOptions options;
  options.channel_scale = {"g*=2", "gy=1/4"};
  options.channel_unit = {"a=3.33 mg"};
  const Recording scaled = read_text(text, options);
  CHECK(scaled.samples[0][0] == 328);
  CHECK(scaled.samples[1][0] == 5);
  CHECK(scaled.samples[2][0] == 3.33);
  CHECK(scaled.info.channels[2].unit == "mg");
  CHECK(count(scaled, "unused_option") == 0);
  options.channel_scale = {"gz=2"};
  CHECK(count(read_text(text, options), "unused_option") == 1);
  for (const char* wrong : {"gx", "gx=", "gx=0", "gx=fast", "=2"}) {
    options.channel_scale = {wrong};
    CHECK_THAT(failure(text, options), Catch::Contains("E0331"));
  }
}

TEST_CASE("the g of a load cell is the gram, and that of an accelerometer is not") {
  const std::string text =
      "t [s],load [g],net_weight [g],HX711 [g],acc_z [g],loaded [g]\n0,1,2,3,4,5\n1,2,3,4,5,6\n2,1,2,3,4,5\n";
  const Recording r = read_text(text);
  for (std::size_t c : {0, 1, 2}) CHECK(r.info.channels[c].unit == "gram");
  for (std::size_t c : {3, 4}) CHECK(r.info.channels[c].unit == "g");
  CHECK(r.samples[0] == std::vector<double>{1, 2, 1});
  CHECK(r.info.guesses.size() == 3);
  ReadOptions options;
  options.channel_unit = {"load=g"};
  CHECK(read_text(text, options).info.channels[0].unit == "g");
}

TEST_CASE("what is not read is recognised, with the way to a table") {
  using namespace std::string_literals;
  const std::pair<std::string, const char*> contents[] = {
      {"PAR1\x15\x04\x15"s, "read_parquet"},
      {"ARROW1\0\0\xFF"s, "read_feather"},
      {"TDSm\x0E\0\0\0"s, "nptdms"},
      {"\xD0\xCF\x11\xE0\xA1\xB1\x1A\xE1"s, "--convert-to xlsx"},
      {"\xB5\x62\x01\x07\x5C\0"s, "pyubx2"},
      {"H Product:Blackbox flight data recorder\n"s, "blackbox_decode"},
      {"weather,place=roof temperature=21.5,humidity=40i 1465839830100400200\n"s, "influx -execute"},
      {"{'t': 0.0, 'x': 1.5}\n{'t': 0.1, 'x': 1.5}\n"s, "> log.jsonl"},
      {"MDF     4.10    "s + std::string(200, 0), "asammdf"},
      {"$GPGGA,123519,4807.038,N\n"s, "gpsbabel"},
      {"\0\x05\xE9\x5C\x6F\x10\x20\x30\xFE\x09\0\x01"s, "mavlogdump"},
      {"$GLGSV,1,1,02,65,40,083,46*5F\r\n"s, "gpsbabel"},
      {"8.0,M,,*4B\r\n$BDGGA,123519,4807.038,N\r\n$BDGGA,123520,4807.038,N\r\n"s, "gpsbabel"},
      {"\x07\x01\xB5\x62\x05\x01\x02\0\x06\x01\x0F\x38\xB5"s, "pyubx2"},  // begins within a message
      {"\x80\x02]q\0("s, "pickle"},
      {"\x80\x04\x95\x10\0\0\0"s, "pickle"},
      {"\x80\x05\x95\x10\0\0\0"s, "pickle"},
      {"MS\x03\x04\0\0\0\0"s, "obspy"},
      {"C 1 CLIENT" + std::string(70, ' '), "obspy"},
      {"1.0                 COMPACT RINEX FORMAT                    CRINEX VERS   / TYPE\n"s, "georinex"},
      {"CDF\x02\0\0\0\0"s, "xarray"},
      {"0       " + std::string(160, 'X') + "01.01.2612.00.00512     " + std::string(80, ' '), "mne.io"},
      {"PK\x03\x04" + std::string(26, '\0') + "mimetypeapplication/vnd.oasis.opendocument.spreadsheet", "libreoffice"},
      {"# DDL\nCREATE DATABASE x\n# DML\nimu gx=0.5 1700000000000000000\n"s, "influx -execute"},
      {"imu,host=a gx=0.5,gy=0.25\nimu,host=a gx=0.5,gy=0.5\n"s, "influx -execute"},
      {"<html><table><tr><td>1</td></tr></table></html>\n"s, "read_html"},
      {"[[0, 1.5], [0.1, 1.25], [0.2, 1.5]]\n"s, "DataFrame"},
      {"{\"t\": [0, 1, 2], \"x\": [1, 2, 1]}\n"s, "DataFrame"},
      {"000001D CMPX\x01\x02"s, "obspy"},
      {"     3.04           OBSERVATION DATA    M                   RINEX VERSION / TYPE\n"s, "georinex"},
      {"# Noise of one channel.\nformat: sensor-model\nversion: 1\n"s, "simulate and compare"},
      {"{\n  \"format\": \"characterization\",\n  \"version\": 1\n}\n"s, "compare and verify"},
  };
  for (const auto& [text, way] : contents) CHECK_THAT(failure(text), Catch::Contains("E0301") && Catch::Contains(way));
}

TEST_CASE("a column of labels that is left out names no source: all rows are read") {
  std::string text = "t [s],type,x\n";
  for (int i = 0; i < 200; ++i) text += fmt::format("{:.1f},{},{}\n", 0.1 * i, i < 150 ? "rest" : "walk", i % 7);
  CHECK_THAT(failure(text), Catch::Contains("E0327") && Catch::Contains("'!type' reads all rows"));
  ReadOptions options;
  options.channels = {"!type"};
  const Recording r = read_text(text, options);
  CHECK(r.samples.at(0).size() == 200);
  CHECK(r.info.time.rate_hz == Approx(10));
}

TEST_CASE("rows of several sensors in turn are no one sensor, however even their stamps") {
  const auto table = [](const char* name, auto&& kind) {
    std::string text = fmt::format("t [s],{},x\n", name);
    for (int i = 0; i < 200; ++i) text += fmt::format("{:.2f},{},{}\n", 0.01 * i, kind(i), i * i % 17);
    return text;
  };
  const auto number = [](int i) { return i % 2; };
  for (const char* name : {"imu_id", "Sensor No", "device", "id"})
    CHECK_THAT(failure(table(name, number)), Catch::Contains("E0327"));
  CHECK_THAT(failure(table("sensor", [](int i) { return i % 3 == 0   ? "left"
                                                        : i % 3 == 1 ? "right"
                                                                     : "top"; })),
             Catch::Contains("E0327"));
  // A count of packets, a switch, a state that changes now and then.
  CHECK(read_text(table("packet_id", number)).samples.size() == 2);
  CHECK(read_text(table("heater", number)).samples.size() == 2);
  CHECK(read_text(table("unit", [](int i) { return i / 50 % 2; })).samples.size() == 2);
}

namespace {

struct BusFrame {
  double time;
  int kind;
};

// One source from the beginning; two slower ones that begin `late` s after it.
std::string bus_frames(const char* column, const char* const (&names)[3], double late, bool sorted = false) {
  std::vector<BusFrame> rows;
  for (int k = 0; k < 4000; ++k) rows.push_back({0.01 * k, 0});
  for (int kind = 1; kind < 3; ++kind)
    for (int k = 0; late + 0.1 * k + 0.003 * kind < 40; ++k) rows.push_back({late + 0.1 * k + 0.003 * kind, kind});
  std::stable_sort(rows.begin(), rows.end(), [sorted](const BusFrame& a, const BusFrame& b) {
    return sorted ? a.kind < b.kind : a.time < b.time;
  });
  std::string text = fmt::format("time [s],{},x\n", column);
  for (std::size_t i = 0; i < rows.size(); ++i)
    text += fmt::format("{:.6f},{},{}\n", rows[i].time, names[rows[i].kind], 100 * rows[i].kind + i * i % 17);
  return text;
}

}  // namespace

TEST_CASE("a bus on which others than the first source are heard late is found on the whole file") {
  const char* const numbers[] = {"288", "580", "992"};
  const char* const words[] = {"0x120", "0x244", "0x3E0"};
  const char* const digits[] = {"120", "1A0", "3E0"};
  CHECK_THAT(failure(bus_frames("ID", digits, 0.98)), Catch::Contains("E0327") && Catch::Contains("120, 1A0, 3E0"));
  for (const double late : {0.98, 12.0, 30.0}) {
    for (const char* column : {"id", "can_id", "Arbitration ID"}) {
      CHECK_THAT(failure(bus_frames(column, numbers, late)),
                 Catch::Contains("E0327") && Catch::Contains("288, 580, 992") && Catch::Contains("`group_by`"));
      CHECK_THAT(failure(bus_frames(column, words, late)), Catch::Contains("E0327") && Catch::Contains("`group_by`"));
    }
    ReadOptions options;
    options.kinds.group_by = "id";
    const Recording all = read_text(bus_frames("id", numbers, late), options);
    CHECK(names(all) == Names{"288", "580", "992"});
    options.channels = {"288"};
    CHECK(read_text(bus_frames("id", numbers, late), options).info.time.rate_hz == Approx(100));
    options = {};
    options.kinds.where = {"id=580"};
    CHECK(read_text(bus_frames("id", numbers, late), options).info.time.rate_hz == Approx(10));
  }
}

TEST_CASE("numbers in a column called after kinds that change on an even clock are values") {
  std::string text = "t [s],channel,x\n";
  for (int i = 0; i < 4000; ++i) text += fmt::format("{:.2f},{},{}\n", 0.01 * i, i / 900, i * i % 17);
  CHECK(read_text(text).samples.size() == 2);
  text = "t [s],unit,x\n";
  for (int i = 0; i < 4000; ++i)
    text += fmt::format("{:.4f},{},{}\n", 0.01 * i + 0.001 * (i * 7919 % 5), i / 900, i % 17);
  CHECK(read_text(text).samples.size() == 2);
}

TEST_CASE("rows sorted by a column, the time of each of whose values begins again: the column is said") {
  const char* const numbers[] = {"17", "4", "9"};
  const std::string text = bus_frames("wagon", numbers, 0, true);
  CHECK_THAT(failure(text), Catch::Contains("E0317") && Catch::Contains("sorted by wagon") &&
                                Catch::Contains("`where` wagon=17") && Catch::Contains("`group_by` wagon"));
  ReadOptions options;
  options.kinds.group_by = "wagon";
  const Recording all = read_text(text, options);
  CHECK(names(all) == Names{"17", "4", "9"});
  CHECK(all.info.time.rate_hz == Approx(100));
  const auto mean = [&](std::size_t channel) {
    double sum = 0, count = 0;
    for (const double value : all.samples[channel])
      if (!std::isnan(value)) {
        sum += value;
        ++count;
      }
    return std::pair(sum / count, count);
  };
  CHECK(mean(0).second == 4000);
  CHECK(mean(1).second == 400);
  CHECK(mean(2).first > 200);
  options.channels = {"4", "9"};
  CHECK(names(read_text(text, options)) == Names{"4", "9"});
  options = {};
  options.kinds.where = {"wagon=4"};
  CHECK(read_text(text, options).info.time.rate_hz == Approx(10));
  // Few rows of each.
  std::string few = "t,probe nr,x,y\n";
  for (int probe = 0; probe < 4; ++probe)
    for (int i = 0; i < 20; ++i) few += fmt::format("{:.1f},{},{},{}\n", 0.1 * i, 5 - probe, i * i % 17, i % 3);
  CHECK_THAT(failure(few), Catch::Contains("E0327") && Catch::Contains("`group_by` 'probe nr'"));
  options = {};
  options.kinds.group_by = "probe nr";
  CHECK(read_text(few, options).samples.size() == 8);
}

TEST_CASE("a stamp with more digits than nanoseconds have does no harm where parts of a second may count") {
  std::string text = "time,x\n";
  for (int i = 0; i < 400; ++i) {
    const int at = i == 301 ? 200 : i;
    text += fmt::format("2024-05-17 08:{:02}:{:02}.{},{}\n", at / 60, at % 60,
                        i == 300     ? "4294967295000"
                        : i % 2 == 1 ? "25"
                                     : "0",
                        i * i % 17);
  }
  CHECK(read_text(text).info.rows == 400);
}

TEST_CASE("more names than the first rows repeat are kinds where they share stamps, and all are counted") {
  std::string text = "t [s],node,x\n", numbered = "t [ms],addr,x\n";
  for (int i = 0; i < 30; ++i)
    for (int k = 0; k < 120; ++k) text += fmt::format("{},node{:03},{}\n", i, k, (i * 120 + k) % 17);
  for (int i = 0; i < 60; ++i)
    for (int k = 0; k < 60; ++k) numbered += fmt::format("{},{},{}\n", 100 * i + k / 2, k * 37 % 60, (i * 60 + k) % 17);
  CHECK_THAT(failure(text), Catch::Contains("E0327") && Catch::Contains("`group_by` node"));
  CHECK_THAT(failure(numbered),
             Catch::Contains("E0327") && Catch::Contains("`group_by` addr") && Catch::Contains("and 48 more"));
  ReadOptions options;
  options.kinds.group_by = "node";
  CHECK(read_text(text, options).samples.size() == 120);
  // A source that speaks for the first time behind the first hundred rows.
  std::string late = "t [s],node,x\n";
  for (int i = 0; i < 400; ++i)
    for (int k = 0; k < (i < 200 ? 2 : 3); ++k) late += fmt::format("{},n{},{}\n", i, k, (i * 3 + k) % 17);
  CHECK(read_text(late, options).samples.size() == 3);
  options = {};
  options.channels = {"!node"};
  CHECK(read_text(text, options).samples.size() == 1);
}

TEST_CASE("a long table made wide: a row for each stamp, or for each turn") {
  ReadOptions options;
  options.kinds.group_by = "id";
  const Recording same = read_text("t [s],id,x,y\n0,a,1,10\n0,b,2,20\n1,a,3,30\n2,a,5,50\n2,b,6,60\n", options);
  CHECK(names(same) == Names{"a_x", "a_y", "b_x", "b_y"});
  CHECK(same.info.rows == 3);
  CHECK(same.samples[0] == std::vector<double>{1, 3, 5});
  CHECK(std::isnan(same.samples[2][1]));
  CHECK(same.samples[3][2] == 60);
  // Channels are chosen by the names that they have in the end, or by columns, or both.
  options.channels = {"b_y", "a_x"};
  const std::string long_form = "t [s],id,x,y\n0,a,1,10\n0,b,2,20\n1,a,3,30\n1,b,4,40\n2,a,5,50\n";
  const Recording some = read_text(long_form, options);
  CHECK(names(some) == Names{"a_x", "b_y"});
  CHECK(some.samples[0] == std::vector<double>{1, 3, 5});
  CHECK(some.samples[1][1] == 40);
  options.channels = {"y"};
  CHECK(names(read_text(long_form, options)) == Names{"a", "b"});
  options.channels = {"y", "b"};
  CHECK(read_text(long_form, options).samples[0][0] == 20);
  options.channels = {"c_x"};
  CHECK_THAT(failure(long_form, options), Catch::Contains("E0320") && Catch::Contains("a_x"));
  options.channels.clear();
  const Recording turns = read_text("t [s],id,x\n0,a,1\n0.1,b,2\n1,a,3\n1.1,b,4\n2,a,5\n2.1,b,6\n", options);
  CHECK(turns.samples[1] == std::vector<double>{2, 4, 6});
  CHECK(turns.info.time.rate_hz == Approx(1));
  const Finding* apart = turns.info.warnings.find("stamps_apart");
  REQUIRE(apart != nullptr);
  CHECK(apart->where.rows == std::vector<std::string>{"b 100 ms behind a"});
  CHECK(apart->help[0].options[0].value == "1");
  options.kinds.own_stamps = true;
  const Recording own = read_text("t [s],id,x\n0,a,1\n0.1,b,2\n1,a,3\n1.1,b,4\n2,a,5\n2.1,b,6\n", options);
  CHECK(own.info.rows == 6);
  CHECK(own.info.warnings.find("stamps_apart") == nullptr);
  options.kinds.own_stamps = false;
  const Recording blocks = read_text("t [s],id,x\n0,a,1\n1,a,2\n2,a,3\n0,b,4\n1,b,5\n", options);
  CHECK(blocks.samples[0] == std::vector<double>{1, 2, 3});
  CHECK(blocks.samples[1][1] == 5);
  options = {};
  options.kinds.where = {"id=b"};
  const Recording one = read_text("t,id,x\n0,a,1\n0,b,2\n1,a,3\n1,b,4\n2,a,5\n2,b,6\n", options);
  CHECK(one.samples == std::vector<std::vector<double>>{{2, 4, 6}});
  options.kinds.where = {"id=c"};
  CHECK_THAT(failure("t,id,x\n0,a,1\n0,b,2\n", options), Catch::Contains("E0328"));
  options.kinds.where = {"no=c"};
  CHECK_THAT(failure("t,id,x\n0,a,1\n0,b,2\n", options), Catch::Contains("E0320"));
}

TEST_CASE("a table of several hundred kinds: each is a channel, also behind the first hundred rows") {
  std::string text = "t [s],id,x\n";
  for (int row = 0; row < 40; ++row)
    for (int id = 0; id < 300; ++id) text += fmt::format("{},node{},{}\n", row, id, row + 100 * id);
  ReadOptions options;
  options.kinds.group_by = "id";
  const Recording log = read_text(text, options);
  REQUIRE(log.samples.size() == 300);
  CHECK(log.samples[299][39] == 39 + 29900);
  CHECK(log.info.time.rate_hz == Approx(1));
}

TEST_CASE("units that begin with those of a humidity are no comment") {
  const Recording log = read_text("Humidity;gyro_y;Force\n%;deg/s;N\n21.4;21.0;-9.9\n21.5;21.2;-9.8\n21.4;21.1;-9.9\n");
  REQUIRE(log.info.channels.size() == 3);
  CHECK(log.info.channels[0].unit == "%");
  CHECK(log.info.channels[2].unit == "N");
}

TEST_CASE("a title of few words above rows between blanks has no names") {
  std::string text = " Table Mountain, CO\n   40.125  -105.237 1689 m version 1\n";
  for (int i = 0; i < 60; ++i)
    text += fmt::format(" 2019   1  1  1  0 {:2}  {:.3f}  88.15   294.{} 0    12.4 0\n", i, i / 60.0, i % 10);
  const Recording log = read_text(text);
  CHECK(log.info.time.rate_hz == Approx(1.0 / 60).epsilon(1e-6));
  REQUIRE(log.samples.size() == 6);
  CHECK(log.samples[2][7] == 294.7);
}
