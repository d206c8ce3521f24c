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
#include "libchar/log/channel_names.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;

namespace {

/// A raw log of doubles that goes with the object.
class RawLog {
 public:
  RawLog(const char* name, std::uint64_t rows, const std::function<double(std::uint64_t)>& sample)
      : path_((std::filesystem::temp_directory_path() /
               (std::string("libchar_stretches_") + std::to_string(::getpid()) + name + ".f64"))
                  .string()) {
    std::vector<double> samples(rows);
    for (std::uint64_t i = 0; i < rows; ++i) samples[i] = sample(i);
    std::ofstream(path_, std::ios::binary)
        .write(reinterpret_cast<const char*>(samples.data()),
               static_cast<std::streamsize>(rows * sizeof(double)));
    std::ofstream(path_ + ".json")
        << R"({"dtype": "f64", "endian": "little", "channels": [{"name": "gyro", "unit": "deg/s"}], "rate_hz": 200})";
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

/// The states of a log in so many stretches of about one length.
std::vector<NamedState> states_of(const std::string& path,
                                  std::uint64_t stretches,
                                  const CharacterizeOptions& options = {}) {
  const std::uint64_t leaves = leaves_of(read_log_head(path, options.reading).rows);
  std::vector<NamedState> states;
  for (std::uint64_t s = 0; s < stretches; ++s) {
    const StretchRange range{s * leaves / stretches, (s + 1) * leaves / stretches};
    if (range.first_leaf == range.end_leaf) continue;
    states.push_back(state_in_memory("state" + std::to_string(s),
                                     characterize_stretch(path, options, range, "log 1")));
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
    REQUIRE(x.problems == y.problems);
    REQUIRE(x.quality.samples == y.quality.samples);
    REQUIRE(x.quality.missing == y.quality.missing);
    REQUIRE(x.quality.distinct_values == y.quality.distinct_values);
    REQUIRE(x.quality.suggestions == y.quality.suggestions);
    REQUIRE(x.quality.mean == Approx(y.quality.mean).epsilon(digits.mean));
    REQUIRE(x.quality.standard_deviation ==
            Approx(y.quality.standard_deviation).epsilon(digits.mean));
    REQUIRE(x.trace.low == y.trace.low);
    REQUIRE(x.trace.high == y.trace.high);
    REQUIRE(x.allan.points.size() == y.allan.points.size());
    for (std::size_t i = 0; i < x.allan.points.size(); ++i) {
      CAPTURE(x.allan.points[i].m);
      REQUIRE(x.allan.points[i].terms == y.allan.points[i].terms);
      REQUIRE(x.allan.points[i].deviation ==
              Approx(y.allan.points[i].deviation).epsilon(digits.allan));
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

void equal_bits(const Characterization& a, const Characterization& b) {
  agree(a, b, {0, 0, 0, 0});
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
