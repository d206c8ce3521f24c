#include <unistd.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <random>

#include "libchar/characterize/characterization.hpp"
#include "libchar/core/error.hpp"

using namespace libchar;

namespace {

// 60000 rows of white noise with a random walk in two channels; `gap`: rows left out, one cell empty.
std::filesystem::path log_of(bool gap) {
  const auto path = std::filesystem::temp_directory_path() /
                    (std::string("libchar_streamed_") + std::to_string(::getpid()) + (gap ? "g.csv" : ".csv"));
  std::mt19937_64 generator(3);
  std::normal_distribution<double> normal;
  std::ofstream out(path);
  out << "t[s],a[rad/s],b[m/s^2]\n";
  double walk = 0;
  char line[128];
  for (int i = 0; i < 60000; ++i) {
    walk += 0.002 * normal(generator);
    const double a = 0.05 * normal(generator) + walk, b = 9.81 + normal(generator);
    if (gap && i >= 30000 && i < 30200) continue;
    std::snprintf(line, sizeof line, gap && i == 41000 ? "%.3f,%.9g,\n" : "%.3f,%.9g,%.9g\n", i * 0.005, a, b);
    out << line;
  }
  return path;
}

Characterization streamed(const std::filesystem::path& path, std::size_t block_bytes, int threads, std::uint64_t memory,
                          std::uint64_t segment = 8192) {
  CharacterizeOptions options;
  options.spectrum.segment = segment;
  options.memory_bytes = memory;
  options.reading.block_bytes = block_bytes;
  options.reading.threads = threads;
  return characterize(path.string(), options);
}

void same_bits(const Characterization& a, const Characterization& b) {
  REQUIRE(a.channels.size() == b.channels.size());
  for (std::size_t c = 0; c < a.channels.size(); ++c) {
    REQUIRE(a.channels[c].spectrum.value == b.channels[c].spectrum.value);
    REQUIRE(a.channels[c].fit->theta == b.channels[c].fit->theta);
    REQUIRE(a.channels[c].quality.difference_kurtosis == b.channels[c].quality.difference_kurtosis);
    REQUIRE(a.channels[c].quality.standard_deviation == b.channels[c].quality.standard_deviation);
    for (std::size_t i = 0; i < a.channels[c].allan.points.size(); ++i)
      REQUIRE(a.channels[c].allan.points[i].deviation == b.channels[c].allan.points[i].deviation);
  }
}

}  // namespace

TEST_CASE("a recording in memory gives the same bits as its file, in one pass or several") {
  const auto path = log_of(true);
  const Recording recording = read_recording(path.string());
  for (const std::uint64_t memory : {std::uint64_t{1} << 30U, std::uint64_t{1} << 18U}) {
    CharacterizeOptions options;
    options.spectrum.segment = 8192;
    options.memory_bytes = memory;
    const Characterization file = characterize(path.string(), options);
    const Characterization again = characterize(recording, options);
    same_bits(file, again);
    CHECK(again.log.samples == file.log.samples);
    CHECK(again.channels[1].channel.name == file.channels[1].channel.name);
  }
  std::filesystem::remove(path);
}

TEST_CASE("a recording made by the caller needs names, a rate, and columns of one length") {
  std::mt19937_64 generator(5);
  std::normal_distribution<double> normal(0, 0.1);
  Recording made;
  made.info.channels = {{"gyr_x", "rad/s", false}};
  made.info.time.rate_hz = 100;
  made.samples.resize(1);
  for (int i = 0; i < 20000; ++i) made.samples[0].push_back(normal(generator));
  const Characterization result = characterize(made);
  REQUIRE(result.channels.size() == 1);
  REQUIRE(result.channels[0].fit);
  CHECK(*(*result.channels[0].fit)[Term::white].value == Approx(0.01).epsilon(0.05));
  made.info.channels.push_back({"gyr_y", "rad/s", false});
  CHECK_THROWS_AS(characterize(made), Error);
  made.samples.push_back({1, 2, 3});
  CHECK_THROWS_AS(characterize(made), Error);
}

TEST_CASE("a log gives the same bits whatever the blocks and threads, with gaps too") {
  for (const bool gap : {false, true}) {
    const auto path = log_of(gap);
    const Characterization first = streamed(path, std::size_t{1} << 20U, 0, 1);
    for (const std::size_t block : {std::size_t{1} << 14U, std::size_t{70000}, std::size_t{3000000}})
      for (const int threads : {1, 2}) {
        CAPTURE(gap, block, threads);
        same_bits(streamed(path, block, threads, 1), first);
      }
    std::filesystem::remove(path);
  }
}
