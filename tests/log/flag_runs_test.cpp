#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <random>

#include "libchar/log/detail/line_watch.hpp"
#include "libchar/log/quality.hpp"

using namespace libchar;
using detail::FlagRuns;
using detail::LineWatch;

namespace {

std::vector<bool> random_flags(std::mt19937_64& engine, std::size_t n, double share) {
  std::vector<bool> flags(n);
  for (std::size_t i = 0; i < n; ++i)
    flags[i] = i > 0 && engine() % 4 != 0 ? flags[i - 1] : (static_cast<double>(engine() % 1000) < 1000 * share);
  return flags;
}

/// Runs as (begin, length), by a plain loop.
std::vector<std::pair<std::size_t, std::size_t>> plain_runs(const std::vector<bool>& flags) {
  std::vector<std::pair<std::size_t, std::size_t>> out;
  for (std::size_t i = 0; i < flags.size(); ++i) {
    if (!flags[i]) continue;
    if (i > 0 && flags[i - 1])
      ++out.back().second;
    else
      out.push_back({i, 1});
  }
  return out;
}

/// `least`: the shortest run that is counted.
void check_same(const FlagRuns& a, const FlagRuns& b, std::size_t least) {
  CHECK(a.longest() == b.longest());
  CHECK(a.places() == b.places());
  for (const std::size_t length : {least, std::size_t{3}}) CHECK(a.from_length(length) == b.from_length(length));
  REQUIRE(a.closed().size() == b.closed().size());
  for (std::size_t length = least; length < a.closed().size(); ++length)
    CHECK(a.closed()[length] == b.closed()[length]);
  if (least > 1) return;
  CHECK(a.set() == b.set());
  CHECK(a.now() == b.now());
  CHECK(a.pauses() == b.pauses());
  CHECK(a.unevenness() == Approx(b.unevenness()));
}

}  // namespace

TEST_CASE("flag runs: counted as by a plain loop, and joined wherever the record is cut") {
  std::mt19937_64 engine(1);
  for (int round = 0; round < 300; ++round) {
    const std::size_t n = 2 + engine() % 60;
    const std::vector<bool> flags = random_flags(engine, n, round % 3 == 0 ? 0.9 : 0.4);
    const auto runs = plain_runs(flags);
    FlagRuns whole(2);
    for (std::size_t i = 0; i < n; ++i) whole.push(flags[i], i);
    std::uint64_t longest = 0, long_runs = 0, in_them = 0;
    std::vector<FlagRuns::Place> places;
    for (const auto& [begin, length] : runs) {
      longest = std::max<std::uint64_t>(longest, length);
      if (length < 2) continue;
      ++long_runs;
      in_them += length;
      if (places.size() < 32) places.push_back({begin, begin + length});
    }
    CHECK(whole.longest() == longest);
    CHECK(whole.from_length(2) == std::pair(long_runs, in_them));
    CHECK(whole.places() == places);
    // A part has no flag for its first sample: the joint gives it.
    FlagRuns joined(2);
    for (std::size_t from = 0; from < n;) {
      const std::size_t to = std::min(n, from + 1 + engine() % 9);
      FlagRuns part(2);
      for (std::size_t i = from + 1; i < to; ++i) part.push(flags[i], i - from);
      joined.push(flags[from], from);
      joined.join(part, from, 1);
      from = to;
    }
    check_same(joined, whole, 1);
  }
}

TEST_CASE("lines: found in noise, not in noise alone, and the same wherever the record is cut") {
  std::mt19937_64 engine(2);
  std::normal_distribution<double> normal;
  std::vector<double> x(50000);
  for (double& v : x) v = std::round(normal(engine) * 1e6) / 1e6;
  LineWatch clean;
  clean.block(x, nullptr, 0);
  CHECK(clean.found(0).least_run == 0);
  for (std::size_t at = 500; at + 100 < x.size(); at += 1000)  // gaps of 20 to 60 samples, filled
    for (std::size_t i = 1, n = 20 + at / 1000 % 41; i < n; ++i)
      x[at + i] = x[at] + (x[at + n] - x[at]) * static_cast<double>(i) / static_cast<double>(n);
  LineWatch whole;
  whole.block(x, nullptr, 0);
  const LineWatch::Found found = whole.found(0);
  REQUIRE(found.least_run > 0);
  CHECK(found.runs->from_length(found.least_run).first == 50);
  for (const auto& [from, to] : found.runs->places()) {  // chance may add one at either end
    CHECK(from % 1000 >= 501);
    CHECK(from % 1000 <= 502);
    CHECK(to - from >= 19);
  }
  for (int round = 0; round < 20; ++round) {
    LineWatch joined;
    for (std::size_t from = 0; from < x.size();) {
      const std::size_t to = std::min(x.size(), from + 1 + engine() % (round < 10 ? 5000 : 7));
      LineWatch part;
      part.block(std::span(x).subspan(from, to - from), nullptr, 0);
      joined.join(part, true, from);
      from = to;
    }
    CHECK(joined.found(0).least_run == found.least_run);
    check_same(*joined.found(0).runs, *found.runs, 2);
  }
}

TEST_CASE("lines: noise that is smooth by nature has none") {
  std::mt19937_64 engine(3);
  std::normal_distribution<double> normal;
  for (const double keep : {0.5, 0.8, 0.95}) {
    double one = 0, two = 0;
    std::vector<double> x(200000);
    for (double& v : x) v = two += (1 - keep) * ((one += (1 - keep) * (normal(engine) - one)) - two);
    LineWatch watch;
    watch.block(x, nullptr, 0);
    INFO("keeps " << keep);
    CHECK(watch.found(0).least_run == 0);
  }
}

TEST_CASE("lines: short gaps that were filled are found where there are digits, never in coarse noise") {
  std::mt19937_64 engine(5);
  std::normal_distribution<double> normal;
  for (const double levels : {2.0, 5.0, 20.0, 100.0, 1e3, 1e4, 1e6}) {  // per standard deviation
    for (int filled : {0, 2, 3, 5}) {
      std::vector<double> x(20000);
      for (double& v : x) v = normal(engine);
      for (std::size_t at = 100; filled > 0 && at + 10 < x.size(); at += 200)
        for (int i = 1; i <= filled; ++i)
          x[at + static_cast<std::size_t>(i)] =
              x[at] + (x[at + static_cast<std::size_t>(filled) + 1] - x[at]) * i / (filled + 1.0);
      for (double& v : x) v = std::round(v * levels) / levels;
      LineWatch watch;
      watch.block(x, nullptr, 0);
      INFO(levels << " levels, " << filled << " filled");
      const LineWatch::Found found = watch.found(0.7 / levels);
      if (filled == 0) CHECK(found.least_run == 0);
      if (filled > 0 && levels >= 1e4) {
        REQUIRE(found.least_run > 0);
        const auto places = static_cast<double>(found.runs->from_length(found.least_run).first);
        CHECK(places > 75);
        CHECK(places < 105);
        std::vector<double> kept = x;
        detail::forget_lines(kept, found.least_run + 2);
        const auto lost = std::count_if(kept.begin(), kept.end(), [](double v) { return v != v; });
        CHECK(static_cast<double>(lost) > 0.75 * 100 * filled);
        CHECK(static_cast<double>(lost) < 1.1 * 100 * filled);
      }
    }
  }
}

// Small steps of a coarse grid repeat exactly by chance: short records have few others to tell how often.
TEST_CASE("lines: white noise in whole counts has none, however short the record") {
  std::mt19937_64 engine(6);
  std::normal_distribution<double> normal;
  int found = 0, records = 0;
  for (const std::size_t n : {std::size_t{1000}, std::size_t{3000}, std::size_t{10000}, std::size_t{30000}})
    for (const double counts : {2.0, 4.0, 6.0, 8.0, 13.0, 20.0, 40.0, 100.0})  // standard deviation
      for (int round = 0; round < 40; ++round, ++records) {
        std::vector<double> x(n);
        for (double& v : x) v = std::round(counts * normal(engine));
        LineWatch watch;
        watch.block(x, nullptr, 0);
        found += watch.found(0.7 / counts).least_run > 0;
      }
  INFO(found << " of " << records);
  CHECK(found <= 3);
}

TEST_CASE("lines: single samples that were filled are found and counted") {
  std::mt19937_64 engine(7);
  std::normal_distribution<double> normal;
  for (const double levels : {100.0, 1e3, 1e6})  // per standard deviation
    for (const double share : {0.0, 0.02, 0.05, 0.2}) {
      std::vector<double> x(100000);
      for (double& v : x) v = std::round(levels * normal(engine)) / levels;
      std::size_t filled = 0;
      for (std::size_t i = 1; i + 1 < x.size(); ++i) {
        if (std::uniform_real_distribution<double>()(engine) >= share) continue;
        x[i] = 0.5 * (x[i - 1] + x[i + 1]);
        ++filled;
        ++i;
      }
      LineWatch watch;
      watch.block(x, nullptr, 0);
      const LineWatch::Found found = watch.found(0.7 / levels);
      INFO(levels << " levels, " << share);
      CHECK((found.least_run > 0) == (share > 0));
      if (share == 0) continue;
      CHECK(found.least_run == 1);
      CHECK(found.alone == Approx(static_cast<double>(filled)).epsilon(0.25));
      detail::forget_lines(x, found.least_run + 2);
      const auto lost = std::count_if(x.begin(), x.end(), [](double v) { return v != v; });
      CHECK(static_cast<double>(lost) > 0.99 * static_cast<double>(filled));
    }
}
