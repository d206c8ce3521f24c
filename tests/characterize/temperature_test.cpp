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

TEST_CASE("temperature of a recording: nobody asked, and the log holds the explanation") {
  constexpr std::size_t kSamples = 40'000;
  int said = 0, walks = 0, mended = 0, records = 0, clean = 0;
  for (const double periods : {1.0, 1.5, 2.2, 4.0})
    for (const double times : {1.0, 5.0})
      for (std::uint64_t seed = 1; seed <= 2; ++seed, ++records) {
        test::NoiseSource source(kSamples, 100, 30 + seed);
        Recording recording;
        recording.info.time.rate_hz = 100;
        recording.info.channels = {{"gyr_x", "deg/s", false}, {"gyr_y", "deg/s", false}, {"temp", "degC", false}};
        recording.samples = {source.record(5e-3, 0, 0), source.record(5e-3, 0, 0), std::vector<double>(kSamples)};
        for (std::size_t t = 0; t < kSamples; ++t) {
          const double part = static_cast<double>(t) / kSamples;
          const double warm = std::sin(2 * M_PI * periods * part + static_cast<double>(seed));
          recording.samples[2][t] = 30 + 4 * warm;
          recording.samples[0][t] += 0.05 * times * warm;
        }
        const Characterization result = characterize(recording, {});
        const ChannelResult &moved = result.channels[0], &still = result.channels[1];
        for (const Finding& one : moved.findings)
          if (one.code == "temperature_left_in")
            said += one.help.at(0).options.at(0).option == "temperature" && one.help[0].options[0].value == "temp";
        walks += (*moved.fit)[Term::walk].status == Status::detected;
        clean += !has(still.findings, "temperature_left_in");
        CHECK_FALSE(has(result.channels[2].findings, "motion"));
        CHECK_FALSE(has(result.channels[2].findings, "moves_throughout"));
        CHECK(moved.means.value.empty());
        CharacterizeOptions options;
        options.temperature = "temp";
        const Characterization again = characterize(recording, options);
        const Coefficient& white = (*again.channels[0].fit)[Term::white];
        mended += white.value && white.ci95.low <= 5e-3 && 5e-3 <= white.ci95.high &&
                  (*again.channels[0].fit)[Term::walk].status == Status::not_detected;
        CHECK_FALSE(has(again.channels[0].findings, "temperature_left_in"));
      }
  INFO(said << " said, " << walks << " walks, " << mended << " mended, " << clean << " clean of " << records);
  CHECK(said == records);
  CHECK(walks == 0);
  CHECK(mended >= records - 2);
  CHECK(clean == records);
}

TEST_CASE("temperature of a recording: walks that no temperature makes are left alone") {
  constexpr std::size_t kSamples = 40'000;
  int said = 0, detected = 0;
  constexpr int kRecords = 30;
  for (int seed = 0; seed < kRecords; ++seed) {
    test::NoiseSource source(kSamples, 100, 60 + static_cast<std::uint64_t>(seed));
    Recording recording;
    recording.info.time.rate_hz = 100;
    recording.info.channels = {{"gyr_x", "deg/s", false}, {"temp", "degC", false}};
    recording.samples = {source.record(5e-3, 0, 3e-3), source.record(5e-3, 0, 3e-2)};
    for (double& warm : recording.samples[1]) warm += 30;
    const Characterization result = characterize(recording, {});
    said += has(result.channels[0].findings, "temperature_left_in");
    detected += (*result.channels[0].fit)[Term::walk].status == Status::detected;
  }
  INFO(said << " said, " << detected << " detected");
  CHECK(said <= 2);
  CHECK(detected >= kRecords - 3);
}
