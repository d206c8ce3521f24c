// The door to all formats: choice of the format, hashes, pipes, real recordings against the figures beside them.
#include "libchar/log/read.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <thread>

#include "libchar/core/file/sha256.hpp"
#include "tests/log/log_text.hpp"

using namespace libchar;
using test::count;

namespace {

std::uint64_t missing(const std::vector<double>& samples) {
  std::uint64_t n = 0;
  for (const double x : samples) n += std::isnan(x);
  return n;
}

}  // namespace

TEST_CASE("what cannot be read is said with its path") {
  const test::TemporaryFolder folder;
  const auto message = [](const std::string& path, ReadOptions options = {}) -> std::string {
    try {
      read_recording(path, options);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  CHECK(message((folder / "absent.csv").string()).find("No such file") != std::string::npos);
  CHECK(message(folder.path().string()).find("folder") != std::string::npos);
  const std::string pipe = (folder / "pipe.csv").string();
  REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
  CHECK(message(pipe).find("empty") != std::string::npos);  // a pipe without a writer does not hang the program
  ReadOptions options;
  options.format = "xls";
  CHECK(message("a.csv", options).find("unknown log format") != std::string::npos);
  options = {};
  options.rate_hz = -1;
  CHECK(message("a.csv", options).find("rate") != std::string::npos);
}

TEST_CASE("a pipe that gives a byte at a time reads like a file") {
  const test::TemporaryFolder folder;
  const std::string pipe = (folder / "pipe").string();  // no name that says what it holds
  const std::string text = "t,x\n0,1\n1,2\n2,4\n";
  REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
  std::thread writer([&] {
    std::ofstream out(pipe);
    for (const char c : text) out << c << std::flush;
  });
  CHECK(read_once(pipe));
  CHECK_FALSE(read_once(folder.path().string()));
  // The reader must find the writer: opening a pipe for writing waits for a reader.
  Recording r;
  for (int attempt = 0; attempt < 100 && r.samples.empty(); ++attempt) {
    try {
      r = read_recording(pipe);
    } catch (const Error&) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }
  writer.join();
  REQUIRE(r.samples.size() == 1);
}

TEST_CASE("the hash is that of the whole file") {
  const std::string text = "t,x\n0,1\n1,2\n2,4\n" + std::string(100, '\0');
  Sha256 sha;
  sha.update(text);
  const std::string expected = sha.finish();
  ReadOptions options;
  for (const std::size_t block : {1U, 5U, 100000U}) {
    options.block_bytes = block;
    CHECK(test::read_text(text, options).info.sha256 == expected);
  }
  options.hash = false;
  CHECK(test::read_text(text, options).info.sha256.empty());
}

TEST_CASE("the hash taken beside the parsing is that of the file, whatever its rows are like") {
  // Regular rows, seventeen digits, quotes, comments, blank lines, words: in stretches of each.
  std::string text = "t,x,y\n";
  for (int i = 0; i < 20000; ++i) {
    const std::string stamp = std::to_string(i);
    const int kind = i / 1500 % 5;
    text += kind == 0   ? stamp + ",-0.5," + stamp + ".25\n"
            : kind == 1 ? stamp + ",0.12345678901234567,1e-3\n"
            : kind == 2 ? stamp + ",\"1\",2\n"
            : kind == 3 ? stamp + ",,nan\n# a comment\n\n"
                        : stamp + ",1,2\n";
  }
  Sha256 sha;
  for (const char c : text) sha.update({&c, 1});
  const std::string expected = sha.finish();
  ReadOptions options;
  const Recording alone = [&] {
    options.threads = 1;
    return test::read_text(text, options);
  }();
  CHECK(alone.info.sha256 == expected);
  for (const int threads : {1, 2, 4})
    for (const std::size_t block : {std::size_t{1000}, std::size_t{4097}, std::size_t{70000}, std::size_t{1} << 22U}) {
      options.threads = threads;
      options.block_bytes = block;
      const Recording r = test::read_text(text, options);
      CHECK(r.info.sha256 == expected);
      REQUIRE(r.samples[0].size() == alone.samples[0].size());
      CHECK(std::memcmp(r.samples[0].data(), alone.samples[0].data(), 8 * r.samples[0].size()) == 0);
      CHECK(std::memcmp(r.samples[1].data(), alone.samples[1].data(), 8 * r.samples[1].size()) == 0);
    }
}

TEST_CASE("before its end a log says how many rows its first ones let expect") {
  struct First final : BlockSink {
    void begin(const LogInfo& so_far) override { expected = so_far.rows; }
    void block(const SampleBlock&) override {}
    std::uint64_t expected = 0;
  } sink;
  const test::TemporaryFolder folder;
  const std::string path = (folder / "a.csv").string();
  {
    std::ofstream out(path);
    out << "t_ms,x\n";
    for (int i = 100000; i < 400000; ++i) out << i << "," << i << "\n";
  }
  const LogInfo info = read_log(path, {}, sink);
  CHECK(info.rows == 300000);
  CHECK(std::abs(static_cast<double>(sink.expected) - 300000.0) < 3);
}

TEST_CASE("the sink sees blocks in order without holes") {
  struct Check final : BlockSink {
    void begin(const LogInfo& so_far) override { rate = so_far.time.rate_hz; }
    void block(const SampleBlock& b) override {
      REQUIRE(b.first == next);
      next += b.rows;
    }
    std::uint64_t next = 0;
    double rate = 0;
  } sink;
  const test::TemporaryFolder folder;
  const std::string path = (folder / "a.csv").string();
  {
    std::ofstream out(path);
    out << "t_ms,x\n";
    for (int i = 0; i < 50000; ++i)
      if (i % 5000 != 17) out << i * 10 << "," << i << "\n";
  }
  ReadOptions options;
  options.block_bytes = 5000;
  const LogInfo info = read_log(path, options, sink);
  CHECK(sink.next == 50000);
  CHECK(info.samples == 50000);
  CHECK(info.rows == 49990);
  CHECK(sink.rate == Approx(100));
}

TEST_CASE("real recordings: air monitors with missing values") {
  NEEDS_SHARED("data/array_airq3_rtp201908_1min.csv");
  const Recording r = read_recording(test::shared("data/array_airq3_rtp201908_1min.csv").string());
  CHECK(r.info.rows == 43969);
  CHECK(r.info.samples == 43969);
  CHECK(r.info.time.rate_hz == Approx(1.0 / 60).epsilon(1e-12));
  const std::uint64_t expected[] = {1133, 1046, 1046, 1135, 1049, 1047, 1135, 1049,
                                    1047, 1133, 1046, 1046, 1133, 1046, 1046};
  REQUIRE(r.samples.size() == 15);
  for (std::size_t c = 0; c < 15; ++c) CHECK(missing(r.samples[c]) == expected[c]);
  CHECK(r.info.channels[0].name == "pm25_1");
  CHECK(r.info.channels[0].unit == "ug/m3");
}

TEST_CASE("real recordings: rates and rows") {
  NEEDS_SHARED("data/array_mimu4444_exp1.csv");
  const auto read = [](const char* name) { return read_recording(test::shared(std::string("data/") + name).string()); };
  const Recording mimu = read("array_mimu4444_exp1.csv");
  CHECK(mimu.info.rows == 37439);
  CHECK(mimu.info.samples == 37439);
  CHECK(mimu.info.time.rate_hz == Approx(62.5).epsilon(1e-5));
  CHECK(mimu.info.channels.size() == 48);
  CHECK(mimu.info.channels[0].unit == "deg/s");  // counts of 1/16.4 deg/s
  CHECK_FALSE(mimu.info.channels[0].integer);
  CHECK(std::fabs(mimu.samples[0][0] * 16.4 - std::round(mimu.samples[0][0] * 16.4)) < 1e-9);
  CHECK(mimu.info.time.gaps == 0);
  const Recording dot = read("array_dot4_quad_horizontal_path_9.csv");
  CHECK(dot.info.samples == 6481);
  CHECK(dot.info.time.rate_hz == Approx(120).epsilon(1e-4));
  const Recording robot = read("tilt_robot_mpu9150_path1_150mms.csv");
  CHECK(robot.info.rows == 3352);
  // 1.36 s at 390 Hz, which are left out, then 100 Hz with jitter
  CHECK(robot.info.time.rate_hz == Approx(100.3).epsilon(0.005));
  CHECK(count(robot, "rate_change") == 1);
  CHECK(count(robot, "jitter") == 1);
  const Recording hourly = read("array_airq3_rtp201908_ref1h.csv");
  CHECK(hourly.info.samples == 739);
  CHECK(hourly.info.time.rate_hz == Approx(1.0 / 3600));
  CHECK(read("array_dot4_quad_horizontal_path_9.gt10hz.csv").info.time.rate_hz == Approx(10).epsilon(1e-4));
}

TEST_CASE("a published curve is a table with a text column: its numbers can be read") {
  NEEDS_SHARED("data/avarcurve_ln200_published.csv");
  const std::string path = test::shared("data/avarcurve_ln200_published.csv").string();
  CHECK_THROWS_AS(read_recording(path), Error);
  ReadOptions options;
  options.channels = {"tau_s", "adev"};
  const Recording r = read_recording(path, options);
  CHECK(r.info.rows == 132);
  CHECK(r.samples[0][0] == 0.005);
  CHECK(r.samples[1][1] == 0.000117659211614);
  CHECK(r.info.time.rate_hz == 0);
}
