// Temperature on its way through a characterization: chosen by name, read beside the others,
// refused where it cannot be had.
#include <catch2/catch.hpp>
#include <cmath>

#include "libchar/characterize/characterization.hpp"
#include "libchar/characterize/compare/verification.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/numeric/leaf_tree.hpp"
#include "tests/characterize/refusal.hpp"
#include "tests/support/memory_log.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;

namespace {

Recording warm_recording(double rate_hz, std::size_t n) {
  test::NoiseSource source(n, rate_hz, 5);
  Recording recording;
  recording.info.time.rate_hz = rate_hz;
  recording.info.channels = {{"gyr_x", "deg/s", false}, {"box", "degF", false}};
  recording.samples = {source.record(5e-3, 0, 1e-4), std::vector<double>(n)};
  for (std::size_t t = 0; t < n; ++t) {
    const double celsius = 20 + 4 * std::sin(12.0 * static_cast<double>(t) / static_cast<double>(n));
    recording.samples[1][t] = celsius * 1.8 + 32;
    recording.samples[0][t] += 0.02 * celsius;
  }
  return recording;
}

}  // namespace

TEST_CASE("temperature of a recording: per K whatever its unit, and the loop closes") {
  const Recording recording = warm_recording(10, 20'000);
  CharacterizeOptions options;
  options.temperature = "box";
  Characterization result = characterize(recording, options);
  REQUIRE(result.channels.size() == 2);
  const NoiseFit& fit = result.channels[0].fit.value();
  REQUIRE(fit.temperature.has_value());
  CHECK(fit.temperature->order >= 1);
  CHECK(fit.temperature->coefficient[0] == Approx(0.02).epsilon(0.1));
  CHECK(fit.temperature->unit == "°C");
  CHECK(fit.temperature->mean == Approx(20).margin(3));
  CHECK(fit.events.empty());
  CHECK_FALSE((result.channels[1].fit && result.channels[1].fit->temperature));
  result.channels.pop_back();
  CHECK(verify(result, options));
}

TEST_CASE("temperature of a recording: a pattern that one channel matches is its name") {
  const Recording recording = warm_recording(10, 20'000);
  CharacterizeOptions options;
  options.temperature = "bo*";
  const Characterization result = characterize(recording, options);
  CHECK(result.channels.at(0).fit.value().temperature.has_value());
}

TEST_CASE("temperature of a recording: refused where it is none or cannot be kept") {
  const Recording recording = warm_recording(10, 20'000);
  CharacterizeOptions options;
  options.temperature = "bx";
  CHECK(test::refusal(recording, options).find("E0702 there is no channel of this name") == 0);
  options.temperature = "*";
  CHECK(test::refusal(recording, options).find("E0702 several channels match this pattern") == 0);
  options.temperature = "gyr_x";
  CHECK(test::refusal(recording, options) == "E0702 the channel gyr_x is in deg/s, which is not a temperature");
  Recording alone = recording;
  alone.info.channels.erase(alone.info.channels.begin());
  alone.samples.erase(alone.samples.begin());
  options.temperature = "box";
  CHECK(test::refusal(alone, options).find("is the only channel") != std::string::npos);
  Recording constant = recording;
  constant.samples[1].assign(20'000, 68);
  CHECK(test::refusal(constant, options).find("E0703 the temperature box is constant") == 0);
  options.memory_bytes = 1U << 16U;
  const Recording longer = warm_recording(10, kLeafSamples + 1);
  CHECK(test::refusal(longer, options).find("E0701 a correction for temperature takes all") == 0);
}

TEST_CASE("temperature of a log: read beside the channels that were chosen, and not shown") {
  const Recording recording = warm_recording(10, 3'000);
  std::string text = "a,box [degF],b\n";
  for (std::size_t t = 0; t < 3'000; ++t)
    text += std::to_string(recording.samples[0][t]) + "," + std::to_string(recording.samples[1][t]) + ",1\n";
  const test::MemoryLog log(text);
  CharacterizeOptions options;
  options.reading.rate_hz = 10;
  options.reading.channels = {"a"};
  options.temperature = "box";
  const Characterization result = characterize(log.path(), options);
  REQUIRE(result.channels.size() == 1);
  CHECK(result.log.channels.size() == 1);
  CHECK(result.channels[0].fit.value().temperature.has_value());
  options.reading.names = {"x"};
  CHECK_THROWS_AS(characterize(log.path(), options), Error);
}
