#include "libchar/log/convert.hpp"

#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "libchar/core/error.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;
using Catch::Contains;
namespace fs = std::filesystem;

namespace {

std::string a_log(const test::TemporaryFolder& folder, bool with_a_gap) {
  const std::string path = (folder / "a.csv").string();
  std::ofstream out(path);
  out << "t[s],x[m/s^2]\n";
  for (int i = 0; i < 40; ++i)
    if (!with_a_gap || i != 17) out << fmt::format("{:.2f},{}\n", 0.01 * i, std::sin(0.7 * i));
  return path;
}

}  // namespace

TEST_CASE("convert_log: there and back holds every bit, the rate and the units") {
  const test::TemporaryFolder folder;
  const std::string from = a_log(folder, false), there = (folder / "b.raw").string(),
                    back = (folder / "c.csv").string();
  const Conversion first = convert_log(from, there);
  CHECK(first.log.samples == 40);
  CHECK(first.files.front() == there);
  CHECK(fs::exists(there));
  convert_log(there, back);
  const Recording a = read_recording(from), c = read_recording(back);
  CHECK(a.samples == c.samples);
  CHECK(c.info.channels[0].name == "x");
  CHECK(c.info.time.rate_hz == Approx(100));
}

TEST_CASE("convert_log: what a format cannot hold is said") {
  const test::TemporaryFolder folder;
  const Conversion result = convert_log(a_log(folder, true), (folder / "b.csv").string());
  CHECK(result.losses.empty());
  ConvertOptions bare;
  bare.writing.time_column = false;
  const Conversion lost = convert_log(a_log(folder, false), (folder / "c.csv").string(), bare);
  REQUIRE(lost.losses.size() == 1);
  CHECK_THAT(lost.losses[0], Contains("rate"));
}

TEST_CASE("convert_log: rows of several clocks are no grid, those of one channel are") {
  const test::TemporaryFolder folder;
  const std::string from = (folder / "joined.csv").string(), to = (folder / "b.csv").string();
  std::ofstream out(from);
  out << "t[s],fast,slow\n";
  for (int i = 0; i < 4000; ++i) {
    out << fmt::format("{:.4f},{},\n", 0.01 * i, i % 7);
    if (i % 12 == 0) out << fmt::format("{:.4f},,{}\n", 0.01 * i + 0.0031, i % 11);
  }
  out.close();
  CHECK_THROWS_WITH(convert_log(from, to), Contains("E0341") && Contains("`channels` fast"));
  CHECK(!fs::exists(to));
  ConvertOptions one;
  one.reading.channels = {"fast"};
  CHECK(convert_log(from, to, one).log.time.rate_hz == Approx(100));
}

TEST_CASE("convert_log: on request nothing is written from a log that has warnings") {
  const test::TemporaryFolder folder;
  const std::string to = (folder / "b.csv").string();
  ConvertOptions options;
  options.only_without_warnings = true;
  const Conversion result = convert_log(a_log(folder, true), to, options);
  CHECK_FALSE(result.log.warnings.empty());
  CHECK(result.files.empty());
  CHECK_FALSE(fs::exists(to));
  CHECK_FALSE(convert_log(a_log(folder, false), to, options).files.empty());
}

TEST_CASE("convert_log: a log is never written over itself, nor over a file that is there") {
  const test::TemporaryFolder folder;
  const std::string from = a_log(folder, false), to = (folder / "b.csv").string();
  ConvertOptions options;
  options.writing.overwrite = true;
  CHECK_THROWS_AS(convert_log(from, from, options), Error);
  convert_log(from, to);
  CHECK_THROWS_AS(convert_log(from, to), Error);
  CHECK_NOTHROW(convert_log(from, to, options));
}
