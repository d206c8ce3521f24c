#include "libchar/log/time/stamp_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <random>

#include "libchar/log/time/delays/clock_behind.hpp"
#include "tests/log/log_text.hpp"

using namespace libchar;

TEST_CASE("two rates in a row: where the one ends and the other begins") {
  std::vector<double> rows, instants;
  for (int i = 0; i < 3000; ++i) {
    rows.push_back(i);
    instants.push_back(i < 1367 ? 25.0 * i : 25.0 * 1367 + 40.0 * (i - 1367));
  }
  const auto change = find_rate_change(rows, instants);
  REQUIRE(change);
  CHECK(change->row == Approx(1367));
  CHECK(change->before_ns == Approx(25));
  CHECK(change->after_ns == Approx(40));
  for (int i = 0; i < 3000; ++i) instants[i] = i + 2e-5 * i * i;  // a drift has no such place
  CHECK_FALSE(find_rate_change(rows, instants));
}

TEST_CASE("rows missing at random stand on a lattice, whatever their jitter") {
  std::uint64_t state = 1;
  const auto random = [&] { return state = state * 6364136223846793005U + 1442695040888963407U; };
  std::vector<std::int64_t> stamps;
  for (std::int64_t i = 0; stamps.size() < 1025; ++i)
    if ((random() >> 40U) % 10 < 4)
      stamps.push_back(10000000 * i + static_cast<std::int64_t>((random() >> 40U) % 1500000));
  const StampModel found = model_of_stamps(stamps);
  CHECK(found.ns == Approx(1e7).epsilon(1e-3));
  CHECK(found.pattern == StampPattern::steps);
}

TEST_CASE("three rows of ten that are missing again and again are gaps, as exactly as steps are alike") {
  std::uint64_t state = 1;
  const auto random = [&] { return state = state * 6364136223846793005U + 1442695040888963407U; };
  std::vector<std::int64_t> stamps;
  for (std::int64_t i = 0; stamps.size() < 1025; ++i)
    if (i % 10 > 2) stamps.push_back(5000000 * i + static_cast<std::int64_t>((random() >> 40U) % 60000));
  const StampModel found = model_of_stamps(stamps);
  CHECK(found.ns == Approx(5e6).epsilon(1e-4));
  CHECK(found.pattern == StampPattern::steps);
}

TEST_CASE("rows missing in long gaps of any length are no packets") {
  std::uint64_t state = 1;
  const auto random = [&] { return state = state * 6364136223846793005U + 1442695040888963407U; };
  int wrong = 0;
  for (int record = 0; record < 50; ++record)
    for (const std::uint64_t run : {4U, 10U}) {
      std::vector<std::int64_t> stamps;
      for (std::int64_t i = 0; stamps.size() < 1025;) {
        // Runs and gaps of geometric lengths: 10 rows are missing on average.
        for (bool more = true; more; more = (random() >> 40U) % run != 0) stamps.push_back(10000000 * i++);
        for (bool more = true; more; more = (random() >> 40U) % 10 != 0) ++i;
      }
      const StampModel found = model_of_stamps(stamps);
      wrong += found.ns != Approx(1e7) || found.pattern != StampPattern::steps;
    }
  CHECK(wrong <= 3);  // 1 of 100 is expected
}

TEST_CASE("stamps of today in nanoseconds keep their last digit") {
  std::vector<std::int64_t> stamps;
  for (std::int64_t i = 0; i < 300; ++i) stamps.push_back(4611686018427387000 + 7 * i);
  CHECK(model_of_stamps(stamps).ns == 7);
}

TEST_CASE("steps of unlike length in turns are no gaps") {
  std::vector<std::int64_t> stamps{0};
  for (int i = 0; i < 1000; ++i) stamps.push_back(stamps.back() + (i % 2 == 0 ? 280 : 720));
  const StampModel turns = model_of_stamps(stamps);
  CHECK(turns.ns == Approx(500));
  CHECK(turns.pattern == StampPattern::uneven);
  stamps = {0};
  for (int i = 0; i < 1000; ++i) stamps.push_back(stamps.back() + (i % 5 < 3 ? 101 : i % 5 == 3 ? 126 : 121));
  stamps.insert(stamps.end(), {});
  for (std::size_t i = 500; i < stamps.size(); ++i) stamps[i] += 30000000;
  CHECK(model_of_stamps(stamps).ns == Approx(110).epsilon(1e-3));
}

TEST_CASE("stamps that rise at all have an interval, however many are equal") {
  std::vector<std::int64_t> stamps(16, 0);
  for (const std::int64_t later : {1000, 2000, 3000, 4000}) stamps.push_back(later);
  const StampModel found = model_of_stamps(stamps);
  CHECK(found.ns == 1000);
  CHECK(found.longest_step >= found.ns);
  CHECK(found.pattern == StampPattern::equal);
}

TEST_CASE("of a short log on a coarse clock the interval is that of rows over time") {
  // 4.2 ticks: steps of 4 and, one in five, of 5.
  std::vector<std::int64_t> stamps{0};
  for (int i = 0; i < 40; ++i) stamps.push_back(stamps.back() + (i % 5 == 4 ? 5000000 : 4000000));
  const StampModel found = model_of_stamps(stamps);
  CHECK(found.ns == Approx(4.2e6).epsilon(0.002));
  CHECK(found.step_ns == 4e6);
  CHECK(found.longest_step > 5e6);
}

TEST_CASE("in a longer log two rounded stamps may be up to two ticks apart from one line") {
  // The same clock, and now and then a step of 5 comes early and the next one late: 1.6 ticks from end to end.
  const auto found = [](int groups) {
    std::vector<std::int64_t> stamps{0};
    for (int g = 0; g < groups; ++g)
      for (int i = 0; i < 5; ++i)
        stamps.push_back(stamps.back() + (i == (2 * g >= groups && 2 * g < groups + 2 ? 0 : 4) ? 5000000 : 4000000));
    return model_of_stamps(stamps).ns;
  };
  CHECK(found(16) == Approx(4.2e6).epsilon(0.002));  // sixteen odd steps
  CHECK(found(10) == Approx(4.2e6).epsilon(0.002));
}

namespace {

/// A sensor of 1 Hz, of whose rows some are lost at random, still has that interval.
void check_whole_seconds(double share_lost, std::size_t rows) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937_64 random(seed);
    std::bernoulli_distribution lost(share_lost);
    std::vector<std::int64_t> stamps;
    for (int i = 0; stamps.size() < rows; ++i)
      if (!lost(random)) stamps.push_back(std::int64_t{1000000000} * i);
    INFO(seed);
    CHECK(model_of_stamps(stamps).ns == Approx(1e9).epsilon(1e-6));
  }
}

}  // namespace

TEST_CASE("samples that beat with the clock's step are no missing ones, and lost samples are no beat") {
  for (const double interval : {1.0102, 1.007, 0.992, 1.018}) {
    std::mt19937_64 random(3);
    std::normal_distribution<double> late(0, 0.01);
    std::vector<std::int64_t> stamps;
    for (int i = 0; i < 1025; ++i)
      stamps.push_back(1000000000 * static_cast<std::int64_t>(std::floor(0.3 + interval * i + late(random))));
    INFO(interval);
    CHECK(model_of_stamps(stamps).ns == Approx(1e9 * interval).epsilon(5e-4));
  }
  std::vector<std::int64_t> hundredth;  // of 50 Hz each hundredth row is lost
  for (int i = 0; hundredth.size() < 1025; ++i)
    if (i % 100 != 5) hundredth.push_back(std::int64_t{20000000} * i);
  CHECK(model_of_stamps(hundredth).ns == Approx(2e7).epsilon(1e-6));
  check_whole_seconds(0.012, 1025);
}

TEST_CASE("an interval that drifts beats with whole seconds, too") {
  std::mt19937_64 random(5);
  std::normal_distribution<double> late(0, 0.01);
  std::vector<std::int64_t> stamps;
  double at = 0.3;
  for (int i = 0; i < 16385; ++i) {
    stamps.push_back(1000000000 * static_cast<std::int64_t>(std::floor(at + late(random))));
    at += 1.0263 - 0.0028 * i / 16385 + 0.0004 * std::sin(i * 1e-3);
  }
  CHECK(model_of_stamps(stamps).ns == Approx(1.0249e9).epsilon(1e-3));
  check_whole_seconds(0.025, 16385);
}

TEST_CASE("few rows lost at random stay missing where chance keeps them near a line") {
  int wrong = 0;
  for (unsigned seed = 1; seed <= 400; ++seed) {
    std::mt19937_64 random(seed);
    std::bernoulli_distribution lost(0.03);
    std::vector<std::int64_t> stamps;
    for (int i = 0; stamps.size() < 600; ++i)
      if (!lost(random)) stamps.push_back(std::int64_t{1000000000} * i);
    wrong += std::fabs(model_of_stamps(stamps).ns - 1e9) > 1e6;
  }
  CHECK(wrong <= 4);
}

// The even clock behind stamps that come late, some of whose rows are lost.

namespace {

using Delay = std::function<double(std::mt19937_64&)>;  // in intervals

std::vector<std::int64_t> late_stamps(const Delay& delay, double loss, unsigned seed, int rows = 1200) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> any;
  std::vector<std::int64_t> out;
  for (int k = 0; k < rows; ++k) {
    if (any(random) < loss) continue;
    const auto stamp = static_cast<std::int64_t>(1e7 * (k + delay(random)));
    out.push_back(out.empty() ? stamp : std::max(stamp, out.back() + 1000));
  }
  return out;
}

std::vector<std::int64_t> renewed(const Delay& step, unsigned seed) {
  std::mt19937_64 random(seed);
  std::vector<std::int64_t> out = {0};
  for (int k = 0; k < 1200; ++k) out.push_back(out.back() + static_cast<std::int64_t>(1e7 * step(random)));
  return out;
}

const Delay kExponential = [](std::mt19937_64& random) {
  return 0.3 * std::exponential_distribution<double>()(random);
};
const Delay kLong = [](std::mt19937_64& random) { return 0.6 * std::exponential_distribution<double>()(random); };
const Delay kHalfNormal = [](std::mt19937_64& random) {
  return std::fabs(std::normal_distribution<double>(0, 0.3)(random));
};

std::string late_table(const std::vector<std::int64_t>& stamps) {
  std::string text = "time [s],x\n";
  for (std::size_t i = 0; i < stamps.size(); ++i)
    text += fmt::format("{:.6f},{}\n", static_cast<double>(stamps[i]) / 1e9, i * i % 17);
  return text;
}

}  // namespace

TEST_CASE("the clock behind late stamps is found whatever is lost, from an interval that is off") {
  for (const Delay& delay : {kExponential, kLong, kHalfNormal})
    for (const double loss : {0.0, 0.02, 0.08, 0.2})
      for (unsigned seed = 0; seed < 4; ++seed)
        for (const double off : {0.95, 1.15}) {
          const EvenClock found = clock_behind(late_stamps(delay, loss, seed), 1e7 * off);
          CHECK(found.needed);
          REQUIRE(found.ns);
          CHECK(*found.ns == Approx(1e7).epsilon(3e-4));
        }
}

TEST_CASE("stamps without an even clock have none behind them, tidy ones need none") {
  const Delay poisson = [](std::mt19937_64& random) { return std::exponential_distribution<double>()(random); };
  const Delay sleeps = [](std::mt19937_64& random) { return std::normal_distribution<double>(1, 0.2)(random); };
  const Delay uniform = [](std::mt19937_64& random) {
    return std::uniform_real_distribution<double>(0.2, 1.8)(random);
  };
  for (unsigned seed = 0; seed < 20; ++seed)
    for (const Delay& step : {poisson, sleeps, uniform}) {
      const EvenClock found = clock_behind(renewed(step, seed), 1e7);
      CHECK(found.needed);
      CHECK_FALSE(found.ns);
    }
  const Delay none = [](std::mt19937_64&) { return 0.0; };
  const Delay little = [](std::mt19937_64& random) { return std::uniform_real_distribution<double>(0, 0.2)(random); };
  for (const Delay& delay : {none, little}) CHECK_FALSE(clock_behind(late_stamps(delay, 0.1, 1), 1e7).needed);
}

TEST_CASE("rates of logs with late stamps and lost rows are right to a thousandth") {
  for (const Delay& delay : {kExponential, kLong, kHalfNormal})
    for (const double loss : {0.0, 0.02, 0.08, 0.2})
      for (unsigned seed = 10; seed < 14; ++seed)
        CHECK(test::read_text(late_table(late_stamps(delay, loss, seed, 4000))).info.time.rate_hz ==
              Approx(100).epsilon(1e-3));
}

TEST_CASE("rows lost in packets of one stamp are missing samples at the rate of whole packets") {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> any;
  for (const auto& [rows, lost, jitter] :
       {std::tuple{10, 0.05, 0.0}, {10, 0.1, 0.0}, {4, 0.05, 0.0}, {8, 0.02, 0.0}, {10, 0.1, 0.02}}) {
    std::string text = "time [s],x\n";
    int there = 0;
    double packet = 0;
    for (int k = 0; k < 4000; ++k) {
      if (k % rows == 0) packet = k * 0.01 + rows * 0.01 * jitter * any(random);
      const bool is_there = k < rows || any(random) > lost;
      if (is_there) text += fmt::format("{:.4f},{}\n", packet, k * k % 17);
      there += is_there;
    }
    INFO(rows << " " << lost << " " << jitter);
    const Recording r = test::read_text(text);
    CHECK(r.info.time.rate_hz == Approx(100).epsilon(1e-3));
    CHECK(static_cast<double>(r.info.time.missing_samples) == Approx(4000 - there).margin(rows));
    CHECK(test::count(r, "packets") == 1);
    ReadOptions over_time;
    over_time.rate_hz = there / 40.0;
    if (jitter == 0) CHECK(test::read_text(text, over_time).info.time.missing_samples == 0);
  }
}

TEST_CASE("numbers of rows that beat with a coarse clock are no losses, and few losses are decided by the told rate") {
  std::string whole = "time [s],x\n", coarse = whole, few = whole;
  for (int k = 0; k < 4000; ++k) {
    const std::string row = fmt::format("{:.3f},{}\n", k / 10 * 0.1, k * k % 17);
    whole += row;
    if (k < 400 && (k < 123 || k > 127)) few += row;
    coarse += fmt::format("{:.1f},{}\n", std::floor(k * 0.0107 * 10) / 10, k * k % 17);
  }
  CHECK(test::read_text(whole).info.time.missing_samples == 0);
  const Recording beats = test::read_text(coarse);
  CHECK(beats.info.time.missing_samples == 0);
  CHECK(beats.info.time.rate_hz == Approx(1 / 0.0107).epsilon(1e-3));
  CHECK(test::count(beats, "uneven_sampling") == 0);
  // A link whose packets have 7 rows and now and then 6, and lose a whole one at times: no rate of 9 Hz.
  std::mt19937_64 random(7);
  std::bernoulli_distribution lost(0.02);
  std::string polled = "time [s],x\n";
  double last = -1;
  bool dropped = false;
  for (int k = 0; k < 4000; ++k) {
    const double packet = std::ceil(k / 8.13) * 1.0;
    if (packet > last) dropped = k > 0 && lost(random);
    last = packet;
    if (!dropped) polled += fmt::format("{:.3f},{}\n", packet, k * k % 17);
  }
  CHECK(test::read_text(polled).info.time.rate_hz == Approx(8.13).epsilon(0.03));
  CHECK(test::read_text(few).info.warnings.find("uneven_sampling")->sentence.find("`rate_hz` 100") !=
        std::string::npos);
  ReadOptions told;
  told.rate_hz = 100;
  const Recording r = test::read_text(few, told);
  CHECK(r.info.time.rate_hz == Approx(100));
  CHECK(r.info.time.missing_samples == 5);
}

TEST_CASE("rows that keep no even clock are said to be uneven") {
  std::size_t said = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    const auto stamps = renewed([](auto& random) { return std::exponential_distribution<double>()(random); }, seed);
    said += test::count(test::read_text(late_table(stamps)), "uneven_sampling");
  }
  CHECK(said >= 19);  // of the seeds one looks like packets, which is said too
}
