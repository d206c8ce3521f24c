#include "libchar/replay/detail/align/instants.hpp"

#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>

#include "libchar/core/error.hpp"
#include "libchar/replay/detail/align/resampled.hpp"
#include "libchar/replay/detail/plan/sensor_knowledge.hpp"
#include "tests/replay/scene_text.hpp"

using namespace libchar;

namespace {

const std::string kHead = "format: scene\nversion: 1\n";

struct Columns {
  Eigen::MatrixXd samples, truth;
  std::vector<Eigen::Index> sizes;
};

Columns all_of(const Instants& instants, std::int64_t from, std::int64_t to, std::size_t size) {
  Columns out;
  out.samples.resize(static_cast<Eigen::Index>(instants.info().units.size()), 0);
  instants.pass(from, to, size, no_progress(), [&](const InstantBlock& b) {
    CHECK(b.first == from + out.samples.cols());
    const Eigen::Index old = out.samples.cols();
    out.samples.conservativeResize(Eigen::NoChange, old + b.samples.cols());
    out.samples.rightCols(b.samples.cols()) = b.samples;
    out.truth.conservativeResize(b.truth.rows(), old + b.truth.cols());
    out.truth.rightCols(b.truth.cols()) = b.truth;
    out.sizes.push_back(b.samples.cols());
  });
  return out;
}

std::string numbered(std::size_t rows, double rate_hz) {
  std::string text = "t[s],a[deg/s],b[deg/s],x[deg/s]\n";
  for (std::size_t k = 0; k < rows; ++k)
    text += std::to_string(static_cast<double>(k) / rate_hz) + "," + std::to_string(k) + "," + std::to_string(2 * k) +
            "," + std::to_string(100 + k) + "\n";
  return text;
}

}  // namespace

TEST_CASE("instants: a short text is parsed once, a longer one and other logs again for each pass") {
  const test::SceneBench bench;
  const auto without_its_file = [&](std::size_t rows) {
    bench.put("log.csv", numbered(rows, 10));
    const Scene scene = bench.read(kHead + "recording: log.csv\nsensors: [{name: a, scale: -0.5}, b]\nreference: x\n");
    const Instants instants(scene, no_progress());
    const auto count = instants.info().count;
    const Columns before = all_of(instants, 0, count, 1000);
    std::filesystem::remove(bench.path("log.csv"));
    CHECK(instants.source().info().kept == (rows <= 1'398'101));  // 2^22 numbers in three columns
    if (!instants.source().info().kept) {
      CHECK_THROWS_AS(all_of(instants, 0, count, 1000), Error);
      return;
    }
    const Columns after = all_of(instants, 0, count, 77);
    CHECK(after.samples == before.samples);
    CHECK(after.truth == before.truth);
    CHECK(all_of(instants, 100, 200, 64).samples == before.samples.middleCols(100, 100));
  };
  without_its_file(20'000);
  without_its_file(1'398'102);
}

TEST_CASE("instants: columns of the recording in blocks of the size that was asked for") {
  const test::SceneBench bench;
  bench.put("log.csv", numbered(1000, 10));
  const Scene scene = bench.read(kHead +
                                 "recording: log.csv\nsensors: [{name: a, scale: -0.5}, b]\n"
                                 "reference: x\n");
  Instants instants(scene, no_progress());
  CHECK(instants.info().rate_hz == Approx(10).epsilon(1e-9));
  CHECK(instants.info().count == 1000);
  CHECK(instants.info().units == std::vector<std::string>{"deg/s (× -0.5)", "deg/s"});
  const Columns whole = all_of(instants, 0, 1000, 4096);
  REQUIRE(whole.samples.cols() == 1000);
  CHECK(whole.samples(0, 7) == -3.5);
  CHECK(whole.samples(1, 7) == 14);
  CHECK(whole.truth(0, 7) == 107);
  for (const std::size_t size : {1, 7, 100, 333}) {
    const Columns part = all_of(instants, 13, 777, size);
    CHECK(part.samples == whole.samples.middleCols(13, 764));
    CHECK(part.truth == whole.truth.middleCols(13, 764));
    for (std::size_t b = 0; b + 1 < part.sizes.size(); ++b) CHECK(part.sizes[b] == static_cast<Eigen::Index>(size));
  }
  instants.set_offsets({1, 2});
  CHECK(all_of(instants, 7, 8, 1).samples(1, 0) == 12);
}

TEST_CASE("instants: times in seconds are instants at or after them") {
  const test::SceneBench bench;
  bench.put("log.csv", numbered(1000, 10));
  const Scene scene = bench.read(kHead + "recording: log.csv\nsensors: [a, b]\n");
  const Instants instants(scene, no_progress());
  CHECK(instants.instant_at(0) == 0);
  CHECK(instants.instant_at(0.3) == 3);
  CHECK(instants.instant_at(0.31) == 4);
  CHECK(instants.instant_at(1e9) == 1000);
  CHECK(instants.instant_at(std::numeric_limits<double>::infinity()) == 1000);
}

TEST_CASE("instants: faults of the scene are injected, whatever window is read") {
  const test::SceneBench bench;
  bench.put("log.csv", numbered(1000, 10));
  const Scene scene = bench.read(kHead +
                                 "recording: log.csv\nsensors: [a, b]\nfaults: [{sensor: b, kind: stuck, from_s: 20, "
                                 "to_s: 30}, {sensor: a, kind: bias, value: 1000, from_s: 50}]\n");
  const Instants instants(scene, no_progress());
  const Columns columns = all_of(instants, 250, 600, 64);
  CHECK(columns.samples(1, 0) == 2 * 199);
  CHECK(columns.samples(1, 49) == 2 * 199);
  CHECK(columns.samples(1, 50) == 600);
  CHECK(columns.samples(0, 249) == 499);
  CHECK(columns.samples(0, 250) == 1500);
}

TEST_CASE("instants: a simulation is the same in every pass") {
  const test::SceneBench bench;
  const Scene scene = bench.read(kHead +
                                 "simulate: {rate_hz: 100, samples: 5000, seed: 3, truth: [{kind: sine, name: x}, "
                                 "{kind: sine, name: y, frequency_hz: 3}]}\nsensors: [{name: a, model: "
                                 "gyro.sensor.yaml, h: [1, 0]}, {name: b, model: none, h: [0, 1]}]\nreference: [y]\n");
  const Instants instants(scene, no_progress());
  const Columns first = all_of(instants, 0, 5000, 1000), second = all_of(instants, 0, 5000, 777);
  CHECK(first.samples == second.samples);
  CHECK(first.truth.rows() == 1);
  CHECK(first.truth == first.samples.row(1));
}

TEST_CASE("instants: a slow reference is compared with means over its intervals") {
  const test::SceneBench bench;
  // Samples at 1 Hz from stamp 5; a reference every 10 s from stamp 0.
  std::string log = "t[s],a,b\n", station = "t[s],x\n";
  for (int k = 0; k < 100; ++k) {
    const int t = 5 + k;
    const bool missing = t >= 40 && t < 46;
    log += std::to_string(t) + "," + std::to_string(t) + "," + (missing ? "" : "1") + "\n";
  }
  for (int j = 0; j < 20; ++j) station += std::to_string(10 * j) + "," + (j == 2 ? "" : std::to_string(7 * j)) + "\n";
  bench.put("log.csv", log);
  bench.put("station.csv", station);
  const Scene scene =
      bench.read(kHead + "recording: log.csv\nsensors: [a, b]\nreference: {channels: [x], recording: station.csv}\n");
  const Instants instants(scene, no_progress());
  CHECK(instants.info().averaged == 10);
  CHECK(instants.info().rate_hz == Approx(0.1));
  CHECK(instants.info().start_s == Approx(5));  // stamp 10, the first whole interval
  CHECK(instants.info().count == 9);            // 10…20, …, 90…100
  const Columns columns = all_of(instants, 0, 9, 4);
  REQUIRE(columns.samples.cols() == 9);
  CHECK(columns.samples(0, 0) == 14.5);
  CHECK(columns.samples(0, 8) == 94.5);
  CHECK(columns.truth(0, 0) == 7);
  CHECK(std::isnan(columns.truth(0, 1)));
  CHECK(columns.truth(0, 8) == 63);
  CHECK(std::isnan(columns.samples(1, 3)));  // six of ten are missing
  CHECK(columns.samples(1, 4) == 1);
  const Columns later = all_of(instants, 3, 6, 1);
  CHECK(later.samples(0, 0) == columns.samples(0, 3));
  CHECK(later.samples.cols() == 3);
}

TEST_CASE("instants: reference and recording without a common time are refused") {
  const test::SceneBench bench;
  bench.put("log.csv", "t[s],a\n0,1\n1,1\n2,1\n3,2\n");
  bench.put("station.csv", "t[s],x\n1000,1\n1010,2\n1020,2\n");
  const Scene scene =
      bench.read(kHead + "recording: log.csv\nsensors: [a]\nreference: {channels: [x], recording: station.csv}\n");
  CHECK_THROWS_WITH(Instants(scene, no_progress()), Catch::Contains("E0902"));
}

TEST_CASE("instants: a faster reference, and a lag, are interpolated") {
  const test::SceneBench bench;
  bench.put("log.csv", numbered(100, 10));
  std::string fast = "t[s],x\n";
  for (int j = 0; j < 400; ++j) fast += std::to_string(j * 0.04) + "," + std::to_string(j * 0.04) + "\n";
  bench.put("fast.csv", fast);
  const Scene scene =
      bench.read(kHead + "recording: log.csv\nsensors: [a, b]\nreference: {channels: [x], recording: fast.csv}\n");
  Instants instants(scene, no_progress());
  const Columns columns = all_of(instants, 0, 100, 100);
  for (Eigen::Index k = 0; k < 100; ++k)
    CHECK(columns.truth(0, k) == Approx(0.1 * static_cast<double>(k)).margin(1e-12));
  instants.set_lag(0.25, no_progress());
  const Columns late = all_of(instants, 0, 100, 100);
  CHECK(std::isnan(late.truth(0, 2)));  // before the reference begins
  CHECK(late.truth(0, 10) == Approx(0.75));
  const Scene own =
      bench.read(kHead + "recording: log.csv\nsensors: [a, b]\nreference: {channels: [x], lag_s: 0.05}\n");
  CHECK(all_of(Instants(own, no_progress()), 0, 100, 100).truth(0, 10) == Approx(109.5));
}

TEST_CASE("instants: a tilt is in radians inside, its scores in the unit of the reference") {
  const test::SceneBench bench;
  bench.put("log.csv", "t[s],w[deg/s],x[g],z[g],angle[deg]\n0,180,0,1,90\n1,0,1,1,45\n2,0,1,0,0\n");
  const Scene scene = bench.read(kHead +
                                 "recording: log.csv\nsensors: [w, x, z]\nreference: angle\n"
                                 "tilt: {gyroscope: w, accelerometer_x: x, accelerometer_z: z}\n");
  const Instants instants(scene, no_progress());
  const Columns columns = all_of(instants, 0, 3, 3);
  CHECK(columns.samples(0, 0) == Approx(std::acos(-1.0)));
  CHECK(columns.samples(1, 1) == 1);
  CHECK(columns.truth(0, 0) == Approx(std::acos(-1.0) / 2));
  CHECK(columns.truth(0, 0) * instants.info().output_scale == Approx(90));
  CHECK(instants.info().input_units[0] == "deg");
}

TEST_CASE("rest: offsets and noise, drift hardly in it") {
  RestMeter meter(2);
  Eigen::MatrixXd block(2, 1000);
  for (Eigen::Index k = 0; k < 1000; ++k) {
    block(0, k) = 1e9 + (k % 2 == 0 ? 1.0 : -1.0);
    block(1, k) = k == 500 ? std::nan("") : 1e-3 * static_cast<double>(k);
  }
  meter.push(block.leftCols(301));
  meter.push(block.rightCols(699));
  CHECK(meter.means()[0] == 1e9);
  CHECK(meter.noise_variances()[0] == 2);
  CHECK(meter.noise_variances()[1] == Approx(0.5e-6));
}

TEST_CASE("resampling: a straight line by its stamps, gaps stay") {
  const test::SceneBench bench;
  std::string log = "t[ms],a,b\n";
  double t = 0;
  for (int k = 0; k < 400; ++k) {
    const double ms = 1000 * t;
    log += std::to_string(ms) + "," + std::to_string(3 * ms) + "," + std::to_string(k) + "\n";
    t += k == 200 ? 0.5 : 0.01 * (1 + 0.6 * std::sin(0.1 * k));
  }
  bench.put("log.csv", log);
  const ResampledLog even = read_resampled(bench.path("log.csv"), {}, {"b", "a"}, 50, 2, no_progress());
  REQUIRE(even.samples.size() == 2);
  std::size_t missing = 0;
  for (std::size_t i = 0; i < even.samples[1].size(); ++i) {
    const double a = even.samples[1][i];
    if (std::isnan(a))
      ++missing;
    else
      CHECK(a == Approx(3 * 20.0 * static_cast<double>(i)).margin(1e-4));
  }
  CHECK(missing >= 23);
  CHECK(missing <= 25);
  bench.put("bare.csv", "a,b\n1,2\n2,3\n");
  CHECK_THROWS_WITH(read_resampled(bench.path("bare.csv"), {}, {"a"}, 50, 1, no_progress()), Catch::Contains("E0907"));
}

TEST_CASE("instants: uneven stamps in any unit give the same instants") {
  const test::SceneBench bench;
  const auto resampled = [&](const std::string& column, double seconds) {
    std::string log = column + ",a\n";
    for (int k = 0; k < 302; ++k) log += fmt::format("{:.9f},{}\n", (k + (k % 3) * 0.1) / seconds, k * k % 17);
    bench.put("log.csv", log);
    return read_resampled(bench.path("log.csv"), {}, {"a"}, 2, 1, no_progress()).samples[0];
  };
  const std::vector<double> expected = resampled("time[s]", 1);
  CHECK(expected.size() == 603);  // 301.1 s
  for (const auto& [column, seconds] :
       {std::pair{"time[min]", 60.0}, std::pair{"time[h]", 3600.0}, std::pair{"time[ms]", 1e-3}}) {
    INFO(column);
    const std::vector<double> got = resampled(column, seconds);
    REQUIRE(got.size() == expected.size());
    double worst = 0;
    for (std::size_t i = 0; i < got.size(); ++i) worst = std::max(worst, std::abs(got[i] - expected[i]));
    CHECK(worst < 1e-3);
  }
}

TEST_CASE("instants: a reference angle is interpolated the short way round") {
  const test::SceneBench bench;
  std::string log = "t[s],w[deg/s],x[g],z[g],angle[deg]\n";
  for (int k = 0; k < 10; ++k) log += std::to_string(k) + ",10,0,1," + std::to_string(k < 5 ? 175 + k : k - 185) + "\n";
  bench.put("log.csv", log);
  const std::string scene = "sensors: [w, x, z]\ntilt: {gyroscope: w, accelerometer_x: x, accelerometer_z: z}\n";
  const auto truth = [&](const std::string& text) {
    const Scene read = bench.read(text);
    const Instants instants(read, no_progress());
    const double turn = 2 * std::acos(-1.0);
    const Columns columns = all_of(instants, 1, 9, 4);
    REQUIRE(columns.truth.size() == 8);
    for (Eigen::Index k = 0; k < 8; ++k) {
      const double degrees = columns.truth(0, k) * 360 / turn;
      CHECK(std::abs(degrees) >= 175);
      CHECK(std::abs(degrees) <= 190);
    }
  };
  truth(kHead + "recording: log.csv\nreference: {channels: [angle], lag_s: 0.5}\n" + scene);
  truth(kHead + "recording: {file: log.csv, resample_hz: 1.7}\nreference: angle\n" + scene);
}

TEST_CASE("resampling: devices that are sampled in turn each go by their own stamps") {
  const test::SceneBench bench;
  std::string log = "t[s],id,v\n";
  for (int k = 0; k < 60; ++k)
    for (const int second : {0, 1}) {
      const double t = 10 * k + 4 * second;
      if (k % 10 != 7 || second == 0) log += fmt::format("{},{},{}\n", t, second == 0 ? "a" : "b", 2 * t);
    }
  bench.put("log.csv", log);
  ReadOptions reading;
  reading.kinds.group_by = "id";
  const ResampledLog even = read_resampled(bench.path("log.csv"), reading, {"a", "b"}, 0.1, 2, no_progress());
  REQUIRE(even.samples.size() == 2);
  CHECK(std::isnan(even.samples[1][0]));  // before its first
  for (std::size_t i = 1; i + 1 < even.samples[1].size(); ++i) {
    CHECK(even.samples[0][i] == Approx(20.0 * static_cast<double>(i)));
    CHECK(even.samples[1][i] == Approx(20.0 * static_cast<double>(i)));
  }
  CHECK(even.log.warnings.find("slow_channel") == nullptr);
  CHECK(even.log.warnings.find("stamps_apart") == nullptr);
}

TEST_CASE("resample_hz goes by stamps that are dates as by numbers") {
  const test::SceneBench bench;
  std::string numbers = "t[s],a\n", dates = "time,a\n";
  for (int k = 0; k < 60; ++k) {
    const int ms = 100 * k + (k % 6 == 5 ? 30 : 0);
    numbers += fmt::format("{}.{:03},{}\n", ms / 1000, ms % 1000, ms);
    dates += fmt::format("2024-01-05T12:00:{:02}.{:03}Z,{}\n", ms / 1000, ms % 1000, ms);
  }
  const auto resampled = [&](const std::string& log) {
    bench.put("log.csv", log);
    return read_resampled(bench.path("log.csv"), {}, {"a"}, 20, 1, no_progress()).samples[0];
  };
  const std::vector<double> expected = resampled(numbers), got = resampled(dates);
  REQUIRE(got.size() == expected.size());
  for (std::size_t i = 0; i < got.size(); ++i) CHECK(got[i] == Approx(expected[i]).margin(1e-6));
}
