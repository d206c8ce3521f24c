// What the values of a slow reference stand for is declared, or read off the sensors.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "libchar/replay/detail/align/reference_track.hpp"
#include "libchar/replay/replay.hpp"
#include "tests/replay/replay_numbers.hpp"
#include "tests/replay/scene_text.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;
using Catch::Contains;

namespace {

constexpr int kPerInterval = 8, kIntervals = 400;

double slow_motion(double k) { return 3 * std::sin(0.11 * k) + 2 * std::sin(0.047 * k + 1) + std::sin(0.19 * k + 2); }

double mean_of_motion(double from) {
  double sum = 0;
  for (int k = 0; k < kPerInterval; ++k) sum += slow_motion(from + k);
  return sum / kPerInterval;
}

double reference_value(const std::string& samples, double stamp) {
  if (samples == "instant") return slow_motion(stamp);
  return mean_of_motion(stamp + kPerInterval * interval_start(samples));
}

// `late`: the sensors, in samples.
void put_slow(const test::SceneBench& bench, const std::string& samples, double late = 0) {
  test::Gaussian gauss(21);
  std::string sensors = "t[s],a,b,c\n", reference = "t[s],r\n";
  for (int k = 0; k < kPerInterval * kIntervals; ++k)
    sensors += fmt::format("{},{},{},{}\n", 0.01 * k, slow_motion(k - late) + 0.05 * gauss(),
                           slow_motion(k - late) + 0.4 + 0.05 * gauss(), slow_motion(k - late) + 0.1 * gauss());
  for (int j = 2; j < kIntervals - 2; ++j)
    reference +=
        fmt::format("{},{}\n", 0.01 * kPerInterval * j, reference_value(samples, kPerInterval * j) + 0.01 * gauss());
  bench.put("sensors.csv", sensors);
  bench.put("slow.csv", reference);
}

ReplayResult run_slow(const test::SceneBench& bench, const std::string& more) {
  return replay(
      bench.read("format: scene\nversion: 1\nrecording: sensors.csv\nsensors: [a, b, c]\n"
                 "reference: {channels: [r], recording: slow.csv" +
                 more + "}\n"));
}

double best_of(const ReplayResult& result) { return result.algorithms[*result.best].rmse; }

}  // namespace

TEST_CASE("slow reference: each of the four readings is told from the others by the sensors") {
  for (const std::string_view one : SceneReference::kReadings) {
    const std::string samples(one);
    INFO(samples);
    test::SceneBench bench;
    put_slow(bench, samples);
    const ReplayResult declared = run_slow(bench, ", samples: " + samples), estimated = run_slow(bench, "");
    CHECK(best_of(declared) < 0.04);
    CHECK(best_of(estimated) <= 1.05 * best_of(declared));
    CHECK(estimated.rate_hz == declared.rate_hz);
    CHECK_THAT(estimated.reference_use, Contains(samples == "instant" ? "its values are samples" : samples));
    CHECK(declared.reference_use.find("likelihood") == std::string::npos);
    for (const std::string_view other : SceneReference::kReadings)
      if (other != one) CHECK(best_of(run_slow(bench, ", samples: " + std::string(other))) > 1.2 * best_of(estimated));
  }
}

TEST_CASE("slow reference: its lag is estimated with the reading") {
  test::SceneBench bench;
  put_slow(bench, "mean_after", 5);
  const ReplayResult found = run_slow(bench, ", lag_s: estimate");
  CHECK(found.lag_estimated);
  CHECK(found.lag_s == Approx(0.05).margin(0.006));
  CHECK(best_of(found) <= 1.05 * best_of(run_slow(bench, ", samples: mean_after, lag_s: 0.05")));
  put_slow(bench, "instant", -3);
  const ReplayResult sampled = run_slow(bench, ", samples: instant, lag_s: estimate");
  CHECK(sampled.lag_s == Approx(-0.03).margin(0.006));
  CHECK(best_of(sampled) < 0.05);
}

TEST_CASE("slow reference: the lag of one that samples is not one of whole samples of the sensors") {
  for (const double late : {-2.4, 1.5, 2.6}) {
    INFO(late);
    test::SceneBench bench;
    put_slow(bench, "instant", late);
    const ReplayResult found = run_slow(bench, ", lag_s: estimate");
    CHECK(found.lag_s == Approx(0.01 * late).margin(0.0002));
  }
}
