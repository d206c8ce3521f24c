#include "libchar/characterize/compare/verification.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "libchar/fit/remedies.hpp"
#include "libchar/log/write.hpp"
#include "libchar/report/html/html_report.hpp"
#include "libchar/simulate/sensor_array.hpp"
#include "tests/support/noise.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;

namespace {

Coefficient given(double value) {
  Coefficient c;
  c.status = Status::given;
  c.value = value;
  return c;
}

// A recording of white noise, flicker and walk; `line` is the amplitude of a sine in it.
std::string recording(const test::TemporaryFolder& folder, std::uint64_t seed, double line, double line_hz = 5) {
  ArraySimulation s;
  s.rate_hz = 100;
  s.samples = 100000;
  s.seed = seed;
  s.truth[0].kind = "sine";
  s.truth[0].frequency_hz = line_hz;
  s.truth[0].amplitude = line;
  SensorModel m;
  m.unit = "deg/s";
  m.rate_hz = 100;
  m.noise = {given(1e-3), given(5e-3), given(3e-3), {}, {}};
  s.sensors = {{"g", m, {1}}};
  LogInfo info;
  info.channels = {{"g", "deg/s", false}};
  info.time.rate_hz = 100;
  const std::string path = (folder / ("r" + std::to_string(seed) + ".f64")).string();
  WriteOptions options;
  options.format = "raw";
  options.overwrite = true;
  const auto writer = open_log_writer(path, info, options);
  ArraySimulator simulator(s);
  for (auto block = simulator.next(8192); !block.empty(); block = simulator.next(8192)) writer->write(block.first(1));
  writer->finish();
  return path;
}

}  // namespace

TEST_CASE("verification: a model of simulated noise agrees, whatever the seeds") {
  const test::TemporaryFolder folder;
  std::size_t agreeing = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    Characterization result = characterize(recording(folder, seed, 0), {});
    VerifyOptions how;
    how.seed = 100 + seed;
    agreeing += verify(result, {}, how);
    const ChannelVerification& v = *result.channels[0].verification;
    CHECK(v.points.size() > 12);
    CHECK(v.terms.size() == 3);
    CHECK(v.agrees == (v.sentences.size() == 1));
  }
  CHECK(agreeing >= 11);  // each point and term has its share of false alarms, about 1 % together
}

TEST_CASE("verification: a slow cycle that the fit took out is in the simulated record too") {
  const test::TemporaryFolder folder;
  std::size_t agreeing = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    Characterization result = characterize(recording(folder, seed, 0.5, 0.0123), {});
    double largest = 0;
    for (const Event& cycle : result.channels[0].fit->cycles) largest = std::max(largest, cycle.size);
    CHECK(largest == Approx(0.5).epsilon(0.1));
    agreeing += verify(result, {});
  }
  CHECK(agreeing >= 5);
}

TEST_CASE("verification: what the model lacks is found at its averaging times") {
  const test::TemporaryFolder folder;
  Characterization result = characterize(recording(folder, 1, 0.02), {});
  CHECK_FALSE(verify(result, {}));
  const ChannelVerification& v = *result.channels[0].verification;
  bool near_line = false;
  for (const PointVerification& point : v.points) {
    if (point.tau_s < 0.2) near_line = near_line || (!point.agrees && point.ratio > 1.05);
    if (point.tau_s > 10) CHECK(point.agrees);
  }
  CHECK(near_line);
  CHECK(v.sentences.size() >= 2);
}

TEST_CASE("verification: spikes that the fit left out are named where the curves differ") {
  Recording spiky;
  spiky.info.channels = {{"g", "deg/s", false}};
  spiky.info.time.rate_hz = 100;
  spiky.samples = {test::NoiseSource(60'000, 100, 5).record(5e-3, 0, 0)};
  for (std::size_t t = 500; t < 60'000; t += 1'500) spiky.samples[0][t] += 3;
  Characterization result = characterize(spiky, {});
  REQUIRE(find_remedy(*result.channels[0].fit, "spikes") != nullptr);
  CHECK_FALSE(verify(result, {}));
  CHECK(result.channels[0].verification->sentences.back() ==
        "The recording's curve holds 40 spikes that were left out of the fit.");
}

TEST_CASE("verification: same seed, same bytes, it stands in every output") {
  const test::TemporaryFolder folder;
  const std::string log = recording(folder, 3, 0);
  Characterization a = characterize(log, {}), b = characterize(log, {});
  verify(a, {});
  verify(b, {});
  CHECK(html_report(a) == html_report(b));
  Json report = json_report(a);
  CHECK(report["verification"]["channels"][0]["agrees"] == a.channels[0].verification->agrees);
  CHECK(report["verification"]["channels"][0]["allan"]["tau_s"].size() ==
        report["allan"]["channels"][0]["tau_s"].size());
  CHECK(html_report(a).find("Simulated from the model") != std::string::npos);
  Characterization plain = characterize(log, {});
  CHECK_FALSE(json_report(plain).contains("verification"));
}
