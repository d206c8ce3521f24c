#include "libchar/fit/curve/curve_table.hpp"

#include <catch2/catch.hpp>
#include <fstream>

#include "libchar/core/error.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;

namespace {

std::optional<CurveTable> read(const std::string& text, bool is_allan) {
  const test::TemporaryFolder folder;
  const std::string path = (folder / "curve.csv").string();
  std::ofstream(path, std::ios::binary) << text;
  return read_curve_table(path, is_allan);
}

std::string fault_of(const std::string& text) {
  try {
    read(text, true);
  } catch (const Error& error) {
    return error.what();
  }
  return "no fault";
}

}  // namespace

TEST_CASE("a header that only a table of curves has") {
  const test::TemporaryFolder folder;
  const std::string path = (folder / "t.csv").string();
  const auto of = [&](const std::string& text) {
    std::ofstream(path, std::ios::binary) << text;
    return curve_in_header(path);
  };
  CHECK(of("tau_s,adev\n1,2\n") == "allan");
  CHECK(of("channel;Tau [s];avar\na;1;2\n") == "allan");
  CHECK(of("frequency_hz,psd\n1,2\n") == "psd");
  CHECK(of("curve,channel,x,value\noadev,a,1,2\n") == "allan or psd");
  for (const char* log : {"x,value\n1,2\n", "t,frequency\n1,2\n", "frequency,temperature\n1,2\n", "tau,x\n1,2\n",
                          "1,2\n3,4\n", "", "\x01\x02"})
    CHECK(of(log).empty());
  CHECK(curve_in_header((folder / "absent.csv").string()).empty());
  CHECK(curve_in_header(folder.path().string()).empty());
}

TEST_CASE("a published table with a channel column gives one curve a channel") {
  NEEDS_SHARED("data/avarcurve_navchip_published.csv");
  const auto table = read_curve_table(test::shared("data/avarcurve_navchip_published.csv").string(), true);
  REQUIRE(table);
  REQUIRE(table->curves.size() == 6);
  const NamedCurve& first = table->curves[0];
  CHECK(first.name == "Gyroscope_X");
  CHECK(first.curve.root);
  REQUIRE(first.curve.x.size() == 20);
  CHECK(first.curve.x[0] == 0.008);
  CHECK(first.curve.y[0] == 0.0013025587815325);
}

TEST_CASE("names of columns as people write them, with units, quotes, BOM, other delimiters") {
  const auto table = read("\xEF\xBB\xBF# made by hand\r\n\"Tau [s]\";\"AVAR\"\r\n0.1;4\r\n0.2;2\r\n\r\n", true);
  REQUIRE(table);
  REQUIRE(table->curves.size() == 1);
  CHECK_FALSE(table->curves[0].curve.root);
  CHECK(table->curves[0].curve.x == std::vector<double>{0.1, 0.2});
  CHECK(table->curves[0].curve.y == std::vector<double>{4, 2});
}

TEST_CASE("a curve is CSV as logs are: decimal commas, old line ends, blanks between the cells") {
  const auto is_curve = [](const std::string& text) {
    const auto table = read(text, true);
    REQUIRE(table);
    CHECK(table->curves.at(0).curve.x == std::vector<double>{0.5, 2});
    CHECK(table->curves.at(0).curve.y == std::vector<double>{1.25, 0.75});
  };
  is_curve("tau;adev\n0,5;1,25\n2;0,75\n");
  is_curve("tau,adev\r0.5,1.25\r2,0.75\r");
  is_curve("tau adev\n0.5 1.25\n  2 0.75\n");
  is_curve("% tau and deviation\ntau\tadev\n0.5\t1.25\n2\t+0.75\n");
}

TEST_CASE("degrees of freedom become the relative uncertainty of the deviation") {
  const auto table = read("tau_s,deviation,edf\n1,2,50\n2,1,8\n", true);
  REQUIRE(table);
  CHECK(table->curves[0].curve.relative_sd == std::vector<double>{0.1, 0.25});
}

TEST_CASE("a density in the square of a unit is a curve of a channel in that unit, and zero frequency is left out") {
  const auto table =
      read("curve,channel,unit,x,value\noadev,a,deg/s,1,2\npsd,a,(deg/s)²/Hz,0,9\npsd,a,(deg/s)²/Hz,1,3\n", false);
  REQUIRE(table);
  REQUIRE(table->curves.size() == 1);
  CHECK(table->curves[0].unit == "deg/s");
  CHECK(table->curves[0].curve.x == std::vector<double>{1});
}

TEST_CASE("a table of bare numbers is not a named one") {
  CHECK_FALSE(read("0.1,4\n0.2,2\n", true));
  CHECK_FALSE(read("time,gyro_x\n0.1,4\n", true));
}

TEST_CASE("rows that do not fit are named with their place") {
  CHECK(fault_of("tau_s,adev\n1,2\n2,x1\n").find("curve.csv:3:3: error E0311") != std::string::npos);
  CHECK(fault_of("tau_s,adev\n1,2,3\n").find("curve.csv:2:1: error E0304") != std::string::npos);
  CHECK(fault_of("tau_s,adev\n").find("holds no Allan curve") != std::string::npos);
}

TEST_CASE("relative and absolute errors are read, whatever they are called") {
  const auto sd = [](const std::string& text) { return read(text, true)->curves.at(0).curve.relative_sd; };
  CHECK(sd("tau_s,adev,rel_err\n1,2,0.25\n2,1,0.5\n") == std::vector<double>{0.25, 0.5});
  CHECK(sd("tau;adev;Relative error [%]\n1;2;25\n2;1;50\n") == std::vector<double>{0.25, 0.5});
  CHECK(sd("tau_s,adev,error\n1,2,0.5\n2,1,0.5\n") == std::vector<double>{0.25, 0.5});
  CHECK(sd("tau_s,adev,low68,high68\n1,2,1.5,2.5\n2,1,0.75,1.75\n") == std::vector<double>{0.25, 0.5});
  CHECK(sd("tau_s,avar,low68,high68\n1,2,1,3\n2,1,0.5,2.5\n") == std::vector<double>{0.25, 0.5});
  CHECK(sd("tau_s,avar,rel_err\n1,4,0.5\n2,1,1\n") ==
        std::vector<double>{0.25, 0.5});                      // of the variance: twice that of its root
  CHECK(sd("tau_s,adev,rel_err\n1,2,0.25\n2,1,\n").empty());  // not for every point: for none
}

TEST_CASE("the relative errors of a published table are read") {
  NEEDS_SHARED("data/avarcurve_navchip_published.csv");
  const auto table = read_curve_table(test::shared("data/avarcurve_navchip_published.csv").string(), true);
  CHECK(table->curves[0].curve.relative_sd.at(0) == 0.0005674816915767);
}

TEST_CASE("what is known of a curve stands beside it, in a column of long and of wide tables") {
  const auto longer = read("channel,tau_s,deviation,findings\na,1,2,motion:bad\na,2,1,motion:bad\nb,1,2,\n", true);
  REQUIRE(longer->curves.size() == 2);
  REQUIRE(longer->curves[0].findings.size() == 1);
  CHECK(longer->curves[0].findings[0].code == "motion");
  CHECK(longer->curves[1].findings.empty());
  const auto wide = read(
      "frequency_hz,a[V],b[(deg/s)²/Hz],c[g/√Hz],findings\n0,1,2,3,|motion:bad event:caution|constant:caution\n"
      "1,1,2,,\n2,1,2,3,\n",
      false);
  REQUIRE(wide->curves.size() == 3);
  CHECK(wide->curves[0].findings.empty());
  CHECK(wide->curves[1].findings.size() == 2);
  CHECK(wide->curves[1].unit == "deg/s");
  CHECK(wide->curves[1].kind == "psd_one_sided");
  REQUIRE(wide->curves[2].findings.size() == 1);
  CHECK(wide->curves[2].curve.root);
  CHECK(wide->curves[2].curve.x == std::vector<double>{2});  // its own rate: no value at 1 Hz
  const auto two = read("frequency_hz,a[V²/Hz]\n-1,2\n0,9\n1,2\n", false);
  CHECK(two->curves[0].curve.sides == Sides::two);
  CHECK(two->curves[0].findings.empty());
  CHECK(two->at_zero == 1);
  CHECK_THROWS_WITH(read("frequency_hz,a[V²/Hz]\n1,2\n2\n", false), Catch::Contains("E0304"));
  CHECK_THROWS_WITH(read("frequency_hz,a[V²/Hz]\n1,x\n", false), Catch::Contains("E0311"));
}
