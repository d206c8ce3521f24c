// What real tables hold beside numbers: line ends and quotes in cells, words here and there, UTF-16, rows
// of a serial line that are none, facts in front of the table, units other than those that are wanted.

#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <string>

#include "libchar/core/error.hpp"
#include "libchar/core/units.hpp"
#include "libchar/log/csv/line.hpp"
#include "libchar/log/read.hpp"
#include "tests/log/log_text.hpp"

using namespace libchar;
using Catch::Contains;
using test::count;
using test::failure;
using test::read_text;

namespace {

template <class Row>
std::string table(const std::string& header, int rows, Row row) {
  std::string out = header + "\n";
  for (int k = 0; k < rows; ++k) out += row(k) + "\n";
  return out;
}

bool said(const std::vector<std::string>& notes, const std::string& part) {
  for (const std::string& note : notes)
    if (note.find(part) != std::string::npos) return true;
  return false;
}

std::string channels_of(const Recording& r) {
  std::string out;
  for (const Channel& c : r.info.channels) out += c.name + "[" + c.unit + "] ";
  return out;
}

std::string shortest_row(int k) { return fmt::format("{},{},{}", k, 0.5 * k, 2 * k); }

}  // namespace

TEST_CASE("a date, a clock time and one value with a decimal comma are three columns") {
  const std::string text = table("Datum;Uhrzeit;Temperatur °C", 60, [](int k) {
    return fmt::format("22.11.2026;12:00:{:02d};21,{:02d}", k, 7 * k % 100);
  });
  const Recording r = read_text(text);
  CHECK(channels_of(r) == "Temperatur[°C] ");
  CHECK(r.samples[0][3] == 21.21);
  CHECK(r.info.time.rate_hz == Approx(1));
}

TEST_CASE("a column that could be two says so, with the options that decide") {
  const std::string one = table("Wert", 30, [](int k) { return fmt::format("21,{:02d}", 3 * k); });
  CHECK(read_text(one).samples[0][2] == 21.06);  // the header has one name
  const Recording two = read_text(one.substr(one.find('\n') + 1));
  CHECK(said(two.info.guesses, "2 columns; with a decimal comma it could be 1"));
  CHECK(said(two.info.guesses, "`delimiter` and `decimal` decide"));
  ReadOptions comma;
  comma.decimal = "comma";
  comma.delimiter = ";";
  CHECK(read_text(one.substr(one.find('\n') + 1), comma).samples[0][2] == 21.06);
}

TEST_CASE("quoted cells hold line ends, quotes and delimiters, in blocks of any size") {
  const std::string text = table("t,x,note", 300, [](int k) {
    return fmt::format("{},{},\"said \"\"{}\"\",\n\nand, then; left\"", k, 0.5 * k, k);
  });
  for (const std::size_t block : {1U, 64U, 1000U, 1U << 21U}) {
    ReadOptions options;
    options.block_bytes = block;
    const Recording r = read_text(text, options);
    REQUIRE(r.info.channels.size() == 1);
    REQUIRE(r.samples[0].size() == 300);
    CHECK(r.samples[0][299] == 149.5);
  }
  // Physical lines are counted: three a row behind the header.
  CHECK_THAT(failure(text + "300,oops,\"\"\n"), Contains("log.csv:902:5 "));
}

TEST_CASE("integers are known as such beside quoted cells that hold commas and fractions") {
  const std::string text =
      table("t,n,note", 300, [](int k) { return fmt::format("{},{},\"0.5,1.5\n2.5,x\"", k, k % 7); });
  CHECK(read_text(text).info.channels[0].integer);
}

TEST_CASE("a quote that never closes is named where it opens") {
  const std::string text =
      table("t,x,note", 40, [](int k) { return fmt::format("{},{},{}", k, 0.5 * k, k == 20 ? "\"open" : "\"shut\""); });
  for (const std::size_t block : {1U, 64U, 1U << 21U}) {
    ReadOptions options;
    options.block_bytes = block;
    CHECK_THAT(failure(text, options), Contains("log.csv:22:7 ") && Contains("E0306"));
  }
  // An inch mark opens nothing.
  const Recording r = read_text(table("t,x,size", 9, [](int k) { return fmt::format("{},{},pipe 5\"", k, k); }));
  CHECK(r.info.channels.size() == 1);
}

TEST_CASE("the end of a row is the first line end outside quoted cells") {
  CHECK(csv::row_end("1,2\n3", 0) == 3);
  CHECK(csv::row_end("1,\"a\nb\"\n3", 0) == 7);
  CHECK(csv::row_end("1,\"a\"\"\nb\"\n3", 0) == 9);
  CHECK(csv::row_end("1,5\"\n3,\"", 0) == 4);
  CHECK(csv::row_end("1,\"a\n2,\"b\"\n", 0) == 4);  // the next quote opens a cell and closes none
  bool open = false;
  CHECK(csv::row_end("1,\"a\n2,b\n", 0, ',', &open) == 4);
  CHECK(open);
}

TEST_CASE("a column with words here and there, or only behind the first rows, is left out") {
  for (const int first : {3, 150, 4000}) {
    const Recording r = read_text(table("t,x,note", 5000, [=](int k) {
      return fmt::format("{},{},{}", k, 0.5 * k, k >= first && k % 50 == first % 50 ? "bump" : "");
    }));
    CHECK(channels_of(r) == "x[] ");
    CHECK(said(r.info.dialect, "columns of words: note"));
  }
  const std::string late =
      table("t,x,note", 300, [](int k) { return fmt::format("{},{},{}", k, 0.5 * k, k < 200 ? "0" : "fault"); });
  CHECK_THAT(failure(late), Contains("log.csv:202:") && Contains("`channels` '!note'"));
  ReadOptions but;
  but.channels = {"!note"};
  CHECK(channels_of(read_text(late, but)) == "x[] ");
}

TEST_CASE("all channels but some: by name, position and pattern") {
  const std::string text = table("t,gx,gy,temp", 5, [](int k) { return fmt::format("{},{},{},{}", k, k, k, k); });
  const auto left = [&](std::vector<std::string> words) {
    ReadOptions options;
    options.channels = std::move(words);
    return channels_of(read_text(text, options));
  };
  CHECK(left({"!temp"}) == "gx[] gy[] ");
  CHECK(left({"!g*"}) == "temp[] ");
  CHECK(left({"!c0", "!temp"}) == "gy[] ");
  CHECK(left({"g*", "!gy"}) == "gx[] ");
  ReadOptions none;
  none.channels = {"!g*", "!temp"};
  CHECK_THAT(failure(text, none), Contains("E0320") && Contains("no channel is left"));
  none.channels = {"!tmp"};
  CHECK_THAT(failure(text, none), Contains("there is no channel of this name"));
}

TEST_CASE("UTF-16 is read in either order of its bytes, also cut in two") {
  const std::string text = table("t [s]\tTemp [°C]", 50, [](int k) { return fmt::format("{}\t{}", k, 0.5 * k); });
  for (const bool big : {false, true}) {
    std::string wide = big ? "\xFE\xFF" : "\xFF\xFE";
    for (std::size_t i = 0; i < text.size(); ++i) {
      const bool degree = text.substr(i, 2) == "°";
      const char low = degree ? '\xB0' : text[i];
      i += degree ? 1 : 0;
      wide += big ? std::string{'\0', low} : std::string{low, '\0'};
    }
    ReadOptions options;
    options.block_bytes = 64;
    const Recording r = read_text(wide, options);
    CHECK(channels_of(r) == "Temp[°C] ");
    CHECK(r.samples[0][49] == 24.5);
    CHECK(said(r.info.dialect, "UTF-16"));
    const Recording cut = read_text(wide.substr(0, wide.size() - 3), options);
    CHECK(cut.samples[0].size() == 49);
    CHECK(read_text(wide.substr(2)).samples[0].size() == 50);  // without its mark
  }
}

TEST_CASE("comments may begin with a semicolon where it separates nothing") {
  const Recording r = read_text(";Title, http://example.org\n;SampleRate, 100,Hz\n;Headers, time,Ax,Ay,Az\n" +
                                table("0.000,1,2,3", 20, [](int k) {
                                  return fmt::format("{:.3f},{},2,{}\n; still there", 0.01 * (k + 1), k, k);
                                }));
  CHECK(channels_of(r) == "Ax[] Ay[] Az[] ");
  CHECK_FALSE(said(r.info.guesses, "could be"));
  CHECK(r.info.time.rate_hz == Approx(100));
  CHECK(count(r, "comment_line") == 20);
  const Recording index =
      read_text(table(";time;gx", 9, [](int k) { return fmt::format("{};{};{}", k, 0.1 * k, k * k); }));
  CHECK(channels_of(index) == "gx[] ");
}

TEST_CASE("names with commas in them are known by the blanks behind those") {
  const Recording r = read_text(table("t,Temp, inside,y", 9, shortest_row));
  CHECK(channels_of(r) == "Temp, inside[] y[] ");
  CHECK_NOTHROW(failure(table(" t , x , y,z", 9, shortest_row)));
}

TEST_CASE("rows that cannot be read are dropped and counted where that is asked for") {
  const auto chatter = [](const char* noise) {
    return table("t,x,y", 60, [=](int k) { return k == 30 ? noise : fmt::format("{},{},{}", k, 0.5 * k, 2 * k); });
  };
  ReadOptions drop;
  drop.missing.bad_rows = true;
  for (const char* noise : {"WARN: i2c", "30,1", "30,x1,2", "30,1,2,3", "30,\"1,2"}) {
    INFO(noise);
    CHECK_THAT(failure(chatter(noise)), Contains("log.csv:32:"));
    for (const std::size_t block : {1U, 64U, 1U << 21U}) {
      drop.block_bytes = block;
      const Recording r = read_text(chatter(noise), drop);
      CHECK(count(r, "bad_row") == 1);
      CHECK(r.info.rows == 59);
      CHECK(r.samples[0].size() == 60);
      CHECK(std::isnan(r.samples[0][30]));
      CHECK(r.samples[0][31] == 15.5);
    }
  }
}

TEST_CASE("without stamps a row that cannot be read is a missing sample, and chatter is none") {
  ReadOptions drop;
  drop.missing.bad_rows = true;
  drop.rate_hz = 10;
  const std::string text = table(
      "x,y", 40, [](int k) { return k == 20 ? "7" : fmt::format("{},{}{}", k % 7, k, k == 30 ? "\nWARN: i2c" : ""); });
  const Recording r = read_text(text, drop);
  REQUIRE(r.samples[0].size() == 40);
  CHECK(std::isnan(r.samples[0][20]));
  CHECK(r.samples[1][39] == 39);
  CHECK(count(r, "bad_row") == 2);
}

TEST_CASE("a table of which more than one row in ten cannot be read is refused") {
  ReadOptions drop;
  drop.missing.bad_rows = true;
  const std::string text =
      table("t,x", 100, [](int k) { return k % 5 == 4 ? "noise" : fmt::format("{},{}", k, k * k); });
  CHECK_THAT(failure(text, drop), Contains("E0335") && Contains("20 of 100 rows"));
}

TEST_CASE("facts in front of a table are used: scales of .gcsv, the rate of SLIST") {
  const Recording gcsv =
      read_text("GYROFLOW IMU LOG\nversion,1.3\ntscale,0.002\ngscale,0.5\nascale,0.25\n" +
                table("t,gx,ax", 20, [](int k) { return fmt::format("{},{},{}", k, 2 * k, 4 * k); }));
  CHECK(channels_of(gcsv) == "gx[rad/s] ax[g] ");
  CHECK(gcsv.samples[0][3] == 3);
  CHECK(gcsv.samples[1][3] == 3);
  CHECK(gcsv.info.time.rate_hz == Approx(500));
  const Recording slist =
      read_text(table("TIMESERIES IU_ANMO_00_BHZ_R, 50 samples, 20 sps, 2018-01-01T00:00:00.000000, SLIST, INTEGER", 50,
                      [](int k) { return fmt::format("{}", k * 7919 % 100); }));
  CHECK(slist.info.time.rate_hz == 20);
  CHECK(slist.samples[0].size() == 50);
}

TEST_CASE("a table that is nothing but its first line is told so") {
  ReadOptions none;
  none.header = "no";
  CHECK_THAT(failure(",a", none), Contains("E0311") && Contains("log.csv:1:"));
  CHECK_THAT(failure("TIMESERIES A, 5 samples, 20 sps, SLIST\n"), Contains("error"));
}

TEST_CASE("units with brackets are units, in names and apart") {
  for (const char* text : {"m/(s^2)", "m/(s·s)", "m.s-2", "m/s**2"}) {
    INFO(text);
    REQUIRE(find_unit(text));
    CHECK(find_unit(text)->symbol == "m/s²");
  }
  CHECK(find_unit("rad/(s)")->symbol == "rad/s");
  const Recording r = read_text(table("t (s),a (m/(s^2)),w [rad/s]", 9, shortest_row));
  CHECK(channels_of(r) == "a[m/(s^2)] w[rad/s] ");
}

TEST_CASE("a channel in another unit of the log is converted, never relabelled") {
  const std::string text =
      table("t,wz[rad/s],T[degC],n", 9, [](int k) { return fmt::format("{},{},{},{}", k, k, k, k); });
  ReadOptions options;
  options.channel_unit = {"wz=deg/s", "n=V"};
  const Recording r = read_text(text, options);
  CHECK(r.samples[0][1] == Approx(57.29577951));
  CHECK(r.samples[2][1] == 1);  // stated no unit
  CHECK(said(r.info.dialect, "converted: 1 rad/s is 57.2958 deg/s: wz"));
  options.channel_scale = {"wz=1"};  // the numbers are right, and the name of the unit is wrong
  CHECK(read_text(text, options).samples[0][1] == 1);
  ReadOptions kelvin;
  kelvin.channel_unit = {"T=K"};
  CHECK_THAT(failure(text, kelvin), Contains(""));
  ReadOptions all;
  all.channels = {"wz"};
  all.units = {"mrad/s"};
  CHECK(read_text(text, all).samples[0][1] == Approx(1000));
}

TEST_CASE("the whole of a long file says which number of a date is the day") {
  std::string text = "date,x\n";
  for (int k = 0; k < 130000; ++k)
    text += fmt::format("{:02d}/{:02d}/2024 {:02d}:{:02d}:{:02d},{}\n", 1 + k / 8640, 5, k / 360 % 24, k / 6 % 60,
                        10 * (k % 6), k % 10);
  REQUIRE(text.size() > 5U << 19U);
  const Recording r = read_text(text);
  CHECK(r.info.time.rate_hz == Approx(0.1));
  CHECK(r.info.time.gaps == 0);
  CHECK_FALSE(said(r.info.guesses, "`date_order`"));
}
