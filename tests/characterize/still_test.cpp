// Only rest is analysed: a stretch as asked, the longest still one, and what is refused. Rails,
// held values and staircases.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <span>

#include "libchar/characterize/characterization.hpp"
#include "libchar/characterize/judgement.hpp"
#include "libchar/characterize/model_from_fit.hpp"
#include "libchar/core/error.hpp"
#include "libchar/fit/signs/digital.hpp"
#include "libchar/log/quality.hpp"
#include "tests/characterize/refusal.hpp"
#include "tests/support/memory_log.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;

namespace {

constexpr double kStillRate = 50;

Recording two_channels(std::size_t n, std::uint64_t seed) {
  test::NoiseSource source(n, kStillRate, seed);
  Recording recording;
  recording.info.time.rate_hz = kStillRate;
  recording.info.channels = {{"gyr_x", "deg/s", false}, {"gyr_y", "deg/s", false}};
  recording.samples = {source.record(5e-3, 0, 0), source.record(5e-3, 0, 0)};
  return recording;
}

void move(std::vector<double>& y, double from_s, double to_s) {
  const auto end = static_cast<std::size_t>(to_s * kStillRate);
  for (auto t = static_cast<std::size_t>(from_s * kStillRate); t < end; ++t)
    y[t] += 3 * std::sin(0.9 * static_cast<double>(t)) + std::sin(0.31 * static_cast<double>(t));
}

CharacterizeOptions only_fit() {
  CharacterizeOptions options;
  options.wanted = {.quality = true, .allan = false, .spectrum = false, .fit = true};
  options.fit.second_opinion = false;
  return options;
}

}  // namespace

TEST_CASE("still: the longest stretch in which no channel moves, and a stretch as asked") {
  Recording recording = two_channels(60'000, 1);
  move(recording.samples[0], 200, 260);
  move(recording.samples[1], 900, 940);
  CharacterizeOptions options = only_fit();
  options.still.search = true;
  const Characterization found = characterize(recording, options);
  REQUIRE(found.still);
  CHECK(found.still->from_s == Approx(260).margin(10));
  CHECK(found.still->to_s == Approx(900).margin(8));
  CHECK(found.still->moving == std::vector<std::string>{"gyr_x", "gyr_y"});
  CHECK(found.still->sentence.find("the longest in which nothing moves") != std::string::npos);
  CHECK(verdict_of(found).find("Only the stretch") != std::string::npos);
  for (const ChannelResult& channel : found.channels) {
    REQUIRE(channel.fit);
    CHECK((*channel.fit)[Term::white].value.value() == Approx(5e-3).epsilon(0.03));
    CHECK(channel.fit->moving_s.empty());
    const SensorModel model = sensor_model_from(channel, found.log);
    REQUIRE(model.stretch_s);
    CHECK(model.stretch_s->low == found.still->from_s);
  }
  options.still = {false, Interval{300, 500}};
  const Characterization asked = characterize(recording, options);
  CHECK(asked.log.samples == 10'000);
  CHECK(asked.still->sentence == "Only the stretch from 300 to 500 s was analysed, as requested.");
}

TEST_CASE("still: a louder stretch is left out, and nothing contradicts the sentence") {
  Recording recording = two_channels(60'000, 3);
  for (std::size_t t = 10'000; t < 40'000; ++t) recording.samples[1][t] *= 1.5;
  CharacterizeOptions options = only_fit();
  options.still.search = true;
  const Characterization found = characterize(recording, options);
  REQUIRE(found.still);
  CHECK(found.still->from_s == Approx(800).margin(8));
  CHECK(found.still->to_s == 1200);
  CHECK(found.still->moving == std::vector<std::string>{"gyr_y"});
  for (const ChannelResult& channel : found.channels) {
    CHECK(channel.motion.changes.empty());
    CHECK((*channel.fit)[Term::white].value.value() == Approx(5e-3).epsilon(0.03));
  }
}

TEST_CASE("still: nothing moves, a log in a file, and all that is refused") {
  Recording recording = two_channels(20'000, 2);
  CharacterizeOptions options = only_fit();
  options.still.search = true;
  const Characterization whole = characterize(recording, options);
  CHECK(whole.still->whole);
  CHECK_FALSE(whole.log.stretch_s);

  std::string text = "a\n";
  for (std::size_t t = 0; t < 20'000; ++t) text += std::to_string(recording.samples[0][t]) + "\n";
  const test::MemoryLog log(text);
  options.reading.rate_hz = kStillRate;
  options.still = {false, Interval{100, 200}};
  CHECK(characterize(log.path(), options).log.samples == 5'000);
  options.still = {false, Interval{100, 500}};
  CHECK_THROWS_AS(characterize(log.path(), options), Error);
  options.still.stretch_s = Interval{200, 100};
  CHECK(test::refusal(recording, options).find("E0704") == 0);
  options.reading.from_s = 10;
  CHECK_THROWS_AS(characterize(log.path(), options), Error);

  // A sensor in use: no two stretches are as lively.
  test::Gaussian gauss(8);
  double lively = 1;
  for (std::size_t t = 0; t < 20'000; ++t) {
    if (t % 100 == 0) lively = std::exp(2.5 * gauss());
    recording.samples[1][t] += lively * std::sin(0.9 * static_cast<double>(t));
  }
  options = only_fit();
  options.still.search = true;
  CHECK(test::refusal(recording, options) == "E0705 the channel gyr_y moves throughout: the log has no still stretch");
  CHECK(test::refusal(two_channels(500, 3), options).find("E0705 no channel can be searched") == 0);
}

TEST_CASE("digital faults stand in the result, and their coefficients are not believed") {
  Recording recording = two_channels(40'000, 4);
  const double sigma = 5e-3 * std::sqrt(kStillRate);
  for (double& value : recording.samples[0]) value = std::clamp(value, -sigma, sigma);
  for (double& value : recording.samples[1]) value = std::round(value / (5 * sigma)) * 5 * sigma;
  const auto find = [](const ChannelResult& channel, const std::string& words) {
    const auto& p = channel.findings;
    return std::any_of(p.begin(), p.end(), [&](const auto& s) { return s.sentence.find(words) != std::string::npos; });
  };
  const Characterization result = characterize(recording, only_fit());
  const ChannelResult &clipped = result.channels[0], &coarse = result.channels[1];
  REQUIRE(clipped.digital.rails.size() == 2);
  CHECK(clipped.digital.rails[0].share == Approx(0.16).margin(0.01));
  CHECK(clipped.quality.saturated == Approx(0.317 * 40'000).epsilon(0.03));
  CHECK(find(clipped, "are at the largest value"));
  CHECK((*clipped.fit)[Term::white].status == Status::misfit);
  REQUIRE(coarse.digital.staircase);
  CHECK(find(coarse, "is below the converter's step"));
  REQUIRE(coarse.fit);
  for (const Coefficient& term : coarse.fit->term) CHECK(term.status != Status::detected);
  const Coefficient& white = (*coarse.fit)[Term::white];
  CHECK(white.value.value() < 0.8 * 5e-3);
  CHECK(white.ci95.high >= 5e-3);

  Recording held = two_channels(40'000, 5);
  for (std::size_t t = 1; t < 40'000; t += 2) held.samples[0][t] = held.samples[0][t - 1];
  const Characterization twice = characterize(held, only_fit());
  REQUIRE(twice.channels[0].digital.held);
  CHECK(twice.channels[0].digital.held->sensor_rate_hz == Approx(25));
  REQUIRE(has(twice.channels[0].quality.findings, "held_values"));
  CHECK(twice.channels[0].quality.findings[0].sentence.find("the sensor gives 25.00 Hz where the log has 50.00 Hz") !=
        std::string::npos);
  CHECK(twice.channels[1].findings.empty());
}
