// Runs of one sensor in one likelihood.

#include "libchar/characterize/compare/runs.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "libchar/core/error.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;
using Catch::Contains;

namespace {

constexpr double kRate = 50;

struct Sensor {
  double q = 5e-3, b = 4e-3, k = 0;
};

Recording recording_of(std::vector<double> samples, const std::string& name, double offset) {
  Recording out;
  out.info.file = name;
  out.info.channels = {{"x", "deg/s"}};
  out.info.time.rate_hz = kRate;
  for (double& value : samples) value += offset;
  out.samples = {std::move(samples)};
  return out;
}

// Characterizing is slow beside what is tested here: curves and spectra are left out.
Characterization run_of(std::vector<double> samples, const std::string& name, double offset = 0) {
  CharacterizeOptions options;
  options.wanted.spectrum = false;
  options.fit.second_opinion = false;
  return characterize(recording_of(std::move(samples), name, offset), options);
}

std::vector<Characterization> runs_of(const Sensor& sensor, std::size_t count, std::size_t samples, std::uint64_t seed,
                                      double turn_on = 0) {
  test::NoiseSource noise(samples, kRate, seed);
  std::vector<Characterization> out;
  for (std::size_t r = 0; r < count; ++r) {
    std::vector<double> record = noise.record(sensor.q, sensor.b, sensor.k);
    out.push_back(run_of(std::move(record), "run" + std::to_string(r), turn_on * noise.gauss()()));
  }
  return out;
}

const PooledChannel& only(const PooledRuns& pooled) {
  REQUIRE(pooled.channels.size() == 1);
  return pooled.channels[0];
}

}  // namespace

TEST_CASE("pooled runs: one set of coefficients, as well known as all runs together allow") {
  const Sensor truth;
  const auto runs = runs_of(truth, 16, 6000, 1);
  const PooledChannel pooled = only(pool_runs(runs));
  CHECK(pooled.consistent);
  CHECK(pooled.runs.size() == 16);
  for (const auto& [term, value] : {std::pair(Term::white, truth.q), std::pair(Term::flicker, truth.b)}) {
    const Coefficient& c = pooled.fit[term];
    CAPTURE(static_cast<int>(term), value);
    REQUIRE(c.value);
    CHECK(std::abs(std::log(*c.value / value)) < 3 * c.relative_sd);
    // Sixteen runs know it four times as well as one.
    const Coefficient& one = (*runs[0].channels[0].fit)[term];
    if (one.value) CHECK(c.relative_sd < 0.4 * one.relative_sd);
  }
  CHECK(pooled.fit.samples == 16 * 6000);
  CHECK_FALSE(pooled.fit.term[0].bound);
}

TEST_CASE("pooled runs: intervals cover, and equal runs of unequal length are called unlike in 1 %") {
  const Sensor truth;
  int covered = 0, unlike = 0;
  constexpr int kSets = 40;
  for (int set = 0; set < kSets; ++set) {
    auto runs = runs_of(truth, 3, 4000, 100 + set);
    const auto longer = runs_of(truth, 2, 9000, 500 + set);
    runs.insert(runs.end(), longer.begin(), longer.end());
    for (std::size_t r = 0; r < runs.size(); ++r) runs[r].log.file = std::to_string(r);
    const PooledChannel pooled = only(pool_runs(runs));
    const Coefficient& white = pooled.fit[Term::white];
    covered += white.ci95.low <= truth.q && truth.q <= white.ci95.high;
    unlike += pooled.consistent ? 0 : 1;
  }
  CHECK(covered >= 33);  // 95 % of 40 less three and a half standard deviations
  CHECK(unlike <= 3);    // 1 % of 40; more than three by chance: 0.1 %
}

TEST_CASE("pooled runs: a run of another sensor is named, and the coefficients are those of the rest") {
  auto runs = runs_of({}, 7, 6000, 3);
  test::NoiseSource noise(6000, kRate, 77);
  runs.push_back(run_of(noise.record(6.5e-3, 4e-3, 0), "odd"));
  const PooledChannel pooled = only(pool_runs(runs));
  CHECK_FALSE(pooled.consistent);
  for (const ChannelRun& run : pooled.runs) CHECK(run.differs == (run.run == 7));
  REQUIRE(has(pooled.fit.findings, "runs_unlike"));
  CHECK_THAT(pooled.fit.findings.back().sentence, Contains("odd"));
  CHECK(pooled.rest_alike);
  const PooledChannel rest = only(pool_runs(runs_of({}, 7, 6000, 3)));
  CHECK(pooled.fit[Term::white].status == Status::detected);
  CHECK(pooled.fit[Term::white].value == rest.fit[Term::white].value);
  CHECK(pooled.fit[Term::white].ci95.high == rest.fit[Term::white].ci95.high);
}

TEST_CASE(
    "pooled runs: a run that was moved is left out, and said, and where too few are left, all are taken with "
    "what is known") {
  auto runs = runs_of({}, 3, 6000, 3);
  const auto spoil = [&](std::size_t r) {
    runs[r].channels[0].findings.push_back(finding("motion", "It was moved.", "moved in a stretch"));
    runs[r].channels[0].findings.back().severity = Severity::bad;
  };
  spoil(1);
  const PooledChannel sound = only(pool_runs(runs));
  REQUIRE(sound.runs.size() == 2);
  CHECK(sound.runs[1].run == 2);
  REQUIRE(has(sound.fit.findings, "run_left_out"));
  CHECK_THAT(sound.fit.findings.back().sentence, Contains("run1 was left out: moved in a stretch"));
  spoil(0);
  const PooledChannel all = only(pool_runs(runs));
  CHECK(all.runs.size() == 3);
  CHECK(has(all.fit.findings, "motion"));
  CHECK(worst_of(all.fit.findings) == Severity::bad);
}

TEST_CASE("pooled runs: where more than single runs differ, the common numbers say so") {
  auto runs = runs_of({}, 2, 6000, 3);
  test::NoiseSource noise(6000, kRate, 77), other(6000, kRate, 78);
  runs.push_back(run_of(noise.record(6.5e-3, 4e-3, 0), "one"));
  runs.push_back(run_of(other.record(6.5e-3, 4e-3, 0), "two"));
  const PooledChannel pooled = only(pool_runs(runs));
  CHECK_FALSE(pooled.consistent);
  CHECK_FALSE(pooled.rest_alike);
  CHECK(pooled.fit[Term::white].status == Status::misfit);
}

TEST_CASE("pooled runs: the turn-on bias has a spread beyond the noise, or a limit") {
  const PooledChannel steady = only(pool_runs(runs_of({}, 12, 4000, 5)));
  REQUIRE(steady.bias);
  CHECK(steady.bias->spread_ci95.high < 0.02);
  CHECK(steady.bias->spread_ci95.high > 0);
  CHECK(steady.bias->p > 0.01);
  const PooledChannel changing = only(pool_runs(runs_of({}, 12, 4000, 5, 0.1)));
  REQUIRE(changing.bias);
  CHECK(changing.bias->spread_ci95.low > 0.03);
  CHECK(changing.bias->p < 1e-3);
  CHECK(changing.bias->spread_ci95.low < 0.1);
  CHECK(changing.bias->spread_ci95.high > 0.1);
  CHECK_THAT(changing.sentences.at(1), Contains("from run to run"));
  // Another bias changes no noise.
  CHECK(*changing.fit[Term::white].value == Approx(*steady.fit[Term::white].value).epsilon(1e-9));
}

TEST_CASE("pooled runs: recordings that are not of one sensor are refused in a sentence") {
  const auto refusal = [](std::vector<Characterization> runs) -> std::string {
    try {
      pool_runs(runs);
    } catch (const Error& error) {
      return error.what();
    }
    return "accepted";
  };
  auto runs = runs_of({}, 2, 3000, 9);
  CHECK_THAT(refusal({runs[0]}), Contains("not several runs"));
  auto other = runs;
  other[1].channels[0].channel.unit = "rad/s";
  CHECK_THAT(refusal(other), Contains("run1") && Contains("E0761") && Contains("one unit"));
  other = runs;
  other[1].channels[0].channel.name = "y";
  CHECK_THAT(refusal(other), Contains("has no channel x"));
  other = runs;
  other[1].channels.push_back(other[1].channels[0]);
  other[1].channels[1].channel.name = "y";
  CHECK_THAT(refusal(other), Contains("has a channel y"));
  other = runs;
  other[1].log.time.rate_hz = 100;
  CHECK_THAT(refusal(other), Contains("one rate"));
  other = runs;
  other[1].channels[0].fit.reset();
  CHECK_THAT(refusal(other), Contains("could be fitted") && Contains("leave this run out"));
  other = runs;
  other[0].log.sha256 = other[1].log.sha256 = "ab";
  CHECK_THAT(refusal(other), Contains("E0762"));
}
