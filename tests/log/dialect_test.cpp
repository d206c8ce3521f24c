// How the dialect of a CSV file is found out from its first lines, and where a message says that something is wrong.
#include "libchar/log/csv/head/dialect.hpp"

#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <functional>
#include <string>

#include "libchar/log/csv/head/candidates.hpp"
#include "libchar/log/csv/head/sample.hpp"
#include "tests/log/log_text.hpp"

using namespace libchar;
using test::count;
using test::failure;
using test::read_text;

namespace {

std::vector<csv::Line> sampled_lines(const std::string& text) {
  return csv::sample_lines(text, true, 0, 1, "log.csv").lines;
}

}  // namespace

TEST_CASE("an empty last cell ends a line of the sample, a quoted one is a cell") {
  const std::string bare = "1,2,\n3,4,\n", quoted = "1,2,\"\"\n3,4,\"\"\n";
  CHECK(csv::candidates(sampled_lines(bare), ',').front().columns == 2);
  CHECK(csv::candidates(sampled_lines(quoted), ',').front().columns == 3);
  // A last column that is empty at times is a column.
  const std::string slow = "1,2,3\n4,5,\n6,7,\n";
  CHECK(csv::candidates(sampled_lines(slow), ',').front().columns == 3);
}

TEST_CASE("cells in apostrophes are quoted cells") {
  const Recording r =
      read_text("'t[s]';'it''s a \"w\"';'x'\r\n'0,00';'1,5';'a;b'\r\n'0,01';'-2,5';'c'\r\n'0,02';'3';''\r\n");
  CHECK(r.info.channels.at(0).name == "it's a \"w\"");
  CHECK(r.samples.at(0) == std::vector<double>{1.5, -2.5, 3});
  CHECK(r.info.time.rate_hz == Approx(100));
}

TEST_CASE("blank lines and comments between the first rows are no part of the sample") {
  const std::string text = "# a;b;c\n\nt,x\n# u;v;w\n\n0,1\n  \n// p;q;r\n1,2\n";
  const csv::Sample sample = csv::sample_lines(text, true, 0, 1, "log.csv");
  REQUIRE(sample.lines.size() == 3);
  CHECK(sample.lines[0].text == "t,x");
  CHECK(sample.lines[1].text == "0,1");
  CHECK(sample.lines[1].number == 6);
  CHECK(sample.lines[2].text == "1,2");
  CHECK(sample.comments.size() == 1);
  std::string remarks;
  for (int i = 0; i < 90; ++i) remarks += "# 1;2;3;4\n";
  const Recording r = read_text("t,x\n0,1\n" + remarks + "1,2\n2,3\n");
  CHECK(r.samples == std::vector<std::vector<double>>{{1, 2, 3}});
}

TEST_CASE("rows that end with a delimiter have no further column, and that is said where it begins") {
  const Recording r = read_text("t,x\n0,1,\n1,2,\n2,3,\n");
  CHECK(r.samples == std::vector<std::vector<double>>{{1, 2, 3}});
  REQUIRE(count(r, "trailing_delimiter") == 1);
  CHECK(r.info.warnings.find("trailing_delimiter")->where.rows[0] == "line 2, column 5");
}

TEST_CASE("columns without a header are c0, c1 and so on, the time not counted") {
  const auto names = [](const Recording& r) {
    std::string list;
    for (const Channel& c : r.info.channels) list += c.name + " ";
    return list;
  };
  CHECK(names(read_text("0.0,5,7,9\n0.1,6,6,9\n0.2,1,5,8\n0.3,7,8,9\n")) == "c0 c1 c2 ");
  CHECK(names(read_text("5,7,9\n1,6,9\n4,5,8\n2,8,9\n")) == "c0 c1 c2 ");
}

TEST_CASE("what is wrong with the first lines is told with line, column and number of lines") {
  CHECK(failure("# nothing\n\n").find("log.csv:1:1 (byte 0): error E0322: no data") == 0);
  // A name of two lines: the columns behind it count from the second.
  const Recording two_lines = read_text("t,\"a\nb\",x,x\n0,1,2,3\n1,2,3,4\n2,3,4,6\n");
  CHECK(two_lines.info.warnings.find("doubled_name")->where.rows == std::vector<std::string>{"line 2, column 6"});
  CHECK(read_text("made by hand\nin May\nt,x\n0,1\n1,2\n2,3\n").info.dialect[1] == "2 lines before the table left out");
  ReadOptions named;
  named.header = "yes";
  CHECK(read_text("made by hand\nin May\nt,x\n0,1\n1,2\n2,3\n", named).info.channels[0].name == "x");
  named.header = "no";
  CHECK(read_text("made by hand\nin May\nt,x\n0,1\n1,2\n2,3\n", named).samples.size() == 2);
}

TEST_CASE("columns of one name are numbered, whatever other names there are") {
  const Recording doubled = read_text("t,x,x,x_2,x\n0,1,2,3,4\n1,2,3,4,6\n2,3,4,6,8\n3,4,6,8,1\n");
  std::vector<std::string> names;
  for (const Channel& channel : doubled.info.channels) names.push_back(channel.name);
  CHECK(names == std::vector<std::string>{"x", "x_2", "x_2_2", "x_3"});
  CHECK(doubled.info.warnings.find("doubled_name")->count == 3);
  CHECK(read_text("t,x,y\n0,1,2\n1,2,3\n2,3,4\n").info.warnings.find("doubled_name") == nullptr);
  const Recording units = read_text("t[s],w[deg/s],w[deg/s]\n0,1,2\n1,2,3\n2,3,4\n");
  CHECK(units.info.channels[0].name == "w");
  CHECK(units.info.channels[1].name == "w_2");
  CHECK(units.info.channels[1].unit == "deg/s");
}

TEST_CASE("a file exactly as long as the head is whole though no line end follows") {
  for (const std::size_t less : {0U, 1U}) {
    const std::string row = "1.5";
    std::string text;
    while (text.size() + 1000 < csv::kHeadBytes) text += "#" + std::string(500, ' ') + "\n";
    text += "#" + std::string(csv::kHeadBytes - less - text.size() - row.size() - 2, ' ') + "\n" + row;
    REQUIRE(text.size() == csv::kHeadBytes - less);
    ReadOptions options;
    options.rate_hz = 1;
    CHECK(read_text(text, options).samples == std::vector<std::vector<double>>{{1.5}});
  }
}

TEST_CASE("text with control characters in a fiftieth of its first 4096 bytes is binary") {
  const auto text_with = [](std::size_t controls, std::size_t last) {
    std::string text(4096, ' ');
    for (std::size_t i = 0; i + 1 < controls; ++i) text[40 * i] = '\x01';
    text[last] = '\x01';
    return text + "\n0,1\n";
  };
  CHECK_THAT(failure(text_with(82, 4095)),
             Catch::Contains("E0301") && Catch::Contains("82 control characters in the first 4096 bytes"));
  CHECK_THAT(failure(text_with(81, 4095)), !Catch::Contains("E0301"));
}

namespace {

std::string forty(const std::function<std::string(int)>& line) {
  std::string text;
  for (int k = 0; k < 40; ++k) text += line(k);
  return text;
}

std::string names_of(const Recording& r) {
  std::string out;
  for (const Channel& c : r.info.channels) out += c.name + "[" + c.unit + "] ";
  return out;
}

}  // namespace

TEST_CASE("a line of names is told from a damaged row, and is found between other signs than the rows") {
  const auto commas = [](int k) { return fmt::format("{:.1f},{}.5,2\n", 0.1 * k, k); };
  const auto blanks = [](int k) { return fmt::format("2024-05-01 12:00:{:02d} {}.5\n", k, k); };
  CHECK_THAT(failure("ERR,0.1,2\n" + forty(commas)), Catch::Contains("E0311"));
  CHECK(names_of(read_text("t,0.5,1.0\n" + forty(commas))) == "0.5[] 1.0[] ");  // depths of a chain
  CHECK(names_of(read_text("t,1,2\n" + forty(commas))) == "1[] 2[] ");
  CHECK(names_of(read_text("t;a;b\n" + forty(commas))) == "a[] b[] ");
  CHECK(names_of(read_text("t a b\n" + forty(commas))) == "a[] b[] ");
  CHECK(names_of(read_text("t,a [V]\n" + forty([](int k) { return fmt::format("{:.1f};{}.5\n", 0.1 * k, k); }))) ==
        "a[V] ");
  CHECK(names_of(read_text("Date; Time; BC1\n" + forty(blanks))) == "BC1[] ");
  const Recording kept = read_text("a note\n" + forty(commas));  // no name for each
  CHECK(count(kept, "no_header") == 1);
}

TEST_CASE("columns behind the last name are known by their position, that of row numbers in front of the first") {
  const auto four = [](char sign) {
    return forty([&](int k) { return fmt::format("{1:.2f}{0}{2}.25{0}{2}.5{0}-{2}.5\n", sign, 0.01 * k, k % 7); });
  };
  for (const char sign : {',', ';', '\t'}) {
    const Recording r = read_text(fmt::format("t{}x [V]\n", sign) + four(sign));
    CHECK(names_of(r) == "x[V] c2[] c3[] ");
    CHECK(r.info.time.rate_hz == Approx(100));
    CHECK(count(r, "unnamed_column") == 2);
  }
  const Recording rows = read_text(
      "t ax ay\n" + forty([](int k) { return fmt::format("{} {:.2f} {}.5 {}.25\n", k + 1, 0.01 * k, k % 7, k % 5); }));
  CHECK(names_of(rows) == "ax[] ay[] ");
  CHECK(rows.info.time.rate_hz == Approx(100));
  CHECK_THAT(failure("t,x\n" + forty([](int k) { return fmt::format("0,{:02d},{},{}\n", k, k % 7, k % 5); })),
             Catch::Contains("decimal commas"));
  CHECK_THAT(failure("Device,ABC,4\n" + four(',')),
             Catch::Contains("line 1 has no name for each column") && Catch::Contains("`skip_rows` 1"));
}

TEST_CASE("between single blanks, a blank in front of names or units is an empty first cell") {
  const auto rows = [](const char* indent) {
    return forty([&](int k) { return fmt::format("{}{:.2f} {}.25 -{}.5\n", indent, 0.01 * k, k % 7, k % 5); });
  };
  const Recording units = read_text("time gx ax\n deg/s m/s^2\n" + rows(""));
  CHECK(names_of(units) == "gx[deg/s] ax[m/s^2] ");
  CHECK(units.info.time.rate_hz == Approx(100));
  const Recording names = read_text(" gx ax\n" + rows(""));  // of an index without a name
  CHECK(names_of(names) == "gx[] ax[] ");
  CHECK(names.info.time.rate_hz == Approx(100));
  CHECK(names_of(read_text(" time gx ax\n s deg/s m/s^2\n" + rows(" "))) == "gx[deg/s] ax[m/s^2] ");
  CHECK_THAT(failure(" gx ax\n" + rows(" ")), Catch::Contains("line 1 has no name for each column"));
}

TEST_CASE("a line of units is told by the unit of the time alone") {
  const Recording r = read_text("Time,a,b\nsec,counts,flurbs\n" +
                                forty([](int k) { return fmt::format("{:.1f},{}.5,2\n", 0.1 * k, k); }));
  CHECK(names_of(r) == "a[counts] b[flurbs] ");
  CHECK(r.info.time.rate_hz == Approx(10));
  CHECK(r.info.time.unit == "s");
}

TEST_CASE("one comma in each line, and always as many digits behind it: decimals, not a second column") {
  const auto decimals = [](int k) { return fmt::format("19,{:03d}\n", 37 * k % 1000); };
  const Recording one = read_text(forty(decimals));
  REQUIRE(one.samples.size() == 1);
  CHECK(one.samples[0][1] == 19.037);
  CHECK(read_text(forty([](int k) { return fmt::format("19,{}\n", 37 * k); })).samples.size() == 2);
  const Recording minus = read_text("-0,7\n-0,712\n-0,68\n-0,71\n0,1\n");
  REQUIRE(minus.samples.size() == 1);
  CHECK(minus.samples[0][1] == -0.712);
}

TEST_CASE("a logger's stamp, words and values with names") {
  const auto lines = [](const std::string& stamp, const std::string& between) {
    std::string text;
    for (int k = 0; k < 60; ++k)
      text += fmt::format(fmt::runtime(stamp), k / 100, k % 100) +
              fmt::format("gx{}{}, gy{}{}\n", between, 0.5 + k % 7, between, k % 5);
    return read_text(text);
  };
  for (const std::string stamp :
       {"2024-05-01 12:00:{:02d}.{:02d}0 INFO imu: ", "171456480{}.{:02d} imu: ", "2{}.{:02d} "})
    for (const std::string between : {"=", ": "}) {
      INFO(stamp << between);
      const Recording r = lines(stamp, between);
      REQUIRE(r.info.channels.size() == 2);
      CHECK(r.info.channels[0].name == "gx");
      CHECK(r.samples[0][0] == 0.5);
      CHECK(r.info.time.rate_hz == Approx(100));
    }
}

TEST_CASE("behind semicolons points between thousands and commas with three digits are both what Europe writes") {
  std::string text = "Zeit [ms];U [V]\n";
  for (int i = 0; i < 400; ++i) {
    const int ms = 500 + 1000 * i;
    text += (ms < 1000 ? fmt::format("{}", ms) : fmt::format("{}.{:03}", ms / 1000, ms % 1000)) +
            fmt::format(";2{},{:03}\n", i % 3, i * 7919 % 1000);
  }
  const Recording r = test::read_text(text);
  CHECK(r.info.time.rate_hz == Approx(1).epsilon(1e-9));
  REQUIRE(r.samples.size() == 1);
  CHECK(r.samples[0][1] == 21.919);
}

TEST_CASE("thousands by blanks beside decimal commas") {
  std::string text = "Zeit;x\n";
  for (int k = 0; k < 60; ++k) text += fmt::format("0,{:02d};{} {:03d},5\n", k, 1 + k % 3, 17 * k % 1000);
  const Recording r = read_text(text);
  REQUIRE(r.samples.size() == 1);
  CHECK(r.samples[0][1] == 2017.5);
}
