#include "libchar/log/write.hpp"

#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <limits>
#include <random>

#include "libchar/core/error.hpp"
#include "libchar/log/read.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;
using ColumnValues = std::vector<double>;

namespace {

LogInfo info_of(const std::vector<Channel>& channels, double rate_hz = 200, std::optional<std::int64_t> start = {}) {
  LogInfo info;
  info.channels = channels;
  info.time.rate_hz = rate_hz;
  info.time.start_ns = start;
  return info;
}

// Written in blocks of uneven length, as readers deliver them.
std::vector<std::string> write(const std::string& path, const LogInfo& info, const std::vector<ColumnValues>& samples,
                               const WriteOptions& options = {}, std::size_t step = 1000) {
  const auto writer = open_log_writer(path, info, options);
  for (std::size_t at = 0; at < samples[0].size(); at += step) {
    std::vector<std::span<const double>> block;
    for (const ColumnValues& column : samples)
      block.emplace_back(std::span(column).subspan(at, std::min(step, column.size() - at)));
    writer->write(block);
  }
  writer->finish();
  return writer->losses();
}

std::vector<std::uint64_t> bits(const ColumnValues& samples) {
  std::vector<std::uint64_t> all;
  for (const double x : samples) all.push_back(std::isnan(x) ? 0x7ff8000000000000U : std::bit_cast<std::uint64_t>(x));
  return all;
}

// Every bit pattern that is a finite double, and the odd missing one.
ColumnValues any_doubles(std::size_t n, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  ColumnValues values = {0.0,     -0.0, 5e-324, -2.2250738585072014e-308, std::numeric_limits<double>::max(),
                         1.0 / 3, 0.1,  1e22,   123456789012345680.0};
  while (values.size() < n) {
    const double x = std::bit_cast<double>(random());
    values.push_back(std::isfinite(x) && random() % 50 != 0 ? x : kMissing);
  }
  return values;
}

}  // namespace

TEST_CASE("CSV, NPY and raw of the same data read back to the same bits") {
  const test::TemporaryFolder folder;
  const std::vector<ColumnValues> samples = {any_doubles(5000, 1), any_doubles(5000, 2), any_doubles(5000, 3)};
  const LogInfo info = info_of({{"gyro_x", "deg/s"}, {"gyro_y", "deg/s"}, {"it's, \"odd\"", ""}}, 200);
  int count = 0;
  for (const char* file : {"a.csv", "b.npy", "c.f64"}) {
    for (const char* order : {"interleaved", "planar"}) {
      for (const bool big : {false, true}) {
        for (const std::size_t step : {std::size_t{1}, std::size_t{777}, std::size_t{100000}}) {
          const std::string path = (folder / file).string();
          INFO(file << " " << order << " " << big << " " << step);
          WriteOptions options;
          options.order = order;
          options.big_endian = big;
          options.overwrite = true;
          write(path, info, samples, options, step);
          ReadOptions reading;
          reading.rate_hz = 200;
          const Recording got = read_recording(path, reading);
          REQUIRE(got.samples.size() == 3);
          for (std::size_t c = 0; c < 3; ++c) CHECK(bits(got.samples[c]) == bits(samples[c]));
          CHECK(got.info.time.rate_hz == Approx(200).epsilon(1e-12));
          const bool has_names = std::string(file) != "b.npy" || std::string(order) == "interleaved";
          CHECK(got.info.channels[0].name == (has_names ? "gyro_x" : "c0"));
          CHECK(got.info.channels[2].name == (has_names ? "it's, \"odd\"" : "c2"));
          ++count;
        }
      }
    }
  }
  CHECK(count == 36);
}

TEST_CASE("columns too long for memory come back from their temporary file in order") {
  const test::TemporaryFolder folder;
  // More than three stretches of half a megabyte, and a rest.
  const std::vector<ColumnValues> samples = {any_doubles(210'000, 1), any_doubles(210'000, 2)};
  for (const char* file : {"b.npy", "c.f64"}) {
    const std::string path = (folder / file).string();
    WriteOptions options;
    options.order = "planar";
    write(path, info_of({{"a", "V"}, {"b", "V"}}), samples, options, 9999);
    ReadOptions reading;
    reading.rate_hz = 200;
    const Recording got = read_recording(path, reading);
    REQUIRE(got.samples.size() == 2);
    for (std::size_t c = 0; c < 2; ++c) CHECK(bits(got.samples[c]) == bits(samples[c]));
  }
}

TEST_CASE("32-bit files hold 32-bit values exactly, and say what they rounded") {
  const test::TemporaryFolder folder;
  const std::vector<ColumnValues> samples = {{0.5, 1.0 / 3, kMissing, -0.0}};
  WriteOptions options;
  options.dtype = "f32";
  for (const char* file : {"a.npy", "a.f32"}) {
    const auto losses = write((folder / file).string(), info_of({{"c0", ""}}, 0), samples, options);
    REQUIRE(losses.size() == 1);
    CHECK(losses[0] == "1 values were rounded to 32 bits");
    const Recording got = read_recording((folder / file).string());
    CHECK(got.samples[0][0] == 0.5);
    CHECK(got.samples[0][1] == static_cast<double>(1.0F / 3.0F));
    CHECK(std::isnan(got.samples[0][2]));
    CHECK(std::signbit(got.samples[0][3]));
  }
  CHECK_THROWS_WITH(write((folder / "b.npy").string(), info_of({{"c0", ""}}), {{1e300}}, options),
                    Catch::Contains("does not fit 32 bits"));
  CHECK_FALSE(std::filesystem::exists(folder / "b.npy"));
}

TEST_CASE("raw keeps names, units, rate and start, CSV too, its absolute start as integers") {
  const test::TemporaryFolder folder;
  const LogInfo info = info_of({{"gyro_x", "deg/s"}}, 200, 1403636579758555392);
  for (const char* file : {"a.csv", "a.f64"}) {
    INFO(file);
    const std::string path = (folder / file).string();
    write(path, info, {{1, 2, 3, 4}});
    const Recording got = read_recording(path);
    CHECK(got.info.channels[0].name == "gyro_x");
    CHECK(got.info.channels[0].unit == "deg/s");
    CHECK(got.info.time.rate_hz == 200);
    CHECK(got.info.time.start_ns == 1403636579758555392);
  }
  CHECK(test::slurp(folder / "a.csv") ==
        "t[ns],gyro_x[deg/"
        "s]\n1403636579758555392,1\n1403636579763555392,2\n1403636579768555392,3\n1403636579773555392,4\n");
  write((folder / "b.csv").string(), info_of({{"c0", ""}}, 200, 2'500'000'000), {{1, kMissing, 3}});
  CHECK(test::slurp(folder / "b.csv") == "t[s],c0\n2.5,1\n2.505,\n2.51,3\n");
  CHECK(read_recording((folder / "b.csv").string()).info.time.start_ns == 2'500'000'000);
}

TEST_CASE("missing samples of a lone channel without stamps are not lost") {
  const test::TemporaryFolder folder;
  WriteOptions options;
  options.time_column = false;
  write((folder / "a.csv").string(), info_of({{"x", ""}}), {{1, kMissing, kMissing, 4}}, options);
  const Recording got = read_recording((folder / "a.csv").string());
  REQUIRE(got.samples[0].size() == 4);
  CHECK(std::isnan(got.samples[0][1]));
  CHECK(got.samples[0][3] == 4);
}

TEST_CASE("a channel name is no formula for a spreadsheet") {
  const test::TemporaryFolder folder;
  write((folder / "a.csv").string(), info_of({{"=1+1", ""}, {"@x", "V"}, {"-y", ""}, {"a\"b", ""}}, 0),
        {{1}, {2}, {3}, {4}});
  CHECK(test::slurp(folder / "a.csv") == "\"'=1+1\",\"'@x[V]\",\"'-y\",\"a\"\"b\"\n1,2,3,4\n");
}

TEST_CASE("an output is whole or absent, and nothing is overwritten unasked") {
  const test::TemporaryFolder folder;
  for (const char* file : {"a.csv", "a.npy", "a.f64"}) {
    const std::string path = (folder / file).string();
    {
      const auto writer = open_log_writer(path, info_of({{"x", ""}}));
      writer->write(std::vector<std::span<const double>>{ColumnValues(10, 1.0)});
    }
    CHECK_FALSE(std::filesystem::exists(path));
    write(path, info_of({{"x", ""}}), {{1, 2}});
    const std::string before = test::slurp(path);
    CHECK_THROWS_AS(open_log_writer(path, info_of({{"x", ""}})), Error);
    CHECK(test::slurp(path) == before);
  }
  std::size_t files = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder.path())) ++files;
  CHECK(files == 4);  // the three and one sidecar: nothing temporary is left
}

TEST_CASE("what cannot be written is refused before anything is") {
  const test::TemporaryFolder folder;
  const auto refuse = [&](const std::string& name, WriteOptions options) {
    try {
      open_log_writer((folder / name).string(), info_of({{"x", ""}}), options);
      return std::string("accepted");
    } catch (const Error& error) {
      CHECK(error.problem().kind == ErrorKind::usage);
      return std::string(error.what());
    }
  };
  CHECK_THAT(refuse("a.xyz", {}), Catch::Contains("the suffix does not say"));
  WriteOptions options;
  options.dtype = "f16";
  CHECK_THAT(refuse("a.npy", options), Catch::Contains("expected f64 or f32"));
  std::ofstream(folder / "b.f64.yaml") << "dtype: f64";
  CHECK_THROWS_WITH(open_log_writer((folder / "b.f64").string(), info_of({{"x", ""}})),
                    Catch::Contains("is a sidecar of this name already"));
}

TEST_CASE("thousands of named channels do not fit a .npy header and say so") {
  const test::TemporaryFolder folder;
  std::vector<Channel> channels;
  for (int i = 0; i < 2000; ++i) channels.push_back({"sensor_" + std::to_string(i), ""});
  const auto losses =
      write((folder / "a.npy").string(), info_of(channels, 0), std::vector<ColumnValues>(2000, ColumnValues{1, 2}));
  REQUIRE(losses.size() == 1);
  CHECK_THAT(losses[0], Catch::Contains("channel names"));
  CHECK(read_recording((folder / "a.npy").string()).info.channels.size() == 2000);
}
