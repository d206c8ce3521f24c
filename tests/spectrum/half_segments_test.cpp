#include "libchar/spectrum/detail/half_segments.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <random>

#include "libchar/core/error.hpp"
#include "libchar/spectrum/detail/segments.hpp"
#include "libchar/spectrum/fft.hpp"
#include "libchar/spectrum/welch_sums.hpp"

using namespace libchar;

namespace {

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

// Noise with everything that a transform of halves might stumble over: an offset, a drift (so that
// the means of the halves differ), a random walk, a sine between two bins.
std::vector<double> noise(std::size_t n, double offset, double drift) {
  std::mt19937_64 generator(11);
  std::normal_distribution<double> normal;
  std::vector<double> x(n);
  double walk = 0;
  for (std::size_t t = 0; t < n; ++t) {
    const double at = static_cast<double>(t);
    walk += 0.01 * normal(generator);
    x[t] = normal(generator) + walk + offset + drift * at / static_cast<double>(n) + std::sin(0.7391 * at);
  }
  return x;
}

WelchOptions segments_of(std::uint64_t n) {
  WelchOptions options;
  options.segment = n;
  return options;
}

double largest(const std::vector<double>& values) {
  double most = 0;
  for (const double v : values) most = std::max(most, v);
  return most;
}

// Amplitudes, against the largest of them: rounding of a transform is relative to its energy.
void same_power(const std::vector<double>& got, const std::vector<double>& wanted, double tolerance) {
  REQUIRE(got.size() == wanted.size());
  const double scale = std::sqrt(largest(wanted));
  double worst = 0;
  for (std::size_t k = 0; k < got.size(); ++k)
    worst = std::max(worst, std::abs(std::sqrt(got[k]) - std::sqrt(wanted[k])) / scale);
  CHECK(worst < tolerance);
}

std::vector<double> power_by_segments(const std::vector<double>& x, std::size_t n) {
  const auto options = segments_of(n);
  const auto window = window_values(Window::hann, n);
  welch_detail::Periodogram periodogram(options, window);
  std::vector<double> power(n / 2 + 1, 0.0);
  for (std::size_t t = 0; t + n <= x.size(); t += n / 2) periodogram.add(x.data() + t, power.data());
  return power;
}

// The halves at x, x + h, …, two by two, into one sum; which segments were used, in order.
std::vector<bool> push_all(HalfSegments& halves, const std::vector<double>& x, HalfSegments::Sums& sums,
                           bool block = false) {
  const std::size_t h = halves.half(), count = x.size() / h;
  std::vector<bool> used;
  for (std::size_t i = 0; i < count; i += 2) {
    const auto a = halves.half_at(x.data() + i * h, block);
    const auto b = i + 1 < count ? halves.half_at(x.data() + (i + 1) * h, block) : HalfSegments::Half();
    const auto [first, second] = halves.push(a, b, &sums, &sums);
    if (i > 0) used.push_back(first);
    if (i + 1 < count) used.push_back(second);
  }
  return used;
}

// Remembers what it was given, and takes every second block that is offered.
struct Taker final : BlockTaker {
  std::vector<double> given;
  std::vector<std::vector<double>> taken;
  std::size_t offered = 0;
  std::optional<std::vector<double>> power;
  bool take_block(std::span<const double> samples) override {
    if (offered++ % 2 == 1) return false;
    given.insert(given.end(), samples.begin(), samples.end());
    taken.emplace_back(samples.begin(), samples.end());
    return true;
  }
  void push(std::span<const double> samples) override { given.insert(given.end(), samples.begin(), samples.end()); }
  void take_power(std::vector<double> sums) override { power = std::move(sums); }
};

std::size_t whole_blocks(const std::vector<double>& x, std::size_t length) {
  std::size_t count = 0;
  for (auto at = x.begin(); x.end() - at >= static_cast<std::ptrdiff_t>(length);
       at += static_cast<std::ptrdiff_t>(length))
    count += std::none_of(at, at + static_cast<std::ptrdiff_t>(length), [](double v) { return std::isnan(v); });
  return count;
}

// Bit for bit, but a missing sample is a missing sample.
bool same_samples(const std::vector<double>& a, const std::vector<double>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](double one, double other) { return one == other || (std::isnan(one) && std::isnan(other)); });
}

}  // namespace

TEST_CASE("halves: the powers of whole segments, for lengths that split in every way") {
  for (const std::size_t n : {4096U, 4800U, 7680U, 8000U, 10000U, 20160U, 65536U}) {
    REQUIRE(HalfSegments::suits(segments_of(n)));
    for (const auto& [offset, drift] : {std::pair{0.0, 0.0}, std::pair{9.81, 3.0}, std::pair{-2e4, 500.0}}) {
      CAPTURE(n, offset, drift);
      const auto x = noise(2 * n + n / 2, offset, drift);
      HalfSegments halves(n);
      const auto sums = halves.zero_sums();
      CHECK(push_all(halves, x, *sums) == std::vector<bool>(4, true));
      std::vector<double> power;
      halves.take_power(*sums, power);
      same_power(power, power_by_segments(x, n), 1e-12);
      halves.take_power(*sums, power);
      CHECK(largest(power) == 0);
    }
  }
}

TEST_CASE("halves: their cosine transforms") {
  for (const std::size_t n : {4096U, 8000U, 65536U}) {
    CAPTURE(n);
    const std::size_t h = n / 2;
    const auto x = noise(3 * h, 9.81, 3);
    HalfSegments halves(n);
    Dct dct(h);
    std::vector<double> wanted(h, 0.0);
    push_all(halves, x, *halves.zero_sums(), true);
    for (std::size_t t = 0; t < x.size(); t += h) {
      const auto c = dct.transform({x.data() + t, h});
      for (std::size_t k = 1; k < h; ++k) wanted[k] += c[k] * c[k];
    }
    std::vector<double> got = halves.block_power();
    got[0] = 0;
    same_power(got, wanted, 1e-12);
  }
}

TEST_CASE("halves: a segment depends on its own pairs only, and each goes to the sum it is for") {
  constexpr std::size_t n = 4096, h = n / 2;
  const auto x = noise(6 * h, 1, 1);
  HalfSegments all(n), alone(n);
  const auto half = [&](std::size_t i) { return all.half_at(x.data() + i * h); };
  const auto sums = all.zero_sums(), first = all.zero_sums(), second = all.zero_sums();
  all.push(half(0), half(1), sums.get(), sums.get());
  all.push(half(2), half(3), sums.get(), sums.get());
  all.push(half(4), half(5), first.get(), second.get());
  std::vector<double> before, segment_3, segment_4, power;
  all.take_power(*sums, before);
  all.take_power(*first, segment_3);
  all.take_power(*second, segment_4);
  // The same from the fourth half on, with another history.
  alone.push(half(0), half(5), nullptr, nullptr);
  alone.forget();
  CHECK_FALSE(alone.push(half(2), half(3), first.get(), nullptr).first);
  alone.take_power(*first, power);
  CHECK(largest(power) == 0);
  const auto used = alone.push(half(4), half(5), first.get(), first.get());
  CHECK((used.first && used.second));
  alone.take_power(*first, power);
  for (std::size_t k = 0; k < power.size(); ++k) REQUIRE(power[k] == segment_3[k] + segment_4[k]);
  // And both sums are what whole segments give.
  same_power(segment_3, power_by_segments({x.begin() + 3 * h, x.begin() + 5 * h}, n), 1e-12);
  same_power(segment_4, power_by_segments({x.begin() + 4 * h, x.end()}, n), 1e-12);
  same_power(before, power_by_segments({x.begin(), x.begin() + 4 * h}, n), 1e-12);
}

TEST_CASE("halves: a last one without a partner changes nothing") {
  constexpr std::size_t n = 8000, h = n / 2;
  const auto x = noise(5 * h, -4, 2);
  HalfSegments halves(n), again(n);
  const auto sums = halves.zero_sums(), rest = halves.zero_sums(), other = halves.zero_sums();
  push_all(halves, {x.begin(), x.begin() + 2 * h}, *sums);
  CHECK(halves.add_last(halves.half_at(x.data() + 2 * h), *rest));
  CHECK_FALSE(again.add_last(again.half_at(x.data() + 2 * h), *other));
  std::vector<double> power, wanted;
  halves.take_power(*rest, power);
  same_power(power, power_by_segments({x.begin() + h, x.begin() + 3 * h}, n), 1e-12);
  halves.push(halves.half_at(x.data() + 2 * h), halves.half_at(x.data() + 3 * h), rest.get(), rest.get());
  push_all(again, {x.begin(), x.begin() + 2 * h}, *other);
  again.take_power(*other, wanted);
  again.push(again.half_at(x.data() + 2 * h), again.half_at(x.data() + 3 * h), other.get(), other.get());
  again.take_power(*other, wanted);
  halves.take_power(*rest, power);
  CHECK(power == wanted);
}

TEST_CASE("halves: with a missing sample neither segment of a half is used") {
  constexpr std::size_t n = 4096, h = n / 2;
  auto x = noise(6 * h, 1, 0);
  for (const double missing : {kMissing, std::numeric_limits<double>::infinity()}) {
    x[2 * h + 17] = missing;
    HalfSegments halves(n);
    const auto sums = halves.zero_sums();
    CHECK(push_all(halves, x, *sums, true) == std::vector<bool>{true, false, false, true, true});
    std::vector<double> power;
    halves.take_power(*sums, power);
    for (const double p : power) REQUIRE(std::isfinite(p));
    for (const double c : halves.block_power()) REQUIRE(std::isfinite(c));
    // The half that shares its transform with the broken one is as it would be alone.
    std::vector<double> wanted = power_by_segments({x.begin(), x.begin() + 2 * h}, n);
    const auto later = power_by_segments({x.begin() + 3 * h, x.end()}, n);
    for (std::size_t k = 0; k < wanted.size(); ++k) wanted[k] += later[k];
    same_power(power, wanted, 1e-12);
  }
}

TEST_CASE("halves: other windows, overlaps, trends and lengths go another way") {
  CHECK(HalfSegments::suits(segments_of(65536)));
  CHECK(HalfSegments::suits(segments_of(2500000)));
  for (const std::uint64_t n : {0U, 8U, 2048U, 65537U, 65538U, 4U * 10007U, 20000006U})
    CHECK_FALSE(HalfSegments::suits(segments_of(n)));
  WelchOptions options = segments_of(65536);
  options.window = Window::hann_nonzero;
  CHECK_FALSE(HalfSegments::suits(options));
  options = segments_of(65536);
  options.overlap = 0.4;
  CHECK_FALSE(HalfSegments::suits(options));
  options = segments_of(65536);
  options.detrend = Detrend::linear;
  CHECK_FALSE(HalfSegments::suits(options));
}

TEST_CASE("a stream by halves gives the bits of the whole, however it is pushed, with missing samples too") {
  auto x = noise(50021, 3, 2);
  for (const bool dirty : {false, true}) {
    if (dirty) x[5] = x[17003] = x[17004] = x[50020] = kMissing;
    for (const std::uint64_t n : {4096U, 8000U}) {
      const Spectrum whole = welch(x, 50, segments_of(n));
      WelchOptions single = segments_of(n);
      single.threads = 1;
      REQUIRE(welch(x, 50, single).value == whole.value);
      for (const std::size_t block : {1U, 999U, 4096U, 50021U}) {
        WelchStream stream(segments_of(n));
        REQUIRE(stream.shared_length() == n / 2);
        Taker taker;
        SharedBlocks blocks(n / 2, taker);
        for (std::size_t i = 0; i < x.size(); i += block)
          stream.push({x.data() + i, std::min(block, x.size() - i)}, blocks);
        const Spectrum s = stream.finish(50);
        CAPTURE(n, block, dirty);
        REQUIRE(s.value == whole.value);
        REQUIRE(s.dof == whole.dof);
        REQUIRE(s.segments == whole.segments);
        REQUIRE(s.dropped == whole.dropped);
        REQUIRE(s.notes == whole.notes);
        // Every sample was given once and in order, and what is whole was offered as a block.
        REQUIRE(taker.given.size() == x.size() / n * n);
        REQUIRE_FALSE(taker.power);
        stream.end(blocks);
        REQUIRE(same_samples(taker.given, x));
        REQUIRE(taker.offered == whole_blocks(x, n / 2));
        REQUIRE(stream.finish(50).value == whole.value);
        // The squares of the blocks that were taken were summed, and no others.
        Dct dct(n / 2);
        REQUIRE(taker.power);
        std::vector<double> wanted(n / 2, 0.0), got = *taker.power;
        for (const std::vector<double>& samples : taker.taken) {
          const auto c = dct.transform(samples);
          for (std::size_t k = 1; k < c.size(); ++k) wanted[k] += c[k] * c[k];
        }
        got[0] = 0;
        same_power(got, wanted, 1e-12);
      }
    }
  }
}

TEST_CASE("a stream shares blocks of its own length only, and none when it goes by segments") {
  const auto x = noise(9000, 0, 0);
  Taker taker;
  SharedBlocks blocks(500, taker);
  WelchStream by_segments(segments_of(1000)), by_halves(segments_of(8000));
  CHECK(by_segments.shared_length() == 0);
  CHECK(by_halves.shared_length() == 4000);
  for (WelchStream* stream : {&by_segments, &by_halves}) {
    CHECK_THROWS_AS(stream->push(x, blocks), Error);
    CHECK_THROWS_AS(stream->end(blocks), Error);
  }
  CHECK(taker.given.empty());
  CHECK_FALSE(taker.power);
}

TEST_CASE("halves and whole segments agree on spectrum, degrees of freedom and bandwidth") {
  const auto x = noise(100000, 1, 2);
  WelchOptions options = segments_of(8192);
  const Spectrum halves = welch(x, 100, options);
  options.overlap = 0.5 + 1e-9;  // the same segments, but not told to be halves
  const Spectrum whole = welch(x, 100, options);
  REQUIRE(halves.value.size() == whole.value.size());
  for (std::size_t k = 0; k < whole.value.size(); ++k)
    REQUIRE(halves.value[k] == Approx(whole.value[k]).epsilon(1e-9).margin(1e-24));
  CHECK(halves.dof[7] == Approx(whole.dof[7]).epsilon(1e-12));
  CHECK(halves.enbw_hz == Approx(whole.enbw_hz).epsilon(1e-12));
  CHECK(halves.neighbour_correlation == whole.neighbour_correlation);
}
