// The time base from stamps: rate, jitter, gaps, doubles, steps back, rollovers; known answers on made-up clocks.
#include "libchar/log/time/grid.hpp"

#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <random>

#include "libchar/log/time/stamp_sketch.hpp"
#include "tests/log/log_text.hpp"

using namespace libchar;
using test::count;
using test::failure;
using test::read_text;

namespace {

std::string log_of(const std::vector<std::int64_t>& stamps, const char* name = "t_us") {
  std::string text = std::string(name) + ",x\n";
  for (std::size_t i = 0; i < stamps.size(); ++i) text += fmt::format("{},{}\n", stamps[i], i);
  return text;
}

std::vector<std::int64_t> even(std::size_t n, std::int64_t step, std::int64_t start = 0) {
  std::vector<std::int64_t> t(n);
  for (std::size_t i = 0; i < n; ++i) t[i] = start + static_cast<std::int64_t>(i) * step;
  return t;
}

}  // namespace

TEST_CASE("missing rows become missing samples, never values") {
  auto t = even(3000, 5000);
  t.erase(t.begin() + 2000, t.begin() + 2007);
  t.erase(t.begin() + 100);
  const Recording r = read_text(log_of(t));
  CHECK(r.info.rows == 2992);
  CHECK(r.info.samples == 3000);
  CHECK(r.info.time.gaps == 2);
  CHECK(r.info.time.missing_samples == 8);
  CHECK(r.info.time.rate_hz == Approx(200).epsilon(1e-12));
  REQUIRE(count(r, "gap") == 2);
  CHECK(r.info.warnings.find("gap")->where.rows[0] == "line 102");
  CHECK(std::isnan(r.samples[0][100]));
  CHECK(r.samples[0][99] == 99);
  CHECK(r.samples[0][101] == 100);
  for (std::size_t i = 2000; i < 2007; ++i) CHECK(std::isnan(r.samples[0][i]));
  CHECK(r.samples[0][2999] == 2991);
}

TEST_CASE("the scatter of the stamps is said in per cent of the interval") {
  // Offsets 0, +a, -a in turn: the median of |offset| is a, so the robust deviation is 1.4826 a.
  std::vector<std::int64_t> t;
  for (int i = 0; i < 3000; ++i) t.push_back(10000 * i + (i % 3 == 1 ? 3000 : i % 3 == 2 ? -3000 : 0));
  const Recording r = read_text(log_of(t));
  REQUIRE(count(r, "jitter") == 1);
  CHECK_THAT(r.info.warnings.find("jitter")->sentence, Catch::Contains("scatter by 44 %"));
}

TEST_CASE("stamps most of which lie on one tick scatter as the others do") {
  std::vector<std::int64_t> t;
  for (int i = 0; i < 3000; ++i) t.push_back(10000 * i + (i % 5 == 2 ? 3000 : i % 5 == 4 ? -3000 : 0));
  const Recording r = read_text(log_of(t));
  const double deviation = 3000e-6 * std::sqrt(0.4);
  CHECK(r.info.time.jitter_s > 0.9 * deviation);
  CHECK(r.info.time.jitter_s < 1.4 * deviation);
}

TEST_CASE("the rate is exact in spite of jitter, drifts of the first rows and outliers") {
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise(0, 300);
  std::vector<std::int64_t> t;
  for (int i = 0; i < 200000; ++i)
    t.push_back(static_cast<std::int64_t>(std::llround(i * 5000.025 + noise(random) + (i % 1000 == 7 ? 1500 : 0))));
  const Recording r = read_text(log_of(t));
  CHECK(r.info.samples == 200000);
  CHECK(r.info.time.rate_hz == Approx(1e6 / 5000.025).epsilon(1e-7));
  CHECK(r.info.time.jitter_s == Approx(300e-6).epsilon(0.05));
  CHECK(r.info.time.max_deviation_s > 1500e-6);
  CHECK(r.info.time.max_deviation_s < 3500e-6);
}

TEST_CASE("one late row whose followers are on time is no gap") {
  auto t = even(2000, 5000);
  t[700] += 4000;
  const Recording r = read_text(log_of(t));
  CHECK(r.info.samples == 2000);
  CHECK(r.info.time.gaps == 0);
}

TEST_CASE("a wild stamp behind a gap leaves the gap and its row, in blocks of any size") {
  for (const std::size_t first : {std::size_t{6}, std::size_t{700}}) {
    auto t = even(2 * first, 1000000);
    t[first] += 60000000;
    t.erase(t.begin() + static_cast<std::ptrdiff_t>(first) + 1);
    for (const std::size_t bytes : {std::size_t{16}, std::size_t{200}, std::size_t{1} << 20U}) {
      ReadOptions options;
      options.block_bytes = bytes;
      const Recording r = read_text(log_of(t), options);
      INFO(first << " rows in blocks of " << bytes << " bytes");
      CHECK(r.info.rows_dropped == 0);
      CHECK(r.info.samples == 2 * first);
      CHECK(r.info.time.missing_samples == 1);
      CHECK(r.info.time.rate_hz == Approx(1).epsilon(1e-9));
      CHECK(count(r, "late_stamp") == 1);
    }
  }
}

TEST_CASE("a blank between a wild stamp and the rows behind it shows no clock of its own") {
  std::string text = "t[s],x\n";
  for (int i = 1; i <= 12; ++i) text += fmt::format("{},{}\n", i == 6 ? 68 : i, i == 7 ? "" : fmt::to_string(i));
  const Recording r = read_text(text);
  CHECK(count(r, "own_rows") == 0);
  CHECK(r.info.samples == 12);
  CHECK(r.info.time.rate_hz == Approx(1));
}

TEST_CASE("rows of blocks that are left out whole are none of those ahead") {
  std::string text = "t[s],fast,slow\n";
  for (int i = 0; i < 4000; ++i)
    text += fmt::format("{},{},{}\n", i % 20 == 0 && i / 20 == 100 ? i * 10 + 4000 : i * 10, i % 7,
                        i % 20 == 0 ? fmt::to_string(i) : "");
  ReadOptions options;
  options.channels = {"slow"};
  const Recording whole = read_text(text, options);
  CHECK(whole.info.samples == 200);
  for (const std::size_t bytes : {std::size_t{9}, std::size_t{40}}) {
    options.block_bytes = bytes;
    const Recording blocks = read_text(text, options);
    CHECK(blocks.info.samples == whole.info.samples);
    CHECK(count(blocks, "late_stamp") == count(whole, "late_stamp"));
  }
}

TEST_CASE("doubled stamps: the first row is kept") {
  auto t = even(50, 1000);
  t.insert(t.begin() + 10, t[9]);
  t.insert(t.begin(), t[0]);
  const Recording r = read_text(log_of(t));
  CHECK(r.info.samples == 50);
  REQUIRE(count(r, "duplicate_timestamp") == 2);
  CHECK(r.info.warnings.find("duplicate_timestamp")->where.rows[0] == "line 3");
  CHECK(r.samples[0][0] == 0);
}

// A log whose rows are written twice here and there, the next row lost or not: `lost` of 20,000 at 100 Hz.
std::string copied_log(double share, bool lost, double step, std::size_t from, std::size_t& missing) {
  std::mt19937 random(11);
  std::normal_distribution<double> noise(0, 0.01);
  std::uniform_real_distribution<double> chance(0, 1);
  std::string text = "t_ms,x,y\n";
  missing = 0;
  for (std::size_t i = 0; i < 3000; ++i) {
    const auto value = [&] { return std::round(noise(random) / step) * step; };
    const std::string row = fmt::format("{},{},{}\n", 10 * i, value(), value());
    text += row;
    if (i < from || i + 3 > 3000 || chance(random) >= share) continue;
    text += row;
    if (!lost) continue;
    ++i;
    ++missing;
  }
  return text;
}

TEST_CASE("rows that are written twice are one sample, also where the next row is lost") {
  for (const double share : {0.01, 0.1, 0.3, 1.0})
    for (const bool lost : {false, true})
      for (const double step : {1e-5, 0.005})
        for (const std::size_t from : {std::size_t{0}, std::size_t{2000}}) {
          if (from > 0 && step > 1e-4) continue;  // a chance pair of coarse values is no copy
          std::size_t missing = 0;
          const std::string text = copied_log(share, lost, step, from, missing);
          INFO(share << (lost ? " lost" : " more") << " step " << step << " from " << from);
          const bool each_second = lost && share == 1 && from == 0;
          for (const std::size_t bytes : {std::size_t{50}, std::size_t{1} << 20U}) {
            ReadOptions options;
            options.block_bytes = bytes;
            const Recording r = read_text(text, options);
            CHECK(r.info.time.rate_hz == Approx(each_second ? 50 : 100).epsilon(1e-4));
            if (!each_second && !(lost && share == 1)) CHECK(r.info.time.missing_samples == missing);
            CHECK(r.info.rows_dropped > 0);
            CHECK(count(r, "held_stamp") == 0);
          }
        }
}

TEST_CASE("rows of a slow sensor with the stamps of a coarse clock are no copies") {
  for (const int changes : {7, 40, 1000}) {  // rows between two values of the sensor
    std::string text = "t[s],x\n";
    for (int i = 0; i < 4000; ++i) text += fmt::format("{},{}\n", i / 10, (i / changes * 7919) % 1000);
    const Recording r = read_text(text);
    INFO(changes);
    CHECK(r.info.time.rate_hz == Approx(10).epsilon(1e-3));
    CHECK(r.info.rows_dropped == 0);
  }
}

TEST_CASE("a clock too coarse to tell rows apart keeps all rows") {
  std::vector<std::int64_t> t;
  for (int i = 0; i < 4000; ++i) t.push_back(i / 2);  // 2 kHz in whole milliseconds
  const Recording r = read_text(log_of(t, "t_ms"));
  CHECK(r.info.samples == 4000);
  CHECK(r.info.time.rate_hz == Approx(2000).epsilon(1e-6));
  CHECK(count(r, "coarse_stamps") == 1);
  // 400 Hz in whole milliseconds: steps of 2 and 3
  t.clear();
  for (int i = 0; i < 4000; ++i) t.push_back(i * 5 / 2);
  const Recording s = read_text(log_of(t, "t_ms"));
  CHECK(s.info.samples == 4000);
  CHECK(s.info.time.rate_hz == Approx(400).epsilon(1e-6));
}

TEST_CASE("of two rows that changed places the second is dropped, and its place stays empty") {
  auto t = even(8000, 10000);
  std::swap(t[3000], t[3001]);
  std::swap(t[5000], t[5001]);
  const Recording r = read_text(log_of(t));
  CHECK(r.info.time.rate_hz == Approx(100).epsilon(1e-9));
  CHECK(r.info.time.missing_samples == 2);
  CHECK(r.info.samples == 8000);
  CHECK(r.samples[0][3001] == 3000);
  CHECK(std::isnan(r.samples[0][3000]));
  CHECK(count(r, "jitter") == 0);
}

TEST_CASE("rows that step back are dropped and counted, a restarted clock is an error") {
  auto t = even(300, 1000);
  std::swap(t[100], t[101]);
  const Recording r = read_text(log_of(t));
  REQUIRE(count(r, "backward_timestamp") == 1);
  CHECK(r.info.warnings.find("backward_timestamp")->where.rows[0] == "line 103");
  auto twice = even(300, 1000);
  const auto again = even(300, 1000);
  twice.insert(twice.end(), again.begin(), again.end());
  CHECK(failure(log_of(twice)).find("log.csv:302:1: error E0317: the time steps back here") == 0);
}

TEST_CASE("rows that step back are a restarted clock when none between them goes on") {
  // 120 rows out of order, in two halves with 256 good rows between: what is looked at together begins and ends there.
  std::vector<std::int64_t> t;
  const auto good = [&](std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) t.push_back(t.empty() ? 1000000 : t.back() + 1000);
  };
  const auto back = [&](std::size_t n) {
    const std::int64_t last = t.back();
    for (std::size_t i = 0; i < n; ++i) t.push_back(500000 + static_cast<std::int64_t>(i));
    return last;
  };
  good(2048 - 60);
  const std::int64_t first = back(60);
  for (std::int64_t i = 1; i <= 256; ++i) t.push_back(first + 1000 * i);
  const std::int64_t second = back(60);
  for (std::int64_t i = 1; i <= 1000; ++i) t.push_back(second + 1000 * i);
  ReadOptions options;
  options.block_bytes = 1 << 20;
  const Recording r = read_text(log_of(t), options);
  CHECK(count(r, "backward_timestamp") == 120);
  CHECK(r.info.samples == 2048 - 60 + 256 + 1000);
}

TEST_CASE("the same gap now and then is no change of rate, eight in a row are") {
  std::vector<std::int64_t> now_and_then;
  for (int i = 0; i < 4000; ++i)
    if (i < 2000 || i % 10 != 0) now_and_then.push_back(5000 * i);
  const Recording r = read_text(log_of(now_and_then));
  CHECK(count(r, "gap") == 200);
  CHECK(count(r, "rate_change") == 0);
  std::vector<std::int64_t> slower = even(2000, 5000);
  for (int i = 0; i < 100; ++i) slower.push_back(slower.back() + 10000);
  CHECK(count(read_text(log_of(slower)), "rate_change") == 1);
}

TEST_CASE("a lasting change of rate is refused with the options that read either stretch") {
  struct Change {
    std::int64_t before, after;
    std::size_t at;
  };
  for (const Change& change : {Change{10000, 14000, 3001}, Change{25000, 40000, 1367}, Change{40000, 25000, 700},
                               Change{10000, 10400, 2000}}) {
    std::vector<std::int64_t> t = even(change.at, change.before);
    for (int i = 0; i < 2500; ++i) t.push_back(t.back() + change.after);
    const std::string said = failure(log_of(t));
    INFO(said);
    REQUIRE_THAT(said, Catch::Contains("error E0334: the sampling rate changes"));
    const double at = std::stod(said.substr(said.find("`to_s` ") + 7));
    CHECK(at == Approx(static_cast<double>(t[change.at - 1]) * 1e-6).margin(0.3));
    ReadOptions first, second;
    first.to_s = second.from_s = at;
    const Recording before = read_text(log_of(t), first), after = read_text(log_of(t), second);
    CHECK(before.info.time.rate_hz == Approx(1e6 / static_cast<double>(change.before)).epsilon(1e-3));
    CHECK(after.info.time.rate_hz == Approx(1e6 / static_cast<double>(change.after)).epsilon(1e-3));
    CHECK(before.info.time.gaps == 0);
    CHECK(after.info.time.gaps == 0);
  }
}

TEST_CASE("a few hundred first rows at another rate are left out") {
  std::vector<std::int64_t> t = even(400, 2560);
  for (int i = 0; i < 3000; ++i) t.push_back(t.back() + 10000);
  const Recording r = read_text(log_of(t));
  CHECK(r.info.time.rate_hz == Approx(100).epsilon(1e-6));
  CHECK(r.info.time.gaps == 0);
  CHECK(r.info.rows_outside == Approx(400).margin(2));
  CHECK(count(r, "rate_change") == 1);
  ReadOptions options;
  options.to_s = 1.02;
  CHECK(read_text(log_of(t), options).info.time.rate_hz == Approx(390.625));
}

TEST_CASE("first rows at another rate neither spoil the rate of the rest nor make gaps of it") {
  std::mt19937_64 random(9);
  std::normal_distribution<double> noise(0, 1000);
  for (const auto& [rows, first_us] :
       {std::pair{1000, 12500}, {1000, 9090}, {1500, 9090}, {300, 12500}, {1500, 20000}}) {
    std::vector<std::int64_t> t = even(static_cast<std::size_t>(rows), first_us);
    for (int i = 0; i < 20 * rows; ++i) t.push_back(t.back() + 10000);
    for (std::int64_t& stamp : t) stamp += static_cast<std::int64_t>(noise(random));
    INFO(rows << " at " << first_us);
    ReadOptions rest;
    const std::string said = failure(log_of(t));
    if (!said.empty()) {
      REQUIRE_THAT(said, Catch::Contains("error E0334: the sampling rate changes"));
      rest.from_s = std::stod(said.substr(said.find("`from_s` ") + 9));
      CHECK(*rest.from_s == Approx(1e-6 * first_us * rows).epsilon(0.05));
    }
    const Recording r = read_text(log_of(t), rest);
    CHECK(r.info.time.rate_hz == Approx(100).epsilon(1e-3));
    CHECK(r.info.time.missing_samples == 0);
  }
}

TEST_CASE("stamps too far away for a grid are refused with their distance") {
  CHECK_THAT(failure("t_ns,x\n-3000000000000000000,1\n-2999999999000000000,2\n"
                     "3000000000000000000,3\n3000000001000000000,4\n"),
             Catch::Contains("log.csv:4:1: error E0316: wild time stamp: 6e+09 s away from the first"));
  auto t = even(1001, 1000);
  for (int i = 0; i < 100; ++i) t.push_back(200001000000 + 1000 * i);
  CHECK_THAT(
      failure(log_of(t)),
      Catch::Contains(
          "log.csv:1003:1: error E0316: wild time stamp: 2e+05 s after the row before (199999999 missing samples)"));
}

TEST_CASE("16- and 32-bit microsecond clocks run over and go on") {
  for (const int bits : {16, 32}) {
    const std::int64_t range = std::int64_t{1} << bits;
    std::vector<std::int64_t> t;
    for (int i = 0; i < 1000; ++i) t.push_back((range - 1000 + i * 100) % range);
    const Recording r = read_text(log_of(t));
    INFO(bits);
    CHECK(r.info.samples == 1000);
    CHECK(count(r, "clock_rollover") == (bits == 16 ? 2U : 1U));
    CHECK(r.info.time.rate_hz == Approx(10000));
    CHECK(r.info.time.gaps == 0);
  }
}

TEST_CASE("a clock in 0.1 ms runs over and goes on") {
  const std::int64_t range = std::int64_t{1} << 32;
  std::vector<std::int64_t> t;
  for (int i = 0; i < 1000; ++i) t.push_back((range - 1000 + i * 100) % range);
  const Recording r = read_text(log_of(t, "SampleTimeFine"));
  CHECK(r.info.samples == 1000);
  CHECK(count(r, "clock_rollover") == 1);
  CHECK(r.info.time.rate_hz == Approx(100));
  CHECK(r.info.time.unit_ns == 100000);
}

TEST_CASE("a clock that comes down at the log's first stamp after many steps began again") {
  // 0.55 s before a 32-bit count of ns runs over.
  std::string text = "t [ns],x\n";
  for (const int run : {0, 1})
    for (int k = 0; k < 750; ++k) text += fmt::format("{},{}\n", k * 5000000LL, (k + run) % 7);
  CHECK_THAT(failure(text), Catch::Contains("E0317"));
}

TEST_CASE("stamps that are no time axis") {
  CHECK(failure("t_us,x\n5,1\n5,2\n5,3\n").find("log.csv:3:1: error E0315: no time axis: all stamps are equal") == 0);
  const std::string turned = failure("t_us,x\n3000,1\n2000,2\n1000,3\n");
  CHECK(turned.find("the newest row is the first") != std::string::npos);
  CHECK(turned.find(" 1000 ignore") != std::string::npos);
  CHECK(count(read_text("t_ns,x\n0,1\n100,2\n200,3\n4000000000000000000,4\n300,5\n400,1\n"), "wild_stamp") == 1);
  CHECK(failure("t_ns,x\n-9000000000000000000,1\n9000000000000000000,2\n").find("error E031") != std::string::npos);
  CHECK(failure("t,x\n0,1\n,2\n").find("log.csv:3:1 (byte 8): error E0313: missing time stamp") == 0);
}

TEST_CASE("a rate that is stated with its uncertainty is taken, and held against stamps by it") {
  ReadOptions options;
  options.rate_hz = 100;
  options.unsaid.rate_uncertainty_hz = 0.5;
  const Recording bare = read_text("x\n1\n2\n3\n4\n", options);
  CHECK(bare.info.time.rate_hz == 100);
  CHECK_THAT(bare.info.warnings.find("rate_uncertain")->sentence, Catch::Contains("N and K to ± 0.25 %"));
  std::string text = "t[s],x\n";
  for (int i = 0; i < 200; ++i) text += fmt::format("{:.6f},{}\n", i / 99.2, i % 7);
  CHECK(count(read_text(text, options), "rate_ignored") == 1);  // 0.8 % off
  options.unsaid.rate_uncertainty_hz = 1.5;
  CHECK(count(read_text(text, options), "rate_ignored") == 0);
}

TEST_CASE("one and two rows") {
  const Recording one = read_text("t,x\n5,1\n");
  CHECK(one.info.samples == 1);
  CHECK(one.info.time.rate_hz == 0);
  CHECK(one.info.time.start_ns == 5000000000);
  const Recording two = read_text("t,x\n5,1\n5.5,2\n");
  CHECK(two.info.time.rate_hz == 2);
  CHECK(two.info.time.jitter_s == 0);
}

TEST_CASE("a window gives the same samples as the whole") {
  auto t = even(5000, 10000, 77);
  t.erase(t.begin() + 1200, t.begin() + 1300);
  const Recording whole = read_text(log_of(t));
  for (const auto& [from, to] :
       {std::pair{0.0, 50.0}, {3.0, 4.0}, {12.5, 12.7}, {11.9, 13.2}, {12.35, 20.0}, {49.0, 99.0}}) {
    ReadOptions options;
    options.from_s = from;
    options.to_s = to;
    const Recording part = read_text(log_of(t), options);
    const auto first = static_cast<std::size_t>(std::llround(from * 100));
    const auto last = std::min<std::size_t>(whole.samples[0].size(), static_cast<std::size_t>(std::llround(to * 100)));
    INFO(from << " " << to);
    REQUIRE(part.samples[0].size() == last - first);
    for (std::size_t i = first; i < last; ++i) {
      const double a = whole.samples[0][i], b = part.samples[0][i - first];
      if (!(a == b || (std::isnan(a) && std::isnan(b)))) FAIL("sample " << i);
    }
    CHECK(part.info.sha256 == whole.info.sha256);
    CHECK(part.info.time.start_ns == 77000 + static_cast<std::int64_t>(first) * 10000000);
  }
  ReadOptions options;
  options.from_s = 2;
  options.to_s = 1;
  CHECK_THROWS_AS(read_text(log_of(t), options), Error);
}

TEST_CASE("windows without stamps go by the given rate") {
  std::string text = "x,y\n";
  for (int i = 0; i < 1000; ++i) text += fmt::format("{},{}\n", i, -i);
  ReadOptions options;
  options.rate_hz = 100;
  options.from_s = 2.5;
  options.to_s = 2.6;
  const Recording r = read_text(text, options);
  REQUIRE(r.info.samples == 10);
  CHECK(r.samples[0][0] == 250);
  options.rate_hz.reset();
  CHECK(failure(text, options).find("`rate_hz` HZ") != std::string::npos);
}

TEST_CASE("stamps sketched together are stamps sketched one by one") {
  std::mt19937_64 generator(5);
  std::normal_distribution<double> jitter(0, 2e4);
  std::vector<std::int64_t> stamps;
  for (std::size_t i = 0; i < 40000; ++i) {
    const double late = i % 977 == 13 ? 3e5 : 0;  // now and then an extreme
    stamps.push_back(static_cast<std::int64_t>(5e6 * static_cast<double>(i) + jitter(generator) + late));
  }
  StampSketch one;
  for (std::size_t i = 0; i < stamps.size(); ++i) one.add(static_cast<std::int64_t>(i), stamps[i]);
  for (const std::size_t run : {1U, 7U, 256U, 40000U}) {
    StampSketch together;
    for (std::size_t i = 0; i < stamps.size(); i += run)
      together.add_run(static_cast<std::int64_t>(i), stamps.data() + i, std::min<std::size_t>(run, stamps.size() - i));
    CAPTURE(run);
    CHECK(together.interval_ns() == one.interval_ns());
    CHECK(together.deviation(5e6).robust == one.deviation(5e6).robust);
    CHECK(together.deviation(5e6).largest == one.deviation(5e6).largest);
  }
  CHECK(one.deviation(5e6).largest > 2.5e5);
}

TEST_CASE("what stamps need does not depend on where blocks of the file begin") {
  // Every kind of irregular stamp, at the beginning, in the middle and at the end of the 256 that
  // are looked at together, wherever these begin.
  std::vector<std::int64_t> t;
  std::int64_t now = 0;
  for (std::size_t i = 0; i < 6000; ++i) {
    now += 5000;
    if (i % 257 == 100) now += 20000;               // four samples are missing
    if (i % 263 == 50) t.push_back(now - 5000);     // a doubled stamp
    if (i % 269 == 70) t.push_back(now - 40000);    // a step back
    t.push_back(i % 271 == 90 ? now - 2000 : now);  // early
  }
  const std::string text = log_of(t);
  ReadOptions options;
  options.block_bytes = 1 << 20;
  const Recording whole = read_text(text, options);
  CHECK(count(whole, "gap") > 20);
  CHECK(count(whole, "duplicate_timestamp") + count(whole, "backward_timestamp") > 30);
  for (const std::size_t bytes : {40U, 3000U, 4096U, 9973U}) {
    options.block_bytes = bytes;
    const Recording r = read_text(text, options);
    CAPTURE(bytes);
    CHECK(r.info.samples == whole.info.samples);
    CHECK(r.info.time.gaps == whole.info.time.gaps);
    CHECK(r.info.time.missing_samples == whole.info.time.missing_samples);
    CHECK(r.info.time.rate_hz == whole.info.time.rate_hz);
    REQUIRE(r.info.warnings.list().size() == whole.info.warnings.list().size());
    for (std::size_t k = 0; k < r.info.warnings.list().size(); ++k) {
      CHECK(r.info.warnings.list()[k].code == whole.info.warnings.list()[k].code);
      CHECK(r.info.warnings.list()[k].count == whole.info.warnings.list()[k].count);
      CHECK(r.info.warnings.list()[k].where.rows == whole.info.warnings.list()[k].where.rows);
    }
    for (std::size_t i = 0; i < r.samples[0].size(); ++i) {
      const double a = r.samples[0][i], b = whole.samples[0][i];
      REQUIRE((a == b || (std::isnan(a) && std::isnan(b))));
    }
  }
}

namespace {

/// Stamps in microseconds of rows that come in packets: each row `inner` after the one before, the
/// last at the time of the packet.
std::vector<std::int64_t> packets(std::size_t rows, double dt, const std::vector<std::size_t>& sizes, double inner,
                                  double jitter) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise;
  std::vector<std::int64_t> t;
  for (std::size_t k = 0; t.size() < rows; ++k) {
    const std::size_t size = sizes[k % sizes.size()];
    const double arrival = dt * static_cast<double>(t.size() + size) + jitter * noise(random);
    for (std::size_t i = 0; i < size; ++i)
      t.push_back(static_cast<std::int64_t>(std::llround(arrival - inner * static_cast<double>(size - 1 - i))));
  }
  t.resize(rows);
  return t;
}

}  // namespace

TEST_CASE("stamps in packets: the rate is rows over time") {
  struct Clock {
    std::vector<std::size_t> sizes;
    double dt, inner, jitter;
  };
  for (const Clock& clock :
       {Clock{{5}, 10000, 200, 0}, Clock{{5}, 10000, 200, 1500}, Clock{{4}, 10000, 150, 300},
        Clock{{1, 7, 3, 4}, 5000, 40, 200}, Clock{{2}, 2500, 30, 100}, Clock{{20}, 1000, 10, 50}}) {
    const Recording r = read_text(log_of(packets(20000, clock.dt, clock.sizes, clock.inner, clock.jitter)));
    INFO(clock.sizes.size() << " " << clock.sizes[0] << " " << clock.dt << " " << clock.jitter);
    CHECK(r.info.time.rate_hz == Approx(1e6 / clock.dt).epsilon(1e-3));
    CHECK(r.info.samples == 20000);
    CHECK(count(r, "packets") == 1);
    CHECK(count(r, "rate_change") == 0);
  }
  ReadOptions inside;
  inside.rate_hz = 5000;
  CHECK(read_text(log_of(packets(5000, 10000, {5}, 200, 0)), inside).info.time.rate_hz == Approx(5000).epsilon(1e-3));
}

TEST_CASE("packets of one stamp each: rate and what is missing, however they are rounded and late") {
  std::mt19937 random(5);
  std::gamma_distribution<double> late(2, 0.02);
  for (const std::size_t rows : {5, 10, 32})
    for (const double rounded_us : {1.0, 1000.0})
      for (const bool lost : {false, true}) {
        const double dt = 1e6 / 104;
        std::vector<std::int64_t> stamps;
        std::size_t missing = 0;
        for (std::size_t packet = 1; packet < 20000 / rows; ++packet) {
          const double at = static_cast<double>(packet * rows) * dt + late(random) * static_cast<double>(rows) * dt;
          const bool gone = lost && packet > 100 / rows && packet % 41 == 0;
          missing += gone ? rows : 0;
          if (!gone)
            stamps.insert(stamps.end(), rows, static_cast<std::int64_t>(std::round(at / rounded_us) * rounded_us));
        }
        const Recording r = read_text(log_of(stamps));
        INFO(rows << " rows, rounded to " << rounded_us << " us, " << missing << " missing");
        CHECK(r.info.time.rate_hz == Approx(104).epsilon(1e-3));
        CHECK(r.info.time.missing_samples == missing);
        CHECK(count(r, "duplicate_timestamp") == 0);
      }
}

TEST_CASE("stamps that a logger holds back keep their rows, doubled rows do not") {
  std::mt19937 random(7);
  std::normal_distribution<double> scatter(0, 3000);
  std::vector<std::int64_t> stamps;
  std::int64_t last = 0;
  for (int i = 0; i < 20000; ++i) {
    last = std::max(last, static_cast<std::int64_t>(10000.0 * i + scatter(random)));
    stamps.push_back(last);
  }
  const Recording held = read_text(log_of(stamps));
  CHECK(held.info.time.rate_hz == Approx(100).epsilon(1e-3));
  CHECK(held.info.samples == Approx(20000).margin(20));
  CHECK(count(held, "held_stamp") > 50);
}

TEST_CASE("coarse stamps: the rate is rows over time") {
  struct Clock {
    double rate_hz, tick_ms;
  };
  for (const Clock clock : {Clock{81.3, 10}, Clock{85.47, 10}, Clock{3, 1000}, Clock{1.2, 1000}, Clock{0.7, 1000},
                            Clock{700, 1}, Clock{1100, 1}, Clock{130, 10}, Clock{400, 1}}) {
    for (const int rows : {200, 20000}) {
      std::vector<std::int64_t> t;
      for (int i = 0; i < rows; ++i)
        t.push_back(static_cast<std::int64_t>(std::floor(i * 1000 / clock.rate_hz / clock.tick_ms) * clock.tick_ms));
      const Recording r = read_text(log_of(t, "t_ms"));
      INFO(clock.rate_hz << " Hz, " << clock.tick_ms << " ms, " << rows);
      CHECK(r.info.time.rate_hz == Approx(clock.rate_hz).epsilon(rows == 200 ? 0.01 : 1e-4));
      CHECK(r.info.samples == static_cast<std::uint64_t>(rows));
      CHECK(r.info.time.gaps == 0);
    }
  }
}

TEST_CASE("rows missing at random are gaps, however many, rows missing at pauses too") {
  std::mt19937_64 random(9);
  for (const double share : {0.03, 0.1, 0.3, 0.5, 0.7}) {
    std::vector<std::int64_t> t;
    for (int i = 0; i < 20000; ++i)
      if (static_cast<double>(random() % 1000) >= 1000 * share) t.push_back(i * 10);
    const Recording r = read_text(log_of(t, "t_ms"));
    INFO(share);
    CHECK(r.info.time.rate_hz == Approx(100).epsilon(1e-6));
    CHECK(static_cast<double>(r.info.time.missing_samples) == Approx(20000 * share).epsilon(0.1));
  }
  std::vector<std::int64_t> pauses;
  for (int i = 0; i < 20000; ++i) pauses.push_back(i * 10 + i / 200 * 1013);  // 2 s, then a pause
  CHECK(read_text(log_of(pauses, "t_ms")).info.time.rate_hz == Approx(100).epsilon(1e-3));
}

TEST_CASE("stamps that say two rates are refused with both, and the rate given decides") {
  std::mt19937_64 random(4);
  std::vector<std::int64_t> t{0};
  for (int i = 0; i < 3000; ++i) t.push_back(t.back() + (random() % 5 == 0 ? 12500 : 5000));
  const std::string said = failure(log_of(t));
  INFO(said);
  CHECK(said.find("E0324") != std::string::npos);
  CHECK(said.find("200 Hz") != std::string::npos);
  CHECK(said.find("`rate_hz` 200 or `rate_hz` ") != std::string::npos);
  const double over_time = std::stod(said.substr(said.rfind("`rate_hz` ") + 10));
  ReadOptions options;
  options.rate_hz = over_time;
  CHECK(read_text(log_of(t), options).info.time.rate_hz == Approx(over_time).epsilon(0.03));
  options.rate_hz = 200;
  CHECK(read_text(log_of(t), options).info.time.rate_hz == Approx(200).epsilon(0.1));
}

TEST_CASE("what a logger that hung writes at once is placed on the grid") {
  std::mt19937_64 random(11);
  for (const double rate : {10.0, 100.0, 400.0})
    for (const double longest : {0.5, 2.0})
      for (const std::int64_t tick : {1, 1000}) {
        std::vector<std::int64_t> t;
        double written = 0, hangs = 4e6;
        for (int i = 0; i < 12000; ++i) {
          const double sampled = 1e6 * i / rate;
          if (sampled > hangs && i + 3 * rate < 12000) {
            written = sampled + 1e6 * longest * (0.5 + 0.5 * static_cast<double>(random() % 1000) / 1000);
            hangs = written + 1e6 * (6 + static_cast<double>(random() % 8));
          }
          written = std::max(sampled + static_cast<double>(random() % 100), written + 150);
          t.push_back(static_cast<std::int64_t>(written) / tick * tick);
        }
        INFO(rate << " Hz, hangs of up to " << longest << " s, stamps in " << tick << " us");
        const Recording r = read_text(log_of(t));
        CHECK(r.info.time.rate_hz == Approx(rate).epsilon(1e-3));
        CHECK(r.info.time.gaps == 0);
        CHECK(r.info.rows_dropped == 0);
        CHECK(r.info.samples == 12000);
        if (longest * rate > 16) CHECK(count(r, "late_stamp") > 1);
      }
}

TEST_CASE("what a logger lost when it hung is a gap in front of what it kept") {
  auto t = even(4000, 10000);
  for (std::size_t i = 2000; i < 2100; ++i) t[i] = 21000000 - 20 * static_cast<std::int64_t>(2100 - i);
  t.erase(t.begin() + 2000, t.begin() + 2060);
  const Recording r = read_text(log_of(t));
  CHECK(r.info.time.rate_hz == Approx(100).epsilon(1e-4));
  CHECK(r.info.time.gaps == 1);
  CHECK(r.info.time.missing_samples == 60);
  CHECK(r.info.samples == 4000);
}

TEST_CASE("a lone first row in front of a gap longer than the log is left out and said") {
  for (const std::size_t rows : {std::size_t{200}, std::size_t{30000}}) {
    auto t = even(rows, 10000, static_cast<std::int64_t>(rows) * 15000 + 7000000);
    t.insert(t.begin(), 7000000);
    const Recording r = read_text(log_of(t));
    CHECK(r.info.time.rate_hz == Approx(100).epsilon(1e-9));
    CHECK(r.info.time.gaps == 0);
    CHECK(r.info.rows_dropped == 1);
    CHECK(count(r, "wild_stamp") == 1);
  }
}

TEST_CASE("a clock that begins again is refused with options that read it") {
  auto t = even(3000, 1000);
  const auto again = even(2000, 1000);
  t.insert(t.end(), again.begin(), again.end());
  const std::string said = failure(log_of(t));
  CHECK_THAT(said, Catch::Contains("two logs in one file, or a device that restarted"));
  ReadOptions part, all;
  part.to_s = std::stod(said.substr(said.find("`to_s` ") + 7));
  const Recording first = read_text(log_of(t), part);
  CHECK(first.info.samples == 2999);
  CHECK(first.info.time.rate_hz == Approx(1000));
  all.time_column = "none";
  all.rate_hz = std::stod(said.substr(said.find("`rate_hz` ") + 10));
  CHECK(read_text(log_of(t), all).info.samples == 5000);
}

TEST_CASE("of a slow channel among fast ones the rows with a value count") {
  std::string text = "t,fast,slow\n";
  for (int i = 0; i < 20000; ++i)
    text += fmt::format("{:.3f},{},{}\n", i * 0.005, i % 5, i % 200 == 0 ? fmt::to_string(i / 200) : "");
  ReadOptions options;
  options.channels = {"slow"};
  const Recording alone = read_text(text, options);
  CHECK(alone.info.time.rate_hz == Approx(1));
  CHECK(alone.info.samples == 100);
  CHECK(count(alone, "own_rows") == 19900);
  const Recording both = read_text(text);
  CHECK(both.info.time.rate_hz == Approx(200));
  CHECK(count(both, "slow_channel") == 1);
}

TEST_CASE("a channel among others has a clock of its own by its steps, not by its first two values") {
  std::mt19937 random(3);
  const auto share = [&] { return static_cast<double>(random()) / 4294967296.0; };
  struct Kind {
    const char* what;
    bool own;
    std::function<bool(int)> there;
  };
  int next = 0;
  const std::vector<Kind> kinds = {
      {"one blank in the second row", false, [](int i) { return i != 1; }},
      {"half missing at random", false, [&](int) { return share() < 0.5; }},
      {"nine of ten missing at random", false, [&](int) { return share() < 0.1; }},
      {"two of three", false, [](int i) { return i % 3 != 2; }},
      {"the second value lost", true, [](int i) { return i % 100 == 0 && i != 100; }},
      {"a sixth of the values lost", true, [&](int i) { return i % 20 == 0 && share() > 0.17; }},
      {"30 Hz in rows of 100", true, [](int i) { return i % 10 == 0 || i % 10 == 3 || i % 10 == 7; }},
      {"late by up to a fifth", true,
       [&](int i) {
         if (i < next) return false;
         next = i + 80 + static_cast<int>(40 * share());
         return true;
       }},
  };
  for (const Kind& kind : kinds) {
    std::string text = "t[s],fast,slow\n";
    for (int i = 0; i < 12000; ++i)
      text += fmt::format("{:.2f},{},{}\n", 0.01 * i, i % 7, kind.there(i) ? fmt::to_string(i % 11) : "");
    INFO(kind.what);
    CHECK(count(read_text(text), "slow_channel") == (kind.own ? 1U : 0U));
    ReadOptions alone;
    alone.channels = {"slow"};
    CHECK((count(read_text(text, alone), "own_rows") > 0) == kind.own);
  }
}

TEST_CASE("of the fast channel of an outer join the rows of the others are no missing samples") {
  std::string text = "t[s],fast,slow\n";
  for (int i = 0; i < 4000; ++i) {
    text += fmt::format("{:.4f},{},\n", 0.01 * i, i % 7);
    if (i % 12 == 0) text += fmt::format("{:.4f},,{}\n", 0.01 * i + 0.0031, i % 11);
  }
  const Recording joined = read_text(text);
  CHECK(count(joined, "slow_channel") == 2);
  CHECK(std::stod(joined.info.warnings.find("slow_channel")->help.back().options.front().value) ==
        Approx(100.0 / 12).epsilon(0.01));
  ReadOptions alone;
  alone.channels = {"fast"};
  const Recording fast = read_text(text, alone);
  CHECK(fast.info.time.rate_hz == Approx(100));
  CHECK(fast.info.samples == 4000);
}

TEST_CASE("rows of a slow channel between those of a fast one do not change its rate, however few they are") {
  for (const int apart : {20, 200, 1000}) {
    std::string text = "t[s],fast,slow\n";
    for (int i = 0; i < 20000; ++i) {
      text += fmt::format("{:.4f},{},\n", 0.005 * i, i % 7);
      if (i % apart == 3) text += fmt::format("{:.4f},,{}\n", 0.005 * i + 0.0013, i % 11);
    }
    INFO("one in " << apart);
    ReadOptions alone;
    alone.channels = {"fast"};
    const Recording fast = read_text(text, alone);
    CHECK(fast.info.time.rate_hz == Approx(200).epsilon(1e-4));
    CHECK(fast.info.samples == 20000);
    CHECK(count(read_text(text), "slow_channel") == 2);
  }
}

TEST_CASE("samples that are missing now and then are missing samples, no clock of their own") {
  std::mt19937 random(5);
  std::string text = "t[s],x\n";
  for (int i = 0; i < 20000; ++i)
    text += fmt::format("{:.5f},{}\n", 0.005 * i + 1e-9 * static_cast<double>(random() % 1000000),
                        i % 200 == 3 ? "" : fmt::to_string(i % 7));
  const Recording r = read_text(text);
  CHECK(r.info.samples == 20000);
  CHECK(count(r, "own_rows") == 0);
}

TEST_CASE("a clock of whole seconds says the rate from step to step, in short logs too") {
  for (const int seconds : {5, 10, 30, 100}) {
    const int rows = 300 * seconds;
    std::string text = "t[s],x\n";
    for (int i = 0; i < rows; ++i) text += fmt::format("{},{}\n", 100 + (i + 130) / 300, i % 7);
    const Recording r = read_text(text);
    INFO(seconds);
    CHECK(r.info.time.rate_hz == Approx(300).epsilon(1e-3));
    CHECK(r.info.samples == static_cast<std::uint64_t>(rows));
  }
}

TEST_CASE("a log that begins and ends in a packet has the rate of its packets") {
  std::string text = "t[ms],x\n";
  for (int i = 0; i < 600; ++i) text += fmt::format("{:.3f},{}\n", (i / 10 * 10 + 9) * 9.6, i * 7919 % 1000);
  const Recording r = read_text(text);
  CHECK(r.info.time.rate_hz == Approx(1000 / 9.6).epsilon(1e-4));
  CHECK(count(r, "uneven_sampling") == 0);
}
