#include "libchar/characterize/stretches.hpp"

#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>

#include "libchar/core/error.hpp"
#include "libchar/core/file/sha256.hpp"
#include "libchar/fit/remedies.hpp"
#include "libchar/log/channel_names.hpp"
#include "tests/support/noise.hpp"
#include "tests/support/places.hpp"

using namespace libchar;

namespace {

/// A raw log of doubles that goes with the object; `sample`: of value i, row by row.
class RawLog {
 public:
  RawLog(const char* name, std::uint64_t rows, const std::function<double(std::uint64_t)>& sample,
         std::size_t channels = 1)
      : path_((std::filesystem::temp_directory_path() /
               (std::string("libchar_stretches_") + std::to_string(::getpid()) + name + ".f64"))
                  .string()) {
    std::vector<double> samples(rows * channels);
    for (std::uint64_t i = 0; i < samples.size(); ++i) samples[i] = sample(i);
    std::ofstream(path_, std::ios::binary)
        .write(reinterpret_cast<const char*>(samples.data()),
               static_cast<std::streamsize>(samples.size() * sizeof(double)));
    std::string names;
    for (std::size_t c = 0; c < channels; ++c)
      names +=
          (c > 0 ? ", " : "") + (R"({"name": "gyro)" + (c > 0 ? std::to_string(c) : "") + R"(", "unit": "deg/s"})");
    std::ofstream(path_ + ".json") << R"({"dtype": "f64", "endian": "little", "channels": [)" + names +
                                          R"(], "rate_hz": 200})";
  }
  ~RawLog() {
    std::filesystem::remove(path_);
    std::filesystem::remove(path_ + ".json");
  }
  RawLog(const RawLog&) = delete;
  RawLog& operator=(const RawLog&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

/// Of a stretch, a state for each channel: "NAME" of the first, "NAME.2" of the second.
std::vector<NamedState> states_in(const std::string& path, const CharacterizeOptions& options, StretchRange range,
                                  const std::string& identity, const std::string& name) {
  std::vector<NamedState> states;
  characterize_stretch(path, options, range, identity, [&](const std::string& bytes) {
    const std::string number = states.empty() ? "" : "." + std::to_string(states.size() + 1);
    states.push_back(state_in_memory(name + number, bytes));
  });
  return states;
}

/// The states of a log in so many stretches of about one length.
std::vector<NamedState> states_of(const std::string& path, std::uint64_t stretches,
                                  const CharacterizeOptions& options = {}) {
  const std::uint64_t leaves = leaves_of(read_log_head(path, options.reading).rows);
  std::vector<NamedState> states;
  for (std::uint64_t s = 0; s < stretches; ++s) {
    const StretchRange range{s * leaves / stretches, (s + 1) * leaves / stretches};
    if (range.first_leaf == range.end_leaf) continue;
    for (NamedState& one : states_in(path, options, range, "log 1", "state" + std::to_string(s)))
      states.push_back(std::move(one));
  }
  return states;
}

Characterization as_stream(const std::string& path, CharacterizeOptions options = {}) {
  options.memory_bytes = 1 << 20U;
  return characterize(path, options);
}

struct Digits {
  double allan = 1e-12, mean = 1e-13, spectrum = 1e-12, fit = 1e-6;
};

void agree(const Characterization& a, const Characterization& b, const Digits& digits) {
  REQUIRE(a.channels.size() == b.channels.size());
  for (std::size_t c = 0; c < a.channels.size(); ++c) {
    const ChannelResult &x = a.channels[c], &y = b.channels[c];
    REQUIRE(x.findings == y.findings);
    REQUIRE(x.quality.samples == y.quality.samples);
    REQUIRE(x.quality.missing == y.quality.missing);
    REQUIRE(x.quality.distinct_values == y.quality.distinct_values);
    REQUIRE(x.quality.findings == y.quality.findings);
    REQUIRE(x.quality.mean == Approx(y.quality.mean).epsilon(digits.mean));
    REQUIRE(x.quality.standard_deviation == Approx(y.quality.standard_deviation).epsilon(digits.mean));
    REQUIRE(x.trace.low == y.trace.low);
    REQUIRE(x.trace.high == y.trace.high);
    REQUIRE(x.allan.points.size() == y.allan.points.size());
    for (std::size_t i = 0; i < x.allan.points.size(); ++i) {
      CAPTURE(x.allan.points[i].m);
      REQUIRE(x.allan.points[i].terms == y.allan.points[i].terms);
      REQUIRE(x.allan.points[i].deviation == Approx(y.allan.points[i].deviation).epsilon(digits.allan));
    }
    REQUIRE(x.spectrum.segments == y.spectrum.segments);
    REQUIRE(x.spectrum.dropped == y.spectrum.dropped);
    REQUIRE(x.spectrum.value.size() == y.spectrum.value.size());
    for (std::size_t k = 0; k < x.spectrum.value.size(); ++k)
      REQUIRE(x.spectrum.value[k] == Approx(y.spectrum.value[k]).epsilon(digits.spectrum));
    REQUIRE(x.fit.has_value() == y.fit.has_value());
    if (!x.fit) continue;
    for (std::size_t t = 0; t < x.fit->theta.size(); ++t)
      REQUIRE(x.fit->theta[t] == Approx(y.fit->theta[t]).epsilon(digits.fit));
  }
}

void equal_bits(const Characterization& a, const Characterization& b) { agree(a, b, {0, 0, 0, 0}); }

std::string refusal_of_states(std::span<const NamedState> states, const CharacterizeOptions& options = {}) {
  try {
    characterize_from_stretches(states, options);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

/// White noise, a walk and an offset.
std::function<double(std::uint64_t)> sensor(double offset, double drift = 0) {
  auto normal = std::make_shared<test::Gaussian>(7);
  auto walk = std::make_shared<double>(0);
  return [=](std::uint64_t i) {
    *walk += 1e-4 * (*normal)();
    return offset + drift * static_cast<double>(i) + *walk + 0.05 * (*normal)();
  };
}

}  // namespace

TEST_CASE("a log in stretches is what a streamed one is") {
  const RawLog log("clean", 5 * kLeafSamples + 123457, sensor(0.3));
  const Characterization whole = as_stream(log.path());
  const Characterization joined = characterize_from_stretches(states_of(log.path(), 1), {});
  agree(joined, whole, {});
}

TEST_CASE("a log in stretches: an offset of 1e9 standard deviations, a drift, another segment") {
  const RawLog log("offset", 3 * kLeafSamples + 50000, sensor(5e7, 1e-8));
  CharacterizeOptions options;
  options.spectrum.segment = 1 << 14U;
  options.spectrum.overlap = 0.75;
  const Characterization whole = as_stream(log.path(), options);
  const Characterization joined = characterize_from_stretches(states_of(log.path(), 3, options), options);
  // Of the stream the blocks of the fit are shorter where they are not half a segment, and
  // quantized to 1e-7 of the noise.
  agree(joined, whole, {.allan = 1e-12, .mean = 1e-12, .spectrum = 1e-10, .fit = 0.3});
}

TEST_CASE("a log in stretches: missing samples, at boundaries and beyond them") {
  auto noise = sensor(0.3);
  std::mt19937_64 generator(5);
  const RawLog log("holes", 4 * kLeafSamples + 70000, [&](std::uint64_t i) {
    const double x = noise(i);
    const bool long_gap = i > 2 * kLeafSamples - 3000 && i < 2 * kLeafSamples + 3000;
    if (long_gap || generator() % 100000 == 0) return std::nan("");
    return i == 77777 ? 1e200 : x;
  });
  const Characterization whole = as_stream(log.path());
  const Characterization joined = characterize_from_stretches(states_of(log.path(), 2), {});
  agree(joined, whole, {.allan = 1e-12, .mean = 1e-13, .spectrum = 1e-12, .fit = 0.05});
  REQUIRE(joined.channels[0].quality.beyond == 1);
  for (const std::uint64_t stretches : {1, 5}) {
    const Characterization other = characterize_from_stretches(states_of(log.path(), stretches), {});
    equal_bits(other, joined);
    REQUIRE(one_line(*other.log.warnings.find("missing_cell"), "") ==
            one_line(*joined.log.warnings.find("missing_cell"), ""));
  }
}

TEST_CASE("a log in stretches: spikes are left out of the leaves that have them") {
  auto noise = sensor(0.3);
  const RawLog log("spikes", 3 * kLeafSamples + 5, [&](std::uint64_t i) {
    const bool wild = i > kLeafSamples && i < 2 * kLeafSamples && i % 5003 == 17;
    return noise(i) + (wild ? 40.0 : 0.0);
  });
  const Characterization whole = as_stream(log.path());
  const Characterization joined = characterize_from_stretches(states_of(log.path(), 3), {});
  equal_bits(characterize_from_stretches(states_of(log.path(), 1), {}), joined);
  const NoiseFit &a = *whole.channels[0].fit, &b = *joined.channels[0].fit;
  REQUIRE(find_remedy(b, "spikes") != nullptr);
  REQUIRE(find_remedy(b, "spikes")->count == find_remedy(a, "spikes")->count);
  REQUIRE(b.theta[0] == Approx(a.theta[0]).epsilon(1e-3));
}

TEST_CASE("the bits of a log in stretches depend neither on the division nor on the order") {
  const RawLog log("divided", 7 * kLeafSamples + 9, sensor(0.3));
  const Characterization one = characterize_from_stretches(states_of(log.path(), 1), {});
  for (const std::uint64_t stretches : {2, 3, 7, 8}) {
    std::vector<NamedState> states = states_of(log.path(), stretches);
    equal_bits(characterize_from_stretches(states, {}), one);
    std::mt19937_64 generator(stretches);
    std::shuffle(states.begin(), states.end(), generator);
    equal_bits(characterize_from_stretches(states, {}), one);
  }
}

TEST_CASE("channels of a log in stretches are taken a few at a time, and are those of logs of their own") {
  constexpr std::size_t kChannels = 5;
  const std::uint64_t rows = 2 * kLeafSamples + 30000;
  auto noise = sensor(0.3);
  const auto hole = [](std::uint64_t row, std::size_t channel) {
    return row % 200001 == 17 * channel && channel % 2 == 1;
  };
  std::vector<double> values(rows * kChannels);
  for (std::uint64_t i = 0; i < values.size(); ++i)
    values[i] = hole(i / kChannels, i % kChannels) ? std::nan("") : noise(i);
  const RawLog log(
      "five", rows, [&](std::uint64_t i) { return values[i]; }, kChannels);
  std::vector<NamedState> states = states_of(log.path(), 2);
  REQUIRE(states.size() == 2 * kChannels);
  const Characterization joined = characterize_from_stretches(states, {});
  std::mt19937_64 generator(3);
  std::shuffle(states.begin(), states.end(), generator);
  equal_bits(characterize_from_stretches(states, {}), joined);
  const Characterization whole = characterize_from_stretches(states_of(log.path(), 1), {});
  equal_bits(whole, joined);
  REQUIRE(joined.log.warnings.find("missing_cell")->count == 22);
  REQUIRE(one_line(*whole.log.warnings.find("missing_cell"), "") ==
          one_line(*joined.log.warnings.find("missing_cell"), ""));
  for (std::size_t c = 0; c < kChannels; ++c) {
    const RawLog alone("one", rows, [&](std::uint64_t i) { return values[i * kChannels + c]; });
    Characterization one = characterize_from_stretches(states_of(alone.path(), 1), {});
    Characterization same = joined;
    same.channels = {joined.channels[c]};
    equal_bits(same, one);
  }
}

TEST_CASE("states of a channel that are missing or double are refused by name") {
  const RawLog log("three", kLeafSamples + 100, sensor(0.3), 3);
  const std::vector<NamedState> all = states_of(log.path(), 2);
  const auto without = [&](std::size_t i) {
    std::vector<NamedState> some = all;
    some.erase(some.begin() + static_cast<std::ptrdiff_t>(i));
    return refusal_of_states(some);
  };
  REQUIRE_THAT(without(1),
               Catch::Contains("state1.2: error E0725: no state has the leaves 0 to 0 of channel 2 before it"));
  REQUIRE_THAT(without(5),
               Catch::Contains("state0.3: error E0725: no state has the leaves 1 to 1 of channel 3 after it"));
  const std::vector<NamedState> no_third = {all[0], all[1], all[3], all[4]};
  REQUIRE_THAT(refusal_of_states(no_third), Catch::Contains("no state is of channel 3 of 3"));
  std::vector<NamedState> twice = all;
  twice.push_back({"copy", all[2].bytes});
  REQUIRE_THAT(refusal_of_states(twice), Catch::Contains("covers leaf 0 of channel 3, which"));
}

TEST_CASE("logs in stretches as short as a sample, and what was not asked for") {
  for (const std::uint64_t rows : {1, 5, 3000, 40000, 70000}) {
    CAPTURE(rows);
    const RawLog log("short", rows, sensor(0.3));
    const Characterization joined = characterize_from_stretches(states_of(log.path(), 1), {});
    REQUIRE(joined.channels[0].quality.samples == rows);
    REQUIRE(joined.channels[0].fit.has_value() == (rows > 5));
    REQUIRE(joined.channels[0].spectrum.value.empty() == (rows <= 5));
  }
  const RawLog log("wanted", kLeafSamples + 100000, sensor(0.3));
  for (const Wanted wanted : {Wanted{true, false, false, false}, Wanted{false, true, false, false},
                              Wanted{false, false, true, false}, Wanted{true, true, false, true}}) {
    CharacterizeOptions options;
    options.wanted = wanted;
    agree(characterize_from_stretches(states_of(log.path(), 2, options), options), as_stream(log.path(), options),
          {.fit = 0.3});  // without a spectrum a stream has shorter blocks
  }
}

TEST_CASE("a log of frequencies in stretches") {
  auto noise = sensor(0);
  const RawLog log("frequency", kLeafSamples + 100000, [&](std::uint64_t i) { return 1e7 + 1e-3 * noise(i); });
  CharacterizeOptions options;
  options.data = SampleKind::frequency;
  options.nominal_frequency = 1e7;
  agree(characterize_from_stretches(states_of(log.path(), 2, options), options), as_stream(log.path(), options),
        {.allan = 1e-11, .mean = 1e-9, .spectrum = 1e-10});
}

namespace {

/// One leaf and a bit, in two states.
struct TwoStates {
  RawLog log{"two", kLeafSamples + 5000, sensor(0.3)};
  std::vector<NamedState> states = states_of(log.path(), 2);
};

std::string refusal_of_stretch(const std::string& path, const CharacterizeOptions& options,
                               StretchRange range = {0, 1}) {
  try {
    characterize_stretch(path, options, range, "x", [](const std::string&) {});
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("states that are missing, double, foreign, or of other settings are refused by name") {
  const TwoStates two;
  const std::vector<NamedState>& states = two.states;
  REQUIRE_THAT(refusal_of_states({}), Catch::Contains("E0725"));
  REQUIRE_THAT(refusal_of_states({states.data(), 1}),
               Catch::Contains("state0: error E0725: no state has the leaves 1 to 1 after it"));
  REQUIRE_THAT(refusal_of_states({states.data() + 1, 1}),
               Catch::Contains("state1: error E0725: no state has the leaves 0 to 0 before it"));
  const std::vector<NamedState> twice = {states[0], states[1], {"copy", states[0].bytes}};
  REQUIRE_THAT(refusal_of_states(twice), Catch::Contains("copy: error E0725: covers leaf 0, which state0 does too"));
  const std::vector<NamedState> foreign = {states[0], states_in(two.log.path(), {}, {1, 2}, "log 2", "other")[0]};
  REQUIRE_THAT(refusal_of_states(foreign), Catch::Contains("other: error E0724: is of another log"));
  CharacterizeOptions options;
  options.spectrum.segment = 1 << 14U;
  REQUIRE_THAT(refusal_of_states(states, options), Catch::Contains("E0724"));
  options = {};
  options.reading.threads = 1;
  options.memory_bytes = 1 << 20U;
  REQUIRE(refusal_of_states(states, options).empty());
}

TEST_CASE("states that are cut or changed anywhere are refused, and never read") {
  const TwoStates two;
  const std::string whole = two.states[0].bytes();
  for (std::size_t at = 0; at < whole.size(); at += 1 + whole.size() / 40) {
    CAPTURE(at);
    std::string other = whole;
    other[at] = static_cast<char>(other[at] ^ 1);
    const std::vector<NamedState> changed = {state_in_memory("bad", other), two.states[1]};
    REQUIRE_THAT(refusal_of_states(changed), Catch::Contains("bad: error E0723"));
    const std::vector<NamedState> cut = {state_in_memory("bad", whole.substr(0, at)), two.states[1]};
    REQUIRE_THAT(refusal_of_states(cut), Catch::Contains("bad: error E0723"));
  }
  REQUIRE(stretch_head(two.states[1]).range.first_leaf == 1);
  REQUIRE(stretch_head(two.states[1]).identity == "log 1");
}

// Whoever changes a state on purpose can give it a digest too: what it says is then refused, or
// shown, and nothing else happens.
TEST_CASE("states that are changed and have the digest of that end in a result or a sentence") {
  const TwoStates two;
  const std::string whole = two.states[0].bytes();
  std::mt19937_64 generator(11);
  for (int i = 0; i < 60; ++i) {
    const std::size_t content = whole.size() - 64;
    std::size_t at = 20 + generator() % (content - 20);
    if (i % 3 == 0) at = 20 + generator() % 3000;            // the head
    if (i % 3 == 1) at = content - 1 - generator() % 40000;  // counts, quality
    std::string other = whole.substr(0, content);
    other[at] = static_cast<char>(generator());
    Sha256 digest;
    digest.update(other);
    other += digest.finish();
    CAPTURE(at);
    const std::vector<NamedState> states = {state_in_memory("bad", other), two.states[1]};
    REQUIRE_NOTHROW(refusal_of_states(states));
  }
}

TEST_CASE("a state whose sampling rate no log can have is refused") {
  const TwoStates two;
  const std::string whole = two.states[0].bytes();
  const double rate_hz = 200;
  const std::string there(reinterpret_cast<const char*>(&rate_hz), sizeof rate_hz);
  const std::size_t at = whole.find(there);
  REQUIRE(at < 3000);
  for (const double wrong : {std::nan(""), -1.0, 1e300, 5e-324}) {
    CAPTURE(wrong);
    std::string other = whole.substr(0, whole.size() - 64);
    std::memcpy(&other[at], &wrong, sizeof wrong);
    Sha256 digest;
    digest.update(other);
    other += digest.finish();
    const std::vector<NamedState> states = {state_in_memory("bad", other), two.states[1]};
    REQUIRE_THAT(refusal_of_states(states), Catch::Contains("bad: error E0723"));
  }
}

TEST_CASE("logs and options that cannot be divided are refused in a sentence") {
  const TwoStates two;
  const std::string& path = two.log.path();
  CharacterizeOptions options;
  REQUIRE_THAT(refusal_of_stretch(path, options, {1, 3}),
               Catch::Contains("E0727: the log has 2 leaves of 1048576 samples"));
  options.quarter_segments = true;
  REQUIRE_THAT(refusal_of_stretch(path, options),
               Catch::Contains("E0726") && Catch::Contains("a quarter of the record takes all samples at once"));
  options = {};
  options.spectrum.segment = 100000;
  REQUIRE_THAT(refusal_of_stretch(path, options), Catch::Contains("do not divide a leaf"));
  options = {};
  options.reading.from_s = 1;
  REQUIRE_THAT(refusal_of_stretch(path, options), Catch::Contains("a part of it already"));
  REQUIRE_THAT(refusal_of_stretch((test::fixtures_folder() / "imu_at_rest.csv").string(), {}),
               Catch::Contains("its rows have no fixed places (csv)"));
}
