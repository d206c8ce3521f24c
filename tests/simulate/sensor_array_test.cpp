#include "libchar/simulate/sensor_array.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>

#include "libchar/core/error.hpp"
#include "libchar/core/numeric/moments.hpp"

using namespace libchar;

namespace {

Coefficient given(double value) {
  Coefficient c;
  c.status = Status::given;
  c.value = value;
  return c;
}

ArraySimulation three_sensors(std::uint64_t samples) {
  ArraySimulation s;
  s.rate_hz = 100;
  s.samples = samples;
  s.truth[0].kind = "sine";
  SensorModel m;
  m.unit = "deg/s";
  m.rate_hz = 100;
  m.noise = {given(1e-2), given(2e-3), given(1e-3), given(1e-4), given(1e-3)};
  m.bandwidth_hz = 20;
  m.bias.spread = 0.1;
  s.sensors = {{"a", m, {1}}, {"b", m, {-1}}, {"c", m, {0}}};
  return s;
}

std::vector<std::vector<double>> run(const ArraySimulation& s, std::size_t rows, int threads = 1) {
  ArraySimulator simulator(s, threads);
  std::vector<std::vector<double>> all;
  for (auto block = simulator.next(rows); !block.empty(); block = simulator.next(rows)) {
    all.resize(block.size());
    for (std::size_t c = 0; c < block.size(); ++c) all[c].insert(all[c].end(), block[c].begin(), block[c].end());
  }
  return all;
}

std::string refusal(const ArraySimulation& s) {
  try {
    check(s);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("sensor array: the same bits for any block size and number of threads") {
  ArraySimulation s = three_sensors(5000);
  s.faults = {{0, FaultKind::noise, 0.1, 10, 20}, {1, FaultKind::stuck, 0, 30, 31}};
  s.temperature = SignalSpec{};
  s.temperature->kind = "random_walk";
  for (const std::uint64_t oversampling : {1, 3}) {
    s.oversampling = oversampling;
    const auto whole = run(s, 5000);
    REQUIRE(whole.size() == 5);
    CHECK(whole[0].size() == 5000);
    CHECK(run(s, 1) == whole);
    CHECK(run(s, 777, 2) == whole);
  }
}

TEST_CASE("sensor array: another seed and another device are other noise, rows of H weigh the truth") {
  ArraySimulation s = three_sensors(4000);
  const auto one = run(s, 512);
  s.seed = 2;
  CHECK(run(s, 512)[0] != one[0]);
  double ab = 0, aa = 0, bb = 0;
  for (std::size_t k = 0; k < one[0].size(); ++k) {
    const double truth = one[3][k];
    CHECK(truth == Approx(std::sin(2 * 3.14159265358979323846 * static_cast<double>(k) / 100)).margin(1e-9));
    const double a = one[0][k] - one[0][0], b = one[1][k] - one[1][0];
    ab += a * b;
    aa += a * a;
    bb += b * b;
  }
  CHECK(ab / std::sqrt(aa * bb) < -0.9);  // h = 1 against h = -1
}

TEST_CASE("sensor array: one sensor more changes none of the others") {
  ArraySimulation s = three_sensors(1000);
  const auto three = run(s, 100);
  s.sensors.pop_back();
  const auto two = run(s, 100);
  CHECK(two[0] == three[0]);
  CHECK(two[1] == three[1]);
}

TEST_CASE("faults do what their names say, in their time") {
  ArraySimulation s;
  s.rate_hz = 10;
  s.samples = 60;
  s.truth[0].kind = "ramp";
  s.truth[0].slope = 1;
  SensorModel m;
  m.rate_hz = 10;
  s.sensors = {{"a", m, {1}}};
  const auto with = [&](FaultKind kind, double value) {
    ArraySimulation f = s;
    f.faults = {{0, kind, value, 2, 4}};
    return run(f, 7)[0];
  };
  const auto clean = run(s, 60)[0];
  const struct {
    FaultKind kind;
    double value;
    std::function<double(double)> expected;  // of t
  } cases[] = {{FaultKind::scale, 1.5, [](double t) { return 1.5 * t; }},
               {FaultKind::bias, 3, [](double t) { return t + 3; }},
               {FaultKind::ramp, 2, [](double t) { return t + 2 * (t - 2); }},
               {FaultKind::stuck, 0, [](double) { return 1.9; }},
               {FaultKind::saturation, 2.5, [](double t) { return std::min(t, 2.5); }}};
  for (const auto& one : cases) {
    const auto y = with(one.kind, one.value);
    for (std::size_t k = 0; k < 60; ++k) {
      INFO(name_of(one.kind) << " " << k);
      CHECK(y[k] == Approx(k >= 20 && k < 40 ? one.expected(clean[k]) : clean[k]).epsilon(1e-12));
    }
  }
  CHECK(std::isnan(with(FaultKind::dropout, 0)[30]));
  CHECK_FALSE(std::isnan(with(FaultKind::dropout, 0)[40]));
  const auto noisy = with(FaultKind::noise, 1);
  CHECK(noisy[19] == clean[19]);
  CHECK(noisy[25] != clean[25]);
  CHECK(noisy[40] == clean[40]);
}

TEST_CASE("sensor array: the truth columns pass a low-pass whose corner halves the power") {
  ArraySimulation s = three_sensors(20000);
  s.truth[0].frequency_hz = 1;
  const double before = run(s, 4096).at(3).at(10025);
  s.truth_bandwidth_hz = 1;
  const std::vector<double> truth = run(s, 4096).at(3);
  Moments moments;
  moments.push(std::span(truth).subspan(10000, 10000));
  CHECK(std::abs(before) == Approx(1));
  CHECK(moments.variance() == Approx(0.25).epsilon(0.01));  // of a sine: half, of which the corner takes half
}

TEST_CASE("sensor array: parts that do not fit together are refused") {
  CHECK(refusal(three_sensors(10)).empty());
  ArraySimulation s = three_sensors(10);
  s.sensors[1].name = "a";
  CHECK(refusal(s).find("two channels would be called a") != std::string::npos);
  s = three_sensors(10);
  s.sensors[0].h = {1, 2};
  CHECK(refusal(s).find("weighs 2 truth signals") != std::string::npos);
  s = three_sensors(0);
  CHECK_FALSE(refusal(s).empty());
  s = three_sensors(10);
  s.faults = {{3, FaultKind::bias, 1, 0, 1}};
  CHECK_FALSE(refusal(s).empty());
  s = three_sensors(10);
  s.truth[0].kind = "derivative";
  CHECK_FALSE(refusal(s).empty());
}

TEST_CASE("sensor array: noise that is renewed thousands of times between two samples is refused") {
  ArraySimulation s = three_sensors(10);
  s.sensors[1].model.white_hold_s = 1e-15;
  CHECK(refusal(s).find("E0554") != std::string::npos);
  CHECK(refusal(s).find("sensor b: white_hold_s of 1e-15 s") != std::string::npos);
  s.sensors[1].model.white_hold_s = 1e-4;
  CHECK(refusal(s).empty());
  s.sensors[2].model.flicker_hold_s = 1e-9;
  CHECK(refusal(s).find("sensor c: flicker_hold_s") != std::string::npos);
}
