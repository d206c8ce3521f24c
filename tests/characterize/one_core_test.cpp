// One answer to "N, B, K of this log?": a file, samples in memory, any memory, any number of
// threads, stretches on many machines.

#include <unistd.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <numbers>
#include <random>

#include "libchar/characterize/characterization.hpp"
#include "libchar/characterize/stretches.hpp"
#include "libchar/log/channel_names.hpp"

using namespace libchar;

namespace {

using Rows = std::vector<double>;

/// White noise and a walk, and what `spoil` does to them.
Rows noise(
    std::size_t rows, const std::function<void(Rows&)>& spoil = [](Rows&) {}) {
  std::mt19937_64 generator(11);
  std::normal_distribution<double> normal;
  Rows y(rows);
  double walk = 0;
  for (double& x : y) x = (walk += 2e-4 * normal(generator)) + 0.05 * normal(generator);
  spoil(y);
  return y;
}

void spikes(Rows& y) {
  for (std::size_t i = 501; i < y.size(); i += 1009) y[i] += i % 2 == 0 ? 1.5 : -1.5;
}
void gaps(Rows& y) {
  constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t i = 77; i < y.size(); i += 997) y[i] = kMissing;
  for (std::size_t i = y.size() / 3; i < y.size() / 3 + y.size() / 200; ++i) y[i] = kMissing;
}
void line(Rows& y) {
  for (std::size_t i = 0; i < y.size(); ++i)
    y[i] += 0.05 * std::sin(2 * std::numbers::pi * 0.2513 * static_cast<double>(i));
}
void step(Rows& y) {
  for (std::size_t i = y.size() * 5 / 9; i < y.size(); ++i) y[i] += 0.4;
}
void all(Rows& y) {
  for (const auto& spoil : {spikes, gaps, line, step}) spoil(y);
}
void phase(Rows& y) {
  double sum = 0;
  for (double& x : y) x = sum += 1e-9 * x;
}

class Log {
 public:
  explicit Log(const Rows& rows)
      : path_((std::filesystem::temp_directory_path() / ("libchar_one_core_" + std::to_string(::getpid()) + ".f64"))
                  .string()) {
    std::ofstream(path_, std::ios::binary)
        .write(reinterpret_cast<const char*>(rows.data()), static_cast<std::streamsize>(rows.size() * sizeof(double)));
    std::ofstream(path_ + ".json")
        << R"({"dtype": "f64", "endian": "little", "channels": [{"name": "a", "unit": "deg/s"}], "rate_hz": 100})";
  }
  ~Log() {
    std::filesystem::remove(path_);
    std::filesystem::remove(path_ + ".json");
  }
  Log(const Log&) = delete;
  Log& operator=(const Log&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

void same(const NoiseFit& a, const NoiseFit& b) {
  for (std::size_t t = 0; t < kTerms; ++t) {
    CHECK(a.term[t].value == b.term[t].value);
    CHECK(a.term[t].upper95 == b.term[t].upper95);
    CHECK(a.term[t].ci95.low == b.term[t].ci95.low);
    CHECK(a.term[t].ci95.high == b.term[t].ci95.high);
    CHECK(a.term[t].status == b.term[t].status);
  }
  CHECK(a.goodness.p == b.goodness.p);
  CHECK(a.findings == b.findings);
  CHECK(a.events.size() == b.events.size());
  CHECK(a.stationarity.tested == b.stationarity.tested);
  REQUIRE(a.remedies.size() == b.remedies.size());
  for (std::size_t i = 0; i < a.remedies.size(); ++i) {
    CHECK(a.remedies[i].kind == b.remedies[i].kind);
    CHECK(a.remedies[i].alarm == b.remedies[i].alarm);
    CHECK(a.remedies[i].count == b.remedies[i].count);
  }
}

void same(const Characterization& a, const Characterization& b) {
  const ChannelResult &x = a.channels.at(0), &y = b.channels.at(0);
  CHECK(x.findings == y.findings);
  CHECK(x.quality.difference_kurtosis == y.quality.difference_kurtosis);
  CHECK(x.quality.mean == y.quality.mean);
  CHECK(x.spectrum.value == y.spectrum.value);
  REQUIRE(x.allan.points.size() == y.allan.points.size());
  for (std::size_t i = 0; i < x.allan.points.size(); ++i)
    CHECK(x.allan.points[i].deviation == y.allan.points[i].deviation);
  REQUIRE(x.fit.has_value() == y.fit.has_value());
  if (x.fit) same(*x.fit, *y.fit);
}

Characterization in_stretches(const std::string& path, const CharacterizeOptions& options, std::uint64_t stretches) {
  const std::uint64_t leaves = leaves_of(read_log_head(path, options.reading).rows);
  std::vector<NamedState> states;
  for (std::uint64_t s = 0; s < stretches; ++s) {
    const StretchRange range{s * leaves / stretches, (s + 1) * leaves / stretches};
    if (range.first_leaf == range.end_leaf) continue;
    characterize_stretch(path, options, range, "x", [&](const std::string& bytes) {
      states.push_back(state_in_memory(std::to_string(s), bytes));
    });
  }
  return characterize_from_stretches(states, options);
}

void one_answer(const Rows& rows, CharacterizeOptions options = {}) {
  const Log log(rows);
  const Characterization answer = characterize(log.path(), options);
  REQUIRE(answer.channels.at(0).fit);
  Recording recording;
  recording.info = answer.log;
  recording.samples = {rows};
  same(characterize(recording, options), answer);
  for (const std::uint64_t memory : {std::uint64_t{1}, std::uint64_t{8} << 20U}) {
    options.memory_bytes = memory;
    same(characterize(log.path(), options), answer);
  }
  for (const int threads : {1, 2}) {
    options.reading.threads = threads;
    options.reading.block_bytes = threads == 1 ? 70000 : std::size_t{1} << 20U;
    same(characterize(log.path(), options), answer);
  }
  CharacterizeOptions fit_alone = options;
  fit_alone.wanted = {false, true, false, true};
  same(*characterize(log.path(), fit_alone).channels[0].fit, *answer.channels[0].fit);
  for (const std::uint64_t stretches : {1U, 2U, 3U}) same(in_stretches(log.path(), options, stretches), answer);
}

}  // namespace

TEST_CASE("one log has one answer, whoever has its samples and however many at a time") {
  for (const std::size_t size : {std::size_t{10'000}, std::size_t{kLeafSamples}, std::size_t{kLeafSamples + 1},
                                 std::size_t{2 * kLeafSamples + 54321}}) {
    CAPTURE(size);
    one_answer(noise(size));
    one_answer(noise(size, all));
    CharacterizeOptions clock;
    clock.data = SampleKind::phase;
    one_answer(noise(size, phase), clock);
  }
}

TEST_CASE("of a log of several leaves events, motion, spikes and changes are found as of a short one") {
  const std::size_t size = 2 * kLeafSamples + 54321;
  const auto fit_of = [&](const std::function<void(Rows&)>& spoil) {
    const Log log(noise(size, spoil));
    return characterize(log.path()).channels.at(0);
  };
  const ChannelResult clean = fit_of([](Rows&) {});
  REQUIRE(clean.fit);
  CHECK(clean.motion.tested);
  CHECK(clean.fit->stationarity.tested);
  CHECK(clean.fit->stationarity.steady);
  CHECK(clean.fit->events.empty());
  CHECK(clean.findings.empty());
  const Coefficient white = (*clean.fit)[Term::white], walk = (*clean.fit)[Term::walk];
  REQUIRE(white.value);
  REQUIRE(walk.value);
  CHECK(*white.value == Approx(0.05 / 10).epsilon(0.01));
  CHECK(*walk.value == Approx(2e-4 * 10).epsilon(0.2));

  const ChannelResult stepped = fit_of(step);
  REQUIRE(stepped.fit->events.size() == 1);
  CHECK(stepped.fit->events[0].kind == EventKind::step);
  CHECK(stepped.fit->events[0].size == Approx(0.4).margin(0.1));
  for (const Term term : {Term::white, Term::walk}) {
    const Coefficient &with = (*stepped.fit)[term], &without = (*clean.fit)[term];
    REQUIRE(with.value);
    CHECK(std::abs(*with.value / *without.value - 1) < 2 * without.relative_sd);
  }
  REQUIRE(stepped.fit->second_opinion);
  CHECK(stepped.fit->second_opinion->agrees);
  CHECK(stepped.fit->stationarity.steady);

  const ChannelResult moved = fit_of([](Rows& y) {
    for (std::size_t i = y.size() / 4; i < y.size() / 4 + y.size() / 20; ++i)
      y[i] += std::sin(0.05 * static_cast<double>(i));
  });
  REQUIRE(moved.motion.moving_s.size() == 1);
  CHECK(moved.motion.moving_s[0].low == Approx(static_cast<double>(size) / 400).epsilon(0.05));

  const ChannelResult louder = fit_of([](Rows& y) {
    for (std::size_t i = y.size() / 2; i < y.size(); ++i) y[i] *= 1.3;
  });
  CHECK(louder.fit->stationarity.tested);
  CHECK_FALSE(louder.fit->stationarity.steady);

  const ChannelResult held = fit_of([](Rows& y) {
    for (std::size_t i = 0; i < y.size(); ++i) y[i] = y[i - i % 3];
  });
  REQUIRE(held.digital.held);
  CHECK(held.digital.held->times == Approx(3).epsilon(0.001));

  const ChannelResult clipped = fit_of([](Rows& y) {
    for (double& x : y) x = std::min(x, 0.1);
  });
  REQUIRE(clipped.digital.rails.size() == 1);
  CHECK(clipped.digital.rails[0].high);
}
