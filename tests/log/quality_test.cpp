#include "libchar/log/quality.hpp"

#include <malloc.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <numbers>
#include <random>
#include <span>
#include <vector>

#include "libchar/core/error.hpp"
#include "libchar/core/file/sha256.hpp"
#include "libchar/core/numeric/moments.hpp"
#include "libchar/core/numeric/state_archive.hpp"

using namespace libchar;

namespace {

ChannelQuality meter(const std::vector<double>& x) {
  QualityMeter m;
  m.push(x);
  return m.finish();
}

std::vector<double> gaussian(std::size_t n, double sd, double mean = 0) {
  std::mt19937_64 random(11);
  std::normal_distribution<double> noise(mean, sd);
  std::vector<double> x(n);
  for (double& v : x) v = noise(random);
  return x;
}

bool suggests(const ChannelQuality& q, const char* what) {
  for (const Finding& s : q.findings)
    if (s.sentence.find(what) != std::string::npos) return true;
  return false;
}

}  // namespace

TEST_CASE("the least step of values on a grid is found in spite of rounding") {
  for (const double lsb : {0.05, 0.00333, 1.0, 1 / 16.4, 0.0625, 9.80665 / 2048, 3e-6})
    for (const double offset : {0.0, 9.81, -1000 * lsb}) {
      auto x = gaussian(20000, 4 * lsb, offset);
      for (double& v : x) v = std::round(v / lsb) * lsb;
      INFO(lsb << " at " << offset);
      const ChannelQuality q = meter(x);
      REQUIRE(q.resolution);
      CHECK(*q.resolution == Approx(lsb).epsilon(1e-6));
      for (double& v : x) v = static_cast<double>(static_cast<float>(v));
      const ChannelQuality f = meter(x);
      CHECK(f.float32);
      if (lsb > 20 * f.float32_step) {
        REQUIRE(f.resolution);
        CHECK(*f.resolution == Approx(lsb).epsilon(1e-3));
      }
    }
}

TEST_CASE("values with no common step have no resolution") {
  CHECK_FALSE(meter(gaussian(20000, 1)).resolution);
  CHECK_FALSE(meter(gaussian(100, 1)).resolution);
  CHECK(meter(gaussian(20000, 1)).distinct_values == 4096);
  CHECK_FALSE(meter(gaussian(20000, 1)).float32);
}

TEST_CASE("mean and spread agree with the moments of the core, whatever the offset") {
  for (const double offset : {0.0, 9.81, 1e9}) {
    const auto x = gaussian(100000, 1e-3, offset);
    const ChannelQuality q = meter(x);
    Moments m;
    m.push(x);
    CHECK(q.mean == Approx(m.mean()).epsilon(1e-15).margin(1e-15));
    CHECK(q.standard_deviation == Approx(m.standard_deviation()).epsilon(1e-12));
    CHECK(q.minimum == m.minimum());
    CHECK(q.maximum == m.maximum());
  }
}

TEST_CASE("the kurtosis of the differences is that of their definition, with a drift as well") {
  std::mt19937_64 random(5);
  std::exponential_distribution<double> skewed(1);
  for (const double drift : {0.0, 3.0}) {
    std::vector<double> x = {100};
    for (int i = 0; i < 5000; ++i) x.push_back(x.back() + drift + skewed(random));
    long double mean = 0, second = 0, fourth = 0;
    const auto n = static_cast<long double>(x.size() - 1);
    for (std::size_t i = 1; i < x.size(); ++i) mean += (x[i] - x[i - 1]) / n;
    for (std::size_t i = 1; i < x.size(); ++i) {
      const long double d = x[i] - x[i - 1] - mean;
      second += d * d / n;
      fourth += d * d * d * d / n;
    }
    CHECK(meter(x).difference_kurtosis == Approx(static_cast<double>(fourth / (second * second))).epsilon(1e-9));
  }
}

TEST_CASE("a counter is said to be one from 63 steps on, and not behind a block of noise") {
  const auto rising = [](std::size_t n) {
    std::vector<double> x(n);
    for (std::size_t i = 0; i < n; ++i) x[i] = 5 * static_cast<double>(i);
    return x;
  };
  CHECK_FALSE(suggests(meter(rising(63)), "counter"));
  CHECK(suggests(meter(rising(64)), "rises by 5 with every sample"));
  auto noisy = gaussian(3000, 1);
  const auto ramp = rising(20000);
  noisy.insert(noisy.end(), ramp.begin(), ramp.end());
  CHECK_FALSE(suggests(meter(noisy), "counter"));
}

TEST_CASE("short runs of one value are frozen stretches where values do not repeat otherwise") {
  std::vector<double> x = gaussian(50000, 1);
  for (double& v : x) v = std::round(v * 1000) / 1000;
  CHECK_FALSE(has(meter(x).findings, "stuck"));
  std::vector<double> frozen = x;
  for (std::size_t i = 500; i < frozen.size(); i += 500)
    std::fill_n(frozen.begin() + static_cast<std::ptrdiff_t>(i), 20, frozen[i]);
  const ChannelQuality q = meter(frozen);
  CHECK(q.signs.frozen_runs == 99);
  CHECK(q.signs.frozen >= 99 * 19);
  REQUIRE(has(q.findings, "stuck"));
  CHECK(worst_of(q.findings) == Severity::bad);
  std::vector<double> at_top = frozen;  // one that hangs at an extreme is not saturated
  std::fill_n(at_top.begin() + 1000, 20, 6.0);
  CHECK(has(meter(at_top).findings, "stuck"));
  CHECK(meter(at_top).saturated == 0);
  std::vector<double> cut = x;  // and one that is cut and hangs once is
  for (double& v : cut) v = std::min(v, 1.2);
  std::fill_n(cut.begin() + 1000, 20, cut[1000]);
  CHECK(meter(cut).saturated > 100);
  QualityMeter first, second;  // joined inside a run
  first.push(std::span(frozen).first(1007));
  second.push(std::span(frozen).subspan(1007));
  first.join(second);
  CHECK(first.finish().signs.frozen == q.signs.frozen);
  CHECK(first.finish().signs.frozen_runs == q.signs.frozen_runs);
  std::vector<double> moves(50000);  // a robot that stops here and there
  for (std::size_t i = 0; i < moves.size(); ++i)
    moves[i] = std::round(1e6 * std::sin(1e-3 * static_cast<double>(i - std::min<std::size_t>(i % 2000, 15)))) / 1e6;
  REQUIRE(meter(moves).longest_stuck >= 15);
  CHECK_FALSE(has(meter(moves).findings, "stuck"));
  std::vector<double> coarse = gaussian(50000, 1);
  double slow = 0;
  for (double& v : coarse) v = std::round(slow += 0.05 * v);  // a slow quantity between the steps of its converter
  CHECK_FALSE(has(meter(coarse).findings, "stuck"));
}

TEST_CASE("zeros among values that hardly repeat are marks, or a dead band, and those of a coarse sensor are values") {
  const std::vector<double> x = gaussian(50000, 1);
  CHECK(meter(x).findings.empty());
  std::vector<double> filled = x, dead = x, coarse = x, moving = x;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (i * 7919 % 1000 < 20) filled[i] = 0;
    if (std::fabs(dead[i]) < 0.2) dead[i] = 0;
    coarse[i] = std::round(x[i] / 0.05) * 0.05;
    moving[i] = i % 5000 < 500 ? 0 : std::sin(0.01 * static_cast<double>(i)) + 1e-3 * x[i];
  }
  const ChannelQuality q = meter(filled);
  CHECK(q.signs.zeros == 1000);
  REQUIRE(has(q.findings, "missing_mark"));
  CHECK(q.findings[0].help.at(0).options.at(0).value == "0");
  CHECK(has(meter(dead).findings, "dead_band"));
  CHECK_FALSE(has(meter(dead).findings, "missing_mark"));
  CHECK_FALSE(has(meter(coarse).findings, "missing_mark"));
  CHECK_FALSE(has(meter(coarse).findings, "dead_band"));
  CHECK_FALSE(has(meter(moving).findings, "missing_mark"));
  for (std::size_t i = 0; i < x.size(); ++i)  // rest about zero in coarse steps, between motions
    moving[i] = std::round((i / 5000 % 2 == 0 ? 0.05 : 5) * x[i] * 100) / 100;
  CHECK_FALSE(has(meter(moving).findings, "missing_mark"));
  for (std::size_t i = 0; i < x.size(); ++i) moving[i] = i < 20000 ? 0 : 3 + 0.1 * x[i];  // a wheel
  CHECK_FALSE(has(meter(moving).findings, "missing_mark"));
  CHECK(meter(moving).saturated == 0);
}

TEST_CASE("all bits of a word are a mark, as a bus in error gives them") {
  for (const double mark : {8388607.0, 65535.0, 32767.0}) {
    std::vector<double> x = gaussian(20000, 1);
    for (double& value : x) value = std::round(0.3 * mark + 20 * value);
    for (std::size_t i = 100; i < x.size(); i += 500) x[i] = mark;
    for (std::size_t i = 300; i < x.size(); i += 1000) x[i] = 0;  // so that the range of the others is wide
    CHECK(has(meter(x).findings, "missing_mark"));
    for (double& value : x)
      if (value == mark) value -= 7;  // no word's end
    CHECK_FALSE(meter(x).signs.marks == std::vector{mark - 7});
  }
}

TEST_CASE("two marks side by side are marks, and no jumps of a phase") {
  std::vector<double> x = gaussian(20000, 1);
  for (std::size_t i = 100; i < x.size(); i += 250) x[i] = i % 500 == 100 ? -99 : -98;
  const ChannelQuality q = meter(x);
  REQUIRE(has(q.findings, "missing_mark"));
  CHECK(q.signs.marks == std::vector<double>{-99, -98});
  CHECK(q.signs.marked == 80);
  CHECK(q.signs.wraps == 0);
}

TEST_CASE("a heading about north wraps with many samples, two levels do not") {
  std::vector<double> x = gaussian(20000, 3), levels = x;
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i] = std::fmod(360.2 + 0.4 * x[i], 360.0);
    levels[i] = (i / 3 % 2 == 0 ? 0 : 90) + 0.1 * levels[i];
  }
  const ChannelQuality q = meter(x);
  CHECK(q.signs.wraps > 4000);
  CHECK(q.signs.period == 360);
  CHECK(meter(levels).signs.wraps == 0);
}

TEST_CASE("a switch jumps by its whole range and wraps nothing, with noise and without") {
  const std::vector<double> noise = gaussian(20000, 8);
  for (const double sd : {0.0, 0.01}) {
    std::vector<double> x(noise.size());
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = (i / 97 % 2 == 0 ? 0 : 1) + sd * noise[i];
    const ChannelQuality q = meter(x);
    CHECK(q.signs.wraps == 0);
    CHECK_FALSE(has(q.findings, "phase_wraps"));
  }
}

TEST_CASE("the period of a phase that wraps is a turn or a power of two where it can be") {
  for (const double period : {2 * std::numbers::pi, 4096.0}) {
    std::vector<double> phase = gaussian(20000, 0.002 * period);
    for (std::size_t i = 0; i < phase.size(); ++i)
      phase[i] = std::fmod(0.013 * period * static_cast<double>(i) + phase[i] + period, period);
    CHECK(meter(phase).signs.period == period);
  }
}

TEST_CASE("saturation, stuck runs, spikes, coarse quantization") {
  auto x = gaussian(50000, 1);
  CHECK(meter(x).saturated == 0);
  CHECK(meter(x).longest_stuck == 1);
  CHECK(meter(x).difference_kurtosis == Approx(3).margin(0.15));
  auto clipped = x;
  for (std::size_t i = 1000; i < 1100; ++i) clipped[i] = 8;
  for (std::size_t i = 7000; i < 7005; ++i) clipped[i] = -8;
  clipped[9000] = 8;  // alone, and at the end of the range all the same
  CHECK(meter(clipped).saturated == 100 + 5 + 1);
  CHECK(meter(clipped).longest_stuck == 100);
  CHECK(suggests(meter(clipped), "saturated"));
  auto spiky = x;
  for (std::size_t i = 0; i < spiky.size(); i += 500) spiky[i] += 40;
  CHECK(meter(spiky).difference_kurtosis > 20);
  CHECK(suggests(meter(spiky), "spikes"));
  std::vector<double> two(100);
  for (std::size_t i = 0; i < two.size(); ++i) two[i] = i % 14 < 7 ? 0 : 0.0625;
  CHECK(meter(two).distinct_values == 2);
  CHECK(suggests(meter(two), "quantization-limited"));
  CHECK(suggests(meter(std::vector<double>(100, 3.0)), "constant"));
  std::vector<double> ramp(1000);
  for (std::size_t i = 0; i < ramp.size(); ++i) ramp[i] = static_cast<double>(i);
  CHECK(meter(ramp).difference_kurtosis == 3);
  CHECK(*meter(ramp).resolution == 1);
}

TEST_CASE("every clipped sample is counted, and coarse rounding is no end of a range") {
  auto clipped = gaussian(50000, 1);
  std::uint64_t beyond = 0;
  for (double& value : clipped) {
    beyond += std::abs(value) > 1 ? 1 : 0;
    value = std::clamp(value, -1.0, 1.0);
  }
  CHECK(meter(clipped).saturated == beyond);
  for (const double step : {0.5, 1.0, 1.5}) {
    auto coarse = gaussian(50000, 1);
    for (double& value : coarse) value = std::round(value / step) * step;
    INFO("step " << step);
    CHECK(meter(coarse).saturated == 0);
  }
}

TEST_CASE("a signal without noise that rests at its extreme is not saturated") {
  // A component of an encoder's quaternion, written to ten digits: it rests, creeps on by its last digit, and moves.
  std::vector<double> w;
  for (int turn = 0; turn < 20; ++turn) {
    for (int i = 0; i < 12; ++i) w.push_back(turn % 2 == 0 ? 1.22e-5 : 1);
    for (int i = 0; i < 5; ++i) w.push_back(turn % 2 == 0 ? 1.22e-5 + 1.25e-11 * (i + 1) : 1 - 1e-10 * (i + 1));
    for (int i = 1; i < 100; ++i)
      w.push_back(0.5 - (turn % 2 == 0 ? 0.5 : -0.5) * std::cos(std::numbers::pi * i / 100));
  }
  CHECK(meter(w).saturated == 0);
  std::erase_if(w, [](double value) { return std::abs(value - 0.5) > 0.48; });
  for (double& value : w) value = std::clamp(value, 0.1, 0.9);
  CHECK(meter(w).saturated > 0);
}

TEST_CASE("the peak of a slow signal in coarse steps is no end of a range") {
  // Of a parabola the last step holds up to 2.4 times as many samples as the one below it.
  std::vector<double> slow(5000);
  for (std::size_t i = 0; i < slow.size(); ++i)
    slow[i] = std::floor(2000 + 1500 * std::sin(2 * std::numbers::pi * static_cast<double>(i) / 4900)) / 100;
  CHECK(meter(slow).saturated == 0);
  for (double& value : slow) value = std::min(value, 34.0);
  CHECK(meter(slow).saturated > 0);
}

TEST_CASE("only the end of the range that clips is named") {
  const auto said = [](double low, double high) {
    auto clipped = gaussian(50000, 1);
    for (double& value : clipped) value = std::clamp(value, low, high);
    const ChannelQuality q = meter(clipped);
    REQUIRE(has(q.findings, "much_saturated"));
    return q.findings.at(0).sentence;
  };
  CHECK_THAT(said(-9, 1.5), Catch::Contains("at the end of the range (1.5): saturated"));
  CHECK_THAT(said(-1.5, 9), Catch::Contains("at the end of the range (-1.5): saturated"));
  CHECK_THAT(said(-1.5, 1.5), Catch::Contains("at the end of the range (-1.5 or 1.5): saturated"));
}

TEST_CASE("missing samples are counted, break runs and leave the differences out") {
  std::vector<double> x = {5, 5, kMissing, 5, 5, 5, 1, kMissing, 2};
  const ChannelQuality q = meter(x);
  CHECK(q.samples == 7);
  CHECK(q.missing == 2);
  CHECK(q.longest_stuck == 3);
  CHECK(q.mean == Approx(4));
  const ChannelQuality none = meter({kMissing, kMissing});
  CHECK(none.samples == 0);
  CHECK(none.missing == 2);
  CHECK(meter({}).samples == 0);
  CHECK(meter({4}).standard_deviation == 0);
}

TEST_CASE("what rests between its movements, or between coarse steps, has not hung, what jumps behind a rest has") {
  std::mt19937_64 random(5);
  std::vector<double> goes, warms;  // stop and go; a thermometer of 0.0625 degrees, 5 degrees in a day
  for (double x = 0; goes.size() < 40000;) {
    const std::size_t moves = 300 + random() % 900, rests = 150 + random() % 600;
    for (std::size_t i = 0; i < moves; ++i)
      goes.push_back(x += 0.005 * (1 - std::cos(2 * M_PI * static_cast<double>(i) / static_cast<double>(moves))));
    goes.insert(goes.end(), rests, x);
  }
  for (int i = 0; i < 86400; ++i) warms.push_back(std::round(40 * std::sin(2 * M_PI * i / 86400.0)) * 0.0625);
  CHECK(meter(goes).longest_stuck > 150);
  CHECK(meter(warms).longest_stuck > 3000);
  for (const auto* clean : {&goes, &warms}) {
    CHECK_FALSE(has(meter(*clean).findings, "stuck"));
    for (const std::size_t from : {10000U, 35500U}) {
      std::vector<double> hung = *clean;
      const std::size_t to = std::min(from + 9000, hung.size());  // the other one until the end
      std::fill(hung.begin() + static_cast<std::ptrdiff_t>(from), hung.begin() + static_cast<std::ptrdiff_t>(to),
                hung[from]);
      INFO((clean == &goes ? "goes" : "warms") << " from " << from);
      CHECK(has(meter(hung).findings, "stuck"));
    }
  }
}

TEST_CASE("how long runs are left does not depend on how the parts are cut") {
  std::mt19937_64 random(11);
  std::vector<double> x;
  for (double value = 0; x.size() < 6000; value += static_cast<double>(random() % 5)) {
    x.insert(x.end(), random() % 4 == 0 ? 90 + random() % 300 : 1 + random() % 3, value);
    if (random() % 9 == 0) x.push_back(kMissing);
  }
  const ChannelQuality whole = meter(x);
  CHECK(whole.signs.longest.jump > 100);
  for (int round = 0; round < 60; ++round) {
    QualityMeter joined;
    for (std::size_t at = 0; at < x.size();) {
      const std::size_t n = std::min<std::size_t>(1 + random() % 400, x.size() - at);
      QualityMeter part;
      part.push({x.data() + at, n});
      joined.join(part);
      at += n;
    }
    const ChannelQuality q = joined.finish();
    REQUIRE(q.signs.longest.rest == whole.signs.longest.rest);
    REQUIRE(q.signs.longest.jump == whole.signs.longest.jump);
  }
}

TEST_CASE("the result does not depend on how the samples are pushed") {
  auto x = gaussian(30000, 2);
  for (std::size_t i = 0; i < x.size(); i += 97) x[i] = kMissing;
  for (std::size_t i = 500; i < 540; ++i) x[i] = 9;
  const ChannelQuality whole = meter(x);
  for (const std::size_t step : {std::size_t{1}, std::size_t{3}, std::size_t{4095}, std::size_t{4097}}) {
    QualityMeter m;
    for (std::size_t i = 0; i < x.size(); i += step) m.push({x.data() + i, std::min(step, x.size() - i)});
    const ChannelQuality q = m.finish();
    CHECK(q.mean == whole.mean);
    CHECK(q.standard_deviation == whole.standard_deviation);
    CHECK(q.difference_kurtosis == whole.difference_kurtosis);
    CHECK(q.saturated == whole.saturated);
    CHECK(q.longest_stuck == whole.longest_stuck);
    CHECK(q.at_minimum == whole.at_minimum);
    CHECK(q.at_maximum == whole.at_maximum);
    CHECK(q.repeats == whole.repeats);
    CHECK(q.findings == whole.findings);
  }
}

TEST_CASE("clocks, counters and sawteeth are named, noise and slow signals are not") {
  const std::size_t n = 10000;
  const auto counter_of = [&](auto&& value) {
    std::vector<double> y(n);
    for (std::size_t t = 0; t < n; ++t) y[t] = value(static_cast<double>(t));
    return meter(y).signs.counter;
  };
  std::mt19937_64 random(4);
  std::normal_distribution<double> noise;
  CHECK(counter_of([](double t) { return t; }) ==
        "rises by 1 with every sample: a counter or a clock, not a measurement");
  CHECK(counter_of([](double t) { return 1.7e9 - 0.01 * t; }).find("falls by 0.01") == 0);
  CHECK(counter_of([](double t) { return std::fmod(t, 256); }).find("rises by 1 with nearly") == 0);
  CHECK(counter_of([&](double t) { return t + std::floor(t / 300) * 5; }).find("nearly") != std::string::npos);
  CHECK(counter_of([&](double t) { return 1e6 * (t + 0.05 * noise(random)); }).find("never falls") == 0);
  CHECK(counter_of([&](double t) { return std::fmod(t + 0.02 * noise(random), 100); }).find("falls back") !=
        std::string::npos);
  double walk = 0;
  CHECK(counter_of([&](double) { return noise(random); }).empty());
  CHECK(counter_of([&](double) { return walk += noise(random); }).empty());
  CHECK(counter_of([&](double t) { return 0.1 * t + noise(random); }).empty());
  CHECK(counter_of([&](double t) { return std::round(26 + 1e-3 * t + 0.1 * noise(random)); }).empty());
  CHECK(counter_of([](double t) { return std::sin(0.01 * t); }).empty());
  CHECK(counter_of([](double) { return 3.0; }).empty());
  CHECK(counter_of([](double t) { return t < 5000 ? 0.0 : 1.0; }).empty());
}

TEST_CASE("a quality meter of a few samples takes little memory") {
  if (::mallinfo2().uordblks == 0) return;  // a heap that is not glibc's (sanitizers)
  constexpr std::size_t kMeters = 1000;
  const std::size_t before = ::mallinfo2().uordblks;
  std::vector<QualityMeter> meters(kMeters);
  for (QualityMeter& meter : meters) meter.push(std::vector<double>{1, 2.5, 4});
  const std::size_t each = (::mallinfo2().uordblks - before) / kMeters;
  CHECK(each <= 2048);
  CHECK(meters.front().finish().distinct_values == 3);
}

TEST_CASE("quality does not depend on the sizes of blocks, from one sample to thousands") {
  std::vector<double> x = gaussian(20000, 1);
  for (std::size_t i = 0; i < x.size(); i += 777) x[i] = std::nan("");
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = std::round(x[i] * 500) / 500;
  const ChannelQuality whole = meter(x);
  for (const std::size_t block : {1U, 7U, 300U, 2048U, 5000U}) {
    QualityMeter m;
    for (std::size_t i = 0; i < x.size(); i += block) m.push(std::span(x).subspan(i, std::min(block, x.size() - i)));
    const ChannelQuality parts = m.finish();
    CHECK(parts.mean == whole.mean);
    CHECK(parts.standard_deviation == whole.standard_deviation);
    CHECK(parts.distinct_values == whole.distinct_values);
    CHECK(parts.resolution == whole.resolution);
    CHECK(parts.missing == whole.missing);
    CHECK(parts.difference_kurtosis == whole.difference_kurtosis);
  }
}

namespace {

/// Channels that a meter has something to say of, as noise, coarse steps, clipped, stuck, counting, missing.
std::vector<std::vector<double>> odd_channels(std::size_t n) {
  std::mt19937_64 engine(n);
  std::normal_distribution<double> normal;
  std::vector<std::vector<double>> out(9, std::vector<double>(n));
  for (std::size_t i = 0; i < n; ++i) {
    const double x = normal(engine);
    out[0][i] = 1e6 + x;
    out[1][i] = std::round(2 * x) / 4;
    out[2][i] = std::clamp(1.3 * x, -1.5, 1.5);
    out[3][i] = i % 500 < 150 ? 0.25 : x;
    out[4][i] = static_cast<double>(i) * 0.125;
    out[5][i] = engine() % 3 == 0 ? std::nan("") : static_cast<double>(static_cast<float>(x));
    out[6][i] = 7;
    out[7][i] = i < n / 2 ? std::nan("") : i % 7 == 0 ? 1e200 : std::round(x);
    out[8][i] = static_cast<double>(i % 100);
  }
  return out;
}

}  // namespace

TEST_CASE("quality: a state whose number of samples is no count is refused") {
  for (const double n : {-1.0, 1e300, std::nan("")}) {
    QualityMeter meter;
    StateWriter to("quality", 1);
    meter.write_state(to);
    std::string bytes = to.finish();
    const std::size_t at = 8 + 4 + 8 + 8 + std::string("quality").size() + 8 + 8;
    std::memcpy(&bytes[at], &n, sizeof n);
    bytes.resize(bytes.size() - 64);
    Sha256 digest;
    digest.update(bytes);
    bytes += digest.finish();
    StateReader from(bytes, "x", "quality", 1);
    QualityMeter again;
    REQUIRE_THROWS_AS(again.read_state(from), Error);
  }
}

TEST_CASE("quality: parts joined are the record, wherever it is cut") {
  std::mt19937_64 engine(4);
  for (const std::size_t n : {3u, 64u, 3000u, 20011u})
    for (const std::vector<double>& x : odd_channels(n))
      for (int cuts = 0; cuts < 6; ++cuts) {
        QualityMeter whole, joined;
        whole.push(x);
        for (std::size_t at = 0; at < n;) {
          const std::size_t count = std::min<std::size_t>(n - at, 1 + engine() % (n < 100 ? 4 : n));
          QualityMeter part;
          part.push({x.data() + at, count});
          StateWriter to("quality", 1);
          part.write_state(to);
          const std::string bytes = to.finish();
          StateReader from(bytes, "x", "quality", 1);
          QualityMeter again;
          again.read_state(from);
          from.finish();
          joined.join(again);
          at += count;
        }
        const ChannelQuality a = whole.finish(), b = joined.finish();
        REQUIRE(b.samples == a.samples);
        REQUIRE(b.missing == a.missing);
        REQUIRE(b.beyond == a.beyond);
        REQUIRE(b.mean == Approx(a.mean).epsilon(1e-13).margin(1e-15));
        REQUIRE(b.standard_deviation == Approx(a.standard_deviation).epsilon(1e-12));
        REQUIRE(b.minimum == a.minimum);
        REQUIRE(b.maximum == a.maximum);
        REQUIRE(b.resolution == a.resolution);
        REQUIRE(b.distinct_values == a.distinct_values);
        REQUIRE(b.saturated == a.saturated);
        REQUIRE(b.longest_stuck == a.longest_stuck);
        REQUIRE(b.signs.longest.rest == a.signs.longest.rest);
        REQUIRE(b.signs.longest.jump == a.signs.longest.jump);
        REQUIRE(b.at_minimum == a.at_minimum);
        REQUIRE(b.at_maximum == a.at_maximum);
        REQUIRE(b.repeats == a.repeats);
        REQUIRE(b.difference_kurtosis == Approx(a.difference_kurtosis).epsilon(1e-12));
        REQUIRE(b.difference_sd == Approx(a.difference_sd).epsilon(1e-12));
        REQUIRE(b.signs.counter == a.signs.counter);
        REQUIRE(b.float32 == a.float32);
      }
}

TEST_CASE("what loggers write for no reading is a mark nearer to the values than other numbers are") {
  const std::vector<double> x = gaussian(20000, 0.5, 9);
  const auto with = [&](double mark, std::size_t every) {
    std::vector<double> y = x;
    for (std::size_t i = 500; i < y.size(); i += every) y[i] = mark;
    return meter(y).signs.marks;
  };
  CHECK(with(-1, 50) == std::vector<double>{-1});
  CHECK(with(-1, 5000).empty());  // too few
  CHECK(with(-1.37, 50).empty());
  CHECK(with(16, 50).empty());
}

TEST_CASE("a value that stands often and far from all others is a mark for missing values") {
  std::vector<double> x = gaussian(20000, 1);
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = std::round(x[i] * 1000) / 1000 + 15;
  CHECK(meter(x).signs.marks.empty());
  std::vector<double> marked = x;
  for (std::size_t i = 500; i < marked.size(); i += 400) marked[i] = -999;
  const ChannelQuality q = meter(marked);
  REQUIRE(q.signs.marks == std::vector<double>{-999});
  REQUIRE(has(q.findings, "missing_mark"));
  CHECK(q.findings[0].help[0].options[0] == Finding::Setting{"missing", "-999"});
  CHECK_FALSE(has(q.findings, "saturated"));
  for (std::size_t i = 700; i < marked.size(); i += 900) marked[i] = 65535;
  CHECK(meter(marked).signs.marks == std::vector<double>{-999, 65535});
  // One wild value, a step and a clipped signal are none.
  std::vector<double> wild = x;
  wild[7000] = 4000;
  CHECK(meter(wild).signs.marks.empty());
  std::vector<double> clipped = x;
  for (double& v : clipped) v = std::min(v, 15.5);
  CHECK(meter(clipped).signs.marks.empty());
  CHECK(meter(clipped).findings.at(0).help.empty());
  // Nearer than that it is one or the other, and the same remedy serves both.
  std::vector<double> near = gaussian(20000, 1);
  for (std::size_t i = 500; i < near.size(); i += 800)
    std::fill_n(near.begin() + static_cast<std::ptrdiff_t>(i), 5, -10.0);
  const ChannelQuality either = meter(near);
  REQUIRE(has(either.findings, "saturated"));
  REQUIRE(either.findings.at(0).help.size() == 1);
  CHECK(either.findings[0].help[0].options[0] == Finding::Setting{"missing", "-10"});
  for (std::size_t i = 700; i < near.size(); i += 800)
    std::fill_n(near.begin() + static_cast<std::ptrdiff_t>(i), 5, 8.0);  // half of the range away, and both are meant
  CHECK(meter(near).findings.at(0).help.at(0).options[0] == Finding::Setting{"missing", "-10,8"});
}

TEST_CASE("a sawtooth wraps, with the period of its jumps, and noise does not") {
  CHECK(meter(gaussian(20000, 1)).signs.wraps == 0);
  std::vector<double> phase = gaussian(20000, 1);
  double turns = 0;
  for (std::size_t i = 0; i < phase.size(); ++i) {
    const double at = 0.3e-9 * static_cast<double>(i) + 2e-10 * phase[i];
    turns = std::floor(at / 1e-7);
    phase[i] = at - turns * 1e-7;
  }
  const ChannelQuality q = meter(phase);
  CHECK(q.signs.wraps >= 59);
  CHECK(q.signs.period == Approx(1e-7).epsilon(1e-9));
  REQUIRE(has(q.findings, "phase_wraps"));
  QualityMeter first, second;  // in two parts
  first.push(std::span(phase).first(7777));
  second.push(std::span(phase).subspan(7777));
  first.join(second);
  CHECK(first.finish().signs.wraps == q.signs.wraps);
}

TEST_CASE("a dead band is named, with its value and share, and coarse rounding and held values are none") {
  std::vector<double> x = gaussian(50000, 1);
  for (double& v : x) v = std::fabs(v) < 1.5 ? 0.0 : v;
  const ChannelQuality q = meter(x);
  REQUIRE(has(q.findings, "dead_band"));
  CHECK(q.signs.resting_value == 0);
  CHECK(static_cast<double>(q.signs.at_rest) == Approx(0.866 * 50000).epsilon(0.02));
  std::vector<double> held = gaussian(50000, 1);
  for (std::size_t i = 0; i < held.size(); ++i) held[i] = held[i - i % 10];
  CHECK_FALSE(has(meter(held).findings, "dead_band"));
  std::vector<double> frozen = gaussian(50000, 1);
  std::fill(frozen.begin() + 20000, frozen.end(), frozen[20000]);
  REQUIRE(has(meter(frozen).findings, "stuck"));
  CHECK(meter(frozen).findings[0].help.size() == 1);
  std::vector<double> slow = gaussian(50000, 0.5);  // steps of a converter, and a long rest on one of them
  for (std::size_t i = 0; i < slow.size(); ++i)
    slow[i] = std::round(10 * std::sin(static_cast<double>(i) / 8000) + slow[i]);
  std::fill(slow.begin() + 20000, slow.begin() + 20200, slow[20000]);
  REQUIRE(has(meter(slow).findings, "stuck"));
  for (const Finding& one : meter(slow).findings)
    if (one.code == "stuck") CHECK(one.help.empty());  // else --frozen would take sound samples away
  CHECK_FALSE(has(meter(frozen).findings, "dead_band"));
  std::vector<double> coarse = gaussian(50000, 1);
  for (double& v : coarse) v = std::round(v);
  CHECK_FALSE(has(meter(coarse).findings, "dead_band"));
}

TEST_CASE("samples that only repeat the one before are told from what steps repeat by chance") {
  std::mt19937_64 engine(21);
  std::normal_distribution<double> normal;
  for (const double levels : {0.5, 2.0, 20.0, 300.0, 1e5})  // per standard deviation
    for (const double share : {0.0, 0.03}) {
      std::vector<double> x(40000);
      for (double& v : x) v = std::round(levels * normal(engine)) / levels;
      for (std::size_t i = 1; i < x.size(); ++i)
        if (std::uniform_real_distribution<double>()(engine) < share) x[i] = x[i - 1];
      INFO(levels << " levels, " << share);
      const bool said = has(meter(x).findings, "repeated_samples");
      if (share == 0) CHECK_FALSE(said);
      if (share > 0 && levels > 100) CHECK(said);
    }
  std::vector<double> digits(40000);  // three of them
  for (double& v : digits) v = 10 + normal(engine), v = std::round(v * (v < 10 ? 100 : 10)) / (v < 10 ? 100 : 10);
  CHECK_FALSE(has(meter(digits).findings, "repeated_samples"));
  CHECK_FALSE(has(meter(digits).findings, "interpolated"));
  // Quiet stretches among loud ones repeat what loud ones do not.
  std::vector<double> handled(40000);
  for (std::size_t i = 0; i < handled.size(); ++i)
    handled[i] = std::round((i % 4000 < 400 ? 200 : 1.0) * normal(engine));
  CHECK_FALSE(has(meter(handled).findings, "repeated_samples"));
}

TEST_CASE("a slower channel that was interpolated by straight lines is named, whatever the ratio of the rates") {
  std::mt19937_64 engine(26);
  std::normal_distribution<double> normal;
  const auto resampled = [&](double ratio, double digits) {
    std::vector<double> slow(30000), out(30000);
    for (double& v : slow) v = normal(engine);
    for (std::size_t i = 0; i < out.size(); ++i) {
      const double at = static_cast<double>(i) / ratio, share = at - std::floor(at);
      const auto k = static_cast<std::size_t>(at);
      out[i] = std::round((slow[k] + share * (slow[k + 1] - slow[k])) * digits) / digits;
    }
    return meter(out);
  };
  for (const double ratio : {2.0, 2.5, 3.15, 3.2, 10.0 / 3, 4.0, 6.25, 10.0}) {
    INFO("ratio " << ratio);
    const ChannelQuality q = resampled(ratio, 1e6);
    REQUIRE(has(q.findings, "resampled"));
    CHECK_FALSE(has(q.findings, "interpolated"));
    CHECK(worst_of(q.findings) == Severity::caution);
  }
  // What moves smoothly, and noise between coarse steps, are full of lines of their own.
  std::vector<double> smooth(30000), coarse(30000), walk(30000);
  double one = 0;
  for (std::size_t i = 0; i < smooth.size(); ++i) {
    smooth[i] = std::sin(1e-3 * static_cast<double>(i)) + std::sin(0.37e-2 * static_cast<double>(i));
    coarse[i] = std::round(1.5 * normal(engine));
    walk[i] = one += std::round(0.6 * normal(engine));
  }
  for (const auto* x : {&smooth, &coarse, &walk}) CHECK_FALSE(has(meter(*x).findings, "resampled"));
}

TEST_CASE("zeros in bursts, far from all other values, are no rest") {
  std::mt19937_64 engine(27);
  std::normal_distribution<double> normal;
  std::vector<double> x(20000);
  for (double& v : x) v = std::round((350 + 0.25 * normal(engine)) * 4) / 4;
  for (std::size_t at = 1000; at + 100 < x.size(); at += 2500) std::fill_n(x.begin() + at, 40, 0.0);
  const ChannelQuality q = meter(x);
  REQUIRE(has(q.findings, "missing_mark"));
  CHECK(q.signs.marks == std::vector<double>{0});
  for (std::size_t i = 0; i < x.size(); ++i)
    if (i / 1000 % 3 == 0) x[i] = 0;  // a pump that is off for a third of the time
  CHECK_FALSE(has(meter(x).findings, "missing_mark"));
}

TEST_CASE("spikes of one size are no wraps, and one frozen stretch is no held value") {
  std::mt19937_64 engine(22);
  std::normal_distribution<double> normal;
  std::vector<double> spiky(50000), heading(50000);
  for (double& v : spiky) v = 1e-9 * normal(engine);
  for (int i = 0; i < 50; ++i) spiky[1 + engine() % 49998] = 2e-8;
  CHECK_FALSE(has(meter(spiky).findings, "phase_wraps"));
  for (double& v : spiky) v = -v;
  CHECK_FALSE(has(meter(spiky).findings, "phase_wraps"));
  for (double& v : heading) v = std::fmod(360.02 + 0.05 * normal(engine), 360.0);
  CHECK(has(meter(heading).findings, "phase_wraps"));
  std::vector<double> frozen = heading;
  for (double& v : frozen) v = normal(engine);
  std::fill_n(frozen.begin() + 20000, 500, 0.0);
  CHECK_FALSE(has(meter(frozen).findings, "held_values"));
  CHECK(has(meter(frozen).findings, "stuck"));
}

TEST_CASE("a concentration that goes to zero and stays there has not hung, one that drops there has") {
  std::vector<double> ozone = gaussian(40000, 0.5);
  for (std::size_t i = 0; i < ozone.size(); ++i) {
    const double level = 20 * std::sin(static_cast<double>(i) / 600) + 15;
    ozone[i] = std::max(0.0, std::round(10 * (level + 0.1 * ozone[i])) / 10);
  }
  CHECK_FALSE(has(meter(ozone).findings, "stuck"));
  for (double& v : ozone) v += 5;
  std::fill(ozone.begin() + 20000, ozone.begin() + 22000, 0.0);
  CHECK(has(meter(ozone).findings, "stuck"));
}

TEST_CASE("a slow sensor in a fast log has hung after several of its values, not after one") {
  std::vector<double> slow = gaussian(60000, 1);
  for (std::size_t i = 0; i < slow.size(); ++i) slow[i] = slow[i - i % 200];
  CHECK(has(meter(slow).findings, "held_values"));
  CHECK_FALSE(has(meter(slow).findings, "stuck"));
  std::fill(slow.begin() + 30000, slow.begin() + 33000, slow[30000]);
  CHECK(has(meter(slow).findings, "stuck"));
}
