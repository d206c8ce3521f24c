// Tables that are no CSV files, read as CSV is: JSON lines, sheets of workbooks, archives of phones; and sound.

#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <tuple>

#include "libchar/core/error.hpp"
#include "libchar/log/read.hpp"
#include "libchar/log/topics/topic_rows.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;

namespace {

std::string of(const std::string& name) { return test::fixture("tables/" + name); }

ReadOptions topic(const std::string& name) {
  ReadOptions options;
  options.topic = name;
  return options;
}

std::string names(const Recording& recording) {
  std::string all;
  for (const Channel& channel : recording.info.channels)
    all += channel.name + (channel.unit.empty() ? "" : "[" + channel.unit + "]") + " ";
  return all;
}

/// The sentence, or "read".
std::string outcome(const std::string& path, const ReadOptions& options = {}) {
  try {
    read_recording(path, options);
  } catch (const Error& error) {
    return error.what();
  }
  return "read";
}

struct StoredTable {
  test::TemporaryFolder folder;
  std::string path;
  StoredTable(const std::string& name, const std::string& bytes) : path((folder / name).string()) {
    std::ofstream(path, std::ios::binary) << bytes;
  }
};

}  // namespace

TEST_CASE("JSON lines: paths are channels, numbers keep their digits") {
  for (const std::size_t block : {std::size_t{1}, std::size_t{100}, std::size_t{1} << 21U}) {
    ReadOptions options;
    options.block_bytes = block;
    const Recording log = read_recording(of("log.jsonl"), options);
    CHECK(log.info.format == "jsonl");
    CHECK(names(log) == "imu.gyro[0] imu.gyro[1] imu.temp[degC] ");
    CHECK(log.info.time.start_ns == 1700000000000000000);
    CHECK(log.info.time.rate_hz == Approx(100));
    CHECK(log.samples[0][39] == 39.0 / 8);
    CHECK(std::isnan(log.samples[1][3]));
    CHECK(log.info.sha256.size() == 64);
  }
}

TEST_CASE("JSON: an array of objects, keys in any order, keys that come late") {
  std::string text = "[ {\"t\":0,\"x [V]\":1},\n  {\"x [V]\":2.5,\"t\":1}, {\"t\":2,\"x [V]\":3,\"y\":NaN} ]";
  const Recording log = read_recording(StoredTable("a.json", text).path);
  CHECK(names(log) == "x[V] y ");
  CHECK(log.samples[0] == std::vector<double>{1, 2.5, 3});
  text = "{\"t\":0,\"x\":1}\n";
  for (int k = 1; k < 20000; ++k)
    text += "{\"t\":" + std::to_string(k) + ",\"x\":1" + (k > 19990 ? ",\"late\":2}\n" : "}\n");
  CHECK(read_recording(StoredTable("a.jsonl", text).path).info.warnings.find("late_key")->count == 9);
}

TEST_CASE("JSON that is broken is refused with the number of the object, a cut end is said") {
  const auto said = [](const std::string& text) { return outcome(StoredTable("a.jsonl", text).path); };
  CHECK_THAT(said("{\"t\":0,\"x\":1}\n{\"t\":1,\"x\":}\n"), Catch::Contains("object 2") && Catch::Contains("E0337"));
  CHECK_THAT(said("{\"t\":0,\"x\":1}\nfoo\n"), Catch::Contains("broken object: foo") && Catch::Contains("(object 2)"));
  CHECK_THAT(said("{\"t\":0,\"x\":1}\n{\"t\":1,\"x\":2}\n{\"t\":2,\"x\":\"4 V or 5\"}\n"),
             Catch::Contains("(object 3)"));
  CHECK_THAT(said("{\"t\":0 \"x\":1}\n"), Catch::Contains("E0337"));
  CHECK_THAT(said("{\"a\":\"" + std::string(3000000, 'x')), Catch::Contains("more than 1048576 bytes"));
  std::string deep;
  for (int k = 0; k < 10000; ++k) deep += "{\"a\":";
  CHECK_THAT(said(deep + "1" + std::string(10000, '}')), Catch::Contains("E0337"));
  const StoredTable cut("a.jsonl", "{\"t\":0,\"x\":1}\n{\"t\":1,\"x\":2}\n{\"t\":2,\"x\":3}\n{\"t\":3,\"x\"");
  const Recording log = read_recording(cut.path);
  CHECK(log.samples[0].size() == 3);
  CHECK(log.info.warnings.find("compressed_cut") != nullptr);
}

namespace {

std::string lvm(const std::string& columns, const std::string& body) {
  return "LabVIEW Measurement\t\nSeparator\tTab\nDecimal_Separator\t,\nMulti_Headings\tYes\nX_Columns\t" + columns +
         "\nDate\t2026/11/22\n***End_of_Header***\t\n\t\n" + body;
}

std::string segment(const std::string& clock, const std::string& x0, const std::string& names) {
  return "Channels\t2\t\t\nSamples\t2\t2\nTime\t" + clock + "\t" + clock + "\nY_Unit_Label\tVolts\tVolts\nX0\t" + x0 +
         "\t" + x0 + "\nDelta_X\t0,01\t0,01\n***End_of_Header***\t\t\n" + names + "\tComment\n";
}

}  // namespace

TEST_CASE("LabVIEW: time in one column, in equal ones, or in none, and segments go on") {
  const std::string two = "X_Value\tA\tB";
  const auto read = [](const std::string& text) { return read_recording(StoredTable("a.lvm", text).path); };
  const Recording one = read(lvm("One", segment("12:00:00,5", "0", two) + "0,00\t1,5\t2\tready\n0,01\t2,5\t3\n\t\n" +
                                            segment("12:00:00,52", "0", two) + "0,00\t3,5\t4\n0,01\t4,5\t5\n"));
  CHECK(names(one) == "A[Volts] B[Volts] ");
  CHECK(one.info.time.rate_hz == Approx(100));
  CHECK(one.samples[0] == std::vector<double>{1.5, 2.5, 3.5, 4.5});
  const Recording none = read(lvm("No", segment("12:00:00,5", "0", two) + "\t1\t2\n\t2\t3\n\t3\t4\n\t4\t5\n"));
  CHECK(none.info.time.rate_hz == Approx(100));
  CHECK(none.samples[1] == std::vector<double>{2, 3, 4, 5});
  const std::string multi = segment("12:00:00,5", "0", "X_Value\tA\tX_Value\tB");
  const Recording each = read(lvm("Multi", multi + "0,00\t1\t0,00\t2\n0,01\t2\t0,01\t3\n0,02\t3\t0,02\t4\n"));
  CHECK(each.samples[1] == std::vector<double>{2, 3, 4});
  std::string apart = multi;  // LabVIEW writes what is said of a channel below its column of values
  apart.replace(apart.find("Volts\tVolts"), 11, "Volts\t\tg");
  CHECK(names(read(lvm("Multi", apart + "0,00\t1\t0,00\t2\n0,01\t2\t0,01\t3\n"))) == "A[Volts] B[g] ");
  CHECK_THAT(outcome(StoredTable("a.lvm", "LabVIEW Measurement\t\nSeparator\tTab\n").path), Catch::Contains("E0340"));
}

TEST_CASE("LabVIEW: clocks a percent apart, or that part after hundreds of rows, are two clocks") {
  for (const bool late : {false, true}) {
    std::string text =
        "Channels\t2\nSamples\t400\t400\nX0\t0,0\t\t0,0\nDelta_X\t0,01\t\t0,01\n***End_of_Header***\n"
        "X_Value\tA\tX_Value\tB\n";
    for (int k = 0; k < 400; ++k) {
      const int other = !late ? 101 * k : k < 200 ? 100 * k : 20000 + 200 * (k - 200);
      text += fmt::format("{},{:04}\t{}\t{},{:04}\t{}\n", k / 100, k % 100 * 100, k % 5, other / 10000, other % 10000,
                          k % 7);
    }
    const StoredTable file("a.lvm", lvm("Multi", text));
    const Recording log = read_recording(file.path);
    INFO(late);
    CHECK(names(log) == "A B ");
    REQUIRE(!log.info.channels[1].own_clock.empty());
    ReadOptions options;
    options.time_column = log.info.channels[1].own_clock;
    options.channels = {"B"};
    if (late)
      CHECK_THAT(outcome(file.path), !Catch::Contains("error"));
    else
      CHECK(read_recording(file.path, options).info.time.rate_hz == Approx(1e4 / 101));
  }
}

TEST_CASE("LabVIEW: channels with clocks of their own have columns of stamps, in the file or by Delta_X") {
  const auto header = [](const std::string& x0, const std::string& delta) {
    return "Channels\t3\nSamples\t40\t10\t40\nX0\t" + x0 + "\nDelta_X\t" + delta + "\n***End_of_Header***\n";
  };
  std::string each = header("0,0\t\t0,0\t\t0,0", "0,01\t\t0,04\t\t0,01") + "X_Value\tA\tX_Value\tB\tX_Value\tC\n";
  std::string none = header("0,0\t0,0\t0,0", "0,01\t0,04\t0,01") + "X_Value\tA\tB\tC\tComment\n";
  for (int k = 0; k < 40; ++k) {
    const std::string b = k < 10 ? std::to_string(3 * k % 7) : "", stamp = k < 10 ? fmt::format("0,{:02}", 4 * k) : "";
    each += fmt::format("0,{0:02}\t{1}\t{2}\t{3}\t0,{0:02}\t{4}\n", k, k % 5, stamp, b, k % 3);
    none += fmt::format("\t{}\t{}\t{}\n", k % 5, b, k % 3);
  }
  for (const std::string& text : {lvm("Multi", each), lvm("No", none)}) {
    const StoredTable file("a.lvm", text);
    const Recording log = read_recording(file.path);
    CHECK(names(log) == "A B C ");
    CHECK(log.info.time.rate_hz == Approx(100));
    CHECK(log.info.channels[0].own_clock.empty());
    CHECK(log.info.channels[2].own_clock.empty());
    ReadOptions options;
    options.time_column = log.info.channels[1].own_clock;
    options.channels = {"B"};
    const Recording slow = read_recording(file.path, options);
    CHECK(slow.info.time.rate_hz == Approx(25));
    CHECK(slow.samples[0].size() == 10);
    CHECK(slow.samples[0][9] == 27 % 7);
  }
}

TEST_CASE("LabVIEW: one header for many packets, special blocks, names that lack, a segment of the next day") {
  const auto read = [](const std::string& text) { return read_recording(StoredTable("a.lvm", text).path); };
  const auto packet = [](int from) {
    std::string rows;
    for (int k = from; k < from + 3; ++k) rows += fmt::format("0,0{}\t{}\t{}\n", k - from, k, 2 * k);
    return rows + "\n";
  };
  const std::string two = segment("23:59:59,5", "0", "X_Value\tA\tB");
  const Recording packets = read(lvm("One", two + packet(0) + packet(3)));
  CHECK(packets.samples[0] == std::vector<double>{0, 1, 2, 3, 4, 5});
  CHECK(packets.info.time.rate_hz == Approx(100));
  const std::string special = "***Start_Special***\nX0\t7\nDelta_X\t5\n\nY_Unit_Label\tg\n***End_Special***\n";
  std::string with = two;
  with.insert(with.find("***End_of_Header***"), special);
  CHECK(names(read(lvm("One", with + packet(0)))) == "A[Volts] B[Volts] ");
  CHECK(read(lvm("No", with + "\t1\t2\n\t2\t3\n\t3\t4\n")).info.time.rate_hz == Approx(100));
  CHECK(names(read(lvm("One", segment("12:00:00,5", "0", "X_Value\tA\t") + packet(0)))) ==
        "A[Volts] Untitled 1[Volts] ");
  const auto of_day = [](std::string text, const std::string& day) {
    text.replace(text.find("Time\t"), 0, "Date\t" + day + "\t" + day + "\n");
    return text;
  };
  const Recording night =
      read(lvm("One", of_day(two, "2026/11/22") + packet(0) +
                          of_day(segment("00:00:00,5", "0", "X_Value\tA\tB"), "2026/11/23") + packet(3)));
  CHECK(night.info.time.gaps == 1);  // a second, of which .03 s are recorded
  CHECK(night.samples[0].size() == 103);
  const std::string other = outcome(
      StoredTable("a.lvm", lvm("One", two + packet(0) + segment("23:59:59,9", "0", "X_Value\tA\tC") + packet(3))).path);
  CHECK_THAT(other, Catch::Contains("E0340") && Catch::Contains("`head -n 20 FILE"));
  std::string spectrum = two;
  spectrum.insert(0, "X_Dimension\tFrequency\tFrequency\n");
  CHECK_THAT(outcome(StoredTable("a.lvm", lvm("One", spectrum + packet(0))).path), Catch::Contains("Frequency"));
}

TEST_CASE("lines of inertial units in a log of several kinds, behind stamps, behind a receiver's answers") {
  ReadOptions options;
  options.rate_hz = 40;
  const auto read = [&](const std::string& text) { return read_recording(StoredTable("a.txt", text).path, options); };
  const std::string gyro = "$VNGYR,+00.1,-0.2,+3.5*5D\r\n", attitude = "$VNYPR,+001.0,+002.0,+003.0*5D\r\n";
  CHECK(names(read(attitude + gyro + attitude + gyro)) == "gyro_x[rad/s] gyro_y[rad/s] gyro_z[rad/s] ");
  CHECK(names(read("$VNGYR,+00.1,-0.2,+3.5,T0001234567*5D\r\n" + gyro)) ==
        "gyro_x[rad/s] gyro_y[rad/s] gyro_z[rad/s] ");
  CHECK_THAT(outcome(StoredTable("a.txt", gyro + "$VNGYR,+00.1,-0.2*5D\r\n" + gyro).path), Catch::Contains("E0304"));
  options.rate_hz.reset();
  std::string stamped, raw = "<OK\r\n[COM1]", corrected;
  for (int k = 0; k < 20; ++k) {
    stamped += fmt::format("2026-11-22 12:00:0{}.{:02}: $VNGYR,+00.{},-0.2,+3.5*5D\r\n", k / 10, 10 * (k % 10), k % 7);
    raw += fmt::format("%RAWIMUSA,2200,300000.000;2200,300000.{:02},00000077,1,2,3,4,{},6*5aa97065\r\n", k, k % 5);
    corrected += fmt::format("%CORRIMUSA,2200,300000.{:02};1,0.125,0.25,{}.5,-1,-2,-3,0,0*5aa97065\r\n", k, k % 3);
  }
  const Recording behind = read(stamped);
  CHECK(behind.info.time.rate_hz == Approx(10));
  CHECK(names(behind) == "gyro_x[rad/s] gyro_y[rad/s] gyro_z[rad/s] ");
  CHECK(behind.samples[0][5] == 0.5);
  const Recording answers = read(raw);
  CHECK(answers.info.time.rate_hz == Approx(100));
  CHECK(answers.samples[4][7] == -2);
  const Recording rates = read(corrected);
  CHECK(rates.info.time.rate_hz == Approx(100));
  CHECK(names(rates) == "pitch[rad] roll[rad] yaw[rad] lateral[m/s] longitudinal[m/s] vertical[m/s] ");
  CHECK(rates.samples[2][4] == 1.5);
}

TEST_CASE("lines of inertial units: VectorNav and NovAtel") {
  ReadOptions options;
  options.rate_hz = 40;
  const Recording vn = read_recording(
      StoredTable("a.txt", "$VNGYR,+00.1,-0.2,+3.5*5D\r\n$VNERR,03*72\r\n$VNGYR,+00.2,-0.25,+3.25*5D\r\n").path,
      options);
  CHECK(names(vn) == "gyro_x[rad/s] gyro_y[rad/s] gyro_z[rad/s] ");
  CHECK(vn.samples[2] == std::vector<double>{3.5, 3.25});
  CHECK(vn.info.warnings.find("comment_line")->count == 1);
  std::string text;
  for (int k = 0; k < 8; ++k)
    text += "#RAWIMUSXA,COM1,0,81.5,FINESTEERING,1724,219418.0,004c,22ff,5;00,11,1724,219418.0" + std::to_string(k) +
            "0,111607,43088060," + std::to_string(k) + ",-3033352,186983,-132863,823*5aa97065\n";
  const Recording nov = read_recording(StoredTable("a.asc", text).path);
  CHECK(nov.info.time.rate_hz == Approx(100));
  CHECK(names(nov) == "acc_z acc_y acc_x gyro_z gyro_y gyro_x ");
  CHECK(nov.samples[1][7] == -7);
  CHECK(nov.samples[4][0] == 132863);
  const Recording attitude = read_recording(
      StoredTable("a.txt",
                  "$VNRRG,1,VN-100*2B\n$VNYMR,+010.1,-000.1,+000.2,+1.0,+0.1,-0.2,+00.1,-00.2,-09.8,+00.001,-00.5,"
                  "-00.002*65\n$VNYMR,+010.2,-000.1,+000.2,+1.0,+0.1,-0.2,+00.1,-00.2,-09.8,+00.001,-00.25,"
                  "-00.002*65\n")
          .path,
      options);
  CHECK(attitude.info.channels.size() == 12);
  CHECK(names(attitude).ends_with("acc_z[m/s^2] gyro_x[rad/s] gyro_y[rad/s] gyro_z[rad/s] "));
  CHECK(attitude.samples[10] == std::vector<double>{-0.5, -0.25});
  for (const auto& [name, line, channel, value] :
       {std::tuple{"%RAWIMUSXA", "00,11,1724,219418.0{}0,111607,43088060,1,2,186983,-132863,823", 4U, 132863.0},
        {"#CORRIMUDATAA", "1724,219418.0{}0,-2.5,1e-3,0.25,1e-4,2e-4,3e-4", 0U, -2.5},
        {"%IMURATECORRIMUSA", "1724,219418.0{}0,-2.5,1e-3,0.25,1e-4,2e-4,3e-4", 0U, -2.5},
        {"%IMURATEPVASA", "1724,219418.0{}0,51.25,-114,1100,1,2,3,4,5,6,INS_SOLUTION_GOOD", 0U, 51.25},
        {"%INSPVASA", "1724,219418.0{}0,51.25,-114,1100,1,2,3,4,5,6,INS_SOLUTION_GOOD", 0U, 51.25}}) {
    std::string lines;
    for (int k = 0; k < 8; ++k)
      lines += fmt::format("{},1724,219418.0;{}*5aa97065\n", name, fmt::format(fmt::runtime(line), k));
    const Recording read = read_recording(StoredTable("a.asc", lines).path);
    INFO(name);
    CHECK(read.info.time.rate_hz == Approx(100));
    CHECK(read.samples[channel][3] == value);
  }
}

TEST_CASE("Shimmer: a line between names and units says that values are calibrated") {
  const Recording log = read_recording(
      StoredTable("a.csv",
                  "Unit\tUnit\tUnit\nTimestamp\tAccel X\tGyro X\nCAL\tCAL\tCAL\nms\tm/(s^2)\tdeg/s\n0.0\t0.5\t0.1\n"
                  "10.0\t0.5\t0.25\n20.0\t0.5\t0.2\n30.0\t0.5\t0.3\n")
          .path);
  CHECK(names(log) == "Accel X[m/(s^2)] Gyro X[deg/s] ");
  CHECK(log.samples[1][1] == 0.25);
}

TEST_CASE("Shimmer: several devices in front of the names, columns of Consensys behind them") {
  const Recording log = read_recording(
      StoredTable(
          "a.dat",
          "Thigh\tThigh\tShank\tShank\tAnnotation\nTimestamp\tGyro X\tTimestamp\tGyro X\tPulse\n"
          "CAL\tCAL\tCAL\tCAL\tPulse\nmSecs\tdeg/sec\tmSecs\tdeg/sec\tBoolean\n"
          "10.0\t0.5\t10.0\t0.1\t0\n20.0\t0.25\t20.0\t0.2\t0\n30.0\t0.75\t30.0\t0.3\t1\n40.0\t0.5\t40.0\t0.1\t0\n")
          .path);
  CHECK(names(log) == "Thigh Gyro X[deg/sec] Shank Gyro X[deg/sec] Pulse[Boolean] ");
  CHECK(log.info.time.rate_hz == Approx(100));
  CHECK(log.samples[1] == std::vector<double>{0.1, 0.2, 0.3, 0.1});
}

TEST_CASE("a workbook: dates by their style, shared texts, the first sheet or one that is named") {
  const Recording log = read_recording(of("log.xlsx"));
  CHECK(names(log) == "gx[deg/s] temp[degC] ");
  CHECK(log.info.time.rate_hz == Approx(50));
  CHECK(*log.info.time.start_ns == 1795391999000000000);
  CHECK(log.samples[0][59] == 59.0 / 8);
  CHECK(std::isnan(log.samples[1][5]));
  CHECK(log.info.topics.size() == 2);
  CHECK_THAT(log.info.guesses.front(), Catch::Contains("sheet: Log, the first table of 2 sheets"));
  const Recording bench = read_recording(of("log.xlsx"), topic("Bench"));
  CHECK(names(bench) == "a[g] ");
  CHECK(bench.samples[0][39] == 1 + 39.0 / 64);
}

TEST_CASE("a workbook without a cell is empty, and not cut") {
  CHECK_THAT(outcome(of("nothing.xlsx")), Catch::Contains("Sheet1: the file is empty"));
}

TEST_CASE("a phone's archive: a topic for each file, with the units of its sensor, or several as one") {
  CHECK_THAT(outcome(of("phone.zip")), Catch::Contains("E0427") && Catch::Contains("Accelerometer"));
  const Recording gyro = read_recording(of("phone.zip"), topic("Gyroscope"));
  CHECK(names(gyro) == "z[rad/s] y[rad/s] x[rad/s] ");  // seconds_elapsed is the time once more
  CHECK(gyro.samples[0][7] == 0.5);
  ReadOptions both = topic("*o*e*");
  both.channels = {"x"};
  const Recording joined = read_recording(of("phone.zip"), both);
  CHECK(names(joined) == "Accelerometer/x[m/s^2] Gyroscope/x[rad/s] ");
  CHECK(joined.samples[1][49] == 49);
}

TEST_CASE("units of what a phone's app writes without them: of the file's name, of the names of the columns") {
  const auto of_file = [](const std::string& name, const std::string& header) {
    std::string text = header + "\n";
    const auto columns = std::count(header.begin(), header.end(), ',');
    for (int k = 0; k < 10; ++k) {
      text += header.starts_with("time,seconds") ? fmt::format("{},{}", 1700000000000000000 + k * 10000000L, 0.01 * k)
                                                 : fmt::format("{}", 0.01 * k);
      for (auto c = header.starts_with("time,seconds") ? 1 : 0; c < columns; ++c)
        text += fmt::format(",{}", (k + c) % 4 + 0.5);
      text += "\n";
    }
    return names(read_recording(StoredTable(name, text).path));
  };
  CHECK(of_file("Barometer.csv", "time,seconds_elapsed,relativeAltitude,pressure") ==
        "relativeAltitude[m] pressure[hPa] ");
  CHECK(of_file("MagnetometerUncalibrated.csv", "time,seconds_elapsed,z,y,x") == "z[uT] y[uT] x[uT] ");
  CHECK(of_file("AccelerometerUncalibrated.csv", "time,seconds_elapsed,z,y,x") == "z y x ");
  CHECK(of_file("Orientation.csv", "time,seconds_elapsed,yaw,qx") == "yaw[rad] qx ");
  CHECK(of_file("a.csv", "time,gFx,gFy,gFz,TgF") == "gFx[g] gFy[g] gFz[g] TgF[g] ");
  CHECK(of_file("a.csv", "time,ax,wx,Bx") == "ax[m/s^2] wx[rad/s] Bx[uT] ");
  CHECK(of_file("a.csv", "time,ax,ay,az") == "ax ay az ");
}

TEST_CASE("an archive with one recording and notes beside it needs no choice") {
  CHECK(names(read_recording(of("phone_notes.zip"))) == "z[m/s^2] y[m/s^2] x[m/s^2] ");
  const Recording sheet = read_recording(of("notes_first.xlsx"));
  CHECK(names(sheet) == "a[g] ");
  CHECK_THAT(sheet.info.guesses.front(), Catch::Contains("sheet: Bench, the first table of 2 sheets"));
}

TEST_CASE("a table of one row beside a recording needs no choice") {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "Accelerometer.csv") << "time,x\n0,1\n0.01,2\n0.02,1\n0.03,3\n";
  std::ofstream(folder / "Metadata.csv") << "version,appVersion,recording epoch time\n3,1.2,1714564800000\n";
  const std::string path = (folder / ".").string();
  CHECK(names(read_recording(path)).starts_with("x"));
  std::ofstream(folder / "Gyroscope.csv") << "time,x\n0,1\n0.01,2\n0.02,1\n0.03,3\n0.04,3\n";
  std::ofstream(folder / "Metadata.csv") << "version,device name\n3,iPhone\n";
  CHECK(names(read_recording(path, topic("*"))).starts_with("Accelerometer/x"));
  CHECK(likely_topic(log_listing(path, {}).topics).name == "Gyroscope");
}

TEST_CASE("a folder of CSV files is read as the archive of them is") {
  const test::TemporaryFolder folder;
  for (const char* name : {"Accelerometer", "Gyroscope"})
    std::ofstream(folder / (std::string(name) + ".csv"))
        << "time,seconds_elapsed,z,y,x\n1700000000000000000,0,9,1,0\n1700000000010000000,0.01,9,1,1\n"
           "1700000000020000000,0.02,9,1,2\n1700000000030000000,0.03,9,1,3\n";
  const std::string path = (folder / ".").string();
  const Recording log = read_recording(path, topic("Gyroscope"));
  CHECK(log.samples[2] == std::vector<double>{0, 1, 2, 3});
  CHECK(log.info.channels[2].unit == "rad/s");
  ReadOptions asked = topic("Gyroscope");
  asked.channels = {"seconds_elapsed"};
  CHECK(names(read_recording(path, asked)) == "seconds_elapsed ");
  CHECK(log.info.sha256.size() == 64);
}

TEST_CASE("sound: PCM of 24 bits as shares of full scale, at the header's rate") {
  const Recording log = read_recording(of("two_24.wav"));
  CHECK(log.info.time.rate_hz == 8000);
  CHECK(names(log) == "c0 c1 ");
  CHECK(log.samples[0][64] == 0.5);
  CHECK(log.samples[1][99] == -99.0 / 128);
}

TEST_CASE("a cut or broken workbook, archive or sound ends in a sentence or in whole rows") {
  for (const char* name : {"log.xlsx", "phone.zip", "two_24.wav", "log.jsonl"}) {
    const std::string bytes = test::slurp(of(name));
    const std::string suffix = std::filesystem::path(name).extension().string();
    for (std::size_t length = 0; length < bytes.size(); length += 1 + bytes.size() / 97) {
      INFO(name << " " << length);
      CHECK(
          !outcome(StoredTable("a" + suffix, bytes.substr(0, length)).path, topic(suffix == ".zip" ? "Gyroscope" : ""))
               .empty());
    }
    for (std::size_t at = 0; at < bytes.size(); at += 1 + bytes.size() / 211) {
      INFO(name << " byte " << at);
      std::string broken = bytes;
      broken[at] = static_cast<char>(~broken[at]);
      CHECK(!outcome(StoredTable("a" + suffix, broken).path).empty());
    }
  }
}

TEST_CASE("JSON lines: what is no object is a row that cannot be read, and the others are read") {
  for (const std::string broken : {R"({"t": 0.5, "x": [1, 2)", R"({"t": 0.5, "x: 3})", "garbage", R"({"t" 0.5})"}) {
    std::string text;
    for (int i = 0; i < 100; ++i)
      text +=
          i == 50 ? broken + "\n" : "{\"t\": " + std::to_string(0.01 * i) + ", \"x\": " + std::to_string(i % 7) + "}\n";
    const StoredTable log("log.jsonl", text);
    INFO(broken);
    if (broken != R"({"t" 0.5})") {
      CHECK(outcome(log.path).find("`drop_bad_rows`") != std::string::npos);
      ReadOptions options;
      options.missing.bad_rows = true;
      CHECK(read_recording(log.path, options).samples[0].size() >= 99);
    } else {
      CHECK(outcome(log.path).find("E0337") != std::string::npos);
    }
  }
}
